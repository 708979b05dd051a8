//! The same problem with thinner layers of its contacts.

use crate::lower::problem::CaseProblem;
use nastic_language::syntax::{At, Diagnostics, Setting};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What differs by less, relatively, is the same thickness.
const ROUNDING: f64 = 1e-9;

impl CaseProblem {
    /// The problem whose contacts have layers of a share of their thickness, with the stiffness that they have: the same pressure at the same share of the
    /// layer. Time steps that were found stay.
    ///
    /// # Errors
    /// What is wrong with the case then: a load case or scenario that sets a thickness of its own, say.
    pub fn with_thinner_layers(&self, share: f64, cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        let known = self.solid().model().contacts().parameters();
        let mut settings = Vec::new();
        for (k, contact) in self.case.contact.iter().enumerate() {
            let name = contact.name();
            let Some((_, layer)) = known.iter().find(|(own, _)| *own == name) else { continue };
            settings.push(Setting::option(&format!("contact/{k}/thickness={}", share * layer.thickness))?);
        }
        let instants = |member: super::CaseMember<'_>| Some(member.reduced().timeline()?.instants().to_vec());
        let found: Option<Vec<Vec<f64>>> = self.has_steps.then(|| self.members().filter_map(instants).collect());
        let thinner = Self::lower_through(self.document.with(&settings)?, cancel, &found.unwrap_or_default(), false)?;
        for (member, own) in thinner.members().zip(self.members()) {
            let layers = own.solid().model().contacts().parameters();
            for ((name, thin), (_, layer)) in member.solid().model().contacts().parameters().iter().zip(layers) {
                let differs = |found: f64, wanted: f64| (found / wanted - 1.0).abs() > ROUNDING;
                let what = match () {
                    () if differs(thin.thickness, share * layer.thickness) => "thickness",
                    () if differs(thin.stiffness, layer.stiffness) => "stiffness",
                    () => continue,
                };
                let message = format!(
                    "{}: contact \"{name}\" has a {what} of its own there: layers of all members are made thinner alike; leave it out",
                    member.name()
                );
                return Err(self.document.complain(&At::root().key("contact"), message).into());
            }
        }
        Ok(Self { has_steps: self.has_steps, ..thinner })
    }
}
