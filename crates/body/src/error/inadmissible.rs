//! [`Inadmissible`]: why nothing is evaluated at a displacement.

use super::FemError;
use crate::discretization::quadrature_points::QuadraturePoints;
use nastic_energy::Outside;
use nastic_linear::NotCoupled;

/// Why a displacement is not admissible: nothing is evaluated there, and a step that would lead to it is shortened.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Inadmissible {
    /// J <= 0.
    #[error("{0}")]
    Inverted(InvertedAt),
    /// A deformation gradient beyond the domain of a law with a limit of its own.
    #[error("element {} left the domain of its law (quadrature point {}): {outside}", .at.cell, .at.point)]
    OutsideDomain {
        /// Where, with its J > 0.
        at: InvertedAt,
        /// What the law says.
        outside: Outside,
    },
    /// A point of the body inside of what it must not enter.
    #[error("the body is inside of \"{name}\" by {depth:.3e} at ({:.4e}, {:.4e}, {:.4e})", .place[0], .place[1], .place[2])]
    Penetrates {
        /// Name of what it must not enter.
        name: String,
        /// Where in space.
        place: [f64; 3],
        /// How deep.
        depth: f64,
    },
    /// Edges of surfaces that touch, as near to each other as no sample may come: they would go through each other between samples.
    #[error("edges of the surfaces of \"{name}\" come within {distance:.3e} of each other at ({:.4e}, {:.4e}, {:.4e}), between samples, which alone push (\"refine\" \
             gives more of them)", .place[0], .place[1], .place[2])]
    EdgesMeet {
        /// Name of the contact.
        name: String,
        /// Where in space.
        place: [f64; 3],
        /// How far they are apart.
        distance: f64,
    },
    /// The part of the body that another rank has is not admissible.
    #[error("the part of the body that another rank has is not admissible")]
    Elsewhere,
    /// Not of the displacement, and no reason to shorten a step: a contribution adds entries to a tangent for nodes that it does not
    /// couple. Solves and adjoints end with [`FemError::NotCoupled`].
    #[error("contribution \"{contribution}\": {lacking}")]
    NotCoupled {
        /// Name of the contribution.
        contribution: String,
        /// The nodes.
        lacking: NotCoupled,
    },
}

impl From<NotCoupled> for Inadmissible {
    /// The model adds the name of the contribution.
    fn from(lacking: NotCoupled) -> Self {
        Inadmissible::NotCoupled { contribution: String::new(), lacking }
    }
}

impl Inadmissible {
    /// With the name of the contribution that it comes from, where that belongs to it.
    pub fn of(self, name: &str) -> Self {
        match self {
            Inadmissible::NotCoupled { contribution, lacking } if contribution.is_empty() => {
                Inadmissible::NotCoupled { contribution: name.to_owned(), lacking }
            }
            other => other,
        }
    }

    /// What no other displacement would mend.
    pub fn problem(&self) -> Option<FemError> {
        match self {
            Inadmissible::NotCoupled { contribution, lacking } => {
                Some(FemError::NotCoupled { contribution: contribution.clone(), lacking: *lacking })
            }
            _ => None,
        }
    }

    /// The cell and its quadrature point, where it is the deformation of the body that is refused.
    #[must_use]
    pub fn cell(&self) -> Option<&InvertedAt> {
        match self {
            Inadmissible::Inverted(at) | Inadmissible::OutsideDomain { at, .. } => Some(at),
            Inadmissible::Penetrates { .. }
            | Inadmissible::EdgesMeet { .. }
            | Inadmissible::Elsewhere
            | Inadmissible::NotCoupled { .. } => None,
        }
    }

    /// What a law says of a deformation beyond its domain.
    #[must_use]
    pub fn outside(&self) -> Option<&Outside> {
        match self {
            Inadmissible::OutsideDomain { outside, .. } => Some(outside),
            _ => None,
        }
    }

    /// A stable name: `inverted`, `outside_domain`, `penetrates`, `edges_meet`, `elsewhere`, `not_coupled`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Inadmissible::Inverted(_) => "inverted",
            Inadmissible::OutsideDomain { .. } => "outside_domain",
            Inadmissible::Penetrates { .. } => "penetrates",
            Inadmissible::EdgesMeet { .. } => "edges_meet",
            Inadmissible::Elsewhere => "elsewhere",
            Inadmissible::NotCoupled { .. } => "not_coupled",
        }
    }
}

/// A quadrature point with J <= 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("element {cell} inverted (J = {jacobian:.3e} at its quadrature point {point})")]
pub struct InvertedAt {
    /// Cell number in the mesh.
    pub cell: usize,
    /// Quadrature point within the cell.
    pub point: usize,
    /// The determinant found, of F or of its projection onto the cell (not a number when the displacement was not finite, or a law named a point that the cell does not have).
    pub jacobian: f64,
}

impl InvertedAt {
    pub(crate) fn new(sampling: &QuadraturePoints, point: usize, jacobian: f64) -> Self {
        for part in sampling.parts.iter().rev() {
            if point >= part.first {
                let local = point - part.first;
                let cell = part.cells[local / part.table.points] as usize;
                return InvertedAt { cell, point: local % part.table.points, jacobian };
            }
        }
        InvertedAt { cell: 0, point, jacobian }
    }
}
