//! Controls on a grid of their own: exact integrals, unknowns, prolongation. Total variation of all spaces.

use nastic_control::{ControlError, ControlNorm, ControlSmoothness, Reduced, Space};
use nastic_energy::{Magnet, MooneyRivlin, Turgor};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh, rectangle};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn controlled(mesh: Mesh, space: Space) -> Outcome<Reduced> {
    let body = Solid::new(mesh)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 5e5)?)?
        .actuate("body", "turgor", Turgor::new())?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("x-")?;
    Ok(Reduced::new(body).control("turgor", space)?.control("magnet.remanence", space)?)
}

/// 3 x 1 x 1 with 6 x 2 x 2 cells.
fn bar(kind: CellKind) -> Outcome<Mesh> {
    Ok(box_mesh([3.0, 1.0, 1.0], [6, 2, 2], kind)?)
}

/// A control vector of `f` at the places of the scalar's unknowns; the vector field is zero.
fn scalar(problem: &Reduced, f: impl Fn([f64; 3]) -> f64) -> Outcome<Vec<f64>> {
    let mut m = vec![0.0; problem.layout().len()];
    let places = problem.layout().block("turgor")?.basis.positions().to_vec();
    m.iter_mut().zip(places).for_each(|(m, x)| *m = f(x));
    Ok(m)
}

/// X and XYZ are in the space: their values at the points, and the integrals of X^2 and |grad X|^2, are exact, where cells of the grid are
/// larger than the body's and where they are smaller. V = 3, int X^2 = 9.
#[test]
fn integrals_over_the_body_are_exact() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        for cells in [[1, 1, 1], [3, 2, 1], [6, 1, 4]] {
            let problem = controlled(bar(kind)?, Space::Grid(cells))?
                .cost(ControlNorm::of("turgor", 2.0)?)?
                .cost(ControlSmoothness::of("turgor", 2.0)?)?;
            let m = scalar(&problem, |x| x[0] * x[1] * x[2])?;
            let disc = problem.solid().discretization();
            let points = disc.points().positions(disc.mesh(), None);
            let values = problem.layout().to_points(&m)?;
            for (v, x) in values.values(0).iter().zip(&points) {
                assert!((v - x[0] * x[1] * x[2]).abs() < 1e-10, "{kind}, {cells:?}: {v} at {x:?}");
            }
            let m = scalar(&problem, |x| x[0])?;
            let u = vec![0.0; disc.dofs()];
            let context = |stage| nastic_control::CostContext {
                solid: problem.solid(),
                layout: problem.layout(),
                u: &u,
                state: None,
                m: &m,
                stage,
                step: None,
            };
            let value = |k: usize| -> Outcome<f64> { Ok(problem.costs()[k].at(&context(0))?.value()) };
            assert!((value(0)? - 9.0).abs() < 1e-9, "{kind}, {cells:?}: {}", value(0)?);
            assert!((value(1)? - 3.0).abs() < 1e-9, "{kind}, {cells:?}: {}", value(1)?);
        }
    }
    Ok(())
}

/// Of a body that leaves a part of its box empty: cells of the grid without a point have no unknowns of their own.
#[test]
fn nodes_without_a_point_have_no_unknown() -> Outcome {
    // A plate whose second half is narrow: of the box 2 x 1 the upper right quarter is empty.
    let plate = box_mesh([2.0, 1.0, 1.0], [4, 2, 1], CellKind::Hex8)?;
    let mut raw = RawMesh::new("plate");
    raw.points = plate.points().to_vec();
    for cell in 0..plate.cells() {
        let nodes = plate.cell(cell).nodes;
        let centre = [0, 1].map(|k| nodes.iter().map(|&n| plate.points()[n as usize][k]).sum::<f64>() / 8.0);
        let part = centre[0] < 1.0 || centre[1] < 0.5;
        raw.push(CellKind::Hex8, nodes, if part { &[1, 2] } else { &[1] });
    }
    for (dim, tag, name) in [(3, 1, "body"), (3, 2, "part"), (2, 3, "x-")] {
        raw.name_group(dim, tag, name);
    }
    for &facet in plate.surface("x-")? {
        let (kind, nodes) = plate.facet_nodes(facet);
        raw.push(kind, &nodes, &[3]);
    }
    let body = Solid::new(Mesh::build(raw)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 5e5)?)?
        .actuate("part", "turgor", Turgor::new())?
        .clamp("x-")?;
    let count = |cells: [u32; 3]| -> Outcome<usize> {
        let body = body.clone();
        Ok(Reduced::new(body).control("turgor", Space::Grid(cells))?.layout().len())
    };
    // 2 x 2 x 1 cells have 18 nodes; the corner of the empty quarter (two nodes, in z) is in no cell with a point.
    assert_eq!(count([2, 2, 1])?, 16);
    // 4 x 4 x 1: 50 nodes, 2 x 2 of them at either height in the empty quarter alone.
    assert_eq!(count([4, 4, 1])?, 42);
    Ok(())
}

/// The grids n and 2n are nested: a coarse field taken to the nodes of the finer grid is the same field.
#[test]
fn a_field_of_a_coarser_grid_is_prolonged_exactly() -> Outcome {
    let coarse = controlled(bar(CellKind::Hex20)?, Space::Grid([3, 1, 2]))?;
    let fine = controlled(bar(CellKind::Hex20)?, Space::Grid([6, 2, 4]))?;
    let block = coarse.layout().block("turgor")?;
    let m: Vec<f64> = (0..coarse.layout().len()).map(|i| ((7 * i + 3) % 11) as f64 - 5.0).collect();
    let prolonged = scalar(&fine, |x| block.basis.on_grid(block.of(&m), 1, x).map_or(f64::NAN, |v| v[0]))?;
    let (there, here) = (fine.layout().to_points(&prolonged)?, coarse.layout().to_points(&m)?);
    for (a, b) in there.values(0).iter().zip(here.values(0)) {
        assert!((a - b).abs() < 1e-10, "{a} and {b}");
    }
    Ok(())
}

#[test]
fn grids_that_cannot_be_are_refused() -> Outcome {
    for cells in [[0, 1, 1], [1, 0, 2], [u32::MAX, 1, 1], [70_000, 70_000, 1]] {
        let refused = controlled(bar(CellKind::Hex8)?, Space::Grid(cells)).err().map(|e| e.to_string());
        assert!(refused.is_some_and(|e| e.contains("grid of")), "{cells:?}");
    }
    let error = ControlError::Grid { cells: [0, 1, 1] };
    assert!(error.to_string().contains("at least 1"), "{error}");
    Ok(())
}

/// Closed forms: `int |grad X| = V`; of cells with 0 below X = 1.5 and 2 above, the area 1 of the face times 2; of a vector that turns
/// by pi over the length, of constant length L: `L pi / 3 V`.
#[test]
fn the_total_variation_is_that_of_closed_forms() -> Outcome {
    for space in [Space::Node, Space::Grid([2, 1, 3])] {
        let problem = controlled(bar(CellKind::Hex8)?, space)?;
        let m = scalar(&problem, |x| 4.0 * x[0] - 3.0 * x[2])?;
        let of = |name: &str, m: &[f64]| -> Outcome<f64> {
            let disc = problem.solid().discretization();
            let block = problem.layout().block(name)?;
            Ok(block.total_variation(disc, block.of(m)))
        };
        assert!((of("turgor", &m)? - 15.0).abs() < 1e-9, "{}: {}", space.name(), of("turgor", &m)?);
        assert_eq!(of("magnet.remanence", &m)?, 0.0);
    }
    let problem = controlled(bar(CellKind::Hex8)?, Space::Cell)?;
    let m = scalar(&problem, |x| if x[0] < 1.5 { 0.0 } else { 2.0 })?;
    let block = problem.layout().block("turgor")?;
    let found = block.total_variation(problem.solid().discretization(), block.of(&m));
    assert!((found - 2.0).abs() < 1e-12, "{found}");

    // Between nodes on the sphere the interpolated vector is shorter; scaled to its length it turns as it should.
    let mesh = box_mesh([3.0, 1.0, 1.0], [48, 1, 1], CellKind::Hex8)?;
    let problem = controlled(mesh, Space::Grid([24, 1, 1]))?.of_length("magnet.remanence", 0.5)?;
    let block = problem.layout().block("magnet.remanence")?;
    let mut m = vec![0.0; problem.layout().len()];
    for (k, x) in block.basis.positions().iter().enumerate() {
        let angle = std::f64::consts::PI * x[0] / 3.0;
        m[block.first + 3 * k] = 0.5 * angle.cos();
        m[block.first + 3 * k + 2] = 0.5 * angle.sin();
    }
    let (found, expected) =
        (block.total_variation(problem.solid().discretization(), block.of(&m)), 0.5 * std::f64::consts::PI);
    assert!((found - expected).abs() < 1e-3 * expected, "{found}, {expected}");
    Ok(())
}

/// The bar has cells of half a metre along every axis: six, two and two.
#[test]
fn a_grid_is_resolved_where_no_cell_is_smaller_than_those_of_the_body() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        for (cells, most) in [
            ([6, 2, 2], None),
            ([1, 1, 1], None),
            ([7, 1, 1], Some([6, 2, 2])),
            ([6, 2, 3], Some([6, 2, 2])),
            ([24, 8, 8], Some([6, 2, 2])),
        ] {
            let problem = controlled(bar(kind)?, Space::Grid(cells))?;
            let map = &problem.layout().block("turgor")?.basis;
            assert_eq!(map.resolved_grid(problem.solid().discretization()), most, "{kind}, {cells:?}");
        }
    }
    let plane = Solid::new(rectangle([1.0, 0.5], [4, 2], CellKind::Quad9)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 5e5)?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?;
    for (cells, most) in [([4, 2, 1], None), ([5, 2, 9], Some([4, 2, 9])), ([4, 2, 9], None)] {
        let problem = Reduced::new(plane.clone()).control("turgor", Space::Grid(cells))?;
        let found = problem.layout().block("turgor")?.basis.resolved_grid(problem.solid().discretization());
        assert_eq!(found, most, "{cells:?}");
    }
    let nodes = controlled(bar(CellKind::Hex8)?, Space::Node)?;
    assert!(nodes.layout().block("turgor")?.basis.resolved_grid(nodes.solid().discretization()).is_none());
    Ok(())
}
