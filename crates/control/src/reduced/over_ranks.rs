//! Reduced problems of a body over ranks: what all ranks have, and what each has a share of.

use super::Reduced;
use nastic_fem::FemError;
use nastic_fields::{ControlError, add_up};
use nastic_numeric::vector::axpy;

impl Reduced {
    /// Refuses a control that is not the same on all ranks: each would solve another problem.
    pub(super) fn check_same_control(&self, m: &[f64]) -> Result<(), ControlError> {
        let Some(share) = self.solid.model().unknowns().share() else { return Ok(()) };
        let all = share.gather(&fingerprint(m)).map_err(FemError::from)?;
        match (1..all.len()).find(|rank| all[*rank] != all[0]) {
            None => Ok(()),
            Some(rank) => {
                let what = format!(
                    "rank {rank} was given another control than rank 0: give all ranks of a body the same vector (that of the optimiser is the same, to the bit, where \
                     all begin with the same)"
                );
                Err(FemError::Meaningless { what }.into())
            }
        }
    }

    /// A derivative by the control of which each rank has its share becomes that of the whole, the same bits on all ranks.
    pub(super) fn whole_derivative(
        &self,
        mut share: Vec<f64>,
        through_state: &[f64],
    ) -> Result<Vec<f64>, ControlError> {
        axpy(1.0, through_state, &mut share[..through_state.len()]);
        add_up(self.solid.model().unknowns().share().map(AsRef::as_ref), &mut share)?;
        Ok(share)
    }
}

/// The length of a vector and a hash of its bits, as numbers that are sent exactly (64 bits in two halves).
fn fingerprint(m: &[f64]) -> [f64; 3] {
    let mix = |hash: u64, x: &f64| (hash ^ x.to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    let hash = m.iter().fold(0xcbf2_9ce4_8422_2325, mix);
    [m.len() as f64, (hash >> 32) as u32 as f64, hash as u32 as f64]
}
