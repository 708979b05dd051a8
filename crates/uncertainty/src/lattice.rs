//! [`Sample::lattice`]: an embedded rank-1 lattice.

use super::lattice_vector::LATTICE_VECTOR;
use super::{Law, Sample, StochasticError};
use nastic_numeric::Random;

/// Numbers at most: entries of the generating vector.
pub const MOST_LATTICE_NUMBERS: usize = LATTICE_VECTOR.len();

/// Bits of the numbers of points.
const BITS: u32 = 16;

impl Sample {
    /// `x_i = frac(z phi_2(i) + shift)` through the quantiles of the laws, equal weights: phi_2 the radical inverse in base 2, z the generating vector, the shift
    /// random by the seed. The first 2^p points are a lattice for every p, so a sample grows without changing.
    ///
    /// The vector was found component by component with weights `1/k^2` for 2^4 to 2^16 points (`scripts/lattice.py`): the most important numbers come first.
    ///
    /// Source: Cools, Kuo & Nuyens, SIAM J. Sci. Comput. 28 (2006) 2162-2188.
    ///
    /// # Errors
    /// [`StochasticError::Rule`] for no law, more than 256 laws, or a count that is no power of two up to 2^16.
    pub fn lattice(laws: &[&dyn Law], count: usize, seed: u64) -> Result<Self, StochasticError> {
        let refuse = |what: String| Err(StochasticError::Rule { rule: "lattice", what });
        if laws.is_empty() || laws.len() > MOST_LATTICE_NUMBERS {
            return refuse(format!(
                "{} random numbers; it takes 1 to {MOST_LATTICE_NUMBERS}: keep fewer modes of a field, or take a Monte Carlo sample",
                laws.len()
            ));
        }
        if !count.is_power_of_two() || count > 1 << BITS {
            let near = count.clamp(1, 1 << BITS).next_power_of_two();
            return refuse(format!(
                "{count} points; a lattice has a power of two of them up to {}: {near}, say",
                1 << BITS
            ));
        }
        let mut random = Random::new(seed);
        let shifts: Vec<f64> = laws.iter().map(|_| random.unit()).collect();
        let coordinate = |i: usize, k: usize| {
            // z phi_2(i) modulo one, exactly: phi_2(i) = reversed/2^16
            let reversed = (i as u32).reverse_bits() >> (u32::BITS - BITS);
            let part = u32::from(LATTICE_VECTOR[k]).wrapping_mul(reversed) % (1 << BITS);
            let p = (f64::from(part) / f64::from(1u32 << BITS) + shifts[k]).fract();
            // quantiles at 0 and 1 may be infinite
            laws[k].quantile(p.clamp(f64::EPSILON, 1.0 - f64::EPSILON))
        };
        let nodes = (0..count).map(|i| (0..laws.len()).map(|k| coordinate(i, k)).collect()).collect();
        Ok(Sample { nodes, weights: vec![1.0 / count as f64; count] })
    }
}
