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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test may

    use super::*;
    use crate::scene::{Corner, Fill, Shape, Stroke};
    use crate::{Body, Colour, Picture};
    use nastic_mesh::{CellKind, box_mesh};

    /// On white.
    fn image(shapes: Vec<Shape>) -> Image {
        let body = Body::new("any", box_mesh([1.0; 3], [1; 3], CellKind::Hex8).unwrap());
        let mut scene = Scene::new(&Picture::new("").plain().body(body)).unwrap();
        scene.shapes = shapes;
        render(&scene, 80, 60)
    }

    fn shape(fill: Fill, pieces: Vec<Vec<Corner>>, strokes: Vec<Stroke>) -> Shape {
        Shape { fill, pieces, strokes, forward: 0.0, open: false }
    }

    /// A line of length l and width w with round ends covers `l w + pi w^2 / 4` pixels, whatever its slope.
    #[test]
    fn lines_cover_their_area() {
        for [x, y] in [[60.0, 45.0], [60.0, 5.1], [8.0, 50.0], [5.1, 50.0], [70.0, 8.0]] {
            let points = vec![[5.1, 5.1, 0.0], [x, y, 0.0]];
            let stroke = Stroke { points, colour: Colour([0; 3]), opacity: 1.0, width: 3.0, lift: 0.0 };
            let image = image(vec![shape(Fill::None, vec![], vec![stroke])]);
            let inked: f32 = image.pixels.iter().map(|pixel| 1.0 - pixel[0]).sum();
            let area = 3.0 * f64::hypot(x - 5.1, y - 5.1) + 0.25 * std::f64::consts::PI * 9.0;
            assert!((f64::from(inked) / area - 1.0).abs() < 0.02, "{x} {y}: {inked} of {area}");
        }
    }

    /// Two planes that cross at x = 10.4: left of it one is seen, right of it the other, and within the pixel both.
    #[test]
    fn pixels_in_which_surfaces_cross_show_both() {
        let plane = |slope: f64| {
            let corner =
                |x: f64, y: f64| Corner { at: [x, y, slope * (x - 10.4)], normal: [0.0, 0.0, 1.0], value: 0.0 };
            vec![corner(0.0, 0.0), corner(40.0, 0.0), corner(40.0, 40.0), corner(0.0, 40.0)]
        };
        let opaque = |colour, slope| shape(Fill::Opaque(Colour(colour)), vec![plane(slope)], vec![]);
        let image = image(vec![opaque([255, 0, 0], 1.0), opaque([0, 0, 255], -1.0)]);
        let at = |column: usize| image.pixels[5 * image.width + column];
        let (left, middle, right) = (at(9), at(10), at(11));
        assert!(left[2] > 0.5 && right[0] > 0.5 && left[0] < 0.3 * left[2] && right[2] < 0.3 * right[0]);
        let mean: Linear = std::array::from_fn(|k| (left[k] + 2.0 * right[k]) / 3.0);
        assert!(mean.iter().zip(middle).all(|(mean, found)| (mean - found).abs() < 1e-5), "{middle:?}");
    }
}
