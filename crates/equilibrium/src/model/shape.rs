//! What a change of the body's shape asks of a model: which nodes it may move, and where the body is at rest.

use super::Model;
use crate::model::views::Checks;
use nastic_body::controls::Controls;
use nastic_body::error::FemError;
use nastic_forces::rayleigh_damping::RayleighDamping;

impl Checks<'_> {
    /// Refuses a change of shape where something holds the drawn body or measures from it.
    ///
    /// # Errors
    /// A mode with the first node that it moves there; Rayleigh damping.
    pub fn check_shape(&self) -> Result<(), FemError> {
        let model = self.model;
        let Some((_, shape)) = model.body.shape() else { return Ok(()) };
        let keeper = |node: u32, c: usize| model.supports.keeper(node, c);
        model.body.check_shape(keeper, "holds it where it is drawn")?;
        for contribution in &model.others {
            let (name, nodes) = (contribution.name(), contribution.drawn_nodes());
            let keeper = |node: u32, _: usize| nodes.binary_search(&node).is_ok().then_some(name);
            model.body.check_shape(keeper, "measures from the drawn body")?;
        }
        match model.contribution(RayleighDamping::NAME) {
            None => Ok(()),
            Some(_) => Err(FemError::Unsupported {
                what: format!("the change of shape \"{}\"", shape.name),
                with: RayleighDamping::NAME.to_owned(),
                why: "its stiffness and mass are those of the drawn body: take \"kelvin_voigt\" or a scheme that damps"
                    .to_owned(),
            }),
        }
    }
}

impl Model {
    /// Where a body under these controls is free of stress: by node the change of its shape, zero without one and of all other unknowns. Zero too of a shape that is none, which
    /// the laws then refuse in their words.
    pub(crate) fn unstressed(&self, controls: &Controls) -> Vec<f64> {
        let mut u = vec![0.0; self.unknowns().len()];
        let is_shape = self.body.shape_quality(controls).is_some_and(|worst| worst.least_volume > 0.0);
        let Some(s) = self.body.shape_displacement(controls).filter(|_| is_shape) else { return u };
        let (dim, block) = (self.discretization().dim(), self.unknowns().block());
        for (own, s) in u.chunks_exact_mut(block).zip(s.chunks_exact(dim)) {
            own[..dim].copy_from_slice(s);
        }
        u
    }
}
