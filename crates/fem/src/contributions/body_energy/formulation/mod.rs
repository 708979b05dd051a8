//! [`Formulation`]: what stands between element and law.

mod of_body;
mod projected_dilatation;
mod standard;

use crate::discretization::Discretization;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::kernel;
use crate::kernels::patch::Patch;
use nastic_mesh::CellKind;
use nastic_tensor::{Kinematics, Mat3};
use projected_dilatation::ProjectedDilatation;
use standard::Standard;
use std::fmt;
use std::sync::LazyLock;

/// How the displacement of a cell becomes the deformation gradients that its laws see, passive ones and actuations.
///
/// Every one derives from a potential, `int W(Fbar(u)) dX`: residuals, tangents and adjoints are its exact derivatives, and
/// tangents are symmetric. With `J = det F` and `Fbar = (Jbar / J)^(1/3) F` (in plane strain `(Jbar / J)^(1/2)` in the plane and
/// `F_33 = 1`), `det Fbar = Jbar`: a nearly incompressible law resists changes of Jbar alone, of which there are as many per cell
/// as the projection has modes, and not of J at every point, which locks.
///
/// Source: Simo, Taylor, Pister, "Variational and projection methods for the volume constraint in finite deformation
/// elasto-plasticity", CMAME 51 (1985); in plane strain de Souza Neto, Peric, Dutko, Owen, "Design of simple low order finite
/// elements for large strain analysis of nearly incompressible solids", IJSS 33 (1996), whose residual is another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Formulation {
    /// `F = 1 + grad u` at every point: the displacement formulation.
    #[default]
    Standard,
    /// Jbar is the mean of J over the cell, of tet4 and tri3 over a patch of cells ([`BodyEnergy::patches`]): one pressure for each.
    ///
    /// [`BodyEnergy::patches`]: crate::BodyEnergy::patches
    MeanDilatation,
    /// Jbar is the L2 projection of J onto `1, X, Y, Z` of the cell: a linear pressure, discontinuous between cells.
    LinearDilatation,
}

/// The kinds of cells that bodies are made of.
static BODIES: LazyLock<Vec<CellKind>> =
    LazyLock::new(|| CellKind::ALL.into_iter().filter(|kind| kernel(*kind).is_some()).collect());

impl Formulation {
    /// Every formulation.
    pub const ALL: [Formulation; 3] = [Self::Standard, Self::MeanDilatation, Self::LinearDilatation];

    /// Its name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::MeanDilatation => "mean_dilatation",
            Self::LinearDilatation => "linear_dilatation",
        }
    }

    /// What it is, in a sentence.
    pub fn about(self) -> &'static str {
        match self {
            Self::Standard => "Displacements alone: laws see F at every point.",
            Self::MeanDilatation => {
                "For nearly incompressible bodies: laws see the mean change of volume of a cell (Q1/P0 of hex8 and quad4, P2/P0 of tet10 and tri6), of a patch of cells of tet4 and tri3."
            }
            Self::LinearDilatation => {
                "For nearly incompressible bodies: laws see the change of volume of a cell projected onto linear functions (Q2/P1 of hex27 and quad9; of hex20 and quad8, whose pressures may oscillate)."
            }
        }
    }

    /// The kinds of cells that can have it: those it helps.
    pub fn kinds(self) -> &'static [CellKind] {
        use CellKind::{Hex8, Hex20, Hex27, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6};
        match self {
            Self::Standard => BODIES.as_slice(),
            Self::MeanDilatation => &[Hex8, Quad4, Tet10, Tri6, Tet4, Tri3],
            Self::LinearDilatation => &[Hex27, Quad9, Hex20, Quad8],
        }
    }

    /// Whether it takes cells of this kind together, in patches.
    pub fn takes_patches(self, kind: CellKind) -> bool {
        self == Self::MeanDilatation && matches!(kind, CellKind::Tri3 | CellKind::Tet4)
    }

    /// The one for nearly incompressible cells of a kind, if there is one.
    pub fn nearly_incompressible(kind: CellKind) -> Option<Self> {
        [Self::MeanDilatation, Self::LinearDilatation].into_iter().find(|f| f.kinds().contains(&kind))
    }

    pub(crate) fn of_cells(self) -> &'static dyn CellFormulation {
        match self {
            Self::Standard => &Standard,
            Self::MeanDilatation => &ProjectedDilatation { linear: false },
            Self::LinearDilatation => &ProjectedDilatation { linear: true },
        }
    }
}

impl fmt::Display for Formulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
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
