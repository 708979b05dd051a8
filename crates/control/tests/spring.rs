//! Bodies with springs: Taylor tests of first and second derivatives by fibres beside them.

use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Solid, Spring};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A bar under fibre tension with a spring along it, one under tension to the ground, and one of rest length 0.
fn bar(kind: CellKind, cells: [usize; 3], stiffness: f64) -> Outcome<Solid> {
    let tip = [2.0, 0.12, 0.12];
    Ok(Solid::new(box_mesh([2.0, 0.25, 0.25], cells, kind)?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .spring(Spring::between("inner", [0.3, 0.12, 0.2], [1.7, 0.1, 0.22], stiffness))?
        .spring(Spring::to_ground("side", tip, [2.1, 0.1, 0.9], 0.05 * stiffness).rest_length(0.5))?
        .spring(Spring::to_ground("point", [1.0, 0.2, 0.1], [1.0, 0.2, 0.0], 0.1 * stiffness).rest_length(0.0))?
        .clamp("x-")?)
}

#[test]
fn derivatives_beside_springs_are_exact() -> Outcome {
    for (kind, cells) in [(CellKind::Hex8, [6, 2, 2]), (CellKind::Tet10, [3, 1, 1])] {
        let solid = bar(kind, cells, 2e3)?;
        let problem = Reduced::new(solid)
            .control("fibre", Space::Cell)?
            .cost(Tracking::surface("x+", Target::position(|x| [x[0] - 0.1, x[1], x[2] + 0.1])))?;
        let n = problem.layout().len();
        let m: Vec<f64> = (0..n).map(|k| -3e3 - 500.0 * (k % 5) as f64).collect();
        // the springs have their part in the state
        let loose = Reduced::new(bar(kind, cells, 1e-6)?)
            .control("fibre", Space::Cell)?
            .cost(Tracking::surface("x+", Target::position(|x| [x[0] - 0.1, x[1], x[2] + 0.1])))?;
        let (held, free) = (problem.at(&m)?.cost(), loose.at(&m)?.cost());
        assert!((held / free - 1.0).abs() > 0.1, "{kind}: {held} {free}");
        let set = Bounds::new(vec![-8e3; n], vec![-1e3; n])?;
        let report = Taylor { directions: 3, second: true, ..Taylor::default() }.test(&problem, &set, &m)?;
        assert_eq!(report.verdict(), Verdict::Right, "{kind}: {report}");
        assert_eq!(report.second_verdict(), Some(Verdict::Right), "{kind}: {report}");
        for direction in &report.directions {
            assert!(direction.order1 > 1.95 && direction.order1 < 2.2, "{kind}: {direction}");
        }
        let orders = report.directions.iter().filter_map(|d| d.second.as_ref()).map(|second| second.order);
        assert!(orders.clone().all(|order| order > 2.9), "{kind}: {:?}", orders.collect::<Vec<_>>());
    }
    Ok(())
}
