//! An optimum of densities and mixtures is a field from 0 to 1. Where it is cut at a level ends a body; this crate describes its outline, has Gmsh mesh it,
//! carries surfaces, regions and fields over, writes a case of its own and solves it: what is left of the optimum without grey and without void.
//!
//! [`remesh`] is the whole of it: an [`Optimum`] is cut into a [`KeptBody`], whose [`Outline`] is made coarse enough for the size of cells.

mod comparison;
mod cut;
mod error;
mod gmsh;
mod kept_body;
mod new_case;
mod optimum;
mod outline;
mod remesh;
mod transfer;
mod vector;
mod written;

pub use comparison::{CarriedGroup, DesignVolume, Remeshed, Solved};
pub use error::RemeshError;
pub use kept_body::{BorderFacet, KeptBody, Piece};
pub use optimum::Optimum;
pub use outline::{Outline, Patch};
pub use remesh::{RemeshRequest, remesh};
pub use transfer::Transfer;
