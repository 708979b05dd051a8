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
        let columns = layers.iter().map(Layer::columns);
        let shown = columns.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0);
        for (row, pixels) in pixels.chunks_mut(width).enumerate() {
            let behind = scene.ground.at((first + row) as f64 / height as f64).linear();
            pixels.fill(behind);
            for (column, out) in shown.clone().zip(&mut pixels[shown.clone()]) {
                *out = pixel(&layers, row, column, behind);
            }
        }
    });
    Image { width, height, pixels }
}

/// The mean of a pixel's samples.
fn pixel(layers: &[Layer], row: usize, column: usize, behind: Linear) -> Linear {
    let (mut covering, mut last, mut whole) = (0_u64, None, true);
    for (index, layer) in layers.iter().enumerate() {
        match layer.seen(row, column) {
            Seen::Nothing => continue,
            Seen::Whole(fragment) => last = Some(fragment),
            Seen::Part => whole = false,
        }
        covering |= 1 << index;
    }
    // Most of a picture is background, and most of a body one layer and one triangle per pixel.
    match (covering.count_ones(), last) {
        (0, _) => return behind,
        (1, Some(fragment)) if whole => return laid(fragment, false, behind),
        _ => {}
    }
    let (row, column) = (row * SAMPLES, column * SAMPLES);
    // Each layer is one plane there: those of which one is in front of the other at all corners do not cross.
    let corners = || [0, SAMPLES - 1].into_iter().flat_map(|k| [(row + k, column), (row + k, column + SAMPLES - 1)]);
    if whole && corners().skip(1).all(|at| is_ordered_alike(layers, covering, (row, column), at)) {
        return through(layers, covering, (row, column), behind);
    }
    let mut sum = [0.0; 3];
    for k in 0..SAMPLES * SAMPLES {
        let sample = through(layers, covering, (row + k / SAMPLES, column + k % SAMPLES), behind);
        sum = std::array::from_fn(|k| sum[k] + sample[k]);
    }
    sum.map(|value| value / (SAMPLES * SAMPLES) as f32)
}

/// Whether all these layers, each of which covers both samples, lie in the same order at both.
fn is_ordered_alike(layers: &[Layer], covering: u64, a: (usize, usize), b: (usize, usize)) -> bool {
    let depth = |index: usize, (row, column): (usize, usize)| layers[index].at(row, column).map(|(z, _)| z);
    let is_in = |index: &usize| covering >> index & 1 == 1;
    (0..layers.len()).filter(is_in).all(|one| {
        let mut others = (0..one).filter(is_in);
        others.all(|other| (depth(other, a) < depth(one, a)) == (depth(other, b) < depth(one, b)))
    })
}

/// What is seen at one sample through the layers that may cover it.
fn through(layers: &[Layer], covering: u64, (row, column): (usize, usize), behind: Linear) -> Linear {
    let mut colour = behind;
    let mut opaque = false;
    // Layers are few: pick the farthest one not yet laid down.
    let mut left = covering;
    while left != 0 {
        let mut next: Option<(usize, f32, &Fragment)> = None;
        for (index, layer) in layers.iter().enumerate() {
            if left >> index & 1 == 0 {
                continue;
            }
            let Some((z, fragment)) = layer.at(row, column) else { continue };
            if next.is_none_or(|(_, farthest, _)| z < farthest) {
                next = Some((index, z, fragment));
            }
        }
        let Some((index, _, fragment)) = next else { break };
        left &= !(1 << index);
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
