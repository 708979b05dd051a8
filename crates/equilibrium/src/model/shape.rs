//! What a change of the body's shape asks of a model: which nodes it may move, and where the body is at rest.

use super::Model;
use crate::model::views::Checks;
use nastic_body::body_energy::free_shape::FreeShape;
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
    /// The change of shape by the nodes of the skin, if there is one, with the index of its block of controls: the displacements s of all nodes.
    pub fn free_shape(&self) -> Option<(&FreeShape, usize)> {
        let shape = self.others.iter().find_map(|own| own.free_shape())?;
        Some((shape, self.contribution(&shape.name)?.1))
    }

    /// By how much the nodes of the drawn body move under these controls, flat; `None` of a body whose shape does not change.
    pub fn shape_displacement(&self, controls: &Controls) -> Option<Vec<f64>> {
        let nodes = self.free_shape().map(|(_, block)| controls.values(block).to_vec());
        nodes.or_else(|| self.body.mode_displacement(controls))
    }

    /// Who holds a component of a node where it is drawn, or measures from there.
    pub fn drawn_keeper(&self) -> impl Fn(u32, usize) -> Option<String> + use<'_> {
        let nodes: Vec<(&str, Vec<u32>)> = self.others.iter().map(|own| (own.name(), own.drawn_nodes())).collect();
        move |node, c| {
            let measures = || nodes.iter().find(|(_, own)| own.binary_search(&node).is_ok()).map(|(name, _)| *name);
            self.supports.keeper(node, c).or_else(measures).map(str::to_owned)
        }
    }

    /// Where a body under these controls is free of stress: by node the change of its shape, zero without one and of all other unknowns. Zero too of a shape that is none, which
    /// the laws then refuse in their words.
    pub(crate) fn unstressed(&self, controls: &Controls) -> Vec<f64> {
        let mut u = vec![0.0; self.unknowns().len()];
        let is_shape = self.body.shape_quality(controls).is_some_and(|worst| worst.least_volume > 0.0);
        let Some(s) = self.shape_displacement(controls).filter(|_| is_shape) else { return u };
        let (dim, block) = (self.discretization().dim(), self.unknowns().block());
        for (own, s) in u.chunks_exact_mut(block).zip(s.chunks_exact(dim)) {
            own[..dim].copy_from_slice(s);
        }
        u
    }
}
