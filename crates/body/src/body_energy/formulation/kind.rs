//! [`Formulation`]: which there are, and which cells take them.

use crate::kernels::kernel;
use nastic_mesh::CellKind;
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
    /// [`BodyEnergy::patches`]: crate::body_energy::BodyEnergy::patches
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
}

impl fmt::Display for Formulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
