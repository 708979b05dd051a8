//! A second field on the nodes: a Poisson problem whose solution pushes the body, its closed form and its adjoint.

use crate::common;

use common::block::STRICT;
use common::own_contributions::Oscillators;
use common::poisson::{Coupled, Poisson, Screened, forces};
use common::{Outcome, distance, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Feature, Foundation, Instant, MovingSupport, Scheme, Solid, SolveOptions, Solver, Spring, State, Tendon,
    TimeStepping, check_contribution,
};
use nastic_mesh::CellKind;

const CONDUCTIVITY: f64 = 0.5;
const PUSH: f64 = 40.0;

/// A bar held at its left end, with displacements alone.
fn bar() -> Outcome<Solid> {
    let mesh = regular(CellKind::Hex20, [1.0, 0.3, 0.3], [4, 1, 1])?;
    Ok(Solid::new(mesh)?.material("body", NeoHooke::new(1e2, 2e2)?)?.clamp("x-")?)
}

/// With what knows of displacements alone: a spring that its control shortens and a foundation.
fn loaded(bar: Solid) -> Outcome<Solid> {
    Ok(bar
        .spring(Spring::between("spring", [0.2, 0.1, 0.1], [0.9, 0.2, 0.25], 3.0))?
        .foundation(Foundation::on("z-", 2.0))?)
}

fn cable() -> Tendon {
    Tendon::through("cable", [[0.1, 0.1, 0.1], [0.5, 0.1, 0.25], [0.9, 0.1, 0.1]]).inextensible()
}

/// With the field, zero at both ends.
fn with_field(solid: Solid) -> Outcome<Solid> {
    let poisson = Poisson::on(solid.discretization(), CONDUCTIVITY, PUSH);
    Ok(solid.contribution(poisson)?.hold("phi", 0, "x-", 0.0)?.hold("phi", 0, "x+", 0.0)?)
}

fn solve(solid: &Solid, source: f64) -> Outcome<State> {
    let mut controls = solid.controls();
    let block = solid.model().controllable().iter().position(|c| c.name == "poisson").ok_or("no source")?;
    controls.values_mut(block)[0] = source;
    Ok(solid.solve(&controls, &STRICT)?)
}

/// `phi = f x (1 - x) / 2k`, which quadratic cells have exactly, whatever stands beside it and in whatever order.
#[test]
fn the_field_has_its_closed_form() -> Outcome {
    let before = with_field(loaded(bar()?)?)?;
    let behind = loaded(with_field(bar()?)?)?;
    let source = 0.7;
    for solid in [&before, &behind] {
        let state = solve(solid, source)?;
        let phi = solid.model().field("phi", &state.u)?;
        let exact: Vec<f64> =
            solid.mesh().points().iter().map(|x| source * x[0] * (1.0 - x[0]) / (2.0 * CONDUCTIVITY)).collect();
        let error = distance(&phi, &exact);
        println!("phi {error:.3e} of {:.3e}, {}", largest(&exact), state.report.solver);
        assert!(error < 1e-12 * largest(&exact), "{error:e}");
        // the body by itself under the forces of the exact field
        let forces = forces(solid.discretization(), PUSH, &exact);
        let alone = loaded(bar()?)?.nodal_force(&forces)?;
        let expected = alone.solve(&alone.controls(), &STRICT)?;
        let u = solid.model().displacement(&state.u);
        let error = distance(&u, &expected.u);
        println!("u {error:.3e} of {:.3e}", largest(&expected.u));
        assert!(largest(&expected.u) > 1e-3 && error < 1e-10 * largest(&expected.u), "{error:e}");
    }
    Ok(())
}

/// A field that no node holds is found to its accuracy: its forces are measured against their own terms.
#[test]
fn a_field_that_nothing_holds_is_found() -> Outcome {
    let solid = bar()?;
    let solid = solid.clone().contribution(Screened::on(solid.discretization()))?;
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = 0.7;
    let state = solid.solve(&controls, &SolveOptions::default())?;
    let theta = solid.model().field("theta", &state.u)?;
    assert!(theta.iter().all(|theta| (theta - 0.7).abs() < 1e-10), "{theta:?}");
    assert!(state.report.newton <= 3, "{:?}", state.report);
    Ok(())
}

/// The contract of the contribution, and of those beside it that see their fields alone.
#[test]
fn contributions_keep_their_contract_among_fields() -> Outcome {
    let solid = with_field(loaded(bar()?)?)?.tendon(cable())?;
    let coupled = bar()?;
    let coupled = coupled.clone().contribution(Coupled::on(coupled.discretization()))?;
    for seed in 0..3 {
        check_contribution(coupled.model(), "coupled", seed)?;
    }
    for name in ["poisson", "spring", "foundation on z-", "cable", "dead load"] {
        check_contribution(solid.model(), name, 3)?;
    }
    Ok(())
}

/// The derivative of `j = c . (u, phi, p)` by the source against the remainder of Taylor's formula, with and without a constraint.
#[test]
fn the_adjoint_goes_through_the_field() -> Outcome {
    for constrained in [false, true] {
        let solid = with_field(loaded(bar()?)?)?;
        let solid = if constrained { solid.tendon(cable())? } else { solid };
        // the tendon is taut where the field pulls
        let (at, along) = (0.9, 1.3);
        let state = solve(&solid, at)?;
        let dofs = solid.model().unknowns().nodal();
        let mut cost: Vec<f64> =
            (0..state.u.len()).map(|i| if i < dofs { (1.7 * i as f64).sin() } else { 0.0 }).collect();
        solid.supports().clear(&mut cost);
        let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
        let lambda = solid.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
        let slopes = solid.model().vjp(&Instant::new(&state.u, &state.controls, 1.0), &lambda)?.controls;
        let block = solid.model().controllable().iter().position(|c| c.name == "poisson").ok_or("no source")?;
        let slope = along * slopes.values(block)[0];
        let value = |t: f64| -> Outcome<f64> {
            Ok(solve(&solid, at + t * along)?.u.iter().zip(&cost).map(|(u, c)| u * c).sum())
        };
        let base = value(0.0)?;
        let remainder = |t: f64| -> Outcome<f64> { Ok((value(t)? - base - t * slope).abs()) };
        let order = (remainder(4e-2)? / remainder(1e-2)?).log2() / 2.0;
        println!("constrained {constrained}: slope {slope:.5e}, Taylor order {order:.4}");
        assert!(order > 1.95 && order < 2.05, "constrained {constrained}: {order}");
    }
    Ok(())
}

/// A surface that moves beside the field: it moves the displacement alone.
#[test]
fn a_surface_moves_beside_the_field() -> Outcome {
    let alone = bar()?.motion(MovingSupport::of("grip", "x+"))?;
    let beside = with_field(alone.clone())?;
    let pulled = |solid: &Solid, more: f64| -> Outcome<State> {
        let mut controls = solid.controls();
        let block = solid.model().controllable().iter().position(|c| c.name == "grip").ok_or("no grip")?;
        controls.values_mut(block).copy_from_slice(&[0.05 + more, 0.01, -0.02, 0.1 + more, 0.0, 0.0]);
        Ok(solid.solve(&controls, &STRICT)?)
    };
    let (expected, state) = (pulled(&alone, 0.0)?, pulled(&beside, 0.0)?);
    let u = beside.model().displacement(&state.u);
    assert!(largest(&expected.u) > 0.04 && distance(&u, &expected.u) < 1e-12, "{:e}", distance(&u, &expected.u));
    // the derivative of j = c . (u, phi) by the grip against a difference
    let cost: Vec<f64> = (0..state.u.len()).map(|i| (1.7 * i as f64).sin()).collect();
    let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
    let lambda = beside.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
    let at = Instant::new(&state.u, &state.controls, 1.0);
    let found = beside.model().prescribed_unknowns().sensitivities(&at, &cost, &lambda)?.controls;
    let slope = found.values(0)[0] + found.values(0)[3];
    let value =
        |more: f64| -> Outcome<f64> { Ok(pulled(&beside, more)?.u.iter().zip(&cost).map(|(u, c)| u * c).sum()) };
    let difference = (value(1e-4)? - value(-1e-4)?) / 2e-4;
    assert!((slope - difference).abs() < 1e-6 * difference.abs(), "{slope} {difference}");
    check_contribution(beside.model(), "grip", 3)?;
    Ok(())
}

/// What does not know of further fields is refused, by the names of the field and of its contribution.
#[test]
fn what_knows_of_the_displacement_alone_is_refused() -> Outcome {
    let solid = with_field(bar()?)?;
    let equilibria = [Feature::Modes, Feature::Deflation, Feature::Descent, Feature::ExactContact];
    let refused = equilibria.map(|feature| solid.model().properties().supports(feature));
    for answer in refused.into_iter().chain([solid.model().supports_motion(&Scheme::bdf2())]) {
        let message = answer.err().ok_or("it goes")?.to_string();
        assert!(message.contains("\"phi\"") && message.contains("\"poisson\""), "{message}");
    }
    let unknown = solid.clone().hold("temperature", 0, "x+", 1.0).err().ok_or("it holds")?;
    assert!(unknown.to_string().contains("displacement, phi"), "{unknown}");
    let conflict = solid.clone().hold("phi", 0, "x+", 1.0).err().ok_or("it holds")?;
    assert!(conflict.to_string().contains("0 of \"phi\""), "{conflict}");
    // multigrid knows of rigid motions alone
    let how = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = 0.7;
    let state = solid.solve(&controls, &STRICT)?;
    assert_eq!(state.report.solver, "lu");
    let adjoint = solid.adjoint(&state, &[&state.u], &how).err();
    for refused in [solid.solve(&controls, &how).err(), adjoint, solid.negative_pivots_by(&state, &how).err()] {
        let refused = refused.ok_or("multigrid solves it")?.to_string();
        assert!(["multigrid", "poisson", "phi", "lu"].iter().all(|word| refused.contains(word)), "{refused}");
    }
    // a contribution that writes to more than its own unknowns would be seen here
    let held = solid.contribution(Oscillators { mass: 0.0, damping: 0.0, stiffness: 1.0, spread: 0.0 })?;
    let state = solve(&held, 0.7)?;
    let middle = common::node_at(held.mesh(), [0.5, 0.0, 0.0]).ok_or("no node")?;
    let phi = held.model().field("phi", &state.u)?[middle];
    assert!((phi - 0.7 * 0.125 / CONDUCTIVITY).abs() < 1e-12, "{phi}");
    Ok(())
}
