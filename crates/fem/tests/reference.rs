//! Numbers nobody here made: displacements and energies agreed by independent codes.

use nastic_energy::{FiberTension, MooneyRivlin, NeoHooke};
use nastic_fem::{Controls, Solid, SolveOptions, State};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// The fibre cantilever: [0,1] x [0,0.2]^2, 10 x 2 x 2 cells (tetrahedra: six each), clamped at X = 0.
fn cantilever(kind: CellKind) -> Outcome<Solid> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [10, 2, 2], kind)?;
    Ok(Solid::new(mesh)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// m(X) = -1.5e5 Z / 0.2 at the quadrature points.
fn linear_tension(solid: &Solid) -> Outcome<Controls> {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    let tension: Vec<f64> = at.iter().map(|x| -1.5e5 * x[2] / 0.2).collect();
    controls.set(0, 0, &tension)?;
    Ok(controls)
}

fn solve(solid: &Solid, controls: &Controls) -> Outcome<State> {
    Ok(solid.solve(controls, &SolveOptions::default())?)
}

fn assert_corner(solid: &Solid, state: &State, expected: [f64; 3], tolerance: f64) {
    let far = [1.0, 0.2, 0.2];
    let distance = |x: &[f64; 3]| (0..3).map(|k| (x[k] - far[k]).abs()).sum::<f64>();
    let node = solid.mesh().points().iter().position(|x| distance(x) < 1e-12).unwrap_or(0);
    let found = &state.u[3 * node..3 * node + 3];
    for k in 0..3 {
        assert!((found[k] - expected[k]).abs() <= tolerance, "{found:.10?} where {expected:?} is agreed");
    }
}

/// The part of the energy that the passive material stores.
fn stored(solid: &Solid, state: &State) -> Outcome<f64> {
    let energy = solid.cell_fields(state)?.energy;
    let weights = solid.discretization().points().weights();
    let volumes = solid.discretization().points_of_cells();
    Ok(volumes.iter().zip(energy).map(|(&(first, n), w)| w * weights[first..first + n].iter().sum::<f64>()).sum())
}

/// FEniCSx, NGSolve, JAX-FEM.
#[test]
fn hex8_tip_agrees_with_three_codes() -> Outcome {
    let solid = cantilever(CellKind::Hex8)?;
    let state = solve(&solid, &linear_tension(&solid)?)?;
    assert_corner(&solid, &state, [-0.186179761, 0.008186681, 0.235506464], 1e-9);
    assert!((state.report.energy - 1340.90738505).abs() < 1e-8);
    assert!((stored(&solid, &state)? - 130.15626793).abs() < 1e-8);
    Ok(())
}

/// FEniCSx, NGSolve, FElupe, JAX-FEM, GetFEM, scikit-fem.
#[test]
fn hex27_tip_and_energies_agree_with_six_codes() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let state = solve(&solid, &linear_tension(&solid)?)?;
    assert_corner(&solid, &state, [-0.221675516, 0.007753715, 0.282876107], 1e-9);
    assert!((state.report.energy - 1332.20755217).abs() < 1e-8);
    assert!((stored(&solid, &state)? - 134.79839792).abs() < 1e-8);
    Ok(())
}

/// FEniCSx, legacy FEniCS: Kuhn split along the body diagonal, quadrature degree 4.
#[test]
fn tet10_tip_agrees_with_fenics() -> Outcome {
    let solid = cantilever(CellKind::Tet10)?;
    let state = solve(&solid, &linear_tension(&solid)?)?;
    assert_corner(&solid, &state, [-0.220968173, 0.007088890, 0.281178542], 1e-6);
    Ok(())
}

/// FEniCSx, torch-fem: the control's value at the cell centre in the whole cell.
#[test]
fn hex8_with_cell_wise_control_agrees_with_two_codes() -> Outcome {
    let solid = cantilever(CellKind::Hex8)?;
    let mut controls = linear_tension(&solid)?;
    let disc = solid.discretization();
    let centre = disc.cell_average(controls.values(0), 1);
    let spread: Vec<f64> = disc.points_of_cells().iter().zip(centre).flat_map(|(&(_, n), m)| vec![m; n]).collect();
    controls.set(0, 0, &spread)?;
    let state = solve(&solid, &controls)?;
    assert_corner(&solid, &state, [-0.15368623, 0.00721213, 0.18226513], 1e-8);
    Ok(())
}

/// HyperFEM.jl, test "StaticMechanicalDirichlet".
#[test]
fn stretched_bar_agrees_with_hyperfem() -> Outcome {
    let mesh = box_mesh([0.05, 0.005, 0.002], [5, 2, 2], CellKind::Hex8)?;
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 3.0)?)?
        .clamp("x-")?
        .displace("x+", [Some(0.08), Some(0.0), Some(0.0)])?;
    let state = solve(&solid, &solid.controls())?;
    let free = state.u.iter().zip(solid.supports().fixed()).filter(|(_, fixed)| !**fixed);
    let norm = free.map(|(u, _)| u * u).sum::<f64>().sqrt();
    assert!((norm - 0.27148722276).abs() < 1e-10, "{norm:.12}");
    Ok(())
}
