//! The Hausdorff distance against closed forms, and its certificate against dense samples.

#![allow(clippy::unwrap_used)] // helpers of tests

use nastic_mesh::spatial::{Hausdorff, Shape, hausdorff, hausdorff_within};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh, rectangle};

type Point = [f64; 3];

fn moved(mesh: &Mesh, map: impl Fn(&Point) -> Point) -> Shape {
    let positions: Vec<Point> = mesh.points().iter().map(map).collect();
    Shape::new(mesh, &positions, None).unwrap()
}

fn solid(size: Point, cells: [usize; 3], kind: CellKind) -> Mesh {
    box_mesh(size, cells, kind).unwrap()
}

/// The closed form lies in the certified interval, which is no wider than the default tolerance.
fn assert_is(found: &Hausdorff, expected: f64, diagonal: f64) {
    assert!(found.gap >= 0.0 && found.gap <= 1.01e-4 * diagonal, "{found:?}");
    let interval = found.distance - 1e-12..=found.distance + found.gap + 1e-12;
    assert!(interval.contains(&expected), "{expected} is not in {found:?}");
}

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The square [-1, 1]^2 onto the disc of radius 1, or the cube onto the ball; `dim` says which.
fn round(x: &Point, dim: usize, radius: f64) -> Point {
    let x = [x[0] - 1.0, x[1] - 1.0, if dim == 3 { x[2] - 1.0 } else { 0.0 }];
    let largest = x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let norm = apart(&x, &[0.0; 3]);
    if norm == 0.0 { x } else { x.map(|v| v * radius * largest / norm) }
}

fn bent(x: &Point, curvature: f64) -> Point {
    let (radius, turn) = (1.0 / curvature, x[0] * curvature);
    [(radius - x[2]) * turn.sin(), x[1], radius - (radius - x[2]) * turn.cos()]
}

#[test]
fn boxes_apart_and_nested() {
    let size = [1.0, 0.2, 0.3];
    let diagonal = size.iter().map(|s| s * s).sum::<f64>().sqrt();
    for (coarse, fine) in
        [(CellKind::Hex8, CellKind::Tet4), (CellKind::Hex27, CellKind::Tet10), (CellKind::Hex20, CellKind::Hex8)]
    {
        let (a, b) = (solid(size, [3, 1, 1], coarse), solid(size, [4, 2, 3], fine));
        let at_rest = moved(&a, |x| *x);
        // No nodes coincide and none need to: the same solid is at distance 0, its shift at the length of the shift.
        assert_is(&hausdorff(&at_rest, &moved(&b, |x| *x)).unwrap(), 0.0, diagonal);
        let shift = [0.11, -0.05, 0.02];
        let shifted = moved(&b, |x| [x[0] + shift[0], x[1] + shift[1], x[2] + shift[2]]);
        let found = hausdorff(&at_rest, &shifted).unwrap();
        assert_is(&found, apart(&shift, &[0.0; 3]), diagonal);
        // A tenth smaller about the centre: inside, and the corners of the larger stick out.
        let smaller = moved(&b, |x| std::array::from_fn(|a| 0.9 * x[a] + 0.05 * size[a]));
        let found = hausdorff(&smaller, &at_rest).unwrap();
        assert_is(&found, 0.05 * diagonal, diagonal);
        assert_eq!((found.a_to_b, found.b_to_a), (0.0, found.distance));
    }
}

#[test]
fn a_turned_square_prism() {
    let mesh = solid([2.0, 2.0, 0.5], [2, 3, 1], CellKind::Hex8);
    let centred = moved(&mesh, |x| [x[0] - 1.0, x[1] - 1.0, x[2]]);
    let s = 0.5f64.sqrt();
    let turned = moved(&mesh, |x| [s * (x[0] - x[1]), s * (x[0] + x[1] - 2.0), x[2]]);
    let found = hausdorff(&centred, &turned).unwrap();
    assert_is(&found, 2f64.sqrt() - 1.0, centred.diagonal().max(turned.diagonal()));
    assert!((found.a_to_b - found.b_to_a).abs() < 1e-12);
}

#[test]
fn concentric_discs_and_balls() {
    for kind in [CellKind::Quad9, CellKind::Tri6, CellKind::Quad8] {
        let mesh = rectangle([2.0; 2], [8, 8], kind).unwrap();
        let (large, small) = (moved(&mesh, |x| round(x, 2, 1.0)), moved(&mesh, |x| round(x, 2, 0.9)));
        let found = hausdorff(&large, &small).unwrap();
        // Quadratic edges of 1/16 of a turn leave the circle by less than 1e-4.
        assert!((found.distance - 0.1).abs() < 1e-4 + found.gap && found.gap < 3e-4, "{found:?}");
        assert_eq!(found.b_to_a, 0.0);
    }
    for kind in [CellKind::Hex27, CellKind::Tet10] {
        let mesh = solid([2.0; 3], [4, 4, 4], kind);
        let (large, small) = (moved(&mesh, |x| round(x, 3, 1.0)), moved(&mesh, |x| round(x, 3, 0.7)));
        let found = hausdorff_within(&large, &small, 1e-2).unwrap();
        assert!((found.distance - 0.3).abs() < 2e-3 + found.gap, "{found:?}");
        // Off by the geometry alone: the corner nodes lie on the spheres.
        assert!((found.distance - 0.3).abs() < 5e-3 && found.b_to_a == 0.0, "{found:?}");
    }
}

#[test]
fn a_plug_is_farthest_from_its_ring_at_the_centre() {
    for kind in [CellKind::Quad9, CellKind::Tri6] {
        let ring = rectangle([1.0, std::f64::consts::TAU], [2, 24], kind).unwrap();
        let ring = moved(&ring, |x| [(1.0 + x[0]) * x[1].cos(), (1.0 + x[0]) * x[1].sin(), 0.0]);
        // An odd number of cells: no node is at the centre.
        let plug = rectangle([2.0; 2], [7, 7], kind).unwrap();
        let plug = moved(&plug, |x| round(x, 2, 1.0));
        let found = hausdorff(&plug, &ring).unwrap();
        assert!((found.a_to_b - 1.0).abs() < 1e-3 && found.gap < 6e-4, "{found:?}");
        // Onto the ring's own solid disc the hole is all that is missing.
        let disc = rectangle([2.0; 2], [6, 6], kind).unwrap();
        let disc = moved(&disc, |x| round(x, 2, 2.0));
        let found = hausdorff(&disc, &ring).unwrap();
        assert!((found.distance - 1.0).abs() < 1e-3 && apart(&found.from, &[0.0; 3]) < 2e-3, "{found:?}");
        assert!((apart(&found.to, &[0.0; 3]) - 1.0).abs() < 1e-3);
    }
}

/// A square plate with a hole: the region of all cells but one.
fn holed(n: usize, hole: usize) -> Mesh {
    let plate = rectangle([1.0; 2], [n, n], CellKind::Quad4).unwrap();
    let mut raw = RawMesh::new("plate");
    raw.points = plate.points().to_vec();
    for cell in 0..plate.cells() {
        raw.push(CellKind::Quad4, plate.cell(cell).nodes, &[if cell == hole { 1 } else { 2 }]);
    }
    raw.name_group(2, 1, "hole");
    raw.name_group(2, 2, "rim");
    Mesh::build(raw).unwrap()
}

#[test]
fn a_hole_smaller_than_the_cells_of_the_other_solid_is_found() {
    let plate = holed(20, 127);
    let rim = Shape::new(&plate, plate.points(), Some("rim")).unwrap();
    let coarse = rectangle([1.0; 2], [1, 1], CellKind::Quad9).unwrap();
    let coarse = Shape::new(&coarse, coarse.points(), None).unwrap();
    let found = hausdorff(&coarse, &rim).unwrap();
    assert_is(&found, 0.025, 2f64.sqrt());
    assert_eq!(found.b_to_a, 0.0);
    let whole = Shape::new(&plate, plate.points(), None).unwrap();
    assert_is(&hausdorff(&whole, &rim).unwrap(), 0.025, 2f64.sqrt());
    // And the regions against each other: the hole's far corner is the plate's.
    let hole = Shape::new(&plate, plate.points(), Some("hole")).unwrap();
    let found = hausdorff(&rim, &hole).unwrap();
    assert_is(&found, 0.6f64.hypot(0.65), 2f64.sqrt());
    assert_is(&Hausdorff { distance: found.b_to_a, ..found }, 0.025, 2f64.sqrt());
}

#[test]
fn a_dent_and_a_bulge_between_the_corners_are_found() {
    // One cell, [0.3, 0.7] x [0.5, 1], in the upper half of a unit square: all of its corners are points of it.
    let one = rectangle([0.4, 0.5], [1, 1], CellKind::Quad9).unwrap();
    let plain = moved(&one, |x| [x[0] + 0.3, x[1] + 0.5, 0.0]);
    let bulging = moved(&one, |x| [x[0] + 0.3, x[1] * (1.0 + x[0] * (0.4 - x[0])) + 0.5, 0.0]);
    let plate = rectangle([1.0; 2], [10, 2], CellKind::Quad4).unwrap();
    let square = moved(&plate, |x| *x);
    // A V of depth 0.1 and width 0.4 in the upper side.
    let dented = moved(&plate, |x| [x[0], x[1] * (1.0 - (0.1 - 0.5 * (x[0] - 0.5).abs()).max(0.0)), 0.0]);
    let dent = 0.1 * 0.2 / 0.1f64.hypot(0.2);
    for (of, on, expected) in [(&plain, &square, 0.0), (&plain, &dented, dent), (&bulging, &square, 0.02)] {
        let found = hausdorff(of, on).unwrap();
        assert_is(&Hausdorff { distance: found.a_to_b, ..found }, expected, 2f64.sqrt());
    }
}

#[test]
fn a_slot_between_two_walls_is_filled_to_its_middle() {
    // Bars 0.3 apart; a block over both: its middle plane is farthest, a whole plane of ties with feet on two sides.
    let plate = solid([1.0, 1.0, 1.3], [1, 1, 13], CellKind::Hex8);
    let mut raw = RawMesh::new("walls");
    raw.points = plate.points().to_vec();
    for cell in 0..plate.cells() {
        let slot = (5..8).contains(&cell);
        raw.push(CellKind::Hex8, plate.cell(cell).nodes, &[if slot { 1 } else { 2 }]);
    }
    raw.name_group(3, 2, "walls");
    let walls = Mesh::build(raw).unwrap();
    let walls = Shape::new(&walls, walls.points(), Some("walls")).unwrap();
    let block = solid([1.0, 1.0, 1.3], [2, 3, 4], CellKind::Tet10);
    let found = hausdorff(&moved(&block, |x| *x), &walls).unwrap();
    assert_is(&found, 0.15, walls.diagonal());
}

#[test]
fn the_certificate_holds_on_dense_samples() {
    let kinds =
        [(CellKind::Hex27, CellKind::Tet10), (CellKind::Tet4, CellKind::Hex8), (CellKind::Hex20, CellKind::Hex27)];
    for (a, b) in kinds {
        let meshes = (solid([1.0, 0.2, 0.2], [5, 1, 1], a), solid([1.0, 0.2, 0.2], [4, 2, 2], b));
        let first = moved(&meshes.0, |x| bent(x, 0.8));
        let second = moved(&meshes.1, |x| bent(x, 0.7));
        let found = hausdorff(&first, &second).unwrap();
        assert!(found.gap <= 1.01e-4 * first.diagonal().max(second.diagonal()), "{found:?}");
        assert!((apart(&found.from, &found.to) - found.distance).abs() < 1e-5 && found.distance > 0.01);
        let (mut there, mut back) = (0.0f64, 0.0f64);
        for i in 0..4000usize {
            // Points of either body, on its surface as often as inside.
            let step = |k: f64| ((i as f64 * k + 0.5).fract() * 1.2 - 0.1).clamp(0.0, 1.0);
            let x = [step(0.8191725), 0.2 * step(0.6710436), 0.2 * step(0.5497004)];
            for (of, on, mesh, worst) in
                [(&first, &second, &meshes.0, &mut there), (&second, &first, &meshes.1, &mut back)]
            {
                let p = bent(&x, if std::ptr::eq(of, &first) { 0.8 } else { 0.7 });
                let (p, _) = of.nearest(p);
                assert!(mesh.cells() > 0 && of.distance(p) < 1e-9);
                *worst = worst.max(on.distance(p));
            }
        }
        assert!(there <= found.a_to_b + found.gap + 1e-9 && there > found.a_to_b - 1e-3, "{there} {found:?}");
        assert!(back <= found.b_to_a + found.gap + 1e-9 && back > found.b_to_a - 1e-3, "{back} {found:?}");
    }
}

#[test]
fn it_is_a_metric() {
    let (hexes, tets) =
        (solid([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex27), solid([1.0, 0.2, 0.2], [5, 2, 2], CellKind::Tet10));
    let shapes =
        [moved(&hexes, |x| bent(x, 0.9)), moved(&tets, |x| bent(x, 0.5)), moved(&tets, |x| [x[0], x[1] + 0.1, x[2]])];
    for shape in &shapes {
        let own = hausdorff(shape, shape).unwrap();
        assert_eq!((own.distance, own.gap), (0.0, 0.0));
    }
    let d = |i: usize, j: usize| hausdorff(&shapes[i], &shapes[j]).unwrap();
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (there, back) = (d(i, j), d(j, i));
        assert_eq!((there.distance, there.a_to_b, there.gap), (back.distance, back.b_to_a, back.gap));
        assert!(there.distance > 0.05);
        let upper = |h: Hausdorff| h.distance + h.gap;
        assert!(there.distance <= upper(d(i, k)) + upper(d(k, j)));
    }
}

#[test]
fn what_a_tolerance_leaves_open_shows_in_the_gap() {
    let mesh = solid([2.0; 3], [2, 2, 2], CellKind::Hex27);
    let (large, small) = (moved(&mesh, |x| round(x, 3, 1.0)), moved(&mesh, |x| round(x, 3, 0.5)));
    let coarse = hausdorff_within(&large, &small, 0.1).unwrap();
    let fine = hausdorff_within(&large, &small, 0.01).unwrap();
    assert!(coarse.gap <= 0.1 && fine.gap <= 0.01);
    assert!(fine.distance <= coarse.distance + coarse.gap && coarse.distance <= fine.distance + fine.gap);
}
