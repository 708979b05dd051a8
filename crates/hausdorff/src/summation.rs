//! [`Summation`]: to what accuracy the pair sums are formed.

use super::error::{HausdorffError, positive};

/// To what accuracy the pair sums are formed.
///
/// With the bound tol of the relative error of every sum A_t, B_q the derivative of a functional J errs, with
/// a = dJ/dlog A, b = dJ/dlog B and S the steepest slope of log phi^alpha, by no more than
///
/// ```text
/// sum_q |error of (dJ/dx_q)_d| <= 2 tol S (sum_t |a_t| + sum_q |b_q|)   for every direction d,
/// sum_q w_q |error of dJ/dw_q| <= 2 tol sum_t |a_t|,
/// ```
///
/// to first order in tol (the proof: `truncation`). All bounds are of exact arithmetic; rounding comes on top, about 2e-16
/// times the largest logarithm of E that counts in a sum. What is observed is a hundredth of the bound and less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Summation {
    /// Pairs are left out that change no sum by more than this in all, relative; 1e-10 by default. Which ones depends on
    /// distances alone, never on time.
    Truncated {
        /// The bound; not below 1e-17.
        tolerance: f64,
    },
    /// Every pair that can change a sum's last bits.
    Direct,
}

impl Default for Summation {
    fn default() -> Self {
        Self::Truncated { tolerance: 1e-10 }
    }
}

/// Share of a sum below which a pair does not change its last bits.
const MIN_PAIR_SHARE: f64 = f64::EPSILON / 16.0;

impl Summation {
    pub(super) fn tolerance(self) -> Result<f64, HausdorffError> {
        match self {
            Self::Truncated { tolerance } => Ok(positive("tolerance", tolerance)?.max(MIN_PAIR_SHARE)),
            Self::Direct => Ok(MIN_PAIR_SHARE),
        }
    }
}
