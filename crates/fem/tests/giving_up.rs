//! Solves that must fail do so soon, and say why.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::shells::{pressure as pressure_at, shell};
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Ahead, Cause, Cavity, Controls, Solid, SolveOptions, SolveReport, State, StateError, Tendon, Workspace,
};
use nastic_mesh::CellKind;

/// An eighth of a thick sphere that is inflated.
fn sphere() -> Outcome<Solid> {
    let planes = ["x-", "y-", "z-"];
    let mut solid = Solid::new(shell(CellKind::Hex20, 1)?)?
        .material("body", NeoHooke::new(1.0, 10.0)?)?
        .cavity(planes.into_iter().fold(Cavity::new("air", "inner"), Cavity::symmetry))?;
    for (k, plane) in planes.into_iter().enumerate() {
        solid = solid.displace(plane, std::array::from_fn(|i| (i == k).then_some(0.0)))?;
    }
    Ok(solid)
}

fn pressure(solid: &Solid, p: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    controls.set(0, 0, &[p])?;
    Ok(controls)
}

/// The pressure of an inflated neo-Hookean sphere has a maximum: beyond it there is no equilibrium.
#[test]
fn a_sphere_beyond_its_largest_pressure_ends_at_a_limit_point() -> Outcome {
    let solid = sphere()?;
    let how = SolveOptions::default();
    // The largest pressure, by bisection from states nearby.
    let (mut low, mut high) = (0.0, 4.0);
    let mut near = solid.rest();
    while high - low > 2e-3 {
        let p = 0.5 * (low + high);
        match solid.solve(&pressure(&solid, p)?, &SolveOptions { near: Some(&near), ..how.clone() }) {
            Ok(state) => (low, near) = (p, state),
            Err(_) => high = p,
        }
    }
    for beyond in [1.2, 3.0] {
        let error =
            solid.solve(&pressure(&solid, beyond * high)?, &how).err().ok_or("an equilibrium beyond the limit")?;
        let StateError::NoConvergence { newton, reached, cause, .. } = &error else { panic!("{error}") };
        let Cause::LimitPoint { load } = cause else { panic!("{error}") };
        assert!((load * beyond - 1.0).abs() < 0.05 && *reached * beyond <= 1.0, "{error}");
        assert!(*newton < 700, "{error}");
    }
    Ok(())
}

/// A budget ends a solve on whatever way it is, from rest or from a state nearby, and says so; one that suffices changes nothing.
#[test]
fn a_solve_ends_with_its_budget() -> Outcome {
    let solid = sphere()?;
    let beyond = pressure(&solid, 10.0)?;
    let near = solid.solve(&pressure(&solid, 0.3)?, &SolveOptions::default())?;
    for budget in [0, 1, 25, 90] {
        for near in [None, Some(&near)] {
            let how = SolveOptions { near, budget: Some(budget), ..SolveOptions::default() };
            let error = solid.solve(&beyond, &how).err().ok_or("an equilibrium beyond the limit")?;
            let StateError::NoConvergence { newton, budget: cut, .. } = &error else { panic!("{error}") };
            assert_eq!((*newton, *cut), (budget, Some(budget)), "{error}");
            assert!(error.to_string().starts_with(&format!("cut after its budget of {budget} Newton")), "{error}");
        }
    }
    let more = SolveOptions { near: Some(&near), budget: Some(40), ..SolveOptions::default() };
    let free = SolveOptions { near: Some(&near), ..SolveOptions::default() };
    let to = pressure(&solid, 0.35)?;
    let (cut, free) = (solid.solve(&to, &more)?, solid.solve(&to, &free)?);
    assert_eq!((&cut.u, cut.report.newton), (&free.u, free.report.newton));
    Ok(())
}

/// The path towards more pressure than the sphere bears turns back at the maximum of the radial problem; towards less it leads to
/// the state.
#[test]
fn a_limit_point_ahead_is_told() -> Outcome {
    let solid = sphere()?;
    // the largest pressure over the inner radius, of the law of the sphere: mu = 1, lambda = 10
    let largest = (10..30).map(|k| pressure_at([0.5, 0.0, 5.0], 0.1 * f64::from(k), 2)).fold(0.0, f64::max);
    let (model, how) = (solid.model(), SolveOptions::default());
    let ahead = |from: &State, p: f64| -> Outcome<(Ahead, SolveReport)> {
        let (mut report, workspace) = (SolveReport::default(), &mut Workspace::default());
        let found = model.moves().ahead(from, (&pressure(&solid, p)?, 1.0), &how, workspace, &mut report)?;
        Ok((found, report))
    };
    let near = solid.solve(&pressure(&solid, 0.3)?, &how)?;
    let to = 4.0;
    let (Ahead::LimitPoint(limit), work) = ahead(&near, to)? else { panic!("no limit point") };
    let p = 0.3 + limit.share * (to - 0.3);
    println!("limit at {p:.4}, radial problem {largest:.4}, {} iterations", work.newton);
    assert!((p / largest - 1.0).abs() < 0.03, "{p} instead of {largest}");
    assert!((limit.state.controls.values(0)[0] / p - 1.0).abs() < 1e-9);
    assert!((10..200).contains(&work.newton), "{}", work.newton);
    // the body goes on outwards there
    let outwards: f64 =
        solid.mesh().points().iter().zip(limit.direction.chunks_exact(3)).map(|(x, d)| x[0] * d[0]).sum();
    assert!(outwards > 0.0, "{outwards}");
    let (Ahead::Clear(state), _) = ahead(&near, 0.9 * p)? else { panic!("a limit point below the largest pressure") };
    let direct = solid.solve(&pressure(&solid, 0.9 * p)?, &SolveOptions { near: Some(&near), ..how.clone() })?;
    let apart = state.u.iter().zip(direct.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart:e}");
    // a path has its budget too
    let brief = SolveOptions { budget: Some(3), ..how.clone() };
    let report = &mut SolveReport::default();
    let cut = model.moves().ahead(&near, (&pressure(&solid, to)?, 1.0), &brief, &mut Workspace::default(), report)?;
    assert!(matches!(cut, Ahead::Unknown(share) if share < limit.share), "{cut:?}");
    Ok(())
}

/// Two tendons pull a bar beyond a limit point where cells collapse beside one of them: the load steps that end before it do not grow like those to
/// a fold, and the path from the last of them finds it.
#[test]
fn a_limit_point_that_load_steps_do_not_show_is_found_by_the_path() -> Outcome {
    let mut solid = Solid::new(regular(CellKind::Hex20, [0.1, 0.016, 0.02], [20, 2, 2])?)?
        .material("body", NeoHooke::from_young_poisson(0.3e6, 0.45)?)?
        .clamp("x-")?;
    for (name, z) in [("flexor", 0.003), ("extensor", 0.017)] {
        let ends = [[0.0, 0.008, z], [0.1, 0.008, z]];
        solid = solid.tendon(Tendon::through(name, ends).spacing(0.005))?;
    }
    let mut controls = solid.controls();
    let how = SolveOptions::default();
    for (k, tension) in [5.0, 15.0].into_iter().enumerate() {
        controls.values_mut(k).fill(tension);
    }
    let error = solid.solve(&controls, &how).err().ok_or("an equilibrium beyond the limit")?;
    let StateError::NoConvergence { cause, .. } = &error else { panic!("{error}") };
    let limit = match cause {
        Cause::LimitPoint { load } => Some(*load),
        Cause::GuidesMeet(guides) => guides.limit,
        _ => None,
    };
    // at the tension of the extensor at which `nastic solve --path` finds it for the same bar
    assert!(limit.is_some_and(|load| (15.0 * load - 10.397).abs() < 0.01), "{error}");
    Ok(())
}
