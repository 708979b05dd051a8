//! The field of a dielectric film as a control.

use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{Dielectric, NeoHookeIsochoric};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, rectangle};
use nastic_opt::{Bounds, Taylor, Verdict};
use nastic_tensor::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// The derivative by fields of cells, in plane strain, on two meshes; the energy is quadratic in them.
#[test]
fn the_derivative_by_a_field_is_exact() -> Outcome {
    for cells in [[4, 1], [8, 2]] {
        let solid = Solid::new(rectangle([1.0, 0.2], cells, CellKind::Quad9)?)?
            .material("body", NeoHookeIsochoric::new(1e5, 2e6)?)?
            .actuate("body", "film", Dielectric::from_relative(3.0, 8.854_187_812_8e-12, Vec3::y())?)?
            .clamp("x-")?;
        let longer = Target::position(|x| [1.2 * x[0], x[1], x[2]]);
        let problem = Reduced::new(solid).control("film", Space::Cell)?.cost(Tracking::surface("x+", longer))?;
        let start: Vec<f64> = (0..problem.layout().len()).map(|k| 1e7 + 1e6 * k as f64).collect();
        let report = Taylor::default().test(&problem, &Bounds::new(0.0, 6e7)?, &start)?;
        assert_eq!(report.verdict(), Verdict::Right, "{report}");
        assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{report}");
    }
    Ok(())
}
