//! Tendons that cannot stretch: the pull as a constraint with the tension as its multiplier, slackness, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, noise, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Instant, Solid, SolveOptions, Spring, State, StateError, Tendon, Workspace, check_contribution};
use nastic_linear::{LinearError, Solver};
use nastic_mesh::{CellKind, rectangle};
use nastic_numeric::vector::{norm, sub};
use nastic_tensor::Vec3;

const LENGTH: f64 = 2.0;
const YOUNG: f64 = 1e5;

/// The four edges of a bar, in order of y, then z.
const EDGES: [(&str, [f64; 2]); 4] =
    [("a", [0.05, 0.05]), ("b", [0.05, 0.45]), ("c", [0.45, 0.05]), ("d", [0.45, 0.45])];

fn way(name: &str, [y, z]: [f64; 2]) -> Tendon {
    Tendon::through(name, [[0.0, y, z], [1.0, y + 0.02, z - 0.01], [LENGTH, y, z]]).spacing(0.25)
}

/// A clamped bar with these tendons.
fn bar(kind: CellKind, tendons: impl IntoIterator<Item = Tendon>) -> Outcome<Solid> {
    let body = Solid::new(regular(kind, [LENGTH, 0.5, 0.5], [6, 2, 2])?)?
        .material("body", NeoHooke::new(0.4 * YOUNG, 0.5 * YOUNG)?)?
        .clamp("x-")?;
    Ok(tendons.into_iter().try_fold(body, Solid::tendon)?)
}

fn solve_from(solid: &Solid, values: &[f64], near: Option<&State>) -> Result<State, StateError> {
    let mut controls = solid.controls();
    values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k).fill(*value));
    solid.solve(&controls, &SolveOptions { near, ..STRICT })
}

fn solve(solid: &Solid, values: &[f64]) -> Result<State, StateError> {
    solve_from(solid, values, None)
}

/// Tension, length, length at rest, 1 where it is slack, and pull of a tendon.
fn message(solid: &Solid, state: &State, name: &str) -> Outcome<[f64; 5]> {
    let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
    let of = |what: &str| all.iter().find(|(own, quantity, _)| own == name && *quantity == what).map(|found| found.2);
    let found = ["tension", "length", "reference_length", "slack", "pull"].map(of);
    found.iter().all(Option::is_some).then(|| found.map(Option::unwrap)).ok_or_else(|| "quantities are missing".into())
}

/// Tension, and `(L0 - s - L) / L0`.
fn complement(solid: &Solid, state: &State, name: &str) -> Outcome<(f64, f64)> {
    let [tension, length, rest, _, pull] = message(solid, state, name)?;
    Ok((tension, (rest - pull - length) / rest))
}

fn apart(a: &Solid, u: &State, b: &Solid, v: &State) -> f64 {
    let (u, v) = (a.model().nodal(&u.u), b.model().nodal(&v.u));
    norm(&sub(u, v)) / norm(v)
}

/// The contract at tensions of both signs, and the lines that are drawn.
#[test]
fn it_keeps_the_contract_on_every_cell() -> Outcome {
    for kind in common::kinds() {
        let plane = kind.dim() == 2;
        let guides = [[0.0, 0.31, 0.2], [1.0, 0.33, 0.17], [2.0, 0.3, 0.21]];
        let guides = guides.map(|x| if plane { [x[0], x[1], 0.0] } else { x });
        let solid = bar(kind, [Tendon::through("cable", guides).spacing(0.7).inextensible()])?;
        (0..6).try_for_each(|seed| check_contribution(solid.model(), "cable", seed))?;
        let (mut state, tension) = (solid.rest(), 7.5);
        let mut u = state.u.to_vec();
        *u.last_mut().ok_or("no unknowns")? = tension;
        state.u = u.into();
        let lines = solid.model().lines(&Instant::new(&state.u, &state.controls, 1.0))?;
        assert_eq!((lines.len(), lines[0].quantities[0].clone()), (1, ("tension".to_owned(), tension)), "{kind}");
    }
    Ok(())
}

/// The tension found, given as a control, makes the same state; the length is the one asked for.
#[test]
fn pull_and_tension_find_the_same_state() -> Outcome {
    for (kind, pull) in [(CellKind::Hex8, 0.1), (CellKind::Tet10, 0.1), (CellKind::Hex20, 0.3), (CellKind::Quad9, 0.2)]
    {
        let edge = if kind.dim() == 2 { [0.05, 0.01] } else { EDGES[1].1 };
        let way = || match kind.dim() {
            2 => Tendon::through("cable", [[0.0, 0.05, 0.0], [LENGTH, 0.05, 0.0]]).spacing(0.25),
            _ => way("cable", edge),
        };
        let (pulled, forced) = (bar(kind, [way().inextensible()])?, bar(kind, [way()])?);
        let state = solve(&pulled, &[pull])?;
        let (tension, gap) = complement(&pulled, &state, "cable")?;
        assert!(tension > 100.0 && gap.abs() < 1e-12, "{kind}: tension {tension}, gap {gap:e}");
        let same = solve(&forced, &[tension])?;
        let apart = apart(&pulled, &state, &forced, &same);
        println!("{kind}: T {tension:.3}, gap {gap:.1e}, apart {apart:.1e}, {} Newton", state.report.newton);
        assert!(largest(&same.u) > pull && apart < 1e-9, "{kind}: {apart:e}");
        assert_eq!(pulled.negative_pivots(&state)?, 0);
    }
    Ok(())
}

/// Let out it has no part: the rest and the state under a load are those of the body without it.
#[test]
fn a_slack_tendon_carries_no_force() -> Outcome {
    let load = |solid: Solid| solid.traction("x+", Vec3::new(0.0, 0.0, -600.0));
    let (with, without) =
        (load(bar(CellKind::Hex8, [way("b", EDGES[0].1).inextensible()])?)?, bar(CellKind::Hex8, [])?);
    let (without, at_rest) = (load(without)?, bar(CellKind::Hex8, [way("b", EDGES[0].1).inextensible()])?);
    let rest = solve(&at_rest, &[-1e-3])?;
    assert!(rest.u.iter().all(|u| *u == 0.0) && message(&at_rest, &rest, "b")?[3] == 1.0);
    // below the axis of a bar that bends down it becomes shorter
    let (slack, alone) = (solve(&with, &[0.0])?, without.solve(&without.controls(), &STRICT)?);
    let (tension, gap) = complement(&with, &slack, "b")?;
    assert!(tension == 0.0 && gap > 1e-3 && message(&with, &slack, "b")?[3] == 1.0, "{tension}, {gap:e}");
    let difference = apart(&with, &slack, &without, &alone);
    assert!(largest(&alone.u) > 0.01 && difference < 1e-12, "{difference:e}");
    // above it, it would be stretched: it holds the bar up
    let held = load(bar(CellKind::Hex8, [way("b", EDGES[1].1).inextensible()])?)?;
    let state = solve(&held, &[0.0])?;
    let (tension, gap) = complement(&held, &state, "b")?;
    let share = largest(held.model().nodal(&state.u)) / largest(&alone.u);
    assert!(tension > 1.0 && gap.abs() < 1e-12 && share < 0.8, "{tension}, {gap:e}, {share}");
    Ok(())
}

/// A guess in which a tendon that is let out pushes, in equilibrium: it is no answer.
#[test]
fn a_tendon_that_pushes_is_no_state() -> Outcome {
    let ends = [[0.5, 0.25, 0.25], [1.5, 0.25, 0.25]];
    let spread = bar(CellKind::Hex8, [])?.spring(Spring::between("spring", ends[0], ends[1], 2e3).rest_length(1.2))?;
    let apart = spread.solve(&spread.controls(), &STRICT)?;
    let all = spread.model().quantities(&Instant::new(&apart.u, &apart.controls, 1.0))?;
    let force = all.iter().find(|(_, what, _)| *what == "force").ok_or("no force of the spring")?.2;
    let solid = bar(CellKind::Hex8, [Tendon::through("cable", ends).inextensible()])?;
    let guess: Vec<f64> = apart.u.iter().copied().chain([force]).collect();
    let mut controls = solid.controls();
    controls.values_mut(0).fill(-0.5);
    let state = solid.solve(&controls, &SolveOptions { guess: Some(&guess), ..STRICT })?;
    assert!(force < -50.0 && largest(&apart.u) > 1e-3, "{force}");
    assert!(largest(&state.u) < 1e-9 && complement(&solid, &state, "cable")?.0 == 0.0, "{:e}", largest(&state.u));
    Ok(())
}

/// One of two is pulled: the other is slack where it is let out, resists where it is not, and pulls back when it is pulled more.
#[test]
fn antagonists_have_states_of_their_own() -> Outcome {
    let pair = || [way("lower", EDGES[2].1).inextensible(), way("upper", EDGES[1].1).inextensible()];
    let both = bar(CellKind::Hex8, pair())?;
    let upper = bar(CellKind::Hex8, [way("upper", EDGES[1].1).inextensible()])?;
    let up = solve(&both, &[-0.5, 0.1])?;
    let alone = solve(&upper, &[0.1])?;
    let difference = apart(&both, &up, &upper, &alone);
    assert!(complement(&both, &up, "lower")?.0 == 0.0 && difference < 1e-12, "{difference:e}");
    let held = solve(&both, &[0.0, 0.1])?;
    let [lower, stiff] = ["lower", "upper"].map(|name| complement(&both, &held, name).unwrap());
    assert!(lower.0 > 1.0 && lower.1.abs() < 1e-12 && stiff.1.abs() < 1e-12, "{lower:?} {stiff:?}");
    let free = complement(&both, &up, "upper")?.0;
    assert!(stiff.0 > 1.1 * free, "the antagonist does not stiffen the bar: {} after {free}", stiff.0);
    // from one side to the other and back, each from the state before: the same states
    let mut last = up.clone();
    for values in [[0.1, 0.1], [0.1, -0.5], [0.1, 0.05], [-0.5, 0.1]] {
        last = solve_from(&both, &values, Some(&last))?;
        let cold = solve(&both, &values)?;
        assert!(apart(&both, &last, &both, &cold) < 1e-9, "{values:?}: {:e}", apart(&both, &last, &both, &cold));
        assert_eq!(last.report.restarts, 0);
    }
    assert!(apart(&both, &last, &both, &up) < 1e-9);
    Ok(())
}

/// An elastic tendon of stiffness k differs from one that cannot stretch by T/k in its length: the error falls as 1/k.
#[test]
fn elastic_tendons_converge_to_it() -> Outcome {
    let rigid = bar(CellKind::Hex8, [way("cable", EDGES[1].1).inextensible()])?;
    let limit = solve(&rigid, &[0.1])?;
    let errors = [1e7, 1e8, 1e9].map(|k| -> Outcome<f64> {
        let elastic = bar(CellKind::Hex8, [way("cable", EDGES[1].1).stiffness(k)])?;
        Ok(apart(&elastic, &solve(&elastic, &[0.1])?, &rigid, &limit))
    });
    let [soft, middle, stiff] = errors.map(|error| error.unwrap_or(f64::NAN));
    println!("errors {soft:.4e} {middle:.4e} {stiff:.4e}");
    assert!((soft / middle / 10.0 - 1.0).abs() < 0.02 && (middle / stiff / 10.0 - 1.0).abs() < 0.02);
    assert!(stiff < 1e-4);
    Ok(())
}

/// A slender strip: kappa = T d / (E I) and s = L T (1 / (E A) + d^2 / (E I)), by geometry and the two stiffnesses of a beam.
#[test]
fn a_pull_bends_a_slender_strip_to_an_arc() -> Outcome {
    let (length, offset, second_moment) = (20.0, 0.4, 1.0 / 12.0);
    let mesh = rectangle([length, 1.0], [40, 2], CellKind::Quad9)?;
    let tendon = [[0.0, 0.5 - offset, 0.0], [length, 0.5 - offset, 0.0]];
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(0.5 * YOUNG, 0.0)?)?
        .clamp("x-")?
        .tendon(Tendon::through("cable", tendon).spacing(length / 40.0).inextensible())?;
    let kappa = 0.008 / length;
    let expected = kappa * YOUNG * second_moment / offset;
    let pull = length * expected / YOUNG * (1.0 + offset * offset / second_moment);
    let state = solve(&solid, &[pull])?;
    let (tension, gap) = complement(&solid, &state, "cable")?;
    let turned = |x: f64| -> Outcome<f64> {
        let at = |y: f64| -> Outcome<[f64; 2]> {
            let node = common::node_at(solid.mesh(), [x, y, 0.0]).ok_or("no node there")?;
            Ok([x + state.u[2 * node], y + state.u[2 * node + 1]])
        };
        let (low, high) = (at(0.0)?, at(1.0)?);
        Ok((low[0] - high[0]).atan2(high[1] - low[1]))
    };
    let found = (turned(0.75 * length)? - turned(0.25 * length)?) / (0.5 * length);
    println!("kappa {:.3e}, tension {:.3e} off, gap {gap:.1e}", found / -kappa - 1.0, tension / expected - 1.0);
    // the clamped and the loaded end are a few thicknesses long
    assert!((tension / expected - 1.0).abs() < 2e-2 && gap.abs() < 1e-12, "{tension} instead of {expected}");
    let of_tension = tension * offset / (YOUNG * second_moment);
    assert!((found / -of_tension - 1.0).abs() < 2e-3, "{found:e} instead of {of_tension:e}");
    Ok(())
}

/// Four tendons, pulled and let out at random under a load: T >= 0, L0 - s - L >= 0, and one of them zero.
#[test]
fn four_tendons_share_a_load() -> Outcome {
    let tendons = EDGES.map(|(name, place)| way(name, place).inextensible());
    let solid = bar(CellKind::Hex8, tendons)?.traction("x+", Vec3::new(0.0, 300.0, -400.0))?;
    let (mut taut, mut last) = (0, None);
    for case in 0..12 {
        let values: [f64; 4] = std::array::from_fn(|k| 0.08 * noise(17 * case + 5 * k) + 0.01);
        let state = solve(&solid, &values)?;
        for (name, _) in EDGES {
            let (tension, gap) = complement(&solid, &state, name)?;
            assert!(tension >= 0.0 && gap > -1e-12 && (tension == 0.0 || gap < 1e-12), "{name}: {tension}, {gap:e}");
            taut += usize::from(tension > 0.0);
        }
        assert_eq!(solid.negative_pivots(&state)?, 0, "{values:?}");
        let warm = solve_from(&solid, &values, last.as_ref())?;
        assert!(apart(&solid, &warm, &solid, &state) < 1e-9);
        println!("case {case}: {} and {} Newton", state.report.newton, warm.report.newton);
        last = Some(state);
    }
    assert!((12..40).contains(&taut), "{taut} of 48 are taut");
    Ok(())
}

/// Multigrid solves the same, and surfaces that are moved in the same step go with it.
#[test]
fn other_solvers_and_moved_surfaces_go_with_it() -> Outcome {
    let tendons = || EDGES.map(|(name, place)| way(name, place).inextensible());
    let solid = bar(CellKind::Hex8, tendons())?;
    let values = [0.05, 0.1, -0.3, 0.02];
    let mut controls = solid.controls();
    values.iter().enumerate().for_each(|(k, value)| controls.values_mut(k).fill(*value));
    let direct = solid.solve(&controls, &STRICT)?;
    let multigrid = solid.solve(&controls, &SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT })?;
    assert!(apart(&solid, &multigrid, &solid, &direct) < 1e-9);
    for (name, _) in EDGES {
        let [(a, gap), (b, _)] = [&multigrid, &direct].map(|state| complement(&solid, state, name).unwrap());
        assert!((a - b).abs() <= 1e-7 * b && (a == 0.0 || gap.abs() < 1e-12), "{name}: {a} and {b}, {gap:e}");
    }
    // its end is drawn out and shifted: some would have to stretch, which holds it back
    let moved = solid.displace("x+", [None, Some(0.3), Some(0.0)])?;
    let state = solve(&moved, &[0.0, 0.0, -0.3, -0.3])?;
    let all = ["a", "b"].map(|name| complement(&moved, &state, name).unwrap());
    assert!(all.iter().all(|(tension, gap)| *tension > 1.0 && gap.abs() < 1e-12), "{all:?}");
    let node = common::node_at(moved.mesh(), [LENGTH, 0.25, 0.25]).ok_or("no node there")?;
    assert!((state.u[3 * node + 1] - 0.3).abs() < 1e-15);
    Ok(())
}

/// A column that is drawn together between its ends buckles; the tendon that does it and one that is slack beside it count as
/// no direction of their own.
#[test]
fn slack_tendons_do_not_count_in_the_inertia() -> Outcome {
    let column = |tendons: Vec<Tendon>| -> Outcome<Solid> {
        let body = Solid::new(rectangle([20.0, 1.0], [20, 2], CellKind::Quad9)?)?
            .material("body", NeoHooke::new(0.5 * YOUNG, 0.0)?)?
            .clamp("x-")?;
        Ok(tendons.into_iter().try_fold(body, Solid::tendon)?)
    };
    let axis = || Tendon::through("axis", [[0.0, 0.5, 0.0], [20.0, 0.5, 0.0]]);
    let side = || Tendon::through("side", [[0.0, 0.9, 0.0], [20.0, 0.9, 0.0]]).inextensible();
    let critical = std::f64::consts::PI.powi(2) * YOUNG / 12.0 / 400.0;
    for (share, negative) in [(0.5, 0), (2.0, 1)] {
        let pull = share * critical / YOUNG * 20.0;
        let alone = column(vec![axis().inextensible()])?;
        let state = solve(&alone, &[pull])?;
        let (tension, _) = complement(&alone, &state, "axis")?;
        assert!((tension / critical / share - 1.0).abs() < 0.1, "{tension} of {critical}");
        let forced = column(vec![axis()])?;
        let same = solve(&forced, &[tension])?;
        assert!(apart(&alone, &state, &forced, &same) < 1e-8);
        let both = column(vec![axis().inextensible(), side()])?;
        let beside = solve(&both, &[pull, -1.0])?;
        assert!(message(&both, &beside, "side")?[3] == 1.0 && apart(&both, &beside, &alone, &state) < 1e-10);
        let counts = [(&alone, &state), (&forced, &same), (&both, &beside)].map(|(s, at)| s.negative_pivots(at));
        assert!(counts.iter().all(|count| matches!(count, Ok(n) if *n == negative)), "{share}: {counts:?}");
    }
    Ok(())
}

/// A ramp from a tendon that is let out to one that is drawn in: nothing happens until it is taut, and nothing is critical.
#[test]
fn a_ramp_passes_the_onset() -> Outcome {
    let solid = bar(CellKind::Hex8, [way("cable", EDGES[1].1).inextensible()])?;
    let at = |pull: f64| {
        let mut controls = solid.controls();
        controls.values_mut(0)[0] = pull;
        controls
    };
    let ends = (&at(-0.1), &at(0.2));
    let ramp = solid.model().stability().ramp(ends.0, ends.1, 7, &STRICT, &mut Workspace::default(), &mut |_| ())?;
    assert!(ramp.points.len() == 7 && ramp.critical.is_empty() && ramp.failure.is_none(), "{:?}", ramp.failure);
    let mut before = 0.0;
    for point in &ramp.points {
        let (tension, gap) = complement(&solid, &point.state, "cable")?;
        let pull = -0.1 + 0.3 * point.s;
        if pull < 1e-9 {
            assert!(tension == 0.0 && point.state.u.iter().all(|u| *u == 0.0), "{pull}: {tension}");
        } else {
            assert!(tension > before && gap.abs() < 1e-12, "{pull}: {tension} after {before}, {gap:e}");
        }
        assert_eq!(point.negative, Some(0));
        before = tension;
    }
    Ok(())
}

/// `j = c . (u, T)` along a change of the pulls: the adjoint against Taylor's formula, with one taut, one slack; the slack one has no part.
#[test]
fn the_derivative_by_the_pull_is_that_of_the_solutions() -> Outcome {
    for (kind, cases) in [(CellKind::Hex8, [[-0.4, 0.1], [0.05, 0.1]]), (CellKind::Tet10, [[-0.4, 0.1], [0.05, 0.1]])] {
        let solid = bar(kind, [way("lower", EDGES[2].1).inextensible(), way("upper", EDGES[1].1).inextensible()])?;
        for at in cases {
            let state = solve(&solid, &at)?;
            let mut cost: Vec<f64> = (0..state.u.len()).map(noise).collect();
            solid.supports().clear(&mut cost);
            let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
            let lambda = solid.adjoint(&state, &[&minus], &STRICT)?.lambda.remove(0);
            let slopes = solid.model().vjp(&Instant::new(&state.u, &state.controls, 1.0), &lambda)?.controls;
            assert_eq!(slopes.values(0)[0] == 0.0, at[0] < 0.0, "{kind}: {slopes:?}");
            let value = |m: [f64; 2]| -> Outcome<f64> {
                let u = solve_from(&solid, &m, Some(&state))?.u;
                Ok(u.iter().zip(&cost).map(|(u, c)| u * c).sum())
            };
            let direction = [0.7, -1.0];
            let slope = direction[0] * slopes.values(0)[0] + direction[1] * slopes.values(1)[0];
            let base = value(at)?;
            let remainder = |t: f64| -> Outcome<f64> {
                Ok((value([at[0] + t * direction[0], at[1] + t * direction[1]])? - base - t * slope).abs())
            };
            let order = (remainder(4e-3)? / remainder(1e-3)?).log2() / 2.0;
            println!("{kind} at {at:?}: Taylor order {order:.4}, slope {slope:.4}");
            assert!(order > 1.95 && order < 2.05, "{kind} at {at:?}: Taylor order {order}");
        }
    }
    Ok(())
}

/// Two along one way: the one that is pulled more is taut. Pulled alike, their tensions are not determined.
#[test]
fn tendons_along_one_way_depend_on_each_other() -> Outcome {
    let twice = bar(CellKind::Hex8, ["one", "two"].map(|name| way(name, EDGES[1].1).inextensible()))?;
    let single = bar(CellKind::Hex8, [way("one", EDGES[1].1).inextensible()])?;
    let state = solve(&twice, &[0.05, 0.1])?;
    let [one, two] = ["one", "two"].map(|name| complement(&twice, &state, name).unwrap());
    assert!(one.0 == 0.0 && (one.1 * message(&twice, &state, "one")?[2] - 0.05).abs() < 1e-12 && two.0 > 1.0);
    assert!(apart(&twice, &state, &single, &solve(&single, &[0.1])?) < 1e-10);
    let refused = solve(&twice, &[0.1, 0.1]).err().ok_or("tensions that are not determined")?;
    assert!(matches!(refused, StateError::Linear(LinearError::Border { .. })), "{refused:?}");
    // a tendon over the whole length, and two over its halves
    let place = EDGES[1].1;
    let piece = |name: &str, from: f64, to: f64| {
        Tendon::through(name, [[from, place[0], place[1]], [to, place[0], place[1]]]).spacing(0.25).inextensible()
    };
    let pieces = bar(CellKind::Hex8, [piece("whole", 0.0, 2.0), piece("root", 0.0, 1.0), piece("end", 1.0, 2.0)])?;
    let state = solve(&pieces, &[0.05, 0.05, 0.05])?;
    let tensions = ["whole", "root", "end"].map(|name| complement(&pieces, &state, name).unwrap().0);
    assert!(tensions[0] == 0.0 && tensions[1] > 1.0 && tensions[2] > 1.0, "{tensions:?}");
    let refused = solve(&pieces, &[0.1, 0.05, 0.05]).err().ok_or("tensions that are not determined")?;
    assert!(matches!(refused, StateError::Linear(LinearError::Border { .. })), "{refused:?}");
    Ok(())
}

#[test]
fn what_it_cannot_do_is_refused() -> Outcome {
    let cable = || way("cable", EDGES[1].1).inextensible();
    let error = bar(CellKind::Hex8, [cable().stiffness(10.0)]).err().ok_or("it stretches")?.to_string();
    assert!(error.contains("cannot stretch") && error.contains("stiffness of 10"), "{error}");
    let solid = bar(CellKind::Hex8, [cable()])?;
    let error = solve(&solid, &[2.1]).err().ok_or("no cable is left")?.to_string();
    assert!(error.contains("\"cable\"") && error.contains("leaves none of its length"), "{error}");
    let held = Tendon::through("cable", [[0.0, 0.1, 0.1], [0.0, 0.4, 0.4]]).inextensible();
    let error = bar(CellKind::Hex8, [held])?.check().err().ok_or("its length cannot change")?.to_string();
    assert!(error.contains("the supports hold all") && error.contains("control its tension"), "{error}");
    Ok(())
}
