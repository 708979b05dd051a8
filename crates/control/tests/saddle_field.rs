//! Optimal control of a soft dielectric: a voltage beside a fibre tension and the pressure of a chamber, with an electrode that floats.

#[path = "../../fem/tests/common/dielectric.rs"]
#[allow(dead_code)] // what the tests of `nastic-fem` take
mod dielectric;

use dielectric::Dielectric;
use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::Slot;
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{Field, NodalValue, Solid};
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_opt::{Bounds, Taylor, Verdict};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn regular(kind: CellKind, size: [f64; 3], cells: [usize; 3]) -> Outcome<Mesh> {
    Ok(box_mesh(size, cells, kind)?)
}

/// The cup of the catalogue with its fibres and its chamber, whose wall is an electrode; it is grounded at one end, and an electrode floats at the other.
fn cup() -> Outcome<Solid> {
    let entry = CATALOGUE.iter().find(|entry| entry.name == "cavity").ok_or("no cavity in the catalogue")?;
    let cup = (entry.example)()?;
    let phi = || Field::saddle("phi", 1);
    let field = Dielectric::on(cup.discretization(), 1.0);
    let cup = cup.contribution(field)?.hold("phi", 0, "x-", 0.0)?;
    let cup = cup.nodal_value(NodalValue::driven("drive", phi(), "inside", Slot::scalar("voltage", "V")))?;
    Ok(cup.nodal_value(NodalValue::floating("plate", phi(), "x+"))?)
}

const M: [(&str, f64); 3] = [("cavity", 4e3), ("fibre", 3e3), ("drive", 150.0)];

fn problem(controls: &[(&str, f64)]) -> Outcome<(Reduced, Vec<f64>, Bounds)> {
    let wider = Target::position(|x| [1.06 * x[0], x[1], x[2]]);
    let mut problem = Reduced::new(cup()?).cost(Tracking::surface("x+", wider))?;
    for (name, _) in controls {
        problem = problem.control(name, Space::Uniform)?;
    }
    let m: Vec<f64> = controls.iter().map(|(_, value)| *value).collect();
    let set =
        Bounds::new(m.iter().map(|m| 0.5 * m).collect::<Vec<_>>(), m.iter().map(|m| 1.5 * m).collect::<Vec<_>>())?;
    Ok((problem, m, set))
}

/// First and second derivatives by tension, voltage and pressure, at once and each by itself.
#[test]
fn derivatives_go_through_the_potential() -> Outcome {
    for controls in [&M[..], &M[..1], &M[1..2], &M[2..]] {
        let (problem, m, set) = problem(controls)?;
        let taylor = Taylor { directions: 2, second: true, ..Taylor::default() };
        let report = taylor.test(&problem, &set, &m)?;
        println!("{controls:?}: {report}");
        assert!(report.passed() && report.verdict() == Verdict::Right, "{controls:?}: {report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{controls:?}: {report}");
        let seconds: Vec<_> = report.directions.iter().filter_map(|direction| direction.second.as_ref()).collect();
        assert!(seconds.iter().any(|second| second.order > 2.95), "{controls:?}: {report} {seconds:?}");
        let point = problem.at(&m)?;
        let stability = problem.solid().model().stability();
        assert_eq!(stability.negative_pivots(point.state())?, 0);
    }
    Ok(())
}
