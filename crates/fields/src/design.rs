//! Design fields: one field from which the slots of several [`Consumer`]s follow.

use crate::control_block::{ControlBlock, ControlTarget, Shown};
use crate::control_names::resolve;
use crate::error::ControlError;
use crate::layout::{Layout, basis_of};
use crate::map::{Basis, Chain, ControlMap, Expansion, Space};
use nastic_energy::SlotGroup;
use nastic_fem::Solid;
use nastic_mesh::GroupNames;
use std::sync::Arc;

/// Slots that follow from a design field x: `m = f(x)` at every point, f the maps given, without one x itself.
///
/// ```
/// use nastic_fields::{Consumer, PowerLaw};
///
/// // A modulus between 1e2 and 1e5 Pa by a density to the third power.
/// let stiffness = Consumer::of("rubber.mu").through(PowerLaw { low: 1e2, high: 1e5, exponent: 3.0 });
/// # let _ = stiffness;
/// ```
#[derive(Debug, Clone)]
pub struct Consumer {
    pub(crate) of: String,
    pub(crate) within: Option<GroupNames>,
    pub(crate) maps: Vec<Arc<dyn ControlMap>>,
}

impl Consumer {
    /// Of these slots: an actuation or contribution with one group of slots, or `NAME.SLOT`.
    pub fn of(name: &str) -> Self {
        Consumer { of: name.to_owned(), within: None, maps: vec![] }
    }

    /// The actuation or contribution that its slots are of.
    pub fn owner(&self) -> &str {
        self.of.rsplit_once('.').map_or(&self.of, |(owner, _)| owner)
    }

    /// In these regions alone: at other points the slots keep their values, or follow another field. Of slots over the cells of the body.
    #[must_use]
    pub fn within(self, regions: impl Into<GroupNames>) -> Self {
        Consumer { within: Some(regions.into()), ..self }
    }

    /// One more map, which takes each point by itself.
    #[must_use]
    pub fn through(mut self, map: impl ControlMap + 'static) -> Self {
        self.maps.push(Arc::new(map));
        self
    }
}

impl Consumer {
    /// Its slots, with the chain from the unknowns of the field to them.
    fn target(
        &self,
        solid: &Solid,
        actuation: usize,
        group: SlotGroup,
        (of_body, space, alone): (Option<&Arc<Basis>>, Space, bool),
        fail: impl Fn(&'static str) -> ControlError,
    ) -> Result<ControlTarget, ControlError> {
        if self.maps.iter().any(|map| map.stages() > 1) {
            return Err(fail("a map of it changes from stage to stage: put that in front of the whole field"));
        }
        let of = &solid.model().controllable()[actuation];
        let basis = match (of_body, of.regions, &self.within) {
            (Some(basis), Some(_), Some(regions)) => {
                let own = basis.within(solid.discretization(), regions)?;
                solid.discretization().share(Arc::new(own))
            }
            (Some(basis), Some(_), None) => basis.clone(),
            (_, None, Some(_)) => {
                return Err(fail("it is no field over the cells of the body, of which regions could be named"));
            }
            _ if space != Space::Uniform && !alone => {
                return Err(fail("points of its own have no field together with others: take the space \"uniform\""));
            }
            _ => basis_of(solid, of, &self.of, space)?,
        };
        let mut map = Chain::default().then(Expansion { basis: basis.clone(), components: 1 });
        self.maps.iter().for_each(|link| map.push(link.clone()));
        if map.values(&vec![1.0; basis.len()]).len() != group.len * basis.points() {
            return Err(fail(
                "its maps do not lead from one number at a point to its slots: a vector needs a `Direction`",
            ));
        }
        Ok(ControlTarget { actuation, slot: group.first, slots: group.len, basis, map, adds: false })
    }
}

impl Layout {
    /// Adds a design field, a scalar without unit over all regions that its consumers act on, from which the slots of each follow.
    ///
    /// # Errors
    /// A name that is taken, no consumers, unknown slots, slots that are driven twice, a space that does not fit the regions;
    /// [`ControlError::Consumer`] of maps that do not lead from a number to the slots, and of contributions in other spaces than `uniform`.
    pub fn design(
        &mut self,
        solid: &Solid,
        name: &str,
        space: Space,
        consumers: &[Consumer],
    ) -> Result<&ControlBlock, ControlError> {
        if self.block(name).is_ok() || resolve(solid, name).is_ok() {
            return Err(ControlError::ControlledTwice { name: name.to_owned(), other: name.to_owned() });
        }
        let mut resolved: Vec<(&Consumer, (usize, SlotGroup))> = Vec::new();
        for consumer in consumers {
            resolved.extend(resolve(solid, &consumer.of)?.into_iter().map(|found| (consumer, found)));
        }
        let all = solid.model().controllable();
        let regions = resolved.iter().filter_map(|(consumer, (actuation, _))| {
            all[*actuation].regions.map(|own| consumer.within.as_ref().unwrap_or(own))
        });
        let mut names: Vec<String> = regions.flat_map(GroupNames::iter).map(str::to_owned).collect();
        names.sort_unstable();
        names.dedup();
        let of_body = match names.is_empty() {
            true => None,
            false => {
                Some(solid.discretization().share(Arc::new(Basis::new(solid.discretization(), &names.into(), space)?)))
            }
        };
        let mut targets: Vec<ControlTarget> = Vec::new();
        for (consumer, found) in resolved {
            let fail = |why| ControlError::Consumer { name: name.to_owned(), of: consumer.of.clone(), why };
            let (actuation, first, end) = (found.0, found.1.first, found.1.first + found.1.len);
            let alone = (of_body.as_ref(), space, consumers.len() == 1);
            let target = consumer.target(solid, found.0, found.1, alone, fail)?;
            self.check_free(&consumer.of, actuation, first..end, &target.basis)?;
            if targets.iter().any(|other| other.overlaps(actuation, &(first..end), &target.basis)) {
                return Err(fail("it is a consumer already"));
            }
            targets.push(target);
        }
        let Some(first) = targets.first() else {
            return Err(ControlError::Consumer { name: name.to_owned(), of: String::new(), why: "there is none" });
        };
        let holds = targets.iter().any(|target| all[target.actuation].holds);
        let basis = of_body.unwrap_or_else(|| first.basis.clone());
        let block = ControlBlock {
            name: name.to_owned(),
            components: 1,
            basis,
            field: Chain::default(),
            targets,
            first: self.len(),
            unit: "1",
            shown: Shown { name: name.to_owned(), unit: String::new() },
            weight: 1.0,
            knots: None,
            holds,
            log: false,
        };
        Ok(self.push(block))
    }
}
