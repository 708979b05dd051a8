//! Painter's algorithm: pieces of all bodies from far to near, as SVG.

use std::fmt::Write;

use super::colour::to_srgb;
use super::frame::{Anchor, Mark};
use super::picture::Picture;
use super::scene::{Corner, Fill, Scene, Shape};
use super::shade::{self, Ground};
use super::vector::{V3, add, scale, sub};

pub(super) fn draw(picture: &Picture, scene: &Scene, marks: &[Mark]) -> String {
    let mut out = head(&picture.title, picture.width, picture.height, scene.ground);
    for item in items(scene) {
        let _ = writeln!(out, "{}", item.text);
    }
    finish(out, marks)
}

/// Marks alone, on the same ground.
pub(super) fn flat(title: &str, size: (u32, u32), marks: &[Mark]) -> String {
    finish(head(title, size.0, size.1, Ground::Shaded), marks)
}

/// Whole drawings, each with the left upper corner at its place.
pub(super) fn sheet([width, height]: [usize; 2], panels: &[([usize; 2], String)]) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n"
    );
    for ([x, y], panel) in panels {
        let _ = write!(out, "<g transform=\"translate({x} {y})\">\n{panel}</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

fn head(title: &str, width: u32, height: u32, ground: Ground) -> String {
    let mut out = String::new();
    let (top, bottom) = (ground.at(0.0).hex(), ground.at(1.0).hex());
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">
<title>{}</title>
<defs><linearGradient id="paper" x2="0" y2="1"><stop stop-color="{top}"/><stop offset="1" stop-color="{bottom}"/></linearGradient></defs>
<rect width="{width}" height="{height}" fill="url(#paper)"/>
<g stroke-linejoin="round" stroke-linecap="round" fill="none">"#,
        nastic_io::escape(title)
    );
    out
}

fn finish(mut out: String, marks: &[Mark]) -> String {
    out.push_str("</g>\n<g font-family=\"Noto Sans Mono, DejaVu Sans Mono, monospace\">\n");
    for mark in marks {
        self::mark(&mut out, mark);
    }
    out.push_str("</g>\n</svg>\n");
    out
}

/// A piece to paint.
struct Item {
    /// Glass is painted first: before an opaque body it shows by its lines only.
    glass: bool,
    depth: f64,
    text: String,
}

/// All pieces, farthest first; the order of equals is that of the bodies.
fn items(scene: &Scene) -> Vec<Item> {
    let mut items = Vec::new();
    for shape in &scene.shapes {
        items.extend(shape.pieces.iter().filter_map(|piece| fill(scene, shape, piece)));
        items.extend(lines(shape));
    }
    items.sort_by(|a, b| b.glass.cmp(&a.glass).then(a.depth.total_cmp(&b.depth)));
    items
}

fn fill(scene: &Scene, shape: &Shape, piece: &[Corner]) -> Option<Item> {
    let [a, b] = [1, piece.len() - 1].map(|k| sub(piece[k].at, piece[0].at));
    let area = a[0] * b[1] - a[1] * b[0];
    // Closed bodies: what faces away is hidden.
    if area == 0.0 || (!scene.plane && !shape.open && area > 0.0) {
        return None;
    }
    let mean = |of: &dyn Fn(&Corner) -> f64| piece.iter().map(of).sum::<f64>() / piece.len() as f64;
    let normal: V3 = std::array::from_fn(|k| mean(&|corner| corner.normal[k]));
    let base = match (shape.fill, &scene.bar) {
        (Fill::Mapped, Some(bar)) => bar.map.colour(mean(&|corner| corner.value)),
        (Fill::Opaque(colour) | Fill::Glass(colour), _) => colour,
        (Fill::None, _) | (Fill::Mapped, None) => return None,
    };
    let colour = if scene.plane { base } else { to_srgb(shade::lit(base.linear(), normal)) }.hex();
    let place = points(&piece.iter().map(|corner| corner.at).collect::<Vec<_>>());
    let glass = matches!(shape.fill, Fill::Glass(_));
    let text = if glass {
        format!(r#"<path d="{place}z" fill="{colour}" fill-opacity="{:.2}"/>"#, shade::glass(normal))
    } else {
        // A hair of its own colour closes the seams between neighbours.
        format!(r#"<path d="{place}z" fill="{colour}" stroke="{colour}" stroke-width=".7"/>"#)
    };
    Some(Item { glass, depth: mean(&|corner| corner.at[2]) + shape.forward, text })
}

fn lines(shape: &Shape) -> impl Iterator<Item = Item> {
    shape.strokes.iter().flat_map(move |stroke| {
        stroke.points.windows(2).map(move |pair| {
            let middle = scale(add(pair[0], pair[1]), 0.5);
            let text = format!(
                r#"<path d="{}" stroke="{}" stroke-opacity="{:.2}" stroke-width="{:.1}"/>"#,
                points(pair),
                stroke.colour.hex(),
                stroke.opacity,
                stroke.width
            );
            // Nearer than the pieces they border on.
            Item { glass: false, depth: middle[2] + shape.forward + stroke.lift.max(6.0), text }
        })
    })
}

fn points(points: &[V3]) -> String {
    let mut out = String::new();
    for (k, p) in points.iter().enumerate() {
        let _ = write!(out, "{}{:.1} {:.1}", if k == 0 { "M" } else { "L" }, p[0], p[1]);
    }
    out
}

fn mark(out: &mut String, mark: &Mark) {
    let _ = match mark {
        Mark::Line { from, to, width, colour } => writeln!(
            out,
            r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" stroke="{}" stroke-width="{width:.1}"/>"#,
            from[0],
            from[1],
            to[0],
            to[1],
            colour.hex()
        ),
        Mark::Polygon { points, colour, opacity } => {
            let flat: Vec<V3> = points.iter().map(|p| [p[0], p[1], 0.0]).collect();
            writeln!(out, r#"<path d="{}z" fill="{}" fill-opacity="{opacity:.2}"/>"#, self::points(&flat), colour.hex())
        }
        Mark::Text { at, anchor, height, bold, colour, text } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            writeln!(
                out,
                r#"<text x="{:.1}" y="{:.1}" font-size="{:.1}" font-weight="{}" text-anchor="{anchor}" dominant-baseline="central" fill="{}">{}</text>"#,
                at[0],
                at[1],
                0.76 * height,
                if *bold { "bold" } else { "normal" },
                colour.hex(),
                nastic_io::escape(text)
            )
        }
    };
}
