//! Springs: a bar on a spring, forces in equilibrium, what they hold, tightening with the load, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, noise, regular, unit};
use nastic_energy::NeoHooke;
use nastic_fem::{BodyPoint, Demand, FemError, Instant, Solid, Spring, State, StateError, check_contribution};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

fn quantity(solid: &Solid, state: &State, name: &str, wanted: &str) -> Outcome<f64> {
    let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
    let found = all.iter().find(|(of, what, _)| of == name && *what == wanted);
    Ok(found.ok_or(format!("no {wanted} of {name}"))?.2)
}

const LENGTH: f64 = 2.0;
const MU: f64 = 4e4;
/// Middles of the ends of a bar whose cells go across it: shape functions there give every node of the end the same weight, as a uniform
/// traction does.
const FOOT: [f64; 3] = [0.0, 0.25, 0.25];
const TIP: [f64; 3] = [LENGTH, 0.25, 0.25];

/// A bar that does not contract sideways: a stretch s takes the force mu A (s - 1/s).
fn bar(kind: CellKind) -> Outcome<Solid> {
    let rollers = Solid::new(regular(kind, [LENGTH, 0.5, 0.5], [4, 1, 1])?)?
        .material("body", NeoHooke::new(MU, 0.0)?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?;
    Ok(if kind.dim() == 3 { rollers.displace("z-", [None, None, Some(0.0)])? } else { rollers })
}

fn in_plane(kind: CellKind, x: [f64; 3]) -> [f64; 3] {
    if kind.dim() == 2 { [x[0], x[1], 0.0] } else { x }
}

/// Pulled by a spring to the ground at x = g, k (g - s l - L) = mu A (s - 1/s); with one between its own ends -k (s l - L) = mu A (s - 1/s).
#[test]
fn a_bar_on_a_spring_has_the_stretch_of_the_closed_solution() -> Outcome {
    let (k, g) = (9e3, 3.1);
    for (kind, area) in [(CellKind::Hex8, 0.25), (CellKind::Quad4, 0.5)] {
        let [foot, tip, ground] = [FOOT, TIP, [g, 0.25, 0.25]].map(|x| in_plane(kind, x));
        // a spring that pulls, pushes, has no rest length, or none of its own
        for rest in [Some(0.6), Some(1.9), Some(0.0), None] {
            let with = |spring: Spring| rest.map_or(spring.clone(), |length| spring.rest_length(length));
            let grounded = with(Spring::to_ground("spring", tip, ground, k));
            let inner = with(Spring::between("spring", foot, tip, k));
            let ends = [(grounded, g - rest.unwrap_or(g - LENGTH), -1.0), (inner, rest.unwrap_or(LENGTH), 1.0)];
            for (spring, pulled, sign) in ends {
                // (mu A + k l) s^2 - k c s - mu A = 0
                let (a, b) = (MU * area + k * LENGTH, k * pulled);
                let s = (b + (b * b + 4.0 * a * MU * area).sqrt()) / (2.0 * a);
                let solid = bar(kind)?.spring(spring.clone())?;
                let state = solid.solve(&solid.controls(), &STRICT)?;
                for &node in &solid.nodes_of("x+")? {
                    let u = state.u[kind.dim() * node as usize];
                    let wanted = (s - 1.0) * LENGTH;
                    assert!((u - wanted).abs() < 1e-10, "{kind}, {spring:?}: {u} instead of {wanted}");
                }
                let force = quantity(&solid, &state, "spring", "force")?;
                let wanted = -sign * MU * area * (s - 1.0 / s);
                assert!((force - wanted).abs() < 1e-6, "{kind}, {spring:?}: {force} instead of {wanted}");
                assert!(rest.is_none() || (s - 1.0).abs() > 0.01, "{kind}, {spring:?}: nothing to see, {s}");
                assert_eq!(solid.negative_pivots(&state)?, 0);
            }
        }
    }
    Ok(())
}

/// The forces on a displaced body: between two of its points without resultant and moment, to the ground k (l - L) along the spring.
#[test]
fn forces_are_those_of_the_elongation() -> Outcome {
    let (a, b, ground) = ([0.1, 0.2, 0.3], [0.9, 0.45, 0.05], [1.4, -0.3, 0.6]);
    let springs = [
        Spring::between("spring", a, b, 7.0).rest_length(0.3),
        Spring::to_ground("spring", a, ground, 7.0).rest_length(0.3),
        Spring::to_ground("spring", a, ground, 7.0).rest_length(0.0),
    ];
    for (at, spring) in springs.into_iter().enumerate() {
        let solid = Solid::new(unit(CellKind::Tet10, 2)?)?.spring(spring)?;
        let u: Vec<f64> = (0..solid.discretization().dofs()).map(|k| 0.05 * noise(k)).collect();
        let controls = solid.controls();
        let instant = Instant::new(&u, &controls, 1.0);
        let force = solid.model().evaluate(&instant, Demand { energy: false, force: true })?.force;
        let (mut sum, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for (node, x) in solid.mesh().points().iter().enumerate() {
            let own = |v: &[f64]| Vec3::from_column_slice(&v[3 * node..3 * node + 3]);
            sum -= own(&force);
            moment -= (Vec3::from(*x) + own(&u)).cross(&own(&force));
        }
        let line = solid.model().lines(&instant)?.remove(0);
        let [from, to] = [0, 1].map(|end| Vec3::from(line.points[end]));
        assert!((from - Vec3::from(a)).norm() > 1e-3 && line.points.len() == 2 && line.name == "spring");
        let wanted = match at {
            0 => Vec3::zeros(),
            1 => 7.0 * ((to - from).norm() - 0.3) * (to - from).normalize(),
            _ => 7.0 * (Vec3::from(ground) - from),
        };
        let error = (sum - wanted).norm().max((moment - from.cross(&wanted)).norm());
        assert!(largest(&force) > 0.5 && error < 1e-12, "{at}: {sum} instead of {wanted}, {moment}");
    }
    Ok(())
}

/// A spring that is too short at rest is tightened with the load: the rest is in equilibrium without it.
#[test]
fn tension_at_rest_comes_with_the_load() -> Outcome {
    for rest in [0.0, 0.6, 1.9] {
        let solid =
            bar(CellKind::Hex8)?.spring(Spring::to_ground("spring", TIP, [3.1, 0.6, 0.25], 9e3).rest_length(rest))?;
        let rest = solid.rest();
        let force = |load: f64| -> Outcome<Vec<f64>> {
            let at = Instant::new(&rest.u, &rest.controls, load);
            Ok(solid.model().evaluate(&at, Demand { energy: false, force: true })?.force)
        };
        let (none, half, full) = (force(0.0)?, force(0.5)?, force(1.0)?);
        assert!(largest(&none) < 1e-12 && largest(&full) > 100.0);
        half.iter().zip(&full).for_each(|(half, full)| assert!((half - 0.5 * full).abs() < 1e-9));
    }
    Ok(())
}

fn floating(kind: CellKind, springs: impl IntoIterator<Item = Spring>) -> Outcome<Solid> {
    let body = Solid::new(regular(kind, [1.0, 0.5, 0.5], [3, 2, 2])?)?.material("body", NeoHooke::new(4e4, 6e4)?)?;
    Ok(springs.into_iter().try_fold(body, Solid::spring)?)
}

/// Three springs of rest length 0 hold a body that nothing else holds; their forces carry its weight.
#[test]
fn springs_to_the_ground_hold_a_body() -> Outcome {
    let points = [[0.0, 0.1, 0.1], [0.9, 0.1, 0.2], [0.4, 0.45, 0.4]];
    for kind in [CellKind::Hex8, CellKind::Tet10] {
        let tied = |(k, x): (usize, [f64; 3])| Spring::to_ground(&format!("{k}"), x, x, 5e3);
        let load = Vec3::new(30.0, -400.0, 200.0);
        let solid = floating(kind, points.into_iter().enumerate().map(tied))?.body_force("body", load)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let lines = solid.model().lines(&Instant::new(&state.u, &state.controls, 1.0))?;
        let pull = |line: &nastic_mesh::Polyline| 5e3 * (Vec3::from(line.points[1]) - Vec3::from(line.points[0]));
        let carried: Vec3 = lines.iter().map(pull).sum();
        assert!((carried + 0.25 * load).norm() < 1e-7, "{kind}: {carried}");
        assert_eq!(solid.negative_pivots(&state)?, 0, "{kind}");
    }
    Ok(())
}

/// Springs without tension hold along themselves: six in general directions hold a body, five leave a motion; those within the body leave all.
#[test]
fn what_springs_leave_free_is_told() -> Outcome {
    let along = [
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([1.0, 0.5, 0.0], [0.0, 0.0, 1.0]),
    ];
    let tied = |k: usize| {
        let (x, n) = along[k];
        Spring::to_ground(&format!("{k}"), x, std::array::from_fn(|i| x[i] - 0.7 * n[i]), 5e3)
    };
    let free = |solid: &Solid| match solid.check() {
        Ok(()) => Ok(0),
        Err(FemError::RigidMotion { free, .. }) => Ok(free),
        Err(other) => Err(other),
    };
    for count in 1..=6 {
        let solid = floating(CellKind::Hex8, (0..count).map(tied))?;
        assert_eq!(free(&solid)?, 6 - count);
    }
    let solid = floating(CellKind::Hex8, (0..6).map(tied))?.body_force("body", Vec3::new(10.0, 20.0, -30.0))?;
    solid.solve(&solid.controls(), &STRICT)?;
    // under tension across itself too, but not under pressure
    assert_eq!(free(&floating(CellKind::Hex8, [tied(0).rest_length(0.3)])?)?, 3);
    assert_eq!(free(&floating(CellKind::Hex8, [tied(0).rest_length(1.3)])?)?, 5);
    let inner = Spring::between("inner", FOOT, [0.9, 0.1, 0.1], 5e3).rest_length(0.0);
    let inside = floating(CellKind::Hex8, [inner])?;
    match inside.solve(&inside.controls(), &STRICT) {
        Err(StateError::Problem(FemError::RigidMotion { free, .. })) => assert_eq!(free, 6),
        other => return Err(format!("{other:?}").into()),
    }
    Ok(())
}

#[test]
fn springs_keep_the_contract_on_every_cell() -> Outcome {
    for kind in common::kinds() {
        let [a, b, ground] = [[0.1, 0.31, 0.2], [0.9, 0.13, 0.4], [1.4, -0.2, 0.7]].map(|x| in_plane(kind, x));
        let springs = [
            Spring::between("spring", a, b, 30.0),
            Spring::between("spring", a, b, 30.0).rest_length(0.2),
            Spring::between("spring", a, b, 30.0).rest_length(0.0),
            Spring::to_ground("spring", a, ground, 30.0).rest_length(2.0),
            Spring::to_ground("spring", b, ground, 30.0).rest_length(0.0),
            Spring::to_ground("spring", b, b, 30.0),
        ];
        for spring in springs {
            let solid = floating(kind, [spring.clone()])?;
            for seed in 0..3 {
                check_contribution(solid.model(), "spring", seed)
                    .map_err(|why| format!("{kind}, {spring:?}: {why}"))?;
            }
        }
    }
    Ok(())
}

#[test]
fn what_is_no_spring_is_refused() -> Outcome {
    let refused = |kind: CellKind, spring: Spring, words: &[&str]| -> Outcome {
        let message = floating(kind, [spring]).err().ok_or(format!("{words:?} passes"))?.to_string();
        assert!(words.iter().chain(&["spring \"s\""]).all(|word| message.contains(word)), "{message}");
        Ok(())
    };
    let (hex, a, b) = (CellKind::Hex8, [0.1, 0.2, 0.3], [0.9, 0.4, 0.2]);
    refused(hex, Spring::between("s", a, b, 0.0), &["stiffness of 0", "positive"])?;
    refused(hex, Spring::between("s", a, b, f64::NAN), &["stiffness", "finite"])?;
    refused(hex, Spring::between("s", a, b, 1.0).rest_length(-0.1), &["rest length of -0.1", "not negative"])?;
    refused(hex, Spring::between("s", a, [2.0, 0.4, 0.2], 1.0), &["end \"to\"", "outside the body", "(1, 0.4, 0.2)"])?;
    refused(hex, Spring::between("s", "anchor", b, 1.0), &["end \"from\"", "anchor"])?;
    refused(hex, Spring::between("s", a, a, 1.0), &["both ends at one point"])?;
    refused(hex, Spring::to_ground("s", a, a, 1.0).rest_length(0.2), &["no direction", "0.2"])?;
    refused(hex, Spring::to_ground("s", a, [0.0, f64::INFINITY, 0.0], 1.0), &["not finite"])?;
    refused(CellKind::Quad4, Spring::to_ground("s", [0.1, 0.2, 0.0], [0.0, 0.0, 0.4], 1.0), &["z = 0.4", "plane"])?;
    let twice = floating(hex, [Spring::between("s", a, b, 1.0), Spring::between("s", b, a, 1.0)]);
    assert!(twice.err().ok_or("one name twice")?.to_string().contains("\"s\""));
    let at = BodyPoint::At(a);
    assert!(floating(hex, [Spring::between("s", at, b, 1.0)]).is_ok());
    Ok(())
}
