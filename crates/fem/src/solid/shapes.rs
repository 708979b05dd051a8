//! The shape of a [`Solid`] as it is drawn.

use super::Solid;
use nastic_body::body_energy::free_shape::FreeShape;
use nastic_body::body_energy::shape::NodalMode;
use nastic_body::error::FemError;
use nastic_energy::{ShapeGradient, ShapeModes};
use nastic_forces::free_shape::ShapeNodes;
use nastic_forces::inertia::BodyInertia;
use nastic_mesh::GroupNames;

impl Solid {
    /// Lets the nodes of a region, or of the union of several, move along fields: the shape of the body itself, see [`ShapeModes`]. It comes before masses and weights, which follow it.
    ///
    /// # Errors
    /// As [`actuate`](Self::actuate); fields that are not of this mesh or move cells outside of the region, another change of shape. [`check`](Self::check) refuses those that
    /// move what supports hold, or what something measures from the drawn body.
    pub fn shape(
        self,
        region: impl Into<GroupNames>,
        name: &str,
        modes: impl IntoIterator<Item = NodalMode>,
    ) -> Result<Self, FemError> {
        let (region, disc) = (region.into(), self.discretization().clone());
        let cells = self.mesh().cells_of(&region)?;
        let modes = modes.into_iter().map(|mode| mode.on(&disc, &cells)).collect::<Result<_, _>>()?;
        self.actuate(region, name, ShapeModes::new(modes)?)
    }

    /// Lets the nodes of a skin move, and those inside follow: see [`FreeShape`]. It comes before masses and weights, which follow it. What it is to stay away from is looked up where it becomes a control, of
    /// the body as it is then.
    ///
    /// # Errors
    /// As [`actuate`](Self::actuate); another change of shape, a bound of det G that is no share.
    pub fn free_shape(self, shape: FreeShape) -> Result<Self, FemError> {
        let law = ShapeGradient::new(self.mesh().dim(), shape.least_volume)?;
        let nodes = ShapeNodes::new(shape.clone(), self.discretization());
        self.actuate(shape.regions.clone(), &shape.name, law)?.contribution(nodes)
    }

    /// Refuses what a change of shape would come too late for.
    pub(super) fn before_shape(&self, name: &str) -> Result<(), FemError> {
        let what = format!("the change of shape \"{name}\"");
        self.model.ranks().refuse_ranks(&what)?;
        let late = self
            .model
            .others
            .iter()
            .find(|own| own.slots().iter().any(|slot| slot.group == "fill") || own.name() == BodyInertia::NAME);
        match late {
            None => Ok(()),
            Some(late) => Err(FemError::Meaningless {
                what: format!(
                    "{what} comes after \"{}\", which has the masses of the drawn body: give it before",
                    late.name()
                ),
            }),
        }
    }
}
