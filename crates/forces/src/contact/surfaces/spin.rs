//! [`Spin`]: how fast a surface turns around a sample.

use nastic_tensor::{Mat3, Vec3};

/// The spin of a surface at a sample: the omega that fits the velocities `a'_k` of its arms `a_k` to the corners around it best,
/// `sum_k |a'_k - omega x a_k|^2`:
///
/// ```text
/// omega = A^-1 sum_k a_k x a'_k,     A = sum_k |a_k|^2 1 - a_k a_k^T
/// ```
///
/// In plane strain about z alone. It is exact where the surface moves as a rigid body.
#[derive(Debug, Clone)]
pub(super) struct Spin {
    arms: Vec<Vec3>,
    inverse: Mat3,
}

impl Spin {
    /// For a body in this number of dimensions.
    pub fn new(arms: Vec<Vec3>, dim: usize) -> Self {
        let squares: f64 = arms.iter().map(Vec3::norm_squared).sum();
        let inverse = match dim {
            2 if squares > 0.0 => Mat3::from_diagonal(&Vec3::new(0.0, 0.0, 1.0 / squares)),
            2 => Mat3::zeros(),
            _ => {
                let products: Mat3 = arms.iter().map(|arm| arm * arm.transpose()).sum();
                // arms along one line alone fit no turn about it
                (squares * Mat3::identity() - products).try_inverse().unwrap_or_else(Mat3::zeros)
            }
        };
        Spin { arms, inverse }
    }

    /// omega, by the velocities of the arms.
    pub fn of(&self, rates: &[Vec3]) -> Vec3 {
        self.inverse * self.arms.iter().zip(rates).map(|(arm, rate)| arm.cross(rate)).sum::<Vec3>()
    }

    /// The change of omega along changes of the arms and of their velocities.
    pub fn change(&self, rates: &[Vec3], arms: &[Vec3], of_rates: &[Vec3]) -> Vec3 {
        let own = arms.iter().zip(rates).map(|(da, rate)| da.cross(rate)).sum::<Vec3>();
        let of_rates = self.arms.iter().zip(of_rates).map(|(arm, rate)| arm.cross(rate)).sum::<Vec3>();
        self.inverse * (own + of_rates - self.change_of_fit(&self.of(rates), arms))
    }

    /// The forces on the corners whose power is `couple . omega`; the sample bears the opposite of their sum.
    pub fn spread(&self, couple: &Vec3) -> impl Iterator<Item = Vec3> {
        let turn = self.inverse * couple;
        self.arms.iter().map(move |arm| turn.cross(arm))
    }

    /// The change of these along changes of the couple and of the arms.
    pub fn spread_change(&self, couple: &Vec3, of_couple: &Vec3, arms: &[Vec3]) -> impl Iterator<Item = Vec3> {
        let turn = self.inverse * couple;
        let of_turn = self.inverse * (of_couple - self.change_of_fit(&turn, arms));
        self.arms.iter().zip(arms).map(move |(arm, da)| of_turn.cross(arm) + turn.cross(da))
    }

    /// The change of `A x` along a change of the arms.
    fn change_of_fit(&self, x: &Vec3, arms: &[Vec3]) -> Vec3 {
        let of_arm = |(a, da): (&Vec3, &Vec3)| 2.0 * a.dot(da) * x - a.dot(x) * da - da.dot(x) * a;
        self.arms.iter().zip(arms).map(of_arm).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_numeric::Random;

    #[test]
    fn a_rigid_motion_has_its_own_spin() {
        let mut random = Random::new(5);
        let mut draw = || Vec3::from_fn(|_, _| random.symmetric());
        for dim in [2, 3] {
            let flat = |v: Vec3| if dim == 2 { Vec3::new(v.x, v.y, 0.0) } else { v };
            let arms: Vec<Vec3> = (0..4).map(|_| flat(draw())).collect();
            let omega = if dim == 2 { Vec3::new(0.0, 0.0, 0.7) } else { draw() };
            let rates: Vec<Vec3> = arms.iter().map(|arm| omega.cross(arm)).collect();
            let (spin, couple) = (Spin::new(arms.clone(), dim), if dim == 2 { Vec3::z() } else { draw() });
            assert!((spin.of(&rates) - omega).norm() < 1e-13);
            // the forces have the moment of the couple
            let moment: Vec3 = spin.spread(&couple).zip(&arms).map(|(force, arm)| arm.cross(&force)).sum();
            assert!((moment - couple).norm() < 1e-13, "{moment:?} {couple:?}");
        }
    }
}
