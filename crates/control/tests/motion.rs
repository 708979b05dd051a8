//! The motion of a rigid surface as a control: derivatives by translation and rotation.

use nastic_control::{Compliance, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_ensemble::Ensemble;
use nastic_fem::{MovingSupport, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Optimizer, Taylor, Verdict};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::CATALOGUE as RISKS;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn bar(kind: CellKind, cells: [usize; 3]) -> Outcome<Solid> {
    bar_of(kind, cells, 1.0)
}

/// One that is so many times as stiff.
fn bar_of(kind: CellKind, cells: [usize; 3], stiffer: f64) -> Outcome<Solid> {
    Ok(Solid::new(box_mesh([2.0, 0.25, 0.25], cells, kind)?)?
        .material("body", NeoHooke::new(4e4 * stiffer, 6e4 * stiffer)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .motion(MovingSupport::of("grip", "x+").about([2.1, 0.0, 0.1]))?)
}

/// Tracked are the whole body, so that the cost depends on the held nodes too, and the upper face.
fn problem(kind: CellKind, cells: [usize; 3], rotation: bool) -> Outcome<Reduced> {
    problem_of(bar(kind, cells)?, rotation)
}

fn problem_of(solid: Solid, rotation: bool) -> Outcome<Reduced> {
    let wanted = Target::position(|x| [0.95 * x[0], x[1] + 0.1 * x[0], x[2] + 0.1 * x[0] * x[0]]);
    let flat = Target::position(|x| [x[0], x[1], x[2] + 0.05]);
    let problem = Reduced::new(solid)
        .control("grip.translation", Space::Uniform)?
        .control("fibre", Space::Region)?
        .cost(Tracking::region("body", wanted))?
        .cost(Tracking::surface("z+", flat))?;
    Ok(if rotation { problem.control("grip.rotation", Space::Uniform)? } else { problem })
}

const M: [f64; 7] = [-0.1, 0.15, 0.2, -400.0, 0.3, -0.4, 0.25];

fn around(m: &[f64]) -> Outcome<Bounds> {
    let shifted = |sign: f64| m.iter().map(|m| m + 0.5 * sign * m.abs()).collect::<Vec<_>>();
    Ok(Bounds::new(shifted(-1.0), shifted(1.0))?)
}

#[test]
fn derivatives_by_translation_and_rotation_are_exact() -> Outcome {
    for (kind, cells) in [(CellKind::Hex8, [6, 2, 2]), (CellKind::Tet10, [3, 1, 1])] {
        let problem = problem(kind, cells, true)?;
        let report = Taylor { directions: 3, ..Taylor::default() }.test(&problem, &around(&M)?, &M)?;
        assert_eq!(report.verdict(), Verdict::Right, "{kind}: {report}");
        for direction in &report.directions {
            assert!(direction.order1 > 1.95 && direction.order1 < 2.05, "{kind}: {direction}");
        }
        // of the rotation alone, and of the translation alone
        for components in [0..3, 4..7] {
            let taylor = Taylor { components: Some(components), ..Taylor::default() };
            let report = taylor.test(&problem, &around(&M)?, &M)?;
            assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{kind}: {report}");
        }
    }
    Ok(())
}

/// By the translation, also where the surface is turned; by the rotation they are refused with its name.
#[test]
fn second_derivatives_by_a_translation_are_exact() -> Outcome {
    let translated = problem(CellKind::Hex8, [6, 2, 2], false)?;
    let m = &M[..4];
    let report = Taylor { second: true, directions: 2, ..Taylor::default() }.test(&translated, &around(m)?, m)?;
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
    let turned = problem(CellKind::Hex8, [6, 2, 2], true)?;
    let refused = Taylor { second: true, ..Taylor::default() }.test(&turned, &around(&M)?, &M);
    let message = refused.err().ok_or("second derivatives by a rotation")?.to_string();
    assert!(message.contains("grip") && message.contains("rotation"), "{message}");
    Ok(())
}

/// What a bent risk and a fixed length take of the first derivatives at the values of the controls is there for held surfaces too.
#[test]
fn second_derivatives_by_a_translation_under_every_risk_and_of_a_length() -> Outcome {
    let m = &M[..4];
    for row in RISKS {
        let mut ensemble = Ensemble::new((row.make)());
        for (name, p, stiffer) in [("soft", 0.3, 0.8), ("stiff", 0.5, 1.3), ("middle", 0.2, 1.0)] {
            ensemble = ensemble.scenario(name, p, problem_of(bar_of(CellKind::Hex8, [6, 1, 1], stiffer)?, false)?);
        }
        let report = Taylor { second: true, directions: 2, ..Taylor::default() };
        let report = report.test(&ensemble.build()?, &around(m)?, m)?;
        assert_eq!(report.second_verdict(), Some(Verdict::Right), "{}: {report}", row.name);
    }
    let fixed = problem(CellKind::Hex8, [6, 1, 1], false)?.of_length("grip.translation", 0.2)?;
    let report = Taylor { second: true, directions: 2, ..Taylor::default() }.test(&fixed, &around(m)?, m)?;
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "of a length: {report}");
    Ok(())
}

/// Pushed far enough, a straight column is an equilibrium that gives way by itself: no compliance, rather than a negative one.
#[test]
fn a_column_behind_its_buckling_load_has_no_compliance() -> Outcome {
    let column = Solid::new(box_mesh([2.0, 0.1, 0.1], [20, 1, 1], CellKind::Hex20)?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .clamp("x-")?
        .motion(MovingSupport::of("grip", "x+"))?;
    let problem = Reduced::new(column)
        .control("grip.translation", Space::Uniform)?
        .cost(Compliance::surface("z+", [0.0, 0.0, 1.0]))?;
    assert!(problem.at(&[-0.01, 0.0, 0.0])?.cost() > problem.at(&[0.0; 3])?.cost(), "it softens");
    let refused = problem.at(&[-0.03, 0.0, 0.0]).err().ok_or("a compliance of an unstable column")?.to_string();
    assert!(refused.contains("unstable"), "{refused}");
    Ok(())
}

/// A turn by 90 is one in degrees.
#[test]
fn more_than_a_turn_is_refused() -> Outcome {
    let turned = problem(CellKind::Hex8, [3, 1, 1], true)?.at(&[0.0, 0.0, 0.0, 0.0, 0.0, 90.0, 0.0]);
    let refused = turned.err().ok_or("90 rad are taken")?.to_string();
    assert!(refused.contains("radians"), "{refused}");
    Ok(())
}

/// The motion that takes the end of the bar where it is wanted is found.
#[test]
fn a_motion_is_found() -> Outcome {
    let problem = problem(CellKind::Hex8, [6, 2, 2], true)?;
    let start = problem.at(&[0.0; 7])?.cost();
    let (lower, upper) = ([-0.5, -0.5, -0.5, -2e3, -1.0, -1.0, -1.0], [0.5, 0.5, 0.5, 1e3, 1.0, 1.0, 1.0]);
    let best = Lbfgs::default().within(Bounds::new(lower.to_vec(), upper.to_vec())?).minimize(&problem, 0.0)?;
    assert!(best.cost < 0.5 * start, "{} of {start} at {:?}", best.cost, best.m);
    Ok(())
}
