//! Outlines of cut bodies, without Gmsh.

#![allow(clippy::unwrap_used)] // helpers of tests

use nastic_mesh::{CellKind, Facet, LevelBody, Mesh, box_mesh, rectangle};
use nastic_remesh::{BorderFacet, KeptBody, Outline};
use nastic_result::made_body::MadePart;
use std::collections::{BTreeMap, BTreeSet};

/// Where a field is above zero, and with `both` where it is below too.
fn parts(mesh: &Mesh, field: impl Fn(&[f64; 3]) -> f64, both: bool) -> Vec<MadePart> {
    let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
    let values: Vec<f64> = mesh.points().iter().map(field).collect();
    let part = |sign: f64| {
        let body = LevelBody::of_nodes(mesh, &cells, values.iter().map(|s| sign * s).collect(), 1.0).above(0.0);
        let simplices = body.simplices(mesh.points());
        MadePart { simplices, regions: Vec::new(), names: Vec::new(), mixed: Vec::new(), second: Vec::new() }
    };
    if both { vec![part(1.0), part(-1.0)] } else { vec![part(1.0)] }
}

fn border_of(mesh: &Mesh, body: &KeptBody) -> (Vec<String>, Vec<BorderFacet>) {
    let facets: Vec<&[Facet]> = mesh.surfaces().values().map(Vec::as_slice).collect();
    (mesh.surfaces().keys().cloned().collect(), body.border(mesh, &facets))
}

fn apart(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let to = [p[0] - a[0], p[1] - a[1]];
    let share = ((along[0] * to[0] + along[1] * to[1]) / (along[0].powi(2) + along[1].powi(2))).clamp(0.0, 1.0);
    (to[0] - share * along[0]).hypot(to[1] - share * along[1])
}

/// A plate with a round hole: the outline is coarser, near the old one, closed, and ends where surfaces do.
#[test]
fn a_plate_with_a_hole() {
    let mesh = rectangle([4.0, 2.0], [40, 20], CellKind::Quad4).unwrap();
    // the end of a surface on a straight edge is no corner
    let lower =
        mesh.surface("y-").unwrap().iter().copied().filter(|facet| mesh.cell_centre(facet.cell as usize)[0] < 2.1);
    let lower = lower.collect();
    let mesh = mesh.with_surface("left of it", lower);
    let hole = |x: &[f64; 3]| (x[0] - 2.03).hypot(x[1] - 1.01) - 0.6;
    let body = KeptBody::of(&mesh, &parts(&mesh, hole, false));
    let (names, border) = border_of(&mesh, &body);
    assert_eq!(body.pieces.len(), 1);
    let area = 8.0 - std::f64::consts::PI * 0.36;
    assert!((body.total() / area - 1.0).abs() < 2e-3, "{}", body.total());
    let size = 0.2;
    let mut outline = Outline::new(2, &body.points, &border, BTreeSet::new(), size);
    let (before, short) = (outline.facets.len(), outline.shortest_edge());
    let removed = outline.simplify();
    assert_eq!(outline.facets.len(), before - removed);
    assert!(removed > 20 && outline.shortest_edge() > 10.0 * short, "{removed} {short} {}", outline.shortest_edge());
    let segments: Vec<[[f64; 3]; 2]> =
        outline.facets.iter().map(|(n, _)| [0, 1].map(|k| outline.points[n[k] as usize])).collect();
    for node in border.iter().flat_map(|facet| &facet.nodes) {
        let p = body.points[*node as usize];
        let nearest = segments.iter().map(|own| apart(p, *own)).fold(f64::INFINITY, f64::min);
        assert!(nearest <= 0.1 * size + 1e-12, "{p:?} {nearest}");
    }
    // by Green's theorem, the body on the left of every edge
    let own: f64 = segments.iter().map(|[a, b]| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum();
    assert!((own / area - 1.0).abs() < 0.01, "{own} {area}");
    for (number, name) in names.iter().enumerate() {
        let expected = match name.as_str() {
            "x-" | "x+" => 2.0,
            "left of it" => 2.1,
            _ => 4.0,
        };
        assert!((outline.measure_of(number) - expected).abs() < 1e-12, "{name} {}", outline.measure_of(number));
    }
}

/// A ball in a block, both kept: two pieces that share the facets between them; each is closed.
#[test]
fn a_ball_in_a_block() {
    let mesh = box_mesh([2.0, 1.6, 1.6], [10, 8, 8], CellKind::Hex8).unwrap();
    let ball = |x: &[f64; 3]| 0.5 - ((x[0] - 1.03).powi(2) + (x[1] - 0.81).powi(2) + (x[2] - 0.8).powi(2)).sqrt();
    let body = KeptBody::of(&mesh, &parts(&mesh, ball, true));
    assert_eq!(body.pieces.len(), 2);
    assert!((body.total() - 5.12).abs() < 1e-9, "{}", body.total());
    let (_, border) = border_of(&mesh, &body);
    // what has nothing on the other side is on the skin of the block
    for facet in border.iter().filter(|facet| facet.outside.is_none()) {
        assert_eq!(facet.surfaces.len(), 1, "{facet:?}");
    }
    let mut outline = Outline::new(3, &body.points, &border, BTreeSet::new(), 0.2);
    let short = outline.shortest_edge();
    outline.simplify();
    assert!(outline.shortest_edge() > 0.02 && short < 0.01, "{short} {}", outline.shortest_edge());
    for (number, piece) in body.pieces.iter().enumerate() {
        let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        let mut volume = 0.0;
        for (nodes, patch) in &outline.facets {
            let patch = &outline.patches[*patch];
            let sign = if patch.inside == number as u32 {
                1
            } else if patch.outside == Some(number as u32) {
                -1
            } else {
                continue;
            };
            for k in 0..3 {
                let (a, b) = (nodes[k], nodes[(k + 1) % 3]);
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { sign } else { -sign };
            }
            let [a, b, c] = [0, 1, 2].map(|k| outline.points[nodes[k] as usize]);
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            volume += f64::from(sign) * (0..3).map(|k| a[k] * cross[k]).sum::<f64>() / 6.0;
        }
        assert!(edges.values().all(|sum| *sum == 0), "not closed");
        assert!((volume / piece.volume - 1.0).abs() < 0.02, "{volume} {}", piece.volume);
    }
}

/// In space, facets are divided where cells are to be smaller than those of the old mesh.
#[test]
fn long_edges_are_divided() {
    let mesh = box_mesh([1.0; 3], [2, 2, 2], CellKind::Hex8).unwrap();
    let body = KeptBody::of(&mesh, &parts(&mesh, |_| 1.0, false));
    let (_, border) = border_of(&mesh, &body);
    let mut outline = Outline::new(3, &body.points, &border, BTreeSet::new(), 0.1);
    outline.simplify();
    let at = |node: u32| outline.points[node as usize];
    for (nodes, _) in &outline.facets {
        for k in 0..3 {
            let (a, b) = (at(nodes[k]), at(nodes[(k + 1) % 3]));
            let length = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
            assert!(length <= 0.15 + 1e-12, "{length}");
        }
    }
    let area: f64 = (0..mesh.surfaces().len()).map(|number| outline.measure_of(number)).sum();
    assert!((area - 6.0).abs() < 1e-9, "{area}");
}

/// Two blobs: the one that is held stays, of a free body the larger one. Points that must stay are not removed.
#[test]
fn islands_and_kept_points() {
    let mesh = rectangle([4.0, 1.0], [40, 10], CellKind::Tri3).unwrap();
    let blobs = |x: &[f64; 3]| (0.81 - x[0]).max(x[0] - 2.03);
    let held: BTreeSet<u32> = mesh.nodes_of_facets(mesh.surface("x-").unwrap()).into_iter().collect();
    for (held, left) in [(held, 0.81), (BTreeSet::new(), 1.97)] {
        let mut body = KeptBody::of(&mesh, &parts(&mesh, blobs, false));
        assert_eq!(body.pieces.len(), 2);
        let gone = body.drop_islands(&mesh, &held);
        assert!(gone.len() == 1 && (body.total() - left).abs() < 1e-9, "{gone:?} {}", body.total());
        let (_, border) = border_of(&mesh, &body);
        let place = border
            .iter()
            .flat_map(|facet| &facet.nodes)
            .copied()
            .find(|k| body.points[*k as usize][0] % 1.0 > 0.05)
            .unwrap();
        let has = |kept: BTreeSet<u32>| {
            let mut outline = Outline::new(2, &body.points, &border, kept, 0.5);
            outline.simplify();
            outline.facets.iter().any(|(nodes, _)| nodes.contains(&place))
        };
        assert!(has(BTreeSet::from([place])) && !has(BTreeSet::new()));
    }
}
