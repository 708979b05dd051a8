//! [`NeoHookeStep`]: a step of a Maxwell branch whose spring is neo-Hookean, in the principal axes of its elastic strain.

use super::spectrum::Spectrum;
use nastic_tensor::{Mat3, Tangent, Vec3};

/// Iterations of Newton's method, which takes five to eight.
const MOST: usize = 60;
/// Longest step of a logarithmic strain.
const LONGEST: f64 = 1.0;

/// At one point. With the eigenvalues x_a of `F_e^T F_e`, `F_e = F F_v^-1`, and `e_a = ln(x_a)/2` less their mean, the logarithmic strains `eps_a` of the spring at the end
/// of the step are where
///
/// ```text
/// (mu/2) (sum exp(2 eps_a) - 3) + mu s/(1 - s) sum (e_a - eps_a)^2,    sum eps_a = 0
/// ```
///
/// is lowest, the energy W of the step: `(1 - s) (E_a - mean E) = 2 s (e_a - eps_a)`, `E_a = exp(2 eps_a)`. Of any s from 0 (all has flowed) to 1 (none has).
pub(super) struct NeoHookeStep {
    mu: f64,
    s: f64,
    inverse: Mat3,
    elastic: Mat3,
    spectrum: Spectrum,
    /// e
    trial: Vec3,
    /// eps
    strain: Vec3,
    /// Inverse of the derivative of the condition by eps, on strains without a mean.
    solve: Mat3,
}

/// The projection on vectors without a mean.
fn deviator() -> Mat3 {
    Mat3::identity() - Mat3::repeat(1.0 / 3.0)
}

fn without_mean(v: &Vec3) -> Vec3 {
    v - Vec3::repeat(v.sum() / 3.0)
}

impl NeoHookeStep {
    /// Of a spring of shear modulus mu, with `F_e` and `F_v^-1`.
    pub fn new(mu: f64, s: f64, elastic: Mat3, inverse: Mat3) -> Self {
        let spectrum = Spectrum::new(&(elastic.transpose() * elastic));
        let trial = without_mean(&Vec3::from(spectrum.values().map(|x| 0.5 * x.ln())));
        let mut step = Self { mu, s, inverse, elastic, spectrum, trial, strain: trial * s, solve: Mat3::zeros() };
        for _ in 0..MOST {
            step.solve = step.curvature().try_inverse().unwrap_or_else(|| Mat3::repeat(f64::NAN));
            let change = without_mean(&(step.solve * step.defect()));
            let size = change.amax();
            if size.is_nan() || size <= f64::EPSILON * step.strain.amax() {
                break;
            }
            step.strain -= change * (LONGEST / size).min(1.0);
        }
        step
    }

    /// `E_a - 1`
    fn squares(&self) -> Vec3 {
        self.strain.map(|strain| (2.0 * strain).exp_m1())
    }

    /// `(1 - s) (E_a - mean E) - 2 s (e_a - eps_a)`
    fn defect(&self) -> Vec3 {
        without_mean(&self.squares()) * (1.0 - self.s) - (self.trial - self.strain) * (2.0 * self.s)
    }

    /// `2 dev diag(E) dev`: the derivative of `E_a - mean E` by the strains.
    fn stiffness(&self) -> Mat3 {
        let project = deviator();
        project * Mat3::from_diagonal(&self.squares().map(|square| 2.0 * (1.0 + square))) * project
    }

    /// The derivative of the condition; 2 along the mean, so that it has an inverse.
    fn curvature(&self) -> Mat3 {
        let project = deviator();
        self.stiffness() * (1.0 - self.s) + project * (2.0 * self.s) + Mat3::repeat(2.0 / 3.0)
    }

    /// `g_a = dW/de_a = mu (E_a - mean E)`
    fn forces(&self) -> Vec3 {
        without_mean(&self.squares()) * self.mu
    }

    /// W
    pub fn energy(&self) -> f64 {
        let (squares, flowed) = (self.squares(), self.trial - self.strain);
        0.5 * self.mu * (squares.sum() + flowed.dot(&without_mean(&squares)))
    }

    /// S, of `F_e S` the derivative of W by `F_e`: `g_a/x_a` in the axes.
    pub fn stress(&self) -> Mat3 {
        self.in_axes(&self.forces())
    }

    /// `g_a/x_a` in the axes, of forces.
    fn in_axes(&self, forces: &Vec3) -> Mat3 {
        let values = Vec3::from_fn(|a, _| forces[a] / self.spectrum.values()[a]);
        let axes = self.spectrum.axes();
        axes * Mat3::from_diagonal(&values) * axes.transpose()
    }

    /// P
    pub fn piola(&self) -> Mat3 {
        self.elastic * self.stress() * self.inverse.transpose()
    }

    /// `dP/ds`
    pub fn piola_by_step(&self) -> Mat3 {
        self.elastic * self.stress_by_step() * self.inverse.transpose()
    }

    fn stress_by_step(&self) -> Mat3 {
        let by_s = without_mean(&self.squares()) + (self.trial - self.strain) * 2.0;
        self.in_axes(&(self.stiffness() * (self.solve * by_s) * self.mu))
    }

    /// `deps_a/de_b`
    fn kept(&self) -> Mat3 {
        self.solve * deviator() * (2.0 * self.s)
    }

    /// What two axes differ by, over the difference of their eigenvalues: E, and the logarithm of what has flowed; to rounding where they are close. With
    /// `x_a = x_b (1 + t)` the strains differ by the root d of `(1 - s) E_b (exp(2 d) - 1) + 2 s d = s ln(1 + t)`.
    fn difference(&self, a: usize, b: usize) -> [f64; 2] {
        let x = self.spectrum.values();
        let (t, square, s) = ((x[a] - x[b]) / x[b], 1.0 + self.squares()[b], self.s);
        let ratio = 2.0 * s / (2.0 * (1.0 - s) * square + 2.0 * s);
        if t == 0.0 {
            return [square * ratio / x[b], 0.5 * (1.0 - ratio) / x[b]];
        }
        let apart = 0.5 * t.ln_1p();
        let mut d = self.strain[a] - self.strain[b];
        for _ in 0..MOST {
            let defect = (1.0 - s) * square * (2.0 * d).exp_m1() + 2.0 * s * (d - apart);
            let change = defect / (2.0 * (1.0 - s) * square * (2.0 * d).exp() + 2.0 * s);
            if change.is_nan() || change.abs() <= f64::EPSILON * d.abs() {
                break;
            }
            d -= change;
        }
        [square * (2.0 * d).exp_m1() / (x[b] * t), (apart - d).exp_m1() / (x[b] * t)]
    }

    /// The derivative of S by `F_e^T F_e` in the axes: factors of the entries off the diagonal, and `dS_a/dx_b` of those on it.
    pub fn slopes(&self) -> SpringSlopes<'_> {
        let (x, forces) = (self.spectrum.values(), self.forces());
        let stiffness = self.stiffness() * self.kept() * self.mu;
        let mut shear = Mat3::zeros();
        for (a, b) in [(1, 0), (2, 0), (2, 1)] {
            let [square, _] = self.difference(a, b);
            shear[(a, b)] = self.mu * square / x[a] - forces[b] / (x[a] * x[b]);
            shear[(b, a)] = shear[(a, b)];
        }
        let along = Mat3::from_fn(|a, b| {
            let own = if a == b { forces[a] / (x[a] * x[a]) } else { 0.0 };
            stiffness[(a, b)] / (2.0 * x[a] * x[b]) - own
        });
        SpringSlopes { of: self, stress: self.stress(), shear, along }
    }

    /// `G - 1` of the flow `F_v -> G F_v`: `exp(e_a - eps_a) - 1` in the axes.
    pub fn flow(&self) -> Mat3 {
        let axes = self.spectrum.axes();
        let values = (self.trial - self.strain).map(f64::exp_m1);
        axes * Mat3::from_diagonal(&values) * axes.transpose()
    }

    /// The derivative of `G : with` by `F_e^T F_e`.
    pub fn flow_vjp(&self, with: &Mat3) -> Mat3 {
        let (x, axes) = (self.spectrum.values(), self.spectrum.axes());
        let flow = (self.trial - self.strain).map(f64::exp);
        let flowed = deviator() - self.kept();
        let inside = axes.transpose() * with * axes;
        let mut out = Mat3::zeros();
        for (a, b) in [(1, 0), (2, 0), (2, 1)] {
            let [_, apart] = self.difference(a, b);
            out[(a, b)] = flow[b] * apart * 0.5 * (inside[(a, b)] + inside[(b, a)]);
            out[(b, a)] = out[(a, b)];
        }
        for b in 0..3 {
            out[(b, b)] = (0..3).map(|a| inside[(a, a)] * flow[a] * flowed[(a, b)] / (2.0 * x[b])).sum();
        }
        axes * out * axes.transpose()
    }

    pub fn elastic(&self) -> &Mat3 {
        &self.elastic
    }

    pub fn inverse(&self) -> &Mat3 {
        &self.inverse
    }
}

/// The derivative of the stress of a [`NeoHookeStep`].
pub(super) struct SpringSlopes<'a> {
    of: &'a NeoHookeStep,
    stress: Mat3,
    shear: Mat3,
    along: Mat3,
}

impl SpringSlopes<'_> {
    /// The change of `F_e S` along a change of `F_e`: the second derivative of the energy by `F_e`, which is symmetric.
    pub fn elastic_change(&self, change: &Mat3) -> Mat3 {
        let NeoHookeStep { elastic, spectrum, .. } = self.of;
        let half = change.transpose() * elastic;
        let axes = spectrum.axes();
        let inside = axes.transpose() * (half + half.transpose()) * axes;
        let mut own = inside.component_mul(&self.shear);
        (0..3).for_each(|a| own[(a, a)] = (0..3).map(|b| self.along[(a, b)] * inside[(b, b)]).sum());
        change * self.stress + elastic * (axes * own * axes.transpose())
    }

    pub fn piola_change(&self, change: &Mat3) -> Mat3 {
        self.elastic_change(&(change * self.of.inverse)) * self.of.inverse.transpose()
    }

    /// dP/dF, as of a Hencky spring: `delta_ik (F_v^-1 S F_v^-T)_JL + sum_ab c_ab M_ab (x) (M_ab + M_ba)` off the diagonal, `2 dS_a/dx_b M_aa (x) M_bb` on it.
    pub fn tangent(&self) -> Tangent {
        let NeoHookeStep { inverse, elastic, spectrum, .. } = self.of;
        let (left, right) = (elastic * spectrum.axes(), inverse * spectrum.axes());
        let mut out = Tangent::zero();
        out.add_metric(&(inverse * self.stress * inverse.transpose()));
        out.add_spectral(&left, &right, &self.shear);
        let own: [Mat3; 3] = std::array::from_fn(|a| left.column(a) * right.column(a).transpose());
        for a in 0..3 {
            for b in 0..3 {
                out.add_outer(&own[a], &own[b], self.along[(a, b)] + self.along[(b, a)]);
            }
        }
        out
    }
}
