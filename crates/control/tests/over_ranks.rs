//! A body over ranks has no reduced problem yet: its costs and derivatives would be those of one part.

use nastic_control::{ControlError, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{FemError, Solid};
use nastic_mesh::{CellKind, box_mesh};
use nastic_team::threads;
use nastic_tensor::Vec3;
use std::sync::Arc;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

#[test]
fn optimal_control_over_ranks_is_refused_by_name() -> Outcome<()> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [4, 1, 1], CellKind::Hex8)?;
    let owners = mesh.bisected(2)?;
    let refused = threads::run(2, &threads::Faults::default(), |rank| -> Result<_, String> {
        let number = nastic_team::Team::rank(&rank) as u32;
        let problem = || -> Outcome<Reduced> {
            let body = Solid::of_part(mesh.part(&owners, number)?, Arc::new(rank))?
                .material("body", NeoHooke::new(1e5, 1e6)?)?
                .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
                .clamp("x-")?;
            let target = Tracking::surface("y+", Target::position(|x| x));
            Ok(Reduced::new(body).control("tension", Space::Uniform)?.cost(target)?)
        };
        Ok(problem().map_err(|error| error.to_string())?.at(&[0.0]).err())
    });
    for refused in refused {
        let named = |what: &str, with: &str| what == "optimal control" && with == "a body over ranks";
        match refused? {
            Some(ControlError::Fem(FemError::Unsupported { what, with, .. })) => assert!(named(&what, &with), "{what}"),
            other => return Err(format!("{other:?}").into()),
        }
    }
    Ok(())
}
