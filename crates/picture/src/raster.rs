//! The z-buffer: nine samples per pixel, one layer per shape, layers laid over each other from far to near.

use super::colour::{Linear, mix, tint};
use super::layer::{Drawable, Fragment, Layer, Seen};
use super::scene::Scene;
use rayon::prelude::*;

/// Pixels in linear light.
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Linear>,
}

/// Samples per pixel along each direction.
pub(super) const SAMPLES: usize = 3;
/// Rows of pixels rendered at a time.
pub(super) const BAND: usize = 8;
/// Layers over each other in a band; further shapes are not drawn there.
const LAYERS: usize = 64;

pub(super) fn render(scene: &Scene, width: usize, height: usize) -> Image {
    let mut pixels = vec![[0.0; 3]; width * height];
    let shapes: Vec<Drawable> =
        scene.shapes.par_iter().map(|shape| Drawable::new(scene, shape, width, height)).collect();
    pixels.par_chunks_mut(BAND * width).enumerate().with_max_len(1).for_each(|(band, pixels)| {
        let (first, rows) = (band * BAND, pixels.len() / width);
        let layers: Vec<Layer> = shapes.iter().filter_map(|shape| Layer::of(shape, band, rows)).take(LAYERS).collect();
        for (row, pixels) in pixels.chunks_mut(width).enumerate() {
            let behind = scene.ground.at((first + row) as f64 / height as f64).linear();
            for (column, out) in pixels.iter_mut().enumerate() {
                *out = pixel(&layers, row, column, behind);
            }
        }
    });
    Image { width, height, pixels }
}

/// The mean of a pixel's samples.
fn pixel(layers: &[Layer], row: usize, column: usize, behind: Linear) -> Linear {
    let mut only = None;
    let mut covering = 0;
    for layer in layers {
        match layer.seen(row, column) {
            Seen::Nothing => continue,
            Seen::Whole(fragment) => only = Some(fragment),
            Seen::Part => only = None,
        }
        covering += 1;
    }
    // Most of a picture is background, and most of a body one layer and one triangle per pixel.
    match (covering, only) {
        (0, _) => return behind,
        (1, Some(fragment)) => return laid(fragment, false, behind),
        _ => {}
    }
    let mut sum = [0.0; 3];
    for k in 0..SAMPLES * SAMPLES {
        let sample = through(layers, row * SAMPLES + k / SAMPLES, column * SAMPLES + k % SAMPLES, behind);
        sum = std::array::from_fn(|k| sum[k] + sample[k]);
    }
    sum.map(|value| value / (SAMPLES * SAMPLES) as f32)
}

/// What is seen through all layers at one sample.
fn through(layers: &[Layer], row: usize, column: usize, behind: Linear) -> Linear {
    let mut colour = behind;
    let mut opaque = false;
    // Layers are few: pick the farthest one not yet laid down.
    let mut done = 0_u64;
    for _ in 0..layers.len() {
        let mut next: Option<(usize, f32, &Fragment)> = None;
        for (index, layer) in layers.iter().enumerate().filter(|(index, _)| done >> index & 1 == 0) {
            let Some((z, fragment)) = layer.at(row, column) else { continue };
            if next.is_none_or(|(_, farthest, _)| z < farthest) {
                next = Some((index, z, fragment));
            }
        }
        let Some((index, _, fragment)) = next else { break };
        done |= 1 << index;
        colour = laid(fragment, opaque, colour);
        opaque |= layers[index].opaque;
    }
    colour
}

/// A fragment over a colour. Glass before an opaque body shows by its lines only: tinting would falsify the colours, in
/// patches where two surfaces nearly coincide.
fn laid(fragment: &Fragment, over_opaque: bool, colour: Linear) -> Linear {
    if fragment.glass && over_opaque {
        return colour;
    }
    let mixed = if fragment.glass { tint } else { mix };
    mixed(colour, fragment.colour, fragment.opacity)
}
