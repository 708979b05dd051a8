use nastic_energy::{EnergyTerm, MaterialPoint, PointBatch, Response as Answer, Slots, Want};
use nastic_tensor::{Kinematics, Mat3, Vec3};

use crate::{Fibers, Mode};

/// A piece of a material with its fibres along or across direction 1 of the test.
#[derive(Clone, Copy)]
pub(crate) struct Specimen<'a> {
    pub law: &'a dyn EnergyTerm,
    pub fibers: Fibers,
}

/// A tensor of the test in the axes of the law, or of these in those of the test.
pub(crate) fn turned(fibers: Fibers, a: Mat3) -> Mat3 {
    match fibers {
        Fibers::Along => a,
        Fibers::Across => {
            let swap = Mat3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
            swap * a * swap
        }
    }
}

/// Steps of the search for a lateral stretch.
const STEPS: usize = 100;

impl Specimen<'_> {
    /// A tensor of the test in the axes of the law.
    pub fn turn(&self, a: Mat3) -> Mat3 {
        turned(self.fibers, a)
    }

    /// The deformation gradient of a test, in the axes of the law; `None` where there is none.
    pub fn gradient(&self, mode: Mode, x: f64) -> Option<Mat3> {
        let f = mode.gradient(x)?;
        Some(self.turn(if mode == Mode::Uniaxial { self.free_sides(x)? } else { f }))
    }

    /// First Piola-Kirchhoff stress, in the axes of the law; `None` beyond its domain.
    pub fn stress(&self, f: Mat3) -> Option<Mat3> {
        self.stresses(&[f]).map(|stress| stress[0])
    }

    /// The same of several.
    pub fn stresses(&self, gradients: &[Mat3]) -> Option<Vec<Mat3>> {
        let states = gradients.iter().map(|f| Kinematics::new(*f).ok()).collect::<Option<Vec<_>>>()?;
        let at = PointBatch { kinematics: &states, cell: 0, first: 0 };
        self.law.check_domain(&at, Slots::none()).ok()?;
        let mut stress = vec![Mat3::zeros(); states.len()];
        let mut answer = Answer { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        self.law.respond(&at, Slots::none(), Want::STRESS, &mut answer);
        Some(stress)
    }

    /// `diag(l, l2, 1/(l l2))` with `tau_2 = tau_3`, in the axes of the test: the sides of a bar are free, and alike without fibres. `tau_2 - tau_3` grows with `l2`; where it
    /// changes sign is found by false position (the Illinois variant: M. Dowell & P. Jarratt, BIT 11, 1971, doi 10.1007/BF01934364).
    fn free_sides(&self, l: f64) -> Option<Mat3> {
        let sides = l.powf(-0.5);
        if self.law.direction(MaterialPoint { cell: 0, point: 0 }).is_none() {
            return Some(Mat3::from_diagonal(&Vec3::new(l, sides, sides)));
        }
        let gradient = |e: f64| Mat3::from_diagonal(&Vec3::new(l, e.exp(), 1.0 / (l * e.exp())));
        let difference = |e: f64| {
            let f = gradient(e);
            let stress = self.stress(self.turn(f))?;
            let tau = self.turn(stress) * f;
            let (across, size) = (tau[(1, 1)] - tau[(2, 2)], tau.abs().max());
            // what rounding leaves is none
            Some(if across.abs() <= 1e-14 * size { 0.0 } else { across })
        };
        let alike = -0.5 * l.ln();
        let first = difference(alike)?;
        if first == 0.0 {
            return Some(gradient(alike));
        }
        let ([mut a, mut fa], [mut b, mut fb]) = bracket(&difference, [alike, first])?;
        for _ in 0..STEPS {
            let e = (a * fb - b * fa) / (fb - fa);
            let at = difference(e)?;
            if at == 0.0 || (b - a).abs() <= f64::EPSILON * a.abs().max(b.abs()) {
                return Some(gradient(e));
            }
            if (at > 0.0) == (fb > 0.0) {
                fa *= 0.5;
            } else {
                (a, fa) = (b, fb);
            }
            (b, fb) = (e, at);
        }
        Some(gradient(b))
    }
}

/// Two points with values of either sign, from one of them: steps against the sign, doubled, and halved where there is no value.
fn bracket(function: &dyn Fn(f64) -> Option<f64>, [mut x, mut y]: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let mut step = -0.1 * y.signum();
    for _ in 0..STEPS {
        match function(x + step) {
            Some(next) if next == 0.0 || (next > 0.0) != (y > 0.0) => return Some(([x, y], [x + step, next])),
            Some(next) => {
                (x, y) = (x + step, next);
                step *= 2.0;
            }
            None => step *= 0.5,
        }
    }
    None
}
