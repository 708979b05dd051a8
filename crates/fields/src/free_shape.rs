//! The nodes of the skin of a [`FreeShape`](nastic_fem::FreeShape) as a control field.

use crate::control_block::{ControlBlock, ControlTarget, Shown};
use crate::error::ControlError;
use crate::layout::{Layout, basis_of};
use crate::map::{Basis, Chain, Expansion, Skin, Space};
use nastic_fem::{SkinMap, Solid};
use std::sync::Arc;

impl Layout {
    /// Adds the normal displacement of the skin of the free shape of a body, which the displacement of its nodes, the gradient that its laws see, and masses follow: in the space `node`, one number a node
    /// of the skin, on a grid, or uniform.
    ///
    /// # Errors
    /// Those of [`SkinMap::new`], another space, one that is controlled already.
    pub(crate) fn add_free_shape(
        &mut self,
        solid: &Solid,
        of: &str,
        space: Space,
    ) -> Result<&ControlBlock, ControlError> {
        let (model, disc) = (solid.model(), solid.discretization());
        let none = || ControlError::UnknownControl { name: of.to_owned(), known: Layout::names(solid).join(", ") };
        let (shape, nodes) = model.free_shape().ok_or_else(none)?;
        let space = match space {
            Space::Node => Space::Point,
            Space::Uniform | Space::Grid(_) => space,
            _ => return Err(ControlError::OwnPoints { name: of.to_owned(), space: space.name() }),
        };
        let map = Arc::new(SkinMap::new(disc, shape, &model.drawn_keeper())?);
        let measure = map.points().iter().map(|point| point.weight).sum();
        let basis = Basis::of_contribution(measure, map.points(), space)?.map(|basis| disc.share(Arc::new(basis)));
        let basis = basis.ok_or_else(none)?;
        let words = format!("shape \"{of}\" of {} filtered over {}", shape.skin, shape.filter);
        let all = model.controllable();
        let mut targets = Vec::new();
        // first the nodes, which are in the unit of the unknowns
        let laws = (0..all.len()).filter(|k| *k != nodes);
        for k in [nodes].into_iter().chain(laws) {
            let gradient = k != nodes;
            let slots = match all[k].shared {
                Some((owner, slots)) if owner == of => slots,
                _ if all[k].name == of => all[k].slots.len(),
                _ => continue,
            };
            let basis_there = basis_of(solid, &all[k], of, Space::Uniform)?;
            self.check_free(of, k, 0..slots, &basis_there)?;
            let link = Skin { shape: words.clone(), map: map.clone(), disc: disc.clone(), gradient };
            let chain = Chain::default().then(Expansion { basis: basis.clone(), components: 1 }).then(link);
            targets.push(ControlTarget { actuation: k, slot: 0, slots, basis: basis_there, map: chain, adds: false });
        }
        let (name, unit) = (of.to_owned(), "m");
        Ok(self.push(ControlBlock {
            shown: Shown { name: name.clone(), unit: unit.to_owned() },
            name,
            components: 1,
            basis,
            field: Chain::default(),
            targets,
            first: self.len(),
            unit,
            weight: 1.0,
            knots: None,
            holds: false,
            log: false,
        }))
    }
}
