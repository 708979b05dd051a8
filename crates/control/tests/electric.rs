//! Optimal control of dielectric bodies by voltages and charges, beside fibres, a chamber of a given volume and a tendon.

use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{DielectricBody, Electrode, Solid, Tendon};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const BODY: &str = "dielectric";

/// The cup of the catalogue with its fibres and a chamber of a given volume, whose wall has a voltage; its end has a charge.
fn cup() -> Outcome<Solid> {
    let name = "cavity of a volume";
    let entry = CATALOGUE.iter().find(|entry| entry.name == name).ok_or("no such chamber in the catalogue")?;
    let cup =
        (entry.example)()?.tendon(Tendon::through("tendon", [[0.2, 0.4, 0.3], [1.6, 0.7, 0.5], [2.9, 0.3, 1.9]]))?;
    let wall = Electrode::on("drive", "inside");
    Ok(cup.electric(
        &[DielectricBody::of(BODY, "body", 1.0)],
        &[Electrode::on("ground", "x-"), wall, Electrode::on("plate", "x+").charged()],
    )?)
}

/// A beam of tetrahedra between a ground and electrodes on two sides.
fn beam() -> Outcome<Solid> {
    let beam = Solid::new(box_mesh([3.0, 1.0, 1.0], [6, 2, 2], CellKind::Tet4)?)?
        .material("body", NeoHooke::new(1e5, 2e5)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .tendon(Tendon::through("tendon", [[0.2, 0.4, 0.3], [1.6, 0.7, 0.5], [2.9, 0.3, 0.8]]))?;
    let plate = Electrode::on("plate", "x+").charged();
    Ok(beam.electric(&[DielectricBody::of(BODY, "body", 1.0)], &[Electrode::on("ground", "x-"), plate])?)
}

fn problem(body: Solid, controls: &[(&str, f64)]) -> Outcome<(Reduced, Vec<f64>, Bounds)> {
    let wider = Target::position(|x| [1.06 * x[0], x[1], x[2]]);
    let mut problem = Reduced::new(body).cost(Tracking::surface("x+", wider))?;
    for (name, _) in controls {
        problem = problem.control(name, Space::Uniform)?;
    }
    let m: Vec<f64> = controls.iter().map(|(_, value)| *value).collect();
    let bound = |share: f64| m.iter().map(|m| share * m).collect::<Vec<_>>();
    let set = Bounds::new(bound(0.5), bound(1.5))?;
    Ok((problem, m, set))
}

type Body = fn() -> Outcome<Solid>;

/// First and second derivatives, at once and by each voltage and charge alone.
#[test]
fn derivatives_by_voltages_and_charges() -> Outcome {
    let hexahedra = [("drive", 120.0), ("plate", 150.0), ("fibre", 3e3), ("cavity of a volume", 0.1), ("tendon", 2e3)];
    let tetrahedra = [("plate", 120.0), ("fibre", 3e3), ("tendon", 2e3)];
    let all: [(Body, &[(&str, f64)]); 5] = [
        (cup, &hexahedra),
        (cup, &hexahedra[..1]),
        (cup, &hexahedra[1..2]),
        (beam, &tetrahedra),
        (beam, &tetrahedra[..1]),
    ];
    for (body, controls) in all {
        let (problem, m, set) = problem(body()?, controls)?;
        let taylor = Taylor { directions: 2, second: true, ..Taylor::default() };
        let report = taylor.test(&problem, &set, &m)?;
        println!("{controls:?}: {report}");
        assert!(report.passed() && report.verdict() == Verdict::Right, "{controls:?}: {report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{controls:?}: {report}");
        let seconds: Vec<_> = report.directions.iter().filter_map(|direction| direction.second.as_ref()).collect();
        assert!(seconds.iter().any(|second| second.order > 2.95), "{controls:?}: {report} {seconds:?}");
        let point = problem.at(&m)?;
        let moved = problem.solid().model().displacement(&point.state().u).iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(moved > 1e-4, "{moved}");
        assert_eq!(problem.solid().model().stability().negative_pivots(point.state())?, 0);
    }
    Ok(())
}
