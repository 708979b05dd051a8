//! Tension and pull of tendons as controls: Taylor tests of first and second derivatives, and a bound that is met.

use nastic_control::{Compliance, Reduced, ReducedWorkspace, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Solid, Tendon};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar with a tendon in its upper half and an antagonist in its lower one, and fibres.
fn bar(kind: CellKind, cells: [usize; 3], drive: fn(Tendon) -> Tendon) -> Outcome<Solid> {
    let way = |name: &str, z: f64| {
        drive(Tendon::through(name, [[0.0, 0.13, z], [0.9, 0.12, z], [2.0, 0.14, z]]).spacing(0.25))
    };
    Ok(Solid::new(box_mesh([2.0, 0.25, 0.25], cells, kind)?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .tendon(way("upper", 0.21))?
        .tendon(way("lower", 0.04))?
        .clamp("x-")?)
}

/// By its tension.
fn forced(tendon: Tendon) -> Tendon {
    tendon
}

/// By the pull of an elastic one.
fn elastic(tendon: Tendon) -> Tendon {
    tendon.stiffness(2e3)
}

fn problem(solid: Solid) -> Outcome<Reduced> {
    let wanted = Target::position(|x| [x[0] - 0.1, x[1], x[2] + 0.2 * x[0]]);
    Ok(Reduced::new(solid)
        .control("upper", Space::Uniform)?
        .control("lower", Space::Uniform)?
        .control("fibre", Space::Region)?
        .cost(Tracking::surface("x+", wanted))?)
}

#[test]
fn derivatives_by_tension_and_pull_are_exact() -> Outcome {
    // both tendons taut, the lower one as an antagonist; of those that do not stretch the lower one slack, too
    let rigid: fn(Tendon) -> Tendon = Tendon::inextensible;
    let drives = [
        ("tension", forced as fn(Tendon) -> Tendon, [60.0, 15.0]),
        ("elastic", elastic, [0.06, 0.03]),
        ("inextensible", rigid, [0.06, 0.03]),
        ("inextensible, one slack", rigid, [0.06, -0.2]),
    ];
    for (kind, cells) in [(CellKind::Hex8, [6, 2, 2]), (CellKind::Tet10, [3, 1, 1])] {
        for (what, drive, values) in drives {
            let problem = problem(bar(kind, cells, drive)?)?;
            let m = [values[0], values[1], -500.0];
            let around = |share: f64| m.iter().map(|m: &f64| m + share * m.abs()).collect::<Vec<f64>>();
            let set = Bounds::new(around(-0.5), around(0.5))?;
            let report = Taylor { directions: 3, second: true, ..Taylor::default() }.test(&problem, &set, &m)?;
            assert_eq!(report.verdict(), Verdict::Right, "{kind}, {what}: {report}");
            for direction in &report.directions {
                assert!(direction.order1 > 1.95 && direction.order1 < 2.05, "{kind}, {what}: {direction}");
            }
            assert_eq!(report.second_verdict(), Some(Verdict::Right), "{kind}, {what}: {report}");
            let orders: Vec<f64> =
                report.directions.iter().filter_map(|d| d.second.as_ref()).map(|second| second.order).collect();
            println!("{kind}, {what}: second orders {orders:.3?}");
            assert!(orders.len() == 3 && orders.iter().all(|order| *order > 2.9), "{kind}, {what}: {orders:?}");
        }
    }
    Ok(())
}

/// A taut cable that cannot stretch stiffens the bar, a slack one does not; derivatives of the compliance are exact.
#[test]
fn a_taut_tendon_stiffens_the_bar() -> Outcome {
    let compliance = |pulls: [f64; 2]| -> Outcome<f64> {
        let problem = Reduced::new(bar(CellKind::Hex8, [6, 2, 2], Tendon::inextensible)?)
            .control("upper", Space::Uniform)?
            .control("lower", Space::Uniform)?
            .cost(Compliance::surface("x+", [0.0, 0.0, 1.0]))?;
        let mut point = problem.at(&pulls)?;
        let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
        for (slope, pull) in derivative.iter().zip(pulls) {
            assert_eq!(*slope == 0.0, pull < 0.0, "{pulls:?}: {derivative:?}");
        }
        if pulls[0] > 0.0 {
            let report = Taylor::default().test(&problem, &Bounds::new(-0.5, 0.5)?, &pulls)?;
            assert_eq!(report.verdict(), Verdict::Right, "{pulls:?}: {report}");
            assert!(report.directions.iter().all(|d| d.order1 > 1.95 && d.order1 < 2.05), "{pulls:?}: {report}");
        }
        Ok(point.cost())
    };
    let [slack, one, both] = [[-0.3, -0.2], [0.03, -0.2], [0.03, 0.02]].map(compliance);
    let (slack, one, both) = (slack?, one?, both?);
    println!("compliance {slack:.4e}, {one:.4e}, {both:.4e}");
    assert!(one < 0.9 * slack && both < 0.9 * one, "{slack:e} {one:e} {both:e}");
    Ok(())
}

/// A tendon at rest is about to pull: the derivative by its pull is there, so that an optimiser may begin at zero. Of one that does not
/// stretch that of the taut cable, which a slack one does not have.
#[test]
fn a_tendon_at_rest_can_be_drawn_in() -> Outcome {
    for (drive, pull) in
        [(elastic as fn(Tendon) -> Tendon, 0.0), (Tendon::inextensible, 0.0), (Tendon::inextensible, -1e-6)]
    {
        let problem = problem(bar(CellKind::Hex8, [3, 1, 1], drive)?)?;
        let mut point = problem.at(&[pull, pull, 0.0])?;
        let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
        match pull < 0.0 {
            true => assert!(derivative[..2] == [0.0, 0.0] && derivative[2] != 0.0, "{derivative:?}"),
            false => assert!(derivative[0] < 0.0 && derivative[1] != 0.0, "{derivative:?}"),
        }
    }
    Ok(())
}

/// A tendon cannot push: the tension of the one on the wrong side stays at zero.
#[test]
fn the_antagonist_that_would_push_stays_at_zero() -> Outcome {
    let wanted = Target::position(|x| [x[0], x[1], x[2] + 0.3]);
    let problem = Reduced::new(bar(CellKind::Hex8, [6, 2, 2], forced)?)
        .control("upper", Space::Uniform)?
        .control("lower", Space::Uniform)?
        .cost(Tracking::surface("x+", wanted))?;
    let start = problem.at(&[0.0, 0.0])?.cost();
    let best = Lbfgs::default().within(Bounds::new(0.0, 400.0)?).minimize(&problem, 1.0)?;
    assert!(best.m[1] == 0.0 && best.m[0] > 20.0 && best.cost < 0.2 * start, "{:?}: {} of {start}", best.m, best.cost);
    Ok(())
}
