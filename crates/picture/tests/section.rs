//! Bodies cut by a plane, paths, and pictures for print.

#![allow(clippy::unwrap_used)] // clippy.toml frees test functions, not their helpers

use crate::picture::{bare, cube, from_the_front, pixels};
use nastic_mesh::{CellKind, box_mesh, rectangle};
use nastic_picture::{Appearance, Body, Colour, Field, Picture, View};

/// Coloured by y, of which the section at 0.45 shows that value wherever it is looked at; nothing of it is missing.
#[test]
fn a_section_shows_what_is_within() {
    for kind in [CellKind::Tet4, CellKind::Tet10, CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
        let mesh = cube(kind);
        let field = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let values = mesh.points().iter().map(value).collect();
            Appearance::Field(Field::at_nodes("y", "", values).range(0.0, 1.0))
        };
        let cut = bare(&mesh, field(&|p| p[1])).clip([0.0, -2.0, 0.0], -0.9);
        let (cut, whole) =
            (pixels(&from_the_front().body(cut)), pixels(&from_the_front().body(bare(&mesh, field(&|_| 0.45)))));
        let mut seen = 0;
        for y in 40..250 {
            for x in 0..320 {
                let (a, b) = (cut.at(x, y), whole.at(x, y));
                let differ = a.iter().zip(b).any(|(a, b)| a.abs_diff(b) > 3);
                // the outlines are drawn on a pixel or two
                let is_inner = (2..318).contains(&x)
                    && (-3_i32..=3).all(|d| {
                        whole.at((x as i32 + d).max(0) as usize, y) == b && whole.at(x, (y as i32 + d) as usize) == b
                    });
                assert!(!is_inner || !differ, "{}: {a:?} where {b:?} is wanted at {x}, {y}", kind.name());
                seen += usize::from(is_inner && b != whole.at(1, y));
            }
        }
        assert!(seen > 5000, "{}: {seen}", kind.name());
    }
}

/// A wall of a tenth around a hollow: through the section one sees the far wall from within.
#[test]
fn what_lies_behind_a_section_is_seen() {
    let mesh = box_mesh([1.0, 1.0, 1.0], [1, 1, 1], CellKind::Hex8).unwrap();
    let outer = bare(&mesh, Appearance::Glass(Colour::GREY)).clip([0.0, -1.0, 0.0], -0.5);
    let small = mesh.points().iter().map(|p| p.map(|x| 0.25 + 0.5 * x)).collect();
    let inner = bare(&mesh, Appearance::Solid(Colour::RED)).at(small);
    let picture = pixels(&from_the_front().body(outer).body(inner));
    let [r, g, b] = picture.middle();
    assert!(u32::from(r) > 2 * u32::from(g.max(b)), "{r} {g} {b}");
}

#[test]
fn planes_that_cut_nothing_are_refused() {
    let refused = |body: Body| Picture::new("").body(body).png().unwrap_err().to_string();
    let body = || Body::new("beam", cube(CellKind::Hex8));
    assert!(refused(body().clip([0.0; 3], 0.0)).contains("normal is zero"));
    let sheet = Body::new("sheet", rectangle([1.0, 1.0], [2, 2], CellKind::Quad4).unwrap());
    assert!(refused(sheet.clip([1.0, 0.0, 0.0], 0.5)).contains("\"sheet\" is plane"));
    let path = Picture::new("").body(body()).path("tip", Colour::RED, vec![[f64::NAN; 3]]);
    assert!(path.png().unwrap_err().to_string().contains("path \"tip\""));
}

#[test]
fn pictures_for_print_are_white_and_name_their_paths() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("a.svg");
    let picture = || {
        let path = vec![[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]];
        Picture::new("a diary")
            .subtitle("of the run")
            .view(View::From([0.0, -1.0, 0.0]))
            .size(640, 400)
            .plain()
            .body(Body::new("body", cube(CellKind::Hex8)))
            .path("path of the tip", Colour::GREEN, path)
    };
    picture().write(&file).unwrap();
    let svg = std::fs::read_to_string(&file).unwrap();
    assert!(svg.contains(">path of the tip</text>") && !svg.contains("of the run"), "{svg}");
    let image = pixels(&picture());
    for (x, y) in [(1, 1), (638, 1), (1, 398), (638, 398)] {
        assert_eq!(image.at(x, y), [255; 3]);
    }
    let [r, g, b] = Colour::GREEN.0;
    assert!(svg.contains(&format!("stroke=\"#{r:02x}{g:02x}{b:02x}\"")));
}
