//! What the ranks of a body send each other beside sums over unknowns.

use crate::error::ControlError;
use nastic_fem::{FemError, Share};

/// The numbers of every rank, in the order of the ranks.
pub fn gathered(share: &Share, own: &[f64]) -> Result<Vec<Vec<f64>>, ControlError> {
    share.gather(own).map_err(|failure| FemError::from(failure).into())
}

/// Numbers become their sums over all ranks; of a body that one process has they stay.
pub fn add_up(share: Option<&Share>, values: &mut [f64]) -> Result<(), ControlError> {
    let Some(share) = share else { return Ok(()) };
    share.sum(values);
    share.failure().map_or(Ok(()), |failure| Err(FemError::from(failure).into()))
}
