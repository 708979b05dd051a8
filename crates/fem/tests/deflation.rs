//! Several equilibria by deflation.

use crate::common;

use common::block::STRICT;
use common::{Outcome, node_at, regular};
use nastic_energy::{NeoHooke, NeoHookeIsochoric, Turgor};
use nastic_fem::{
    Demand, Equilibria, Formulation, Instant, PathOptions, Solid, SolveOptions, State, StateError, Workspace,
};
use nastic_mesh::CellKind;
use nastic_numeric::vector::norm;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

/// A strip of height h between two clamps, pressed by turgor with a multiple of Euler's load, and its straight state.
fn strip(multiple: f64, h: f64) -> Outcome<(Solid, State)> {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, h, 0.0], [20, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .clamp("x+")?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(multiple * PI.powi(2) * h * h / 3.0);
    let state = solid.solve(&controls, &STRICT)?;
    Ok((solid, state))
}

fn find(solid: &Solid, known: &State, count: usize) -> Outcome<Equilibria> {
    let mut seen = 0;
    let found =
        solid.model().stability().equilibria(known, count, &STRICT, &mut Workspace::default(), &mut |_| seen += 1)?;
    assert_eq!(seen, found.found.len());
    Ok(found)
}

/// Every state is an equilibrium of the same controls and load, and no two are the same.
fn check(solid: &Solid, all: &Equilibria) -> Outcome {
    let first = &all.found[0].state;
    for (k, one) in all.found.iter().enumerate() {
        let state = &one.state;
        assert_eq!((&state.controls, state.load), (&first.controls, first.load));
        let sums = solid
            .model()
            .evaluate(&Instant::new(&state.u, &state.controls, state.load), Demand { energy: true, force: true })?;
        let mut residual = sums.force;
        solid.supports().clear(&mut residual);
        assert!(norm(&residual) < 1e-10 * norm(&sums.force_scale), "equilibrium {k}");
        assert_eq!(state.report.energy, sums.energy, "equilibrium {k}");
        assert_eq!(one.negative, Some(solid.negative_pivots(state)?));
        for other in &all.found[..k] {
            assert!(common::distance(&state.u, &other.state.u) > 1e-4, "equilibrium {k} is an earlier one");
        }
    }
    Ok(())
}

fn height(solid: &Solid, at: [f64; 3]) -> Outcome<impl Fn(&State) -> f64> {
    let node = node_at(solid.mesh(), at).ok_or("no such node")?;
    Ok(move |state: &State| state.u[2 * node + 1])
}

#[test]
fn both_buckled_branches_stand_beside_the_straight_one() -> Outcome {
    for h in [0.05, 0.02, 0.005] {
        let (solid, straight) = strip(1.5, h)?;
        let all = find(&solid, &straight, 3)?;
        check(&solid, &all)?;
        let counts: Vec<_> = all.found.iter().map(|one| one.negative).collect();
        assert_eq!(counts, [Some(1), Some(0), Some(0)], "h = {h}");
        let middle = height(&solid, [0.5, 0.5 * h, 0.0])?;
        let [a, b] = [1, 2].map(|k| middle(&all.found[k].state));
        assert!(a.abs() > 0.5 * h && (a + b).abs() < 1e-6 * h, "h = {h}: {a} and {b}");
        let energies: Vec<f64> = all.found.iter().map(|one| one.state.report.energy).collect();
        assert!(energies[1] < energies[0] && energies[2] < energies[0], "{energies:?}");
    }
    Ok(())
}

/// Beyond its second load the strip has five states: straight (two negative pivots), two stable, two S-shaped saddles.
#[test]
fn branches_of_the_second_mode_are_found_too() -> Outcome {
    let (solid, straight) = strip(3.0, 0.02)?;
    let all = find(&solid, &straight, 5)?;
    check(&solid, &all)?;
    let mut counts: Vec<_> = all.found.iter().map(|one| one.negative).collect();
    counts.sort();
    assert_eq!(counts, [0, 0, 1, 1, 2].map(Some));
    let quarter = height(&solid, [0.25, 0.01, 0.0])?;
    let saddles: Vec<f64> =
        all.found.iter().filter(|one| one.negative == Some(1)).map(|one| quarter(&one.state)).collect();
    assert!(saddles[0].abs() > 0.01 && (saddles[0] + saddles[1]).abs() < 1e-8, "{saddles:?}");
    Ok(())
}

/// Between its limit points the symmetric path of an arch passes three states under one weight: deflation finds all of
/// them, from the first alone, and two antisymmetric saddles that the path does not see.
#[test]
fn the_three_states_of_an_arch_are_found() -> Outcome {
    let (h, e, nu, s) = (0.02, 1e6, 0.3, 0.3);
    let flat = regular(CellKind::Quad8, [1.0, h, 0.0], [20, 1, 1])?;
    let raised = flat.points().iter().map(|x| [x[0], x[1] + h * (1.0 - (2.0 * PI * x[0]).cos()), 0.0]).collect();
    let mesh = flat.with_points(raised)?;
    let under = |weight: f64| -> Outcome<Solid> {
        Ok(Solid::new(mesh.clone())?
            .material("body", NeoHooke::new(e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)))?)?
            .clamp("x-")?
            .clamp("x+")?
            .body_force("body", Vec3::y() * -weight)?)
    };
    let (solid, full) = (under(1600.0 * s)?, under(1600.0)?);
    let all = find(&solid, &solid.solve(&solid.controls(), &STRICT)?, 5)?;
    check(&solid, &all)?;
    let crown = height(&solid, [0.5, 3.0 * h, 0.0])?;
    let to = (&full.controls(), 1.0);
    let none = &mut |_: &_| ();
    let path = full.model().stability().path(
        &full.rest(),
        to,
        &PathOptions::default(),
        &STRICT,
        &mut Workspace::default(),
        none,
    )?;
    let crossings: Vec<_> = path.points.windows(2).filter(|pair| (pair[0].s - s) * (pair[1].s - s) < 0.0).collect();
    assert_eq!(crossings.len(), 3);
    for (pair, count) in crossings.iter().zip([0, 2, 0]) {
        let [a, b] = [0, 1].map(|k| crown(&pair[k].state));
        let on_path = |one: &&nastic_fem::Equilibrium| {
            let at = crown(&one.state);
            one.negative == Some(count) && a.min(b) < at && at < a.max(b)
        };
        assert_eq!(all.found.iter().filter(on_path).count(), 1, "between {a} and {b}");
    }
    assert_eq!(all.found.iter().filter(|one| one.negative == Some(1)).count(), 2);
    Ok(())
}

#[test]
fn what_cannot_be_asked_is_a_typed_error() -> Outcome {
    let (solid, straight) = strip(0.5, 0.02)?;
    assert_eq!(find(&solid, &straight, 1)?.found.len(), 1);
    let ask = |solid: &Solid, count: usize, how: &SolveOptions| {
        solid.model().stability().equilibria(&straight, count, how, &mut Workspace::default(), &mut |_| ())
    };
    assert!(matches!(ask(&solid, 0, &STRICT), Err(StateError::Problem(_))));
    let other = Solid::new(regular(CellKind::Quad4, [1.0, 1.0, 0.0], [1, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .clamp("x-")?;
    assert!(matches!(ask(&other, 2, &STRICT), Err(StateError::Problem(_))));
    let cancel = std::sync::atomic::AtomicBool::new(true);
    let cancelled = ask(&solid, 2, &SolveOptions { cancel: Some(&cancel), ..STRICT });
    assert!(matches!(cancelled, Err(StateError::Cancelled)), "{cancelled:?}");
    Ok(())
}

/// Rivlin's cube: under three equal tractions T per reference area a nearly incompressible neo-Hookean cube has, beside the shape that it had, states of
/// stretches `(l, l, l^-2)` with `l + l^-2 = T / mu` about each axis (R. S. Rivlin, Phil. Trans. A 240, 1948, 491-508).
#[test]
fn the_seven_states_of_a_cube_under_equal_tractions() -> Outcome {
    let ratio = 2.2;
    // l + l^-2 falls up to l = 2^(1/3) and rises beyond
    let root = |(mut low, mut high): (f64, f64), rising: bool| {
        for _ in 0..60 {
            let l = 0.5 * (low + high);
            if (l + l.powi(-2) > ratio) == rising { high = l } else { low = l }
        }
        low
    };
    let roots = [root((0.5, 1.25), false), root((1.26, 3.0), true)];
    for (stiffness, wanted) in [(10.0, None), (1e3, Some(7)), (1e4, Some(5))] {
        let mut solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1, 1, 1])?)?
            .material("body", NeoHookeIsochoric::new(1.0, stiffness)?)?
            .formulation("body", Formulation::MeanDilatation)?;
        for (k, (held, pulled)) in [("x-", "x+"), ("y-", "y+"), ("z-", "z+")].into_iter().enumerate() {
            let mut traction = Vec3::zeros();
            traction[k] = ratio;
            solid =
                solid.displace(held, std::array::from_fn(|i| (i == k).then_some(0.0)))?.traction(pulled, traction)?;
        }
        let rest = solid.solve(&solid.controls(), &STRICT)?;
        let all = find(&solid, &rest, 9)?;
        check(&solid, &all)?;
        println!("bulk over shear modulus {stiffness}: {} states", all.found.len());
        assert!(all.found.len() >= wanted.unwrap_or(7), "{} states at {stiffness}", all.found.len());
        if wanted.is_none() {
            continue;
        }
        let corner = node_at(solid.mesh(), [1.0; 3]).ok_or("no such node")?;
        let mut seen = [0; 2];
        for one in &all.found[1..] {
            let mut l: Vec<f64> = one.state.u[3 * corner..][..3].iter().map(|u| 1.0 + u).collect();
            l.sort_by(f64::total_cmp);
            // the two equal ones stand in the middle
            let kind = roots.iter().position(|root| (l[1] / root - 1.0).abs() < 5e-3).ok_or(format!("{l:?}"))?;
            assert!((l[0] * l[1] * l[2] - 1.0).abs() < 1e-2, "{l:?}");
            seen[kind] += 1;
        }
        assert!(seen.iter().all(|&seen| (1..=3).contains(&seen)), "{seen:?}");
    }
    Ok(())
}
