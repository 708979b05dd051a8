//! A body over ranks: every rank has a [`Part`] of its cells, and solves for the whole.
//!
//! ```text
//! energy(u) = sum_p energy_p(u),    r(u) = sum_p r_p(u),    K = sum_p K_p,    j_m = sum_p (j_m)_p
//! ```
//!
//! Displacements and residuals are whole on every rank at its own nodes, tangents and derivatives by controls are shares by its own cells
//! ([`Share`]). What decides on the way (energies, residuals, the least J, admissible steps, failures) is agreed on, so that all ranks take the same steps.

use crate::error::FemError;
use nastic_linear::Share;
use nastic_mesh::Part;
use nastic_team::{Team, TeamError};
use std::sync::Arc;

/// What refusals call it.
const OVER_RANKS: &str = "a body over ranks";

/// The part of one rank.
#[derive(Debug)]
pub struct Parted {
    /// Its cells, and whose nodes they are.
    pub part: Part,
    /// What sums over unknowns of all ranks.
    pub share: Arc<Share>,
}

impl Parted {
    /// With the team that it sums over.
    pub fn new(part: Part, team: Arc<dyn Team>) -> Self {
        let share = Share::new(team, part.owned(), part.sharers().to_vec());
        Parted { part, share }
    }
}

/// What a rank has found by itself, or that another one has not: before messages that would wait for that one. Without a share it is what was found.
///
/// # Errors
/// What was found; [`FemError::Elsewhere`] where another rank found an error, [`FemError::Team`] where messages have failed.
pub fn all_accept<T, E: From<FemError>>(share: Option<&Share>, found: Result<T, E>) -> Result<T, E> {
    unless_elsewhere(share, found, |failure| failure.map_or(FemError::Elsewhere, FemError::from).into())
}

/// The same with an error of its own for what another rank has found.
pub fn unless_elsewhere<T, E>(
    share: Option<&Share>,
    found: Result<T, E>,
    elsewhere: impl FnOnce(Option<TeamError>) -> E,
) -> Result<T, E> {
    let Some(share) = share else { return found };
    match (share.any(found.is_err()), found) {
        (true, Ok(_)) => Err(elsewhere(share.failure())),
        (_, found) => found,
    }
}

/// Refuses what a body over ranks does not have, with the reason.
pub fn not_over_ranks(what: &str, why: &str) -> FemError {
    FemError::Unsupported { what: what.to_owned(), with: OVER_RANKS.to_owned(), why: why.to_owned() }
}
