//! What an adjoint says of the controls is known to 1e-8, whatever factor it was found with.

use crate::common;

use common::{Outcome, kinds, noise, regular};
use nastic_energy::{FiberTension, Magnet, MooneyRivlin, NeoHooke, Turgor};
use nastic_fem::{Controls, Solid, SolveOptions, State, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

/// A body, what drives it, and its name.
struct Case {
    name: String,
    solid: Solid,
    controls: Controls,
}

/// A bar that bends: two actuations, a load.
fn bar(kind: CellKind, size: [f64; 3], cells: [usize; 3], bulk: f64) -> Outcome<Case> {
    let solid = Solid::new(regular(kind, size, cells)?)?
        .material("body", MooneyRivlin::new(1.0, 0.2, bulk)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .traction("x+", Vec3::new(0.0, 1e-4 * size[1], 0.0))?;
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    for (q, x) in at.iter().enumerate() {
        controls.values_mut(0)[q] = -0.5 * x[1] / size[1];
        controls.values_mut(1)[q] = 0.02 * x[0];
    }
    Ok(Case { name: format!("{kind}, {size:?}, mu_3 = {bulk}"), solid, controls })
}

/// A thin strip with a remanence that turns along it.
fn strip() -> Outcome<Case> {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.1, 0.02], [24, 3, 1])?)?
        .material("body", NeoHooke::new(1.0, 3.0)?)?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("x-")?;
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    let (field, remanence) = ([0.0, 0.0, 1e-4], |x: f64| [(2.0 * x).cos(), 0.0, (2.0 * x).sin()]);
    for (q, x) in at.iter().enumerate() {
        controls.values_mut(0)[6 * q..6 * q + 3].copy_from_slice(&remanence(x[0]));
        controls.values_mut(0)[6 * q + 3..6 * q + 6].copy_from_slice(&field);
    }
    Ok(Case { name: "strip".to_owned(), solid, controls })
}

fn cases() -> Outcome<Vec<Case>> {
    let mut cases = Vec::new();
    for kind in kinds() {
        cases.push(bar(kind, [1.0, 0.3, 0.3], [4, 2, 2], 5.0)?);
    }
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10, CellKind::Quad9] {
        cases.push(bar(kind, [1.0, 0.02, 0.1], [16, 1, 2], 5.0)?);
    }
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tri6] {
        cases.push(bar(kind, [1.0, 0.2, 0.2], [8, 2, 2], 500.0)?);
    }
    cases.push(strip()?);
    Ok(cases)
}

/// Right-hand sides: without a pattern; the tip's way, as of a cost that looks there; a wave.
fn wishes(solid: &Solid) -> Vec<Vec<f64>> {
    let dim = solid.discretization().dim();
    let points = solid.mesh().points();
    let of = |wish: &dyn Fn(usize, usize) -> f64| (0..dim * points.len()).map(|i| wish(i / dim, i % dim)).collect();
    vec![
        of(&|node, c| noise(dim * node + c)),
        of(&|node, c| if points[node][0] > 0.999 && c == 1 { 1.0 } else { 0.0 }),
        of(&|node, c| (3.0 * points[node][0] + c as f64).sin()),
    ]
}

fn gradient(solid: &Solid, state: &State, lambda: &[f64]) -> Outcome<Controls> {
    Ok(solid.body().control_vjp(&state.u, &state.controls, lambda, false)?)
}

/// The adjoint corrected by adjoints of what is left of its residual, until that is rounding.
fn converged(solid: &Solid, state: &State, rhs: &[f64], mut lambda: Vec<f64>) -> Outcome<Vec<f64>> {
    for _ in 0..4 {
        let mut left = vec![0.0; rhs.len()];
        solid.body().tangent_product(&state.u, &state.controls, &lambda, &mut left, false)?;
        left.iter_mut().zip(rhs).for_each(|(l, b)| *l = b - *l);
        let more = solid.adjoint(state, &[&left], &SolveOptions::default())?.lambda.remove(0);
        lambda.iter_mut().zip(&more).for_each(|(l, m)| *l += m);
    }
    Ok(lambda)
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum::<f64>().sqrt()
}

/// To half of the 1e-8 that is promised.
#[test]
fn the_default_gradient_is_that_of_a_converged_adjoint() -> Outcome {
    for Case { name, solid, controls } in cases()? {
        let (mut own, mut at_rest) = (Workspace::default(), Workspace::default());
        let state = solid.solve_with(&controls, &SolveOptions::default(), &mut own)?;
        solid.solve_with(&solid.controls(), &SolveOptions::default(), &mut at_rest)?;
        for (n, wish) in wishes(&solid).iter().enumerate() {
            let first = solid.adjoint(&state, &[wish], &SolveOptions::default())?.lambda.remove(0);
            let lambda = converged(&solid, &state, wish, first)?;
            let exact = gradient(&solid, &state, &lambda)?;
            for (whose, workspace) in [("own", &Workspace::default()), ("kept", &own), ("at rest", &at_rest)] {
                let how = SolveOptions::default();
                let adjoint = solid.adjoint_with(&state, &[wish], &how, &mut workspace.clone())?;
                let found = gradient(&solid, &state, &adjoint.lambda[0])?;
                for k in 0..exact.len() {
                    let error = norm(found.values(k).iter().zip(exact.values(k)).map(|(a, b)| a - b));
                    let error = error / norm(exact.values(k).iter().copied());
                    assert!(error <= 5e-9, "{name}, wish {n}, actuation {k}, factor {whose}: {error:e}");
                }
            }
        }
    }
    Ok(())
}
