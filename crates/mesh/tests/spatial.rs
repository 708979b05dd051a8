//! Points and curved solids: containment and nearest points, against brute force and closed forms.

#![allow(clippy::unwrap_used)] // helpers of tests

use nastic_mesh::spatial::{Shape, SpatialError, hausdorff};
use nastic_mesh::{CellKind, Domain, Mesh, box_mesh, rectangle};

type Point = [f64; 3];

/// A bar or strip bent on an arc and twisted.
fn bent(x: &Point) -> Point {
    let angle = 0.5 * x[0];
    let (y, z) = (x[1] * angle.cos() - x[2] * angle.sin(), x[1] * angle.sin() + x[2] * angle.cos());
    let (radius, turn) = (1.4, x[0] / 1.4);
    [(radius - z) * turn.sin(), y, radius - (radius - z) * turn.cos()]
}

fn bent_in_plane(x: &Point) -> Point {
    let (radius, turn) = (1.4, x[0] / 1.4);
    [(radius - x[1]) * turn.sin(), radius - (radius - x[1]) * turn.cos(), 0.0]
}

fn bent_solid(kind: CellKind) -> (Mesh, Vec<Point>) {
    if kind.dim() == 3 {
        let mesh = box_mesh([1.0, 0.3, 0.4], [3, 1, 2], kind).unwrap();
        let positions = mesh.points().iter().map(bent).collect();
        (mesh, positions)
    } else {
        let mesh = rectangle([1.0, 0.3], [4, 2], kind).unwrap();
        let positions = mesh.points().iter().map(bent_in_plane).collect();
        (mesh, positions)
    }
}

fn cell_kinds() -> impl Iterator<Item = CellKind> {
    CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1)
}

/// A fixed sequence in the unit cube that fills it evenly.
fn spread(n: usize) -> impl Iterator<Item = Point> {
    (1..=n).map(|i| [0.8191725, 0.6710436, 0.5497004].map(|step: f64| (0.5 + step * i as f64).fract()))
}

fn place(positions: &[Point], nodes: &[u32], kind: CellKind, xi: &Point) -> Point {
    let mut shapes = vec![0.0; kind.nodes()];
    kind.shapes(xi, &mut shapes);
    let mut x = [0.0; 3];
    for (&node, n) in nodes.iter().zip(&shapes) {
        for (x, p) in x.iter_mut().zip(positions[node as usize]) {
            *x += n * p;
        }
    }
    x
}

/// Reference point of a kind from a point of the unit cube.
fn reference(kind: CellKind, u: &Point) -> Point {
    let mut xi = [0.0; 3];
    xi[..kind.dim()].copy_from_slice(&u[..kind.dim()]);
    match kind.domain() {
        Domain::Box => xi[..kind.dim()].iter_mut().for_each(|v| *v = 2.0 * *v - 1.0),
        Domain::Simplex => {
            // Sorted coordinates cut the cube into equal simplices; their differences fill the unit one.
            let dim = kind.dim();
            xi[..dim].sort_by(f64::total_cmp);
            for a in (1..dim).rev() {
                xi[a] -= xi[a - 1];
            }
        }
    }
    xi
}

fn distance(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Points of the boundary on a fine grid over every face.
fn boundary_points(mesh: &Mesh, positions: &[Point], n: usize) -> Vec<Point> {
    let mut points = Vec::new();
    for &facet in mesh.boundary() {
        let (kind, nodes) = mesh.facet_nodes(facet);
        for i in 0..=n {
            for j in 0..=if kind.dim() == 1 { 0 } else { n } {
                let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
                let xi = match kind.domain() {
                    Domain::Simplex => [u * (1.0 - v), v, 0.0],
                    Domain::Box => [2.0 * u - 1.0, if kind.dim() == 1 { 0.0 } else { 2.0 * v - 1.0 }, 0.0],
                };
                points.push(place(positions, &nodes, kind, &xi));
            }
        }
    }
    points
}

#[test]
fn nearest_boundary_points_are_those_of_brute_force() {
    for kind in cell_kinds() {
        let (mesh, positions) = bent_solid(kind);
        let shape = Shape::new(&mesh, &positions, None).unwrap();
        let samples = boundary_points(&mesh, &positions, 24);
        for u in spread(40) {
            let p = [1.6 * u[0] - 0.3, 1.6 * u[1] - 0.6, if kind.dim() == 3 { 1.6 * u[2] - 0.5 } else { 0.0 }];
            let (foot, found) = shape.nearest_boundary(p);
            let brute = samples.iter().map(|x| distance(x, &p)).fold(f64::INFINITY, f64::min);
            // The grid is never nearer than the truth, and one of its points is within half a grid width of the foot.
            assert!(found <= brute + 1e-12, "{kind:?} at {p:?}: {found} but a sample is at {brute}");
            let width: f64 = 0.5 * 2f64.sqrt() * 0.4 / 24.0;
            assert!(
                brute <= (found * found + width * width).sqrt() + 0.3 * width,
                "{kind:?} at {p:?}: {found} {brute}"
            );
            assert!((distance(&foot, &p) - found).abs() < 1e-13);
            let on_it = samples.iter().map(|x| distance(x, &foot)).fold(f64::INFINITY, f64::min);
            assert!(on_it < 1.5 * width && shape.distance(foot) < 1e-9, "{kind:?}: {foot:?} is not on the boundary");
        }
    }
}

#[test]
fn points_of_cells_are_inside_and_points_beyond_the_boundary_are_not() {
    for kind in cell_kinds() {
        let (mesh, positions) = bent_solid(kind);
        let shape = Shape::new(&mesh, &positions, None).unwrap();
        for cell in 0..mesh.cells() {
            let cell = mesh.cell(cell);
            for u in spread(40) {
                let x = place(&positions, cell.nodes, kind, &reference(kind, &u));
                assert!(shape.contains(x), "{kind:?} {x:?}");
                assert_eq!(shape.nearest(x), (x, 0.0));
            }
        }
        // Outside points, seen from the foot: a little towards the point is outside, a little back is inside.
        let mut outside = 0;
        for u in spread(40) {
            let p = [1.6 * u[0] - 0.3, 1.6 * u[1] - 0.6, if kind.dim() == 3 { 1.6 * u[2] - 0.5 } else { 0.0 }];
            let (foot, d) = shape.nearest(p);
            if d == 0.0 {
                continue;
            }
            outside += 1;
            let at = |s: f64| std::array::from_fn(|a| foot[a] + s * (p[a] - foot[a]) / d);
            assert!(!shape.contains(at(1e-6)) && shape.distance(at(-1e-9)) < 1e-8, "{kind:?} at {p:?}");
            assert!((shape.distance(at(1e-6)) - 1e-6).abs() < 1e-9);
        }
        assert!(outside > 15);
        for node in mesh.corner_nodes() {
            assert!(shape.distance(positions[node as usize]) < 1e-12, "a node is a point of the solid");
        }
    }
}

#[test]
fn a_single_strongly_curved_face_is_met_where_it_is_nearest() {
    // The upper edge is the parabola y = 1 + 0.4 (1 - x^2), x in [-1, 1].
    let mesh = rectangle([2.0, 1.0], [1, 1], CellKind::Quad9).unwrap();
    let bulge = |x: &Point| [x[0] - 1.0, x[1] * (1.0 + 0.4 * x[0] * (2.0 - x[0])), 0.0];
    let positions: Vec<Point> = mesh.points().iter().map(bulge).collect();
    let shape = Shape::new(&mesh, &positions, None).unwrap();
    for (x, out) in [(0.0, 0.7), (0.4, 0.05), (-0.9, 1.3), (0.7, 0.3)] {
        // Along the normal of a convex curve the foot stays.
        let (y, slope): (f64, f64) = (1.0 + 0.4 * (1.0 - x * x), -0.8 * x);
        let length = slope.hypot(1.0);
        let p = [x - out * slope / length, y + out / length, 0.0];
        let (foot, d) = shape.nearest(p);
        assert!((d - out).abs() < 1e-12 && distance(&foot, &[x, y, 0.0]) < 1e-7, "{x}: {foot:?} {d}");
    }
    // Beyond the corner the corner is nearest.
    assert!((shape.distance([1.5, 1.6, 0.0]) - 0.5f64.hypot(0.6)).abs() < 1e-12);
}

#[test]
fn a_single_cell_bent_to_a_ball_is_searched_whole() {
    for kind in [CellKind::Quad9, CellKind::Hex27, CellKind::Hex20] {
        let round = |x: &Point| {
            let x: Point = std::array::from_fn(|a| if a < kind.dim() { x[a] - 1.0 } else { 0.0 });
            let (norm, largest) = (distance(&x, &[0.0; 3]), x.iter().fold(0.0f64, |m, v| m.max(v.abs())));
            if norm == 0.0 { x } else { x.map(|v| v * largest / norm) }
        };
        let mesh =
            if kind.dim() == 3 { box_mesh([2.0; 3], [1; 3], kind) } else { rectangle([2.0; 2], [1; 2], kind) }.unwrap();
        let positions: Vec<Point> = mesh.points().iter().map(round).collect();
        let shape = Shape::new(&mesh, &positions, None).unwrap();
        let samples = boundary_points(&mesh, &positions, 64);
        for u in spread(400) {
            // On faces and edges as often as inside.
            let u = u.map(|v| (1.4 * v - 0.2).clamp(0.0, 1.0));
            let x = place(&positions, mesh.cell(0).nodes, kind, &reference(kind, &u));
            assert!(shape.contains(x), "{kind:?} {x:?}");
            let (_, found) = shape.nearest_boundary(x);
            let brute = samples.iter().map(|y| distance(&x, y)).fold(f64::INFINITY, f64::min);
            assert!(found <= brute + 1e-12 && found > brute - 0.03, "{kind:?} {x:?}: {found} {brute}");
        }
        assert!(shape.distance([1.0, 1.0, 0.0]) > 0.35 && !shape.contains([0.95, 0.4, 0.0]));
    }
}

#[test]
fn a_cell_folded_flat_or_inside_out_gives_an_answer() {
    for kind in [CellKind::Tet10, CellKind::Hex8, CellKind::Hex27] {
        let mesh = box_mesh([1.0; 3], [2, 2, 2], kind).unwrap();
        let sound = Shape::new(&mesh, mesh.points(), None).unwrap();
        let maps: [fn(&Point) -> Point; 4] = [
            |x| [x[0], x[1], 0.0],
            |_| [0.3, 0.3, 0.3],
            |x| [-x[0], x[1], x[2]],
            |x| [(x[0] - 0.4).powi(2), x[1], (3.0 * x[2]).sin()],
        ];
        for map in maps {
            let positions: Vec<Point> = mesh.points().iter().map(map).collect();
            let shape = Shape::new(&mesh, &positions, None).unwrap();
            let distance = hausdorff(&shape, &sound).unwrap();
            assert!(distance.distance.is_finite() && distance.gap.is_finite() && distance.gap >= 0.0);
            assert!(shape.distance([2.0, 2.0, 2.0]).is_finite());
        }
        let flat: Vec<Point> = mesh.points().iter().map(maps[0]).collect();
        let flat = Shape::new(&mesh, &flat, None).unwrap();
        assert!((flat.distance([0.5, 0.5, 0.7]) - 0.7).abs() < 1e-12);
    }
}

#[test]
fn wrong_input_is_named() {
    let mesh = box_mesh([1.0; 3], [1, 1, 1], CellKind::Hex8).unwrap();
    let few = Shape::new(&mesh, &mesh.points()[1..], None).unwrap_err();
    assert_eq!(
        few.to_string(),
        "7 positions given for the 8 nodes of mesh \"box\"; give one per node (mesh.points() at rest)"
    );
    let mut broken = mesh.points().to_vec();
    broken[5][1] = f64::NAN;
    let broken = Shape::new(&mesh, &broken, None).unwrap_err();
    assert!(matches!(broken, SpatialError::NotFinite { node: 5, .. }), "{broken}");
    let unknown = Shape::new(&mesh, mesh.points(), Some("bdy")).unwrap_err();
    assert!(unknown.to_string().contains("\"bdy\" not found") && unknown.to_string().contains("body"), "{unknown}");
    let plane = rectangle([1.0; 2], [1, 1], CellKind::Quad4).unwrap();
    let plane = Shape::new(&plane, plane.points(), None).unwrap();
    let solid = Shape::new(&mesh, mesh.points(), None).unwrap();
    assert!(matches!(hausdorff(&solid, &plane), Err(SpatialError::Dimension { a: 3, b: 2 })));
}
