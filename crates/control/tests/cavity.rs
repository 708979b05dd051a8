//! The pressure of a cavity as a control.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_control::{
    Compliance, ControlError, ControlNorm, Evaluated, PumpWork, Reduced, ReducedWorkspace, Space, Target, Tracking,
};
use nastic_energy::FiberTension;
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{Foundation, Instant, Solid};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer, Problem, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// The cup of the catalogue, with the tension of its fibres.
fn cup() -> Outcome<Solid> {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "cavity").ok_or("no cavity in the catalogue")?;
    Ok((entry.example)()?)
}

fn problem() -> Outcome<Reduced> {
    let wider = Target::position(|x| [1.06 * x[0], x[1], x[2]]);
    Ok(Reduced::new(cup()?)
        .control("cavity", Space::Uniform)?
        .control("fibre", Space::Cell)?
        .cost(Tracking::surface("x+", wider))?
        .cost(ControlNorm::of("cavity", 1e-14)?)?)
}

#[test]
fn the_derivative_by_a_pressure_is_exact() -> Outcome {
    let problem = problem()?;
    let mut m = vec![-2e3; problem.layout().len()];
    m[0] = 8e3;
    let set = Bounds::new(-1e6, 1e6)?;
    let report = Taylor::default().test(&problem, &set, &m)?;
    assert_eq!(report.verdict(), Verdict::Right, "{report}");
    for direction in &report.directions {
        assert!(direction.order1 > 1.95 && direction.order1 < 2.05, "{direction}");
    }
    // by the pressure alone
    let alone = Reduced::new(cup()?).control("cavity", Space::Uniform)?.cost(ControlNorm::of("cavity", 1e-14)?)?;
    let wider = Target::position(|x| [1.06 * x[0], x[1], x[2]]);
    let report = Taylor::default().test(&alone.cost(Tracking::surface("x+", wider))?, &set, &[8e3])?;
    assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{report}");
    Ok(())
}

#[test]
fn a_pressure_is_found_beside_a_field() -> Outcome {
    let problem = problem()?;
    let best = Lbfgs::default().within(Bounds::new(-5e4, 5e4)?).minimize(&problem, 0.0)?;
    let start = problem.at(&vec![0.0; problem.layout().len()])?;
    assert!(best.cost < 1e-2 * start.cost(), "{} of {}", best.cost, start.cost());
    assert!(best.m[0] > 1e2, "the pressure stays at {}", best.m[0]);
    let snapshot = problem.snapshot(&best.point, None)?;
    assert!(snapshot.cell_array("fibre").is_some() && snapshot.cell_array("cavity").is_none());
    let product = problem.inner_product()?;
    let mut unit = vec![0.0; product.len()];
    unit[0] = 1.0;
    assert!((product.inner(&unit, &unit) - 1.2).abs() < 1e-12, "the weight of a pressure is the cavity's volume");
    assert!(problem.summary(&best.point).get("min_J").is_some_and(|j| j > 0.5));
    Ok(())
}

#[test]
fn a_pressure_is_one_number() -> Outcome {
    let error = Reduced::new(cup()?).control("cavity", Space::Cell).err().ok_or("a field of pressures")?;
    assert!(matches!(error, ControlError::OneNumber { .. }), "{error}");
    let error = Reduced::new(cup()?).control("air", Space::Uniform).err().ok_or("an unknown cavity")?.to_string();
    assert!(error.contains("cavity") && error.contains("fibre"), "{error}");
    let twice = cup()?.actuate("body", "cavity", FiberTension::along(Vec3::x())?);
    assert!(twice.is_err(), "two things of one name");
    Ok(())
}

/// `dW/dV = p`: the work of the pump, against the pressure that holds the volume; dead loads stay in the balance.
#[test]
fn the_work_of_a_pump_has_the_pressure_as_its_derivative() -> Outcome {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "cavity of a volume").ok_or("no cavity of a volume")?;
    let loaded = |solid: Solid| solid.traction("x+", Vec3::new(2e3, -1e3, 1e3));
    let solid = loaded((entry.example)()?)?;
    let problem = Reduced::new(solid).control(entry.name, Space::Uniform)?.cost(PumpWork::new(1.0)?)?;
    let pressure = |at: &Evaluated| -> Outcome<f64> {
        let model = problem.solid().model();
        let all = model.quantities(&Instant::new(&at.state().u, &at.state().controls, 1.0))?;
        Ok(all.iter().find(|(_, what, _)| *what == "pressure").ok_or("no pressure is reported")?.2)
    };
    let mut workspace = ReducedWorkspace::default();
    let mut sum = 0.0;
    let (from, to, steps) = (0.05, 0.25, 8);
    let at = |k: usize| from + (to - from) * k as f64 / steps as f64;
    for k in 0..=steps {
        let mut point = problem.at(&[at(k)])?;
        let (p, derivative) = (pressure(&point)?, problem.derivative(&mut point, &mut workspace)?[0]);
        assert!((derivative / p - 1.0).abs() < 1e-8, "dW/dV = {derivative} at p = {p}");
        // Simpson's rule for the work between two volumes
        let weight = if k == 0 || k == steps {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        };
        sum += weight / 3.0 * p * (to - from) / steps as f64;
    }
    let work = problem.at(&[to])?.cost() - problem.at(&[from])?.cost();
    assert!((work / sum - 1.0).abs() < 1e-5, "{work} instead of {sum}");
    Ok(())
}

/// What a foundation stores is not in the work of the body: refused rather than wrong.
#[test]
fn the_work_of_a_pump_beside_a_foundation_is_refused() -> Outcome {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "cavity of a volume").ok_or("no cavity of a volume")?;
    let bedded = (entry.example)()?.foundation(Foundation::on("x+", 1e5))?;
    let problem = Reduced::new(bedded).control(entry.name, Space::Uniform)?.cost(PumpWork::new(1.0)?)?;
    let refused = problem.at(&[0.1]).err().ok_or("the work beside a foundation is told")?.to_string();
    assert!(refused.contains("is not counted"), "{refused}");
    Ok(())
}

/// The compliance of a body whose cavity keeps its volume: the bordered tangent, less than under the pressure that is there.
#[test]
fn a_compliance_keeps_the_volume() -> Outcome {
    let mut found = Vec::new();
    for (name, value) in [("cavity of a volume", 0.1), ("cavity", 0.0)] {
        let entry = CATALOGUE.iter().find(|entry| entry.name == name).ok_or("no such cavity")?;
        let problem = Reduced::new((entry.example)()?)
            .control(name, Space::Uniform)?
            .control("fibre", Space::Cell)?
            .cost(Compliance::surface("x+", [1.0, 0.2, 0.1]))?;
        let mut m = vec![-2e3; problem.layout().len()];
        m[0] = value;
        if value == 0.0 {
            m[0] = found.pop().ok_or("no pressure")?;
        }
        let point = problem.at(&m)?;
        let near = |sign: f64| m.iter().map(|m| m + 0.5 * sign * m.abs()).collect::<Vec<_>>();
        let report = Taylor::default().test(&problem, &Bounds::new(near(-1.0), near(1.0))?, &m)?;
        assert_eq!(report.verdict(), Verdict::Right, "{name}: {report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{name}: {report}");
        found.push(point.cost());
        found.push(point.state().u.last().copied().ok_or("no pressure")?);
    }
    let [by_volume, by_pressure] = [found[0], found[1]];
    assert!(by_volume < by_pressure, "{by_volume} at a fixed volume, {by_pressure} at a fixed pressure");
    Ok(())
}
