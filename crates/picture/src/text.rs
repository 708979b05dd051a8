//! Rasterisation: lines and polygons with antialiased edges, text from a rasterised font.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::colour::{Colour, tint};
use super::frame::{Anchor, Mark};
use super::raster::Image;

pub(super) fn draw(image: &mut Image, marks: &[Mark]) {
    for mark in marks {
        match mark {
            Mark::Line { from, to, width, colour } => line(image, *from, *to, *width, *colour),
            Mark::Polygon { points, colour, opacity } => polygon(image, points, *colour, *opacity),
            Mark::Text { at, anchor, height, bold, colour, text } => {
                let style = Style { size: nearest(*height), weight: weight(*bold) };
                letters(image, *at, *anchor, style, *colour, text);
            }
        }
    }
}

/// Width in pixels of a text of that height.
pub(super) fn width(text: &str, height: f64) -> f64 {
    (text.chars().count() * get_raster_width(FontWeight::Regular, nearest(height))) as f64
}

#[derive(Clone, Copy)]
struct Style {
    size: RasterHeight,
    weight: FontWeight,
}

fn weight(bold: bool) -> FontWeight {
    if bold { FontWeight::Bold } else { FontWeight::Regular }
}

fn nearest(height: f64) -> RasterHeight {
    match height {
        height if height < 18.0 => RasterHeight::Size16,
        height if height < 22.0 => RasterHeight::Size20,
        height if height < 28.0 => RasterHeight::Size24,
        _ => RasterHeight::Size32,
    }
}

fn letters(image: &mut Image, at: [f64; 2], anchor: Anchor, style: Style, colour: Colour, text: &str) {
    let advance = get_raster_width(style.weight, style.size);
    let total = (advance * text.chars().count()) as f64;
    let left = match anchor {
        Anchor::Start => at[0],
        Anchor::Middle => at[0] - 0.5 * total,
        Anchor::End => at[0] - total,
    };
    let top = at[1] - 0.5 * style.size.val() as f64;
    for (index, letter) in text.chars().enumerate() {
        let raster = get_raster(letter, style.weight, style.size).or_else(|| get_raster('?', style.weight, style.size));
        let Some(raster) = raster else { continue };
        for (row, line) in raster.rows().enumerate() {
            for (column, intensity) in line.iter().enumerate() {
                let x = left.round() as i64 + (index * advance + column) as i64;
                blend(image, x, top.round() as i64 + row as i64, colour, f32::from(*intensity) / 255.0);
            }
        }
    }
}

fn line(image: &mut Image, from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let size = along[0].hypot(along[1]);
    if size == 0.0 {
        return;
    }
    let side = [-along[1] / size * 0.5 * width, along[0] / size * 0.5 * width];
    let corner = |p: [f64; 2], sign: f64| [p[0] + sign * side[0], p[1] + sign * side[1]];
    polygon(image, &[corner(from, 1.0), corner(to, 1.0), corner(to, -1.0), corner(from, -1.0)], colour, 1.0);
}

/// A convex polygon, sixteen samples per pixel.
fn polygon(image: &mut Image, points: &[[f64; 2]], colour: Colour, opacity: f32) {
    const SAMPLES: usize = 4;
    let range = |axis: usize, most: usize| {
        let values = points.iter().map(|p| p[axis]);
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        (low.floor().clamp(0.0, most as f64) as i64, high.ceil().clamp(0.0, most as f64) as i64)
    };
    let (left, right) = range(0, image.width);
    let (top, bottom) = range(1, image.height);
    for y in top..bottom {
        for x in left..right {
            let mut inside_count = 0;
            for k in 0..SAMPLES * SAMPLES {
                let offset = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
                inside_count +=
                    usize::from(inside(points, x as f64 + offset(k % SAMPLES), y as f64 + offset(k / SAMPLES)));
            }
            let covered = inside_count as f32 / (SAMPLES * SAMPLES) as f32;
            blend(image, x, y, colour, opacity * covered);
        }
    }
}

fn inside(points: &[[f64; 2]], x: f64, y: f64) -> bool {
    let side = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % points.len()]);
        (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
    };
    let (mut left, mut right) = (true, true);
    for k in 0..points.len() {
        left &= side(k) >= 0.0;
        right &= side(k) <= 0.0;
    }
    left || right
}

fn blend(image: &mut Image, x: i64, y: i64, colour: Colour, opacity: f32) {
    if opacity <= 0.0 || x < 0 || y < 0 || x >= image.width as i64 || y >= image.height as i64 {
        return;
    }
    let pixel = &mut image.pixels[y as usize * image.width + x as usize];
    *pixel = tint(*pixel, colour.linear(), opacity);
}
