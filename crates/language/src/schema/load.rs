//! The blocks of `loads`.

use crate::expression::Formula;
use crate::schema::field::VectorField;
use crate::schema::obstacle::VectorInTime;
use crate::schema::read::Reader;
use nastic_mesh::GroupNames;

object! {
    /// A dead load: per reference area on a surface, per reference volume on a region, or the weight of the whole body.
    pub struct Load one of [surface, region, gravity] checked by check {
        /// Surface that bears the traction.
        pub surface: Option<GroupNames>,
        /// Region that bears the body force.
        pub region: Option<GroupNames>,
        /// Force per reference area, on a surface; of a motion formulas of t or a table.
        pub traction: Option<VectorInTime> as PRESSURE_IN_TIME,
        /// Force per reference volume, on a region; of a motion formulas of t or a table.
        pub body_force: Option<VectorInTime> as BODY_FORCE_IN_TIME,
        /// Acceleration of gravity, which acts on the density of every material: [0, 0, "-9.81 m/s^2"]; of a motion formulas of t or a table.
        pub gravity: Option<VectorInTime> as ACCELERATION_IN_TIME,
    }
}

fn check(load: &Load, reader: &mut Reader<'_>) {
    let given = [("traction", load.traction.is_some()), ("body_force", load.body_force.is_some())];
    if let Some(gravity) = &load.gravity {
        let varies = match gravity.field() {
            Some(VectorField::Formulas(entries)) => entries.iter().any(Formula::varies_in_space),
            Some(VectorField::Array(_)) => true,
            None => false,
        };
        if varies {
            let message =
                "gravity is the same everywhere: numbers or formulas of t; a force that varies is a \"body_force\"";
            reader.complain_at(&load.at.key("gravity"), message);
        }
        for (key, _) in given.into_iter().filter(|(_, given)| *given) {
            let message = format!("\"gravity\" acts on the whole body: give the \"{key}\" as a load of its own");
            reader.complain_at(&load.at.key(key), message);
        }
        return;
    }
    let (place, wanted, other) = match load.surface {
        Some(_) => ("surface", given[0], given[1]),
        None => ("region", given[1], given[0]),
    };
    if other.1 {
        reader.complain_at(&load.at.key(other.0), format!("a {place} takes \"{}\", not \"{}\"", wanted.0, other.0));
    } else if !wanted.1 {
        reader.complain_at(&load.at, format!("missing key \"{}\": the load on this {place}", wanted.0));
    }
}
