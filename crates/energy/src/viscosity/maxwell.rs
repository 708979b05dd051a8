use nastic_tensor::{Kinematics, Mat3, Tangent};

use super::evolution::Evolution;
use super::neo_hooke_spring::NeoHookeStep;
use super::only_at_rest;
use super::spectrum::{Spectrum, log_over, log_over_divided, power_divided};
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// A Maxwell branch: a spring in series with a dashpot, in parallel with the passive law, in the isochoric response.
///
/// **Internal variable.** The viscous part `F_v` of `F = F_e F_v`, `det F_v = 1`, up to a rotation: `z = F_v - 1`.
///
/// **Energy.** `mu |dev ln U_e|^2`, `U_e^2 = F_e^T F_e` (Hencky). The flow costs `mu tau |d_v|^2`, `d_v` the rate of viscous stretching.
/// A step of length h from F_v, with the exponential map, has the minimum over the flow in closed form:
///
/// ```text
/// W(F; F_v) = s mu |dev ln U_e|^2,    F_e = F F_v^-1,    s = 1/(1 + h/tau)
/// F_v -> (U_e^2 / det^(1/3))^((1 - s)/2) F_v
/// ```
///
/// so that `F_v^T F_v` moves by the share `1 - s` along the geodesic of positive definite tensors to the isochoric `F^T F`. First order in h.
///
/// That is a spring of the measure [`Hencky`](SpringMeasure::Hencky), the default. A [`NeoHooke`](SpringMeasure::NeoHooke) spring stores `(mu/2) (tr C_e / det^(1/3) - 3)`,
/// `C_e = F_e^T F_e`; its flow, with the same cost, is found by Newton's method in the principal axes. Stretched to twice its length it bears 1.68 times the stress, at small strains the same.
///
/// **Small strains.** Relaxation of the shear modulus by `mu exp(-t/tau)`: one term of a Prony series.
///
/// **Stress.** `P = F_e S F_v^-T`, `S = 2 s mu dev(ln U_e) U_e^-2`. Objective. The dissipation `mu tau |d_v|^2` is never negative.
///
/// **Convexity.** Not polyconvex (Hencky's energy is not); it grows like `ln^2`, with a neo-Hookean spring as `|F|^2` in a step without length.
///
/// **Parameters.** `shear` mu > 0 in Pa and `relaxation` tau > 0 in s, each a [`Field`]. Slots: `F_v - 1` by rows, `s`.
///
/// **Source.** S. Reese, S. Govindjee, Int. J. Solids Struct. 35 (1998) 3455-3482, doi 10.1016/S0020-7683(97)00217-5; logarithmic
/// strains as there, section 4.
#[derive(Clone, Debug)]
pub struct MaxwellBranch {
    shear: Field<f64>,
    relaxation: Field<f64>,
    measure: SpringMeasure,
}

/// What of its elastic strain the spring of a [`MaxwellBranch`] resists to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpringMeasure {
    /// Logarithmic strains: `mu |dev ln U_e|^2`.
    #[default]
    Hencky,
    /// Squares of stretches: `(mu/2) (tr C_e / det^(1/3) - 3)`.
    NeoHooke,
}

/// The slot of s.
const STEP: usize = 9;

impl MaxwellBranch {
    /// Name in messages.
    pub const NAME: &str = "maxwell";

    const SLOTS: [Slot; 10] = [Slot::internal("internal", ""); 10];

    /// From the shear modulus (Pa) and the relaxation time (s).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are positive and finite.
    pub fn new(shear: impl Into<Field<f64>>, relaxation: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (shear, relaxation) = (shear.into(), relaxation.into());
        shear.require_positive(Self::NAME, "shear")?;
        relaxation.require_positive(Self::NAME, "relaxation")?;
        Ok(MaxwellBranch { shear, relaxation, measure: SpringMeasure::default() })
    }

    /// The same with a spring of another measure.
    #[must_use]
    pub fn measure(mut self, measure: SpringMeasure) -> Self {
        self.measure = measure;
        self
    }

    /// A step of a neo-Hookean spring with these slots; none of a branch that contributes nothing.
    fn neo_hooke(&self, at: MaterialPoint, k: &Kinematics, m: &[f64]) -> Option<NeoHookeStep> {
        (m.get(STEP).is_some_and(|s| *s != 0.0)).then(|| self.neo_hooke_of_any(at, k, m))
    }

    fn neo_hooke_of_any(&self, at: MaterialPoint, k: &Kinematics, m: &[f64]) -> NeoHookeStep {
        let inverse = inverse(m);
        NeoHookeStep::new(self.shear.at(at), m[STEP], k.f() * inverse, inverse)
    }

    fn is_hencky(&self) -> bool {
        self.measure == SpringMeasure::Hencky
    }

    fn branch(&self, at: MaterialPoint, k: &Kinematics, m: &[f64]) -> Option<Branch> {
        (m.get(STEP).is_some_and(|s| *s != 0.0)).then(|| Branch::new(m[STEP] * self.shear.at(at), k, m))
    }
}

fn matrix(m: &[f64]) -> Mat3 {
    Mat3::from_row_slice(&m[..9])
}

/// `F_v^-1`; of one that is singular, which no step makes, nothing that is finite.
fn inverse(m: &[f64]) -> Mat3 {
    (Mat3::identity() + matrix(m)).try_inverse().unwrap_or_else(|| Mat3::repeat(f64::NAN))
}

/// The elastic part of a branch at one point.
struct Branch {
    /// `s mu`
    factor: f64,
    inverse: Mat3,
    elastic: Mat3,
    spectrum: Spectrum,
    inverse_metric: Mat3,
    /// `ln det U_e^2 / 3`
    mean: f64,
    /// S
    stress: Mat3,
}

impl Branch {
    fn new(factor: f64, k: &Kinematics, m: &[f64]) -> Self {
        let inverse = inverse(m);
        let elastic = k.f() * inverse;
        let spectrum = Spectrum::new(&(elastic.transpose() * elastic));
        let mean = 2.0 * elastic.determinant().ln() / 3.0;
        let inverse_metric = spectrum.map(|x| 1.0 / x);
        let stress = (spectrum.map(log_over) - inverse_metric * mean) * factor;
        Branch { factor, inverse, elastic, spectrum, inverse_metric, mean, stress }
    }

    /// `s mu |dev ln U_e|^2 = (s mu / 4) |dev ln U_e^2|^2`
    fn energy(&self) -> f64 {
        let strain = self.spectrum.map(f64::ln) - Mat3::identity() * self.mean;
        0.25 * self.factor * strain.norm_squared()
    }

    /// P
    fn piola(&self) -> Mat3 {
        self.elastic * self.stress * self.inverse.transpose()
    }

    /// What its changes take.
    fn slopes(&self) -> Slopes<'_> {
        Slopes { of: self, divided: self.spectrum.divided(log_over_divided) }
    }
}

/// The derivative of the stress of a branch.
struct Slopes<'a> {
    of: &'a Branch,
    /// Divided differences of `ln x / x`.
    divided: Mat3,
}

impl Slopes<'_> {
    /// The change of `F_e S` along a change of `F_e`: the second derivative of the energy by `F_e`, which is symmetric.
    fn elastic_change(&self, change: &Mat3) -> Mat3 {
        let Branch { elastic, inverse_metric: inverse, .. } = self.of;
        let half = change.transpose() * elastic;
        let d = half + half.transpose();
        let own = self.of.spectrum.change(&self.divided, &d) - inverse * (inverse.dot(&d) / 3.0)
            + inverse * d * inverse * self.of.mean;
        change * self.of.stress + elastic * own * self.of.factor
    }

    fn piola_change(&self, change: &Mat3) -> Mat3 {
        self.elastic_change(&(change * self.of.inverse)) * self.of.inverse.transpose()
    }

    /// dP/dF: with the axes n_a of U_e^2, its eigenvalues x_a, their divided differences f_ab and `M_ab = F_e n_a (x) F_v^-1 n_b`,
    ///
    /// ```text
    /// delta_ik (F_v^-1 S F_v^-T)_JL + sum_ab c_ab M_ab (x) (M_ab + M_ba) - (2 s mu/3) T (x) T,
    /// c_ab = s mu (f_ab + (ln det U_e^2 / 3)/(x_a x_b)),    T = sum_a M_aa/x_a
    /// ```
    fn tangent(&self) -> Tangent {
        let Branch { factor, inverse, elastic, spectrum, stress, mean, .. } = self.of;
        let (x, axes) = (spectrum.values(), spectrum.axes());
        let (left, right) = (elastic * axes, inverse * axes);
        let mut out = Tangent::zero();
        out.add_metric(&(inverse * stress * inverse.transpose()));
        out.add_spectral(&left, &right, &Mat3::from_fn(|a, b| factor * (self.divided[(a, b)] + mean / (x[a] * x[b]))));
        let trace = left * Mat3::from_diagonal(&x.map(|x| 1.0 / x).into()) * right.transpose();
        out.add_outer(&trace, &trace, -2.0 * factor / 3.0);
        out
    }
}

impl MaxwellBranch {
    /// `P : H = F_e S : H G^T` with `G = F_v^-T`, and the change of `F_v` moves `F_e` by `-F_e dF_v F_v^-1` and `F_v^-1` by `-F_v^-1 dF_v F_v^-1`.
    fn vjp_at(&self, at: MaterialPoint, k: &Kinematics, m: &[f64], with: &Mat3, by_slots: &mut [f64]) {
        if !self.is_hencky() {
            let step = self.neo_hooke_of_any(at, k, m);
            let (pushed, turned) = (with * step.inverse(), step.inverse().transpose());
            let by_elastic = step.elastic().transpose() * step.slopes().elastic_change(&pushed);
            let by_inverse = pushed.transpose() * step.elastic() * step.stress();
            let by_viscous = -(by_elastic + by_inverse) * turned;
            by_slots[..STEP].copy_from_slice(by_viscous.transpose().as_slice());
            by_slots[STEP] = step.piola_by_step().dot(with);
            return;
        }
        let Some(branch) = self.branch(at, k, m) else {
            by_slots[..STEP].fill(0.0);
            by_slots[STEP] = Branch::new(self.shear.at(at), k, m).piola().dot(with);
            return;
        };
        let (pushed, turned) = (with * branch.inverse, branch.inverse.transpose());
        let by_elastic = branch.elastic.transpose() * branch.slopes().elastic_change(&pushed);
        let by_inverse = pushed.transpose() * branch.elastic * branch.stress;
        let by_viscous = -(by_elastic + by_inverse) * turned;
        by_slots[..STEP].copy_from_slice(by_viscous.transpose().as_slice());
        by_slots[STEP] = (branch.elastic * branch.stress).dot(&pushed) / m[STEP];
    }
}

impl EnergyTerm for MaxwellBranch {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            if !self.is_hencky() {
                let Some(step) = self.neo_hooke(at.place(q), k, m.only(q).values) else { continue };
                if want.energy {
                    out.energy[q] += step.energy();
                }
                if want.stress {
                    out.stress[q] += step.piola();
                }
                if want.tangent {
                    out.tangent[q].add(&step.slopes().tangent());
                }
                continue;
            }
            let Some(branch) = self.branch(at.place(q), k, m.only(q).values) else { continue };
            if want.energy {
                out.energy[q] += branch.energy();
            }
            if want.stress {
                out.stress[q] += branch.piola();
            }
            if want.tangent {
                out.tangent[q].add(&branch.slopes().tangent());
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, k) in at.kinematics.iter().enumerate() {
            if !self.is_hencky() {
                let step = self.neo_hooke(at.place(q), k, m.only(q).values);
                step.iter().for_each(|step| out[q] += step.slopes().piola_change(&change[q]));
            } else if let Some(branch) = self.branch(at.place(q), k, m.only(q).values) {
                out[q] += branch.slopes().piola_change(&change[q]);
            }
        }
    }

    /// Zero where the branch contributes nothing, as in statics.
    fn second_stress_change(
        &self,
        _: &PointBatch,
        m: Slots,
        _: [&[Mat3]; 2],
        _: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        only_at_rest::<Self>(m, STEP, "EnergyTerm::second_stress_change")
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.shear.check_len(Self::NAME, "shear", cells, points)?;
        self.relaxation.check_len(Self::NAME, "relaxation", cells, points)
    }

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let out = &mut out[q * STEP + q..][..=STEP];
            let m = m.only(q).values;
            if !self.is_hencky() {
                let step = self.neo_hooke_of_any(at.place(q), k, m);
                let (piola, slopes) = (step.piola(), step.slopes());
                out[STEP] = step.piola_by_step();
                for (entry, out) in out[..STEP].iter_mut().enumerate() {
                    let mut unit = Mat3::zeros();
                    unit[(entry / 3, entry % 3)] = 1.0;
                    let change = step.elastic() * unit * step.inverse(); // -dF_e
                    *out = -slopes.elastic_change(&change) * step.inverse().transpose()
                        - piola * (step.inverse() * unit).transpose();
                }
                continue;
            }
            let shear = self.shear.at(at.place(q));
            out[STEP] = Branch::new(shear, k, m).piola();
            let Some(branch) = self.branch(at.place(q), k, m) else {
                out[..STEP].fill(Mat3::zeros());
                continue;
            };
            let (piola, slopes) = (branch.piola(), branch.slopes());
            for (entry, out) in out[..STEP].iter_mut().enumerate() {
                let mut unit = Mat3::zeros();
                unit[(entry / 3, entry % 3)] = 1.0;
                let change = branch.elastic * unit * branch.inverse; // -dF_e
                *out = -slopes.elastic_change(&change) * branch.inverse.transpose()
                    - piola * (branch.inverse * unit).transpose();
            }
        }
    }

    /// Zero where the branch contributes nothing and nothing changes that.
    fn slots_vjp(&self, at: &PointBatch, m: Slots, with: &[Mat3], out: &mut [f64]) {
        let mut own = vec![0.0; m.width];
        for (q, (k, out)) in at.kinematics.iter().zip(out.chunks_exact_mut(m.width)).enumerate() {
            self.vjp_at(at.place(q), k, m.only(q).values, &with[q], &mut own);
            out.iter_mut().zip(&own).for_each(|(out, own)| *out += own);
        }
    }

    fn control_stress_change(
        &self,
        _: &PointBatch,
        m: Slots,
        _: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        out.fill(Mat3::zeros());
        [m, v].into_iter().try_for_each(|m| only_at_rest::<Self>(m, STEP, "EnergyTerm::control_stress_change"))
    }

    fn evolution(&self) -> Option<&dyn Evolution> {
        Some(self)
    }
}

impl Evolution for MaxwellBranch {
    fn set_step(&self, at: MaterialPoint, dt: f64, slots: &mut [f64]) {
        slots[STEP] = 1.0 / (1.0 + dt / self.relaxation.at(at));
    }

    fn advance(&self, at: MaterialPoint, k: &Kinematics, slots: &[f64], next: &mut [f64]) {
        let increment = match self.measure {
            SpringMeasure::Hencky => Flow::new(k, slots).increment,
            SpringMeasure::NeoHooke => self.neo_hooke_of_any(at, k, slots).flow(),
        };
        // the rounding errors of many steps stay relative to z
        let viscous = matrix(slots) + increment * (Mat3::identity() + matrix(slots));
        next[..9].copy_from_slice(viscous.transpose().as_slice());
    }

    fn advance_vjp(
        &self,
        at: MaterialPoint,
        k: &Kinematics,
        slots: &[f64],
        by_next: &[f64],
        by_f: &mut Mat3,
        by_slots: &mut [f64],
    ) {
        let (by_next, viscous) = (matrix(by_next), Mat3::identity() + matrix(slots));
        let by_stretch = by_next * viscous.transpose();
        let symmetric = (by_stretch + by_stretch.transpose()) * 0.5;
        if !self.is_hencky() {
            let step = self.neo_hooke_of_any(at, k, slots);
            let by_elastic = step.elastic() * step.flow_vjp(&symmetric) * 2.0 * step.inverse().transpose();
            *by_f += by_elastic;
            let stretch = Mat3::identity() + step.flow();
            let by_viscous = stretch * by_next - step.elastic().transpose() * by_elastic;
            by_slots[..9].iter_mut().zip(by_viscous.transpose().as_slice()).for_each(|(out, d)| *out += d);
            return;
        }
        let flow = Flow::new(k, slots);
        let by_metric = flow.spectrum.change(&flow.spectrum.divided(power_divided(flow.power)), &symmetric)
            * flow.scale
            - flow.spectrum.map(|x| 1.0 / x) * (flow.power / 3.0 * symmetric.dot(&flow.stretch));
        let by_elastic = flow.elastic * by_metric * 2.0 * flow.inverse.transpose();
        *by_f += by_elastic;
        let by_viscous = flow.stretch * by_next - flow.elastic.transpose() * by_elastic;
        by_slots[..9].iter_mut().zip(by_viscous.transpose().as_slice()).for_each(|(out, d)| *out += d);
    }
}

/// `G = (U_e^2 / det^(1/3))^p` with `p = (1 - s)/2`, by which the flow of a step multiplies `F_v`.
struct Flow {
    inverse: Mat3,
    elastic: Mat3,
    spectrum: Spectrum,
    power: f64,
    /// `det(U_e^2)^(-p/3)`
    scale: f64,
    stretch: Mat3,
    /// `G - 1`
    increment: Mat3,
}

impl Flow {
    fn new(k: &Kinematics, slots: &[f64]) -> Self {
        let inverse = inverse(slots);
        let elastic = k.f() * inverse;
        let spectrum = Spectrum::new(&(elastic.transpose() * elastic));
        let power = 0.5 * (1.0 - slots[STEP]);
        let mean = 2.0 * elastic.determinant().ln() / 3.0;
        let increment = spectrum.map(|x| (power * (x.ln() - mean)).exp_m1());
        let (scale, stretch) = ((-power * mean).exp(), increment + Mat3::identity());
        Flow { inverse, elastic, spectrum, power, scale, stretch, increment }
    }
}
