//! Tension and pull of tendons as controls: Taylor tests of first and second derivatives, and a bound that is met.

use nastic_control::{Reduced, ReducedWorkspace, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Solid, Tendon};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar with a tendon in its upper half and an antagonist in its lower one, and fibres.
fn bar(kind: CellKind, cells: [usize; 3], stiffness: Option<f64>) -> Outcome<Solid> {
    let way = |name: &str, z: f64| {
        let tendon = Tendon::through(name, [[0.0, 0.13, z], [0.9, 0.12, z], [2.0, 0.14, z]]).spacing(0.25);
        stiffness.map_or(tendon.clone(), |k| tendon.stiffness(k))
    };
    Ok(Solid::new(box_mesh([2.0, 0.25, 0.25], cells, kind)?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .tendon(way("upper", 0.21))?
        .tendon(way("lower", 0.04))?
        .clamp("x-")?)
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
    // both tendons taut, the lower one as an antagonist
    let drives = [(None, [60.0, 15.0]), (Some(2e3), [0.06, 0.03])];
    for (kind, cells) in [(CellKind::Hex8, [6, 2, 2]), (CellKind::Tet10, [3, 1, 1])] {
        for (stiffness, values) in drives {
            let problem = problem(bar(kind, cells, stiffness)?)?;
            let m = [values[0], values[1], -500.0];
            let lower = [0.5 * m[0], 0.5 * m[1], 1.5 * m[2]].to_vec();
            let upper = [1.5 * m[0], 1.5 * m[1], 0.5 * m[2]].to_vec();
            let set = Bounds::new(lower, upper)?;
            let report = Taylor { directions: 3, second: true, ..Taylor::default() }.test(&problem, &set, &m)?;
            assert_eq!(report.verdict(), Verdict::Right, "{kind}, stiffness {stiffness:?}: {report}");
            for direction in &report.directions {
                assert!(direction.order1 > 1.95 && direction.order1 < 2.05, "{kind}, {stiffness:?}: {direction}");
            }
            assert_eq!(report.second_verdict(), Some(Verdict::Right), "{kind}, stiffness {stiffness:?}: {report}");
            let orders = report.directions.iter().filter_map(|d| d.second.as_ref()).map(|second| second.order);
            assert!(orders.clone().all(|order| order > 2.9), "{:?}", orders.collect::<Vec<_>>());
        }
    }
    Ok(())
}

/// An elastic tendon at rest is about to pull: the derivative by its pull is there, so that an optimiser may begin at zero.
#[test]
fn a_tendon_at_rest_can_be_drawn_in() -> Outcome {
    let problem = problem(bar(CellKind::Hex8, [3, 1, 1], Some(2e3))?)?;
    let mut point = problem.at(&[0.0; 3])?;
    let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
    assert!(derivative[0] < 0.0 && derivative[1] != 0.0, "{derivative:?}");
    Ok(())
}

/// A tendon cannot push: the tension of the one on the wrong side stays at zero.
#[test]
fn the_antagonist_that_would_push_stays_at_zero() -> Outcome {
    let wanted = Target::position(|x| [x[0], x[1], x[2] + 0.3]);
    let problem = Reduced::new(bar(CellKind::Hex8, [6, 2, 2], None)?)
        .control("upper", Space::Uniform)?
        .control("lower", Space::Uniform)?
        .cost(Tracking::surface("x+", wanted))?;
    let start = problem.at(&[0.0, 0.0])?.cost();
    let best = Lbfgs::default().within(Bounds::new(0.0, 400.0)?).minimize(&problem, 1.0)?;
    assert!(best.m[1] == 0.0 && best.m[0] > 20.0 && best.cost < 0.2 * start, "{:?}: {} of {start}", best.m, best.cost);
    Ok(())
}
