//! Dielectric bodies and electrodes.

use super::Solid;
use nastic_body::contribution::Contribution;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_energy::MaterialPoint;
use nastic_forces::dielectric_body::DielectricBody;
use nastic_forces::electrode::{Electrode, ElectrodePlace, unconnected};
use std::collections::BTreeSet;

impl Solid {
    /// Makes regions dielectrics, puts electrodes on them, and holds the potential at zero where neither is.
    ///
    /// # Errors
    /// As [`dielectric_body`](Self::dielectric_body), [`electrode`](Self::electrode) and [`close_potential`](Self::close_potential).
    pub fn electric(self, bodies: &[DielectricBody], electrodes: &[Electrode]) -> Result<Self, FemError> {
        let with_bodies = bodies.iter().try_fold(self, Self::dielectric_body)?;
        electrodes.iter().try_fold(with_bodies, Self::electrode)?.close_potential()
    }

    /// Makes a region a dielectric whose potential is an unknown; [`close_potential`](Self::close_potential) comes after all of these and of the electrodes.
    ///
    /// # Errors
    /// As [`DielectricBody::on`]; a name that is taken.
    pub fn dielectric_body(self, body: &DielectricBody) -> Result<Self, FemError> {
        let unit = self.potential_unit(body)?;
        let contribution = body.clone().in_units_of(unit).on(self.whole_mesh("a dielectric body")?)?;
        self.contribution(contribution)
    }

    /// Puts an electrode on the body.
    ///
    /// # Errors
    /// An unknown surface, node set or region; a node of another electrode; a name that is taken.
    pub fn electrode(self, electrode: &Electrode) -> Result<Self, FemError> {
        let nodes = match electrode.place() {
            ElectrodePlace::Nodes(names) => self.nodes_of(names)?,
            ElectrodePlace::Region(names) => self.mesh().nodes_of_cells(&self.mesh().cells_of(names)?),
        };
        let own: BTreeSet<u32> = nodes.iter().copied().collect();
        for other in self.electrodes() {
            if let Some(node) = other.nodes.iter().find(|node| own.contains(node)) {
                let what = format!(
                    "the electrodes \"{}\" and \"{}\" share node {node} at {}: leave a gap between them, or make them one electrode",
                    other.name,
                    electrode.name(),
                    self.place_of(*node)
                );
                return Err(FemError::Meaningless { what });
            }
        }
        let unit = self.model.unit_of(DielectricBody::POTENTIAL);
        let contribution = electrode.clone().in_units_of(unit).of(self.mesh(), nodes)?;
        self.contribution(contribution)
    }

    /// Holds the potential at zero at nodes of neither dielectrics nor electrodes; nothing where there is no potential.
    ///
    /// # Errors
    /// No dielectric body; an electrode on none; a dielectric whose potential no voltage determines.
    pub fn close_potential(mut self) -> Result<Self, FemError> {
        let fail = |what: String| Err(FemError::Meaningless { what });
        if self.model.unknowns().nodal_field(DielectricBody::POTENTIAL).is_none() {
            return Ok(self);
        }
        let electrodes = self.electrodes();
        let dielectric: BTreeSet<u32> = self.with_potential(|contribution| {
            if contribution.gathers().is_some() { Vec::new() } else { contribution.field_nodes().unwrap_or_default() }
        });
        if dielectric.is_empty() {
            return fail("there are electrodes and no dielectric: add a dielectric_body".to_owned());
        }
        let apart = electrodes.iter().find(|electrode| !electrode.nodes.iter().any(|node| dielectric.contains(node)));
        if let Some(apart) = apart {
            return fail(format!("the electrode \"{}\" has no node of a dielectric_body", apart.name));
        }
        if let Some(node) = self.undetermined(&dielectric, &electrodes) {
            return fail(format!(
                "nothing determines the potential of the dielectric at {}: give one of its electrodes a voltage, 0 for a ground",
                self.place_of(node)
            ));
        }
        self.model.hold_idle_fields()?;
        Ok(self)
    }

    /// That of the potential so far; for the first body the power of two nearest to `(mu/eps)^(1/2)`, mu the shear modulus at rest where it begins.
    fn potential_unit(&self, body: &DielectricBody) -> Result<f64, FemError> {
        if self.model.unknowns().nodal_field(DielectricBody::POTENTIAL).is_some() {
            return Ok(self.model.unit_of(DielectricBody::POTENTIAL));
        }
        let first = self.mesh().cells_of(body.region())?.first().copied().unwrap_or_default() as usize;
        let at = MaterialPoint { cell: first, point: self.discretization().points_of_cells()[first].0 };
        let shear = self.body().materials_of(first).find_map(|law| Some(law.moduli(at)?.mu_t));
        let exponent: f64 = shear.map_or(0.0, |shear| (0.5 * (shear / body.permittivity()).log2()).round());
        Ok(if exponent.is_finite() { exponent.exp2() } else { 1.0 })
    }

    /// A node of a dielectric that neither cells nor an electrode connect with a voltage.
    fn undetermined(&self, dielectric: &BTreeSet<u32>, electrodes: &[ElectrodeNodes]) -> Option<u32> {
        let mesh = self.mesh();
        let cells = (0..mesh.cells()).map(|cell| mesh.cell(cell).nodes);
        let cells = cells.filter(|nodes| nodes.iter().all(|node| dielectric.contains(node)));
        let joined = cells.chain(electrodes.iter().map(|electrode| &electrode.nodes[..]));
        let (first, _) = self.model.unknowns().nodal_field(DielectricBody::POTENTIAL)?;
        let given = dielectric.iter().copied().filter(|node| self.supports().holds(*node, first));
        unconnected(mesh.points().len(), joined, dielectric.iter().copied(), given)
    }

    /// Its electrodes, each with its nodes.
    fn electrodes(&self) -> Vec<ElectrodeNodes> {
        let block = self.mesh().dim() + 1;
        let mut all = Vec::new();
        self.with_potential(|contribution| {
            if let Some(gathers) = contribution.gathers() {
                let nodes = gathers.unknowns().into_iter().map(|dof| (dof / block) as u32).collect();
                all.push(ElectrodeNodes { name: contribution.name().to_owned(), nodes });
            }
            Vec::new()
        });
        all
    }

    /// The nodes that a function finds of every contribution to the potential.
    fn with_potential(&self, mut of: impl FnMut(&dyn Contribution) -> Vec<u32>) -> BTreeSet<u32> {
        let rest = self.rest();
        let mut all = BTreeSet::new();
        let each = self.model.each_other(&Instant::of(&rest), |contribution, _| {
            if contribution.fields().iter().any(|field| field.name == DielectricBody::POTENTIAL) {
                all.extend(of(contribution));
            }
            Ok::<(), std::convert::Infallible>(())
        });
        let Ok(()) = each;
        all
    }

    fn place_of(&self, node: u32) -> String {
        let [x, y, z] = self.mesh().points()[node as usize];
        format!("({x:.4e}, {y:.4e}, {z:.4e})")
    }
}

/// The nodes of an electrode.
struct ElectrodeNodes {
    name: String,
    nodes: Vec<u32>,
}
