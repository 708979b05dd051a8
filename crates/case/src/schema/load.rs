//! The blocks of `loads`.

use crate::schema::field::VectorField;
use crate::schema::read::Reader;
use nastic_mesh::GroupNames;

object! {
    /// A dead load: per reference area on a surface, or per reference volume on a region.
    pub struct Load one of [surface, region] checked by check {
        /// Surface that bears the traction.
        pub surface: Option<GroupNames>,
        /// Region that bears the body force.
        pub region: Option<GroupNames>,
        /// Force per reference area, on a surface.
        pub traction: Option<VectorField> as PRESSURE,
        /// Force per reference volume, on a region.
        pub body_force: Option<VectorField> as BODY_FORCE,
    }
}

fn check(load: &Load, reader: &mut Reader<'_>) {
    let (place, wanted, other) = match load.surface {
        Some(_) => ("surface", ("traction", load.traction.is_some()), ("body_force", load.body_force.is_some())),
        None => ("region", ("body_force", load.body_force.is_some()), ("traction", load.traction.is_some())),
    };
    if other.1 {
        reader.complain_at(&load.at.key(other.0), format!("a {place} takes \"{}\", not \"{}\"", wanted.0, other.0));
    } else if !wanted.1 {
        reader.complain_at(&load.at, format!("missing key \"{}\": the load on this {place}", wanted.0));
    }
}
