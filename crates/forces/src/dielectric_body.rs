//! [`DielectricBody`]: a dielectric whose electric potential is an unknown.

use crate::matter_cells::MatterCells;
use nastic_body::body_energy::point_peaks::PointPeak;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::{Dielectric, Matter};
use nastic_linear::Field;
use nastic_mesh::{GroupNames, Mesh};

/// The cells of a region are an ideal dielectric of permittivity eps (F/m), in the field of a potential phi (V) that is an unknown at every node: to the potential energy it adds
///
/// ```text
/// -(eps/2) int J |F^-T grad phi|^2 dX,
/// ```
///
/// of which equilibria are minima by the displacement and maxima by phi: `div D = 0` and the stress of Maxwell follow. phi has the shape functions of the displacement: its equation is elliptic by itself,
/// so no pair of spaces has to be stable, and electrodes are nodes of the mesh. F is that of the displacement, whatever formulation the passive law has.
/// In plane strain per unit of thickness. Where no dielectric is, and no electrode, phi is held at zero.
///
/// **Source.** See [`Matter`].
#[derive(Debug, Clone, PartialEq)]
pub struct DielectricBody {
    name: String,
    region: GroupNames,
    permittivity: f64,
    breakdown: Option<f64>,
    unit: f64,
}

impl DielectricBody {
    /// What it is called in case files.
    pub const KIND: &str = "dielectric_body";
    /// The name of its field, and of that in results.
    pub const POTENTIAL: &str = "potential";

    /// Over a region, of a permittivity.
    pub fn of(name: &str, region: impl Into<GroupNames>, permittivity: f64) -> Self {
        DielectricBody { name: name.to_owned(), region: region.into(), permittivity, breakdown: None, unit: 1.0 }
    }

    /// With the largest true field that it bears, V/m, which is reported and changes no state.
    #[must_use]
    pub fn with_breakdown(self, strength: f64) -> Self {
        DielectricBody { breakdown: Some(strength), ..self }
    }

    /// With unknowns that are potentials over so many V, a power of two: what makes `eps unit^2` some shear modulus of the body.
    #[must_use]
    pub fn in_units_of(self, unit: f64) -> Self {
        DielectricBody { unit, ..self }
    }

    /// Its permittivity.
    pub fn permittivity(&self) -> f64 {
        self.permittivity
    }

    /// Where it is.
    pub fn region(&self) -> &GroupNames {
        &self.region
    }

    /// The potential: one for all dielectrics and electrodes of a body.
    pub fn potential() -> Field {
        Field::saddle(Self::POTENTIAL, 1)
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// An unknown region; a permittivity or breakdown strength that is not positive.
    pub fn on(&self, mesh: &Mesh) -> Result<DielectricCells, FemError> {
        let numbers = [("permittivity", Some(self.permittivity)), ("breakdown strength", self.breakdown)];
        for (what, number) in numbers {
            if let Some(number) = number.filter(|number| !(number.is_finite() && *number > 0.0)) {
                let what = format!("\"{}\" has a {what} of {number}; it must be positive and finite", self.name);
                return Err(FemError::Meaningless { what });
            }
        }
        let cells = mesh.cells_of(&self.region)?;
        let points = QuadraturePoints::of_cells(mesh, cells, |kind| kind.rule().clone())?;
        let matter = Matter::Dielectric { permittivity: self.permittivity * self.unit * self.unit };
        let cells = MatterCells { matter, points, dim: mesh.dim() };
        let (name, fields) = (self.name.clone(), [Self::potential()]);
        Ok(DielectricCells { name, fields, cells, breakdown: self.breakdown, unit: self.unit })
    }
}

/// The contribution of a [`DielectricBody`].
#[derive(Debug)]
pub struct DielectricCells {
    name: String,
    fields: [Field; 1],
    cells: MatterCells,
    breakdown: Option<f64>,
    /// V
    unit: f64,
}

impl Contribution for DielectricCells {
    fn name(&self) -> &str {
        &self.name
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn field_nodes(&self) -> Option<Vec<u32>> {
        Some(self.cells.nodes())
    }

    fn field_unit(&self) -> f64 {
        self.unit
    }

    /// F is that from the drawn cells.
    fn drawn_nodes(&self) -> Vec<u32> {
        self.cells.nodes()
    }

    /// Electric energy `(eps/2) int J |F^-T grad phi|^2 dX`.
    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.cells.energy(at).into_iter().map(|energy| ("electric_energy", energy)).collect()
    }

    /// Of the true field `|F^-T grad phi|`.
    fn point_peak(&self, at: &Instant) -> Option<PointPeak> {
        let fields: Vec<_> =
            self.cells.largest_fields(at)?.into_iter().map(|(cell, field)| (cell, self.unit * field)).collect();
        let first = fields.first().copied()?;
        let most = fields.iter().copied().fold(first, |most, own| if own.1 > most.1 { own } else { most });
        Some(PointPeak {
            actuation: self.name.clone(),
            quantity: Dielectric::TRUE_FIELD,
            value: most.1,
            cell: most.0,
            share: self.breakdown.map(|limit| (most.1 / limit, limit)),
            beyond: self.breakdown.map_or(0, |limit| fields.iter().filter(|(_, field)| *field > limit).count()),
        })
    }

    fn at<'a>(&'a self, at: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        self.cells.check(at)?;
        Ok(Box::new(&self.cells))
    }
}
