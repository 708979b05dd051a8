//! [`Electrode`]: nodes with one electric potential.

use crate::dielectric_body::DielectricBody;
use crate::nodal_value::{NodalValue, OneValue};
use nastic_body::error::FemError;
use nastic_energy::Slot;
use nastic_mesh::{GroupNames, Mesh};
use nastic_numeric::DisjointSets;
use std::collections::BTreeSet;

/// The nodes of surfaces, node sets or regions (a conductor in the body) have one potential phi: a given voltage U (V), or that at which the charge on them is Q (C), in plane strain per unit of thickness.
///
/// `Q = -sum_a dP/dphi_a` over its nodes. A given charge adds `Q phi` to the potential energy P: with it there is no pull-in. Voltage and charge are controls.
#[derive(Debug, Clone, PartialEq)]
pub struct Electrode {
    name: String,
    place: ElectrodePlace,
    drive: ElectrodeDrive,
    unit: f64,
}

/// Where an electrode is.
#[derive(Debug, Clone, PartialEq)]
pub enum ElectrodePlace {
    /// On surfaces or node sets.
    Nodes(GroupNames),
    /// In regions, which conduct.
    Region(GroupNames),
}

/// What is given of an electrode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElectrodeDrive {
    /// Its voltage.
    Voltage,
    /// Its charge.
    Charge,
    /// That it has no charge.
    Floating,
}

impl Electrode {
    /// Of a given voltage.
    pub const VOLTAGE: Slot = Slot::scalar("voltage", "V");
    /// Of a given charge.
    pub const CHARGE: Slot = Slot::scalar("charge", "C");

    /// On surfaces or node sets, with a voltage.
    pub fn on(name: &str, surface: impl Into<GroupNames>) -> Self {
        let place = ElectrodePlace::Nodes(surface.into());
        Electrode { name: name.to_owned(), place, drive: ElectrodeDrive::Voltage, unit: 1.0 }
    }

    /// In regions, with a voltage.
    pub fn within(name: &str, region: impl Into<GroupNames>) -> Self {
        let place = ElectrodePlace::Region(region.into());
        Electrode { name: name.to_owned(), place, drive: ElectrodeDrive::Voltage, unit: 1.0 }
    }

    /// With a charge in the place of a voltage.
    #[must_use]
    pub fn charged(self) -> Self {
        Electrode { drive: ElectrodeDrive::Charge, ..self }
    }

    /// Without a charge.
    #[must_use]
    pub fn floating(self) -> Self {
        Electrode { drive: ElectrodeDrive::Floating, ..self }
    }

    /// Of a potential whose unknowns are in this unit, as those of the [dielectric bodies](DielectricBody::in_units_of).
    #[must_use]
    pub fn in_units_of(self, unit: f64) -> Self {
        Electrode { unit, ..self }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where it is.
    pub fn place(&self) -> &ElectrodePlace {
        &self.place
    }

    /// The contribution on nodes of a mesh.
    ///
    /// # Errors
    /// As [`NodalValue::on`].
    pub fn of(&self, mesh: &Mesh, nodes: Vec<u32>) -> Result<OneValue, FemError> {
        let (ElectrodePlace::Nodes(names) | ElectrodePlace::Region(names)) = &self.place;
        let (name, field) = (&self.name, DielectricBody::potential());
        let value = match self.drive {
            ElectrodeDrive::Voltage => NodalValue::driven(name, field, names.clone(), Self::VOLTAGE),
            ElectrodeDrive::Charge => NodalValue::charged(name, field, names.clone(), Self::CHARGE),
            ElectrodeDrive::Floating => NodalValue::floating(name, field, names.clone()),
        };
        value.in_units_of(self.unit).on(mesh, nodes)
    }
}

/// The first of some of so many nodes that lists of nodes which hang together connect with none of the given ones.
pub fn unconnected<'n>(
    count: usize,
    joined: impl Iterator<Item = &'n [u32]>,
    nodes: impl Iterator<Item = u32>,
    given: impl Iterator<Item = u32>,
) -> Option<u32> {
    let mut sets = DisjointSets::new(count);
    joined.for_each(|nodes| nodes.windows(2).for_each(|pair| sets.union(pair[0], pair[1])));
    let known: BTreeSet<u32> = given.map(|node| sets.find(node)).collect();
    let mut nodes = nodes;
    nodes.find(|node| !known.contains(&sets.find(*node)))
}
