//! Signed distances from meshed solids with flat faces.

use nastic_mesh::spatial::{Feature, Polyhedron};
use nastic_mesh::{CellKind, Mesh, Shape, box_mesh, rectangle};
use nastic_numeric::Random;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Signed distance from the box `[0, size]`, and its gradient.
fn from_box(size: &[f64], x: &[f64; 3]) -> f64 {
    let beyond = |i: usize| (-x[i]).max(x[i] - size[i]);
    let outside: f64 = (0..size.len()).map(|i| beyond(i).max(0.0).powi(2)).sum();
    let inside = (0..size.len()).map(beyond).fold(f64::NEG_INFINITY, f64::max);
    if inside > 0.0 { outside.sqrt() } else { inside }
}

fn points(count: usize, dim: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let mut of = || std::array::from_fn(|i| if i < dim { 3.0 * random.unit() - 1.0 } else { 0.0 });
    (0..count).map(|_| of()).collect()
}

/// The gradient by central differences, where the distance has one.
fn gradient(solid: &Polyhedron, x: &[f64; 3]) -> [f64; 3] {
    const H: f64 = 1e-6;
    std::array::from_fn(|i| {
        if i >= solid.dim() {
            return 0.0;
        }
        let at = |by: f64| {
            let mut moved = *x;
            moved[i] += by;
            solid.nearest(moved).distance
        };
        (at(H) - at(-H)) / (2.0 * H)
    })
}

#[test]
fn of_boxes_and_rectangles() -> Outcome {
    let size = [1.0, 0.6, 0.8];
    let bricks = [CellKind::Hex8, CellKind::Tet4].map(|kind| box_mesh(size, [3, 2, 2], kind));
    let plates = [CellKind::Quad4, CellKind::Tri3].map(|kind| rectangle([1.0, 0.6], [3, 2], kind));
    for mesh in bricks.into_iter().chain(plates) {
        let mesh = mesh?;
        let (solid, dim) = (Polyhedron::of(&mesh, None)?, mesh.dim());
        let mut on = [0; 3];
        for x in points(2000, dim, 7) {
            let near = solid.nearest(x);
            let exact = from_box(&size[..dim], &x);
            assert!((near.distance - exact).abs() < 1e-14, "{x:?}: {near:?}, not {exact}");
            let found = gradient(&solid, &x);
            let gap = (0..3).map(|i| (near.normal[i] - found[i]).abs()).fold(0.0, f64::max);
            assert!(gap < 1e-5, "{x:?}: {near:?}, differences {found:?}");
            on[match near.on {
                Feature::Face => 0,
                Feature::Edge(_) => 1,
                Feature::Corner => 2,
            }] += 1;
        }
        assert!(on[0] > 100 && (dim == 2) == (on[1] == 0) && on[2] > 100, "{on:?}");
    }
    Ok(())
}

/// A ring in the plane and a ball of bricks: inside and outside as the search in their cells says; concave edges.
#[test]
fn of_bodies_with_hollows() -> Outcome {
    let bend = |x: [f64; 3]| {
        let (radius, angle) = (0.4 + 0.5 * x[1], -5.0 * x[0]);
        [0.5 + radius * angle.cos(), 0.5 + radius * angle.sin(), x[2]]
    };
    let ring = rectangle([1.0, 1.0], [40, 2], CellKind::Tri3)?.mapped(bend)?;
    let arch = box_mesh([1.0, 1.0, 0.7], [12, 2, 2], CellKind::Tet4)?.mapped(bend)?;
    for mesh in [ring, arch] {
        let (solid, shape) = (Polyhedron::of(&mesh, None)?, Shape::new(&mesh, mesh.points(), None)?);
        let mut inside = 0;
        for x in points(1500, mesh.dim(), 3) {
            let (near, (_, exact)) = (solid.nearest(x), shape.nearest_boundary(x));
            assert!((near.distance.abs() - exact).abs() < 1e-12, "{x:?}: {near:?}, not {exact}");
            assert_eq!(near.distance < 0.0, shape.contains(x), "{x:?}: {near:?}");
            inside += usize::from(near.distance < 0.0);
            let p = near.point;
            let back: f64 = (0..3).map(|i| (p[i] + near.distance * near.normal[i] - x[i]).abs()).sum();
            assert!(back < 1e-12, "{x:?}: {near:?}");
        }
        assert!(inside > 50, "{inside}");
    }
    Ok(())
}

/// On the surface itself there is a normal too; regions; what has no flat faces is refused.
#[test]
fn on_the_surface_and_refused() -> Outcome {
    let mesh = box_mesh([1.0; 3], [2; 3], CellKind::Hex8)?;
    let solid = Polyhedron::of(&mesh, None)?;
    let face = solid.nearest([0.5, 0.5, 1.0]);
    assert_eq!((face.distance, face.normal, face.on), (0.0, [0.0, 0.0, 1.0], Feature::Face));
    let edge = solid.nearest([1.0, 0.3, 1.0]);
    let half = 0.5f64.sqrt();
    assert!(edge.distance == 0.0 && (edge.normal[0] - half).abs() < 1e-15 && (edge.normal[2] - half).abs() < 1e-15);
    // above a diagonal and a node within a face
    for x in [[0.25, 0.25, 1.3], [0.5, 0.5, 1.3]] {
        let near = solid.nearest(x);
        assert!(near.on == Feature::Face && (near.distance - 0.3).abs() < 1e-15, "{near:?}");
    }
    let body = nastic_mesh::GroupNames::from("body");
    assert_eq!(Polyhedron::of(&mesh, Some(&body))?, solid);
    assert!(Polyhedron::of(&mesh, Some(&"nowhere".into())).is_err());
    let curved: Mesh = box_mesh([1.0; 3], [1; 3], CellKind::Hex27)?;
    let message = Polyhedron::of(&curved, None).err().ok_or("flat")?.to_string();
    assert!(message.contains("hex27") && message.contains("linear cells"), "{message}");
    Ok(())
}

/// In the plane the sign at a corner is right however sharp it is: a rectangle that is sheared until its corners have 20 degrees.
#[test]
fn of_sharp_corners_in_the_plane() -> Outcome {
    for shear in [0.5, 1.5, 2.7] {
        let plain = rectangle([1.0, 1.0], [3, 3], CellKind::Tri3)?;
        let points: Vec<[f64; 3]> = plain.points().iter().map(|x| [x[0] + shear * x[1], x[1], 0.0]).collect();
        let solid = Polyhedron::of(&plain.with_points(points)?, None)?;
        let mut random = Random::new(5);
        for _ in 0..4000 {
            let x = [7.0 * random.unit() - 2.0, 3.0 * random.unit() - 1.0, 0.0];
            let inside = x[1] > 0.0 && x[1] < 1.0 && x[0] > shear * x[1] && x[0] < 1.0 + shear * x[1];
            let near = solid.nearest(x);
            assert_eq!(near.distance < 0.0, inside, "shear {shear}: {x:?}: {near:?}");
        }
    }
    Ok(())
}

/// Bricks with three corners of a face on one line: the other diagonal leaves no sliver, whose normal would be rounding.
#[test]
fn of_faces_with_corners_on_a_line() -> Outcome {
    let mut random = Random::new(11);
    for k in 0..200 {
        let plain = box_mesh([1.0, 1.0, 1.0], [1, 1, 1], CellKind::Hex8)?;
        // one corner of the upper face between its neighbours
        let corner = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]][k % 4];
        let share = 0.2 + 0.6 * random.unit();
        let of = |c: f64, share: f64| if c == 0.0 { share } else { 1.0 - share };
        let moved = [of(corner[0], share), of(corner[1], 1.0 - share), 1.0];
        let points = plain.points().iter().map(|x| if *x == corner { moved } else { *x }).collect();
        let solid = Polyhedron::of(&plain.with_points(points)?, None)?;
        for _ in 0..50 {
            let x = [1.4 * random.unit() - 0.2, 1.4 * random.unit() - 0.2, 1.05 + random.unit()];
            let near = solid.nearest(x);
            assert!(near.distance > 0.0, "{corner:?} at {moved:?}, {x:?}: {near:?}");
        }
    }
    Ok(())
}
