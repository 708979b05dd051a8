//! The arithmetic of a [`Formulation`]: what stands between element and law.

pub mod kind;
mod of_body;
mod projected_dilatation;
mod standard;

use crate::discretization::Discretization;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
pub use kind::Formulation;
use nastic_tensor::{Kinematics, Mat3};
use projected_dilatation::ProjectedDilatation;
use standard::Standard;
use std::fmt;

impl Formulation {
    pub(crate) fn of_cells(self) -> &'static dyn CellFormulation {
        match self {
            Self::Standard => &Standard,
            Self::MeanDilatation => &ProjectedDilatation { linear: false },
            Self::LinearDilatation => &ProjectedDilatation { linear: true },
        }
    }
}

/// A stress with its derivatives along two fields, whose gradients at the points are `along`: value, first, second, mixed. An empty
/// slice is zero. Stresses carry their quadrature weights.
#[derive(Clone, Copy)]
pub(crate) struct StressJet<'a> {
    pub along: [&'a [Mat3]; 2],
    pub parts: [&'a [Mat3]; 4],
}

/// The arithmetic of a formulation, a patch at a time: `Fbar = F(u)` at its points, and the transposes of that,
/// `dF = F'(u) v`, `f = F'(u)^T P`, `K = F'(u)^T (dP/dF) F'(u) + P : F''(u)`. Stresses and tangents carry their quadrature weights.
pub(crate) trait CellFormulation: fmt::Debug + Send + Sync {
    /// Whether F is affine in u: `F'' = 0`.
    fn is_affine(&self) -> bool;

    /// Shape gradients and kinematics of a displaced patch, into the scratch. All that follows is about that patch.
    fn kinematics(
        &self,
        disc: &Discretization,
        cells: Cells,
        patch: Patch,
        to: Displaced,
        scratch: &mut Scratch,
    ) -> Result<(), Inadmissible>;

    /// `1 + grad u` at the points.
    fn own<'a>(&self, scratch: &'a Scratch) -> &'a [Kinematics];

    /// `values` at the points as the determinant of what laws see has them; nothing where it has them as they are.
    fn projected(&self, scratch: &Scratch, values: &[f64]) -> Option<Vec<f64>>;

    /// For every mode of the projection the nodal rows of its change along displacements, of `sum_q w phi_i J`; nothing where there is none.
    fn changes_of_modes(&self, cells: Cells, patch: Patch, scratch: &Scratch) -> Vec<Vec<f64>>;

    /// The change of F along a nodal field v, and the gradient of v itself, into the scratch.
    fn change(&self, cells: Cells, patch: Patch, v: &[f64], scratch: &mut Scratch);

    /// `F''(u)(a, b)` of two fields whose gradients are given.
    fn second_change(&self, scratch: &Scratch, along: [&[Mat3]; 2]) -> Vec<Mat3>;

    /// Adds the nodal forces of stresses to rows.
    fn add_force(&self, cells: Cells, scratch: &Scratch, stress: &[Mat3], rows: &mut [f64]);

    /// Adds a derivative of the nodal forces of a stress to rows: the first (1), the second (2) or the mixed one (3).
    fn add_force_derivative(&self, cells: Cells, scratch: &Scratch, jet: StressJet, which: usize, rows: &mut [f64]);

    /// Sets the matrix of the patch from the tangents and, unless F is affine, the stresses in the scratch. Tangents are overwritten.
    fn tangent(&self, cells: Cells, patch: Patch, scratch: &mut Scratch, matrix: &mut PatchMatrix);
}
