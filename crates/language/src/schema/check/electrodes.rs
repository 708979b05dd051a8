//! Electrodes against controls and dielectrics.

use crate::schema::actuation::Actuation;
use crate::schema::control::Control;
use crate::schema::electrode::Electrode;
use crate::schema::read::Reader;
use nastic_fem::DielectricBody;

/// Something gives an electrode its voltage or charge, or it floats.
pub(super) fn check_driven<'b>(
    electrodes: impl Iterator<Item = &'b Actuation>,
    controls: impl Iterator<Item = &'b Control>,
    reader: &mut Reader<'_>,
) {
    let controlled: Vec<&str> = controls.map(|control| control.of.as_str()).collect();
    for electrode in electrodes {
        let driver = electrode.slots().into_iter().find(|(name, _)| controlled.contains(&name.as_str()));
        match (electrode.has_flag("floating"), driver) {
            (true, Some((_, slot))) => {
                let message = format!("it floats, and a control gives it a {}: keep one of them", slot.key);
                reader.complain_at(&electrode.at.key("floating"), message);
            }
            (false, None) if electrode.fixed.is_empty() => {
                let message = format!(
                    "nothing drives \"{name}\": give a \"voltage\", 0 for a ground, a \"charge\", \"floating\": true, or a control {{ \"of\": \"{name}\", ... }}",
                    name = electrode.name
                );
                reader.complain_at(&electrode.at, message);
            }
            _ => {}
        }
    }
}

/// Electrodes need a dielectric.
pub(super) fn check_body(actuation: &[Actuation], reader: &mut Reader<'_>) {
    let has_body = actuation.iter().any(|own| own.kind() == DielectricBody::KIND);
    if let Some(first) = actuation.iter().find_map(Electrode::of).filter(|_| !has_body) {
        let message = "electrodes are of a body with a potential: add an actuation of the \"kind\": \"dielectric_body\"; a film in a given field is of the kind \"dielectric\"";
        reader.complain_at(&first.at, message);
    }
}
