//! Automatic stages of the smoothed Hausdorff distance: what they resolve.

use nastic_control::{BoundHausdorff, Cost, SmoothedHausdorff, Smoothing};
use nastic_energy::NeoHooke;
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh, rectangle};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn bar(cells: [usize; 3]) -> Outcome<Mesh> {
    Ok(box_mesh([1.0, 0.2, 0.2], cells, CellKind::Hex8)?)
}

fn bound(
    cells: [usize; 3],
    change: impl Fn(SmoothedHausdorff) -> SmoothedHausdorff,
) -> Outcome<(Solid, BoundHausdorff)> {
    let solid = Solid::new(bar(cells)?)?.material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?.clamp("x-")?;
    let cost = change(SmoothedHausdorff::to(bar(cells)?).automatic_stages()).bind_to(&solid)?;
    Ok((solid, cost))
}

fn resolved(stages: &[Smoothing]) -> Vec<f64> {
    stages.iter().map(Smoothing::resolution).collect()
}

/// One Gauss point per cell of 10 x 2 x 2: centres 0.1 m apart in a box of 0.9 x 0.1 x 0.1 m, whose tenth they do not resolve: one stage. Cells
/// of 1 cm: from a tenth of the diagonal down to 1 cm in `1 + round(log_4 9.9)` = 3 stages.
#[test]
fn they_go_from_the_size_of_the_target_to_the_spacing_of_the_points() -> Outcome {
    let (solid, cost) = bound([10, 2, 2], |cost| cost.quadrature(1))?;
    let stages = cost.smoothings();
    assert_eq!(stages.len(), 1);
    assert!((stages[0].resolution() - 0.1).abs() < 1e-8 && stages[0].beta() == 16.0 && stages[0].gamma() == 8.0);
    assert!(cost.warnings(&solid).is_empty(), "{:?}", cost.warnings(&solid));

    let (solid, cost) = bound([100, 20, 20], |cost| cost.quadrature(1))?;
    let (stages, d) = (cost.smoothings(), (0.99f64.powi(2) + 2.0 * 0.19f64.powi(2)).sqrt());
    let lengths = resolved(&stages);
    assert_eq!(lengths.len(), 3, "{lengths:?}");
    let (first, last) = (0.1 * d, 0.01);
    for (length, expected) in lengths.iter().zip([first, (first * last).sqrt(), last]) {
        assert!((length - expected).abs() < 1e-6 * expected, "{lengths:?}: {expected}");
    }
    let exponents: Vec<(f64, f64)> = stages.iter().map(|s| (s.beta(), s.gamma())).collect();
    for ((beta, gamma), expected) in exponents.iter().zip([(4.0, 4.0), (8.0, 4.0 * 2f64.sqrt()), (16.0, 8.0)]) {
        assert!((beta - expected.0).abs() < 1e-12 && (gamma - expected.1).abs() < 1e-12, "{exponents:?}");
    }
    assert!(cost.warnings(&solid).is_empty(), "{:?}", cost.warnings(&solid));
    Ok(())
}

/// alpha follows the length of phi: what is resolved does not depend on it. Points left open resolve a fortieth of the diagonal.
#[test]
fn they_do_not_depend_on_the_length_of_phi_and_choose_points() -> Outcome {
    let of = |length: f64| -> Outcome<Vec<f64>> {
        Ok(resolved(&bound([10, 2, 2], |cost| cost.exponential(length))?.1.smoothings()))
    };
    let (short, long) = (of(0.02)?, of(0.5)?);
    assert_eq!(short.len(), 2);
    assert!(short.iter().zip(&long).all(|(a, b)| (a - b).abs() < 1e-12 * a), "{short:?}, {long:?}");
    assert!(short[1] <= 1.08f64.sqrt() / 40.0, "{short:?}");
    Ok(())
}

/// A square of 5 cm of 2 x 2 cells, of which a strip of 1 m beside it is a part of the mesh where `strip` is given.
fn square(strip: bool) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("target");
    for (tag, name, left, size) in [(1, "goal", 0.0, [0.05, 0.05]), (2, "strip", 0.1, [1.0, 0.05])] {
        if tag == 1 || strip {
            let part = rectangle(size, [2, 2], CellKind::Quad4)?;
            let first = raw.points.len() as u32;
            raw.points.extend(part.points().iter().map(|x| [x[0] + left, x[1], 0.0]));
            for cell in 0..part.cells() {
                let nodes: Vec<u32> = part.cell(cell).nodes.iter().map(|node| first + node).collect();
                raw.push(CellKind::Quad4, &nodes, &[tag]);
            }
            raw.name_group(2, tag, name);
        }
    }
    Ok(Mesh::build(raw)?)
}

/// Points resolve a fortieth of the region that is the target, whatever else its mesh holds: the square of 5 cm is resolved in two stages.
#[test]
fn the_size_is_that_of_the_region_of_the_target() -> Outcome {
    let solid = Solid::new(rectangle([0.05, 0.05], [2, 2], CellKind::Quad4)?)?;
    let solid = solid.material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?.clamp("x-")?;
    let of = |strip: bool| -> Outcome<Vec<f64>> {
        let cost = SmoothedHausdorff::to(square(strip)?).target_region("goal").exponential(0.005).automatic_stages();
        Ok(resolved(&cost.bind_to(&solid)?.smoothings()))
    };
    let (alone, beside) = (of(false)?, of(true)?);
    assert!(alone.len() == 2 && alone[1] <= 0.05 * 2f64.sqrt() / 40.0 * (1.0 + 1e-8), "{alone:?}");
    assert_eq!(alone, beside);
    Ok(())
}
