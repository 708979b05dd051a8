//! [`Multipliers`]: estimates of the multipliers, with the penalty that goes with them.

use crate::constrained::{ConstraintGroup, Sense};

/// Estimates l_k of the multipliers and the penalty r of the function of Powell, Hestenes and Rockafellar. With `s_k` the scale of
/// the group and `d_k = c_k / s_k`, both l and r have the unit of the cost:
///
/// ```text
/// psi(c) = sum over c_k <= 0: (max(0, l_k + r d_k)^2 - l_k^2) / (2 r),   over c_k = 0: l_k d_k + r d_k^2 / 2
/// ```
///
/// A penalty of zero means no constraints: psi = 0.
///
/// Source: Nocedal and Wright, Numerical Optimization, 2nd ed., section 17.4 and eq. (17.65); Birgin and Martinez, Practical Augmented Lagrangian
/// Methods for Constrained Optimization, section 4.1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Multipliers {
    groups: Vec<ConstraintGroup>,
    /// l_k.
    pub values: Vec<f64>,
    /// r.
    pub penalty: f64,
}

/// What one value contributes.
struct One {
    sense: Sense,
    scale: f64,
    /// l_k
    multiplier: f64,
    /// d_k
    value: f64,
}

impl One {
    /// `dpsi/dd`: the multiplier after an update.
    fn slope(&self, penalty: f64) -> f64 {
        let slope = self.multiplier + penalty * self.value;
        match self.sense {
            Sense::AtMost => slope.max(0.0),
            Sense::Equal => slope,
        }
    }
}

impl Multipliers {
    /// All zero, with no penalty.
    pub fn none(groups: Vec<ConstraintGroup>) -> Self {
        let values = vec![0.0; groups.iter().map(|group| group.len).sum()];
        Self { groups, values, penalty: 0.0 }
    }

    pub fn groups(&self) -> &[ConstraintGroup] {
        &self.groups
    }

    fn each<'a>(&'a self, c: &'a [f64]) -> impl Iterator<Item = One> + 'a {
        let groups = self.groups.iter().flat_map(|group| std::iter::repeat_n(group, group.len));
        groups.zip(&self.values).zip(c).map(|((group, l), c)| One {
            sense: group.sense,
            scale: group.scale,
            multiplier: *l,
            value: c / group.scale,
        })
    }

    /// The group of the largest violation relative to its scale, and which of the group's values that is.
    pub fn worst(&self, c: &[f64]) -> (String, usize) {
        let (mut first, mut worst) = (0, (f64::NEG_INFINITY, "", 0));
        for group in &self.groups {
            for (index, c) in c.iter().skip(first).take(group.len).enumerate() {
                let violation = group.sense.violation(*c) / group.scale;
                if violation > worst.0 {
                    worst = (violation, &group.name, index);
                }
            }
            first += group.len;
        }
        (worst.1.to_owned(), worst.2)
    }

    /// psi(c).
    pub fn value(&self, c: &[f64]) -> f64 {
        if self.penalty == 0.0 {
            return 0.0;
        }
        let r = self.penalty;
        let of = |one: One| match one.sense {
            Sense::AtMost => (one.slope(r).powi(2) - one.multiplier.powi(2)) / (2.0 * r),
            Sense::Equal => one.value * (one.multiplier + 0.5 * r * one.value),
        };
        self.each(c).map(of).sum()
    }

    /// `r sum_k max(0, d_k)`, of inequalities.
    pub fn exact_penalty(&self, c: &[f64]) -> f64 {
        let violation: f64 = self.each(c).map(|one| one.sense.violation(one.value)).sum();
        if violation > 0.0 { self.penalty * violation } else { 0.0 }
    }

    /// d_k.
    pub fn relative(&self, c: &[f64]) -> Vec<f64> {
        self.each(c).map(|one| one.value).collect()
    }

    /// Derivatives of c_k become those of d_k.
    pub fn scale(&self, rows: &mut [Vec<f64>]) {
        let groups = self.groups.iter().flat_map(|group| std::iter::repeat_n(group, group.len));
        rows.iter_mut().zip(groups).for_each(|(row, group)| row.iter_mut().for_each(|d| *d /= group.scale));
    }

    /// `l_k / s_k` of given l_k.
    pub fn per_value(&self, l: &[f64]) -> Vec<f64> {
        self.each(l).map(|one| one.value).collect()
    }

    /// `y_k = dpsi/dc_k`.
    pub fn slopes(&self, c: &[f64]) -> Vec<f64> {
        self.each(c).map(|one| one.slope(self.penalty) / one.scale).collect()
    }

    /// `w_k = d2psi/dc_k^2`, where that is defined; on the kink that of the inactive side.
    pub fn curvatures(&self, c: &[f64]) -> Vec<f64> {
        let active = |one: &One| one.sense == Sense::Equal || one.slope(self.penalty) > 0.0;
        self.each(c).map(|one| if active(&one) { self.penalty / one.scale.powi(2) } else { 0.0 }).collect()
    }

    /// The first-order update `l_k <- dpsi/dd_k`, kept within `largest`.
    pub fn updated(&self, c: &[f64], largest: f64) -> Vec<f64> {
        self.each(c).map(|one| one.slope(self.penalty).clamp(-largest, largest)).collect()
    }

    /// The largest violation, relative to the scales.
    pub fn violation(&self, c: &[f64]) -> f64 {
        self.each(c).map(|one| one.sense.violation(one.value)).fold(0.0, f64::max)
    }

    /// The largest `|max(d_k, -l_k / r)|` (`|d_k|` of equalities): violation and failing complementarity in one measure.
    pub fn measure(&self, c: &[f64]) -> f64 {
        let of = |one: One| match one.sense {
            Sense::AtMost => one.value.max(-one.multiplier / self.penalty).abs(),
            Sense::Equal => one.value.abs(),
        };
        self.each(c).map(of).fold(0.0, f64::max)
    }
}
