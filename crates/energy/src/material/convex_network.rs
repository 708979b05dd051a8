use nastic_tensor::{HyperDual, Kinematics, Mat3, Scalar, Tangent, Vec3};
use std::sync::Arc;

use super::engineering::bulk_of_d1;
use super::volumetric::volumetric;
use crate::formula::Number;
use crate::network::{CheckedNetwork, MOST_INPUTS, Network, NetworkError, NetworkInput, SquareOf, pair};
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, Partials, TensionBound, Want, check,
};

/// A learned law: a neural network that is convex and nondecreasing in polyconvex invariants.
///
/// **Energy.** `W = s (N(x) - N(0) - n log J) + kappa/4 (J^2 - 1 - 2 log J)`. The inputs x, each less its value at rest, are the isochoric `J^(-2/3) |F|^2`, `(J^(-4/3) |H|^2)^(3/2)`
/// and with a fibre a `J^(-2/3) |F a|^2`, `(J^(-4/3) |H a|^2)^(3/2)`, where n = 0; or `|F|^2`, `|H|^2`, `J` and with a fibre `|F a|^2`, `|H a|^2`. The network is
/// `z_1 = g(A_1 x + b_1)`, `z_k = g(B_k z_(k-1) + A_k x + b_k)`, `N = B z + A x`, `g(t) = log(1 + e^t)`, all `A`, `B >= 0` but the columns of J.
///
/// **Free of stress at rest** by `n = sum_a N_a p_a`, of the derivatives `p_a tr e + t_a (a.ea)` of the inputs along a small strain e (`-n (J - 1)` instead of `-n log J` where
/// n < 0), and with a fibre by a multiple, not negative, of that one of its two inputs which makes `sum_a N_a t_a = 0`.
///
/// **Derivatives.** `N_a`, `N_ab` by the chain rule through the layers (`g' = 1/(1 + e^-t)`, `g'' = g' (1 - g')`), third ones in hyper-dual numbers; `P` and `dP/dF` by the chain rules of the inputs
/// and of [`ConvexDensity`].
///
/// **Parameters.** The network; s > 0, its `scale`, in Pa; the bulk modulus `bulk > 0` in Pa, or `d1 = 2 / bulk` in 1/Pa; each a [`Field`]; the unit vector `fiber`. W is linear in `scale` and `bulk`.
///
/// **Convexity.** Polyconvex for every such network: convex and nondecreasing functions of functions that are convex in (F, J) or (H, J). `W -> inf` as `J -> 0`. Coercive with `|F|^2` and `|H|^2`
/// among the inputs that N grows with.
///
/// **Source.** Input convex networks: B. Amos, L. Xu & J. Z. Kolter, ICML 2017, arXiv 1609.07152; of invariants: D. K. Klein, M. Fernandez, R. J. Martin, P. Neff & O. Weeger, J. Mech. Phys. Solids 159 (2022)
/// 104703, doi 10.1016/j.jmps.2021.104703; the isochoric invariants: S. Hartmann & P. Neff, Int. J. Solids Struct. 40 (2003) 2767-2791, doi 10.1016/S0020-7683(03)00086-6.
#[derive(Clone, Debug)]
pub struct ConvexNetwork {
    network: Arc<CheckedNetwork>,
    /// n.
    pressure: f64,
    scale: Field<f64>,
    bulk: Field<f64>,
    fiber: Option<Field<Vec3>>,
}

/// Derivatives of `W`, the volumetric part apart, by the squares q of the inputs and by J.
#[derive(Clone, Copy)]
struct Slopes<T> {
    by_square: [T; MOST_INPUTS],
    by_j: T,
}

/// The second ones.
struct Curvatures {
    by_squares: [[f64; MOST_INPUTS]; MOST_INPUTS],
    mixed: [f64; MOST_INPUTS],
    by_j: f64,
}

impl ConvexNetwork {
    /// Name in case files and messages.
    pub const NAME: &str = "convex_network";

    /// From the network, its scale (Pa), the bulk modulus (Pa) and the fibre.
    ///
    /// # Errors
    /// [`EnergyError::Network`] names the weight, or the input; [`EnergyError::Parameter`] unless `scale > 0`, `bulk > 0`; [`EnergyError::Direction`] of no unit vector.
    pub fn new(
        network: &Network,
        scale: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
        fiber: Option<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let (scale, bulk) = (scale.into(), bulk.into());
        let network = CheckedNetwork::new(network)?;
        match (network.inputs.iter().find(|input| input.is_of_fiber()), &fiber) {
            (Some(input), None) => return Err(NetworkError::NoFiber { name: input.name() }.into()),
            (None, Some(_)) => return Err(NetworkError::UnusedFiber.into()),
            _ => {}
        }
        scale.require_positive(Self::NAME, "scale")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        let fiber = fiber.map(|fiber| fiber.unit_directions(Self::NAME, "fiber")).transpose()?;
        let slopes = network.inputs.iter().zip(network.slopes_at_rest);
        let pressure: f64 = slopes.map(|(input, slope)| input.at_rest()[0] * slope).sum();
        // what rounding leaves of isochoric inputs is none
        let pressure = if network.inputs.iter().all(|input| input.is_isochoric()) { 0.0 } else { pressure };
        let law = Self { network: Arc::new(network), pressure, scale, bulk, fiber };
        let shear = law.shear_over_scale();
        if shear > 0.0 { Ok(law) } else { Err(NetworkError::NoShear { shear }.into()) }
    }

    /// From `d1` (1/Pa): bulk modulus `2 / d1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `d1 > 0`.
    pub fn from_d1(
        network: &Network,
        scale: impl Into<Field<f64>>,
        d1: impl Into<Field<f64>>,
        fiber: Option<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        Self::new(network, scale, bulk_of_d1(Self::NAME, &d1.into())?, fiber)
    }

    /// Shear modulus at rest over the scale, without what a fibre adds: `2 N_1 + 3 sqrt(3) N_2` of the isochoric inputs, `2 N_1 + 2 N_2` of the others.
    pub fn shear_over_scale(&self) -> f64 {
        self.network.shear()
    }

    fn count(&self) -> usize {
        self.network.inputs.len()
    }

    /// The metric M of an input: `q = F M : F` or `H M : H`.
    #[inline]
    fn metric(&self, at: MaterialPoint, input: NetworkInput) -> Mat3 {
        let fiber = self.fiber.as_ref().filter(|_| input.is_of_fiber());
        fiber.map_or_else(Mat3::identity, |fiber| {
            let a = fiber.at(at);
            a * a.transpose()
        })
    }

    /// `F M` or `H M` of every input.
    #[inline]
    fn halves(&self, at: MaterialPoint, f: &Mat3, h: &Mat3) -> [Mat3; MOST_INPUTS] {
        let mut out = [Mat3::zeros(); MOST_INPUTS];
        for (out, &input) in out.iter_mut().zip(&self.network.inputs) {
            let of = match input.square_of() {
                SquareOf::F => f,
                SquareOf::H => h,
                SquareOf::Neither => continue,
            };
            *out = if input.is_of_fiber() { of * self.metric(at, input) } else { *of };
        }
        out
    }

    /// q of every input.
    #[inline]
    fn squares(&self, halves: &[Mat3; MOST_INPUTS], f: &Mat3, h: &Mat3) -> [f64; MOST_INPUTS] {
        let mut out = [0.0; MOST_INPUTS];
        for ((out, half), input) in out.iter_mut().zip(halves).zip(&self.network.inputs) {
            *out = half.dot(if input.square_of() == SquareOf::H { h } else { f });
        }
        out
    }

    /// `x`, `x_q`, `x_J` of every input, and the changes of x since rest, which the network takes.
    #[inline]
    fn inputs<T: Scalar>(&self, squares: &[T; MOST_INPUTS], j: T) -> ([[T; 3]; MOST_INPUTS], [T; MOST_INPUTS]) {
        let zero = T::of(0.0);
        let (mut out, mut changes) = ([[zero; 3]; MOST_INPUTS], [zero; MOST_INPUTS]);
        for (k, input) in self.network.inputs.iter().enumerate() {
            out[k] = input.value(squares[k], j);
            let [rest, ..] = input.value(if input.is_of_fiber() { 1.0 } else { 3.0 }, 1.0);
            changes[k] = out[k][0] - T::of(rest);
        }
        (out, changes)
    }

    /// `-n log J`, or `-n (J - 1)` where n < 0; its derivative in numbers that may carry derivatives; its second one.
    fn release<T: Scalar>(&self, j: T) -> (f64, T, f64) {
        let (n, x) = (self.pressure, j.value());
        match n >= 0.0 {
            true => (-n * x.ln(), T::of(-n) / j, n / (x * x)),
            false => (-n * (x - 1.0), T::of(-n), 0.0),
        }
    }

    fn slopes<T: Number + Scalar>(&self, scale: f64, squares: &[T; MOST_INPUTS], j: T) -> Slopes<T> {
        let (inputs, changes) = self.inputs(squares, j);
        let (_, by_input) = self.network.gradient(changes);
        self.chained(scale, &inputs, &by_input, j)
    }

    fn chained<T: Scalar>(
        &self,
        scale: f64,
        inputs: &[[T; 3]; MOST_INPUTS],
        by_input: &[T; MOST_INPUTS],
        j: T,
    ) -> Slopes<T> {
        let scale = T::of(scale);
        let mut out = Slopes { by_square: [T::of(0.0); MOST_INPUTS], by_j: scale * self.release(j).1 };
        for (k, [_, by_q, by_j]) in inputs.iter().enumerate().take(self.count()) {
            let first = scale * by_input[k];
            out.by_square[k] = first * *by_q;
            out.by_j = out.by_j + first * *by_j;
        }
        out
    }

    fn both(&self, scale: f64, squares: &[f64; MOST_INPUTS], j: f64) -> (Slopes<f64>, Curvatures) {
        let (inputs, changes) = self.inputs(squares, j);
        let (by_input, by_pair) = self.network.curvature(changes);
        let slopes = self.chained(scale, &inputs, &by_input, j);
        let mut out = Curvatures {
            by_squares: [[0.0; MOST_INPUTS]; MOST_INPUTS],
            mixed: [0.0; MOST_INPUTS],
            by_j: scale * self.release(j).2,
        };
        for a in 0..self.count() {
            let [_, q_a, j_a] = inputs[a];
            let first = scale * by_input[a];
            let [qq, qj, jj] = self.network.inputs[a].curvature(squares[a], j, inputs[a]);
            out.by_squares[a][a] += first * qq;
            out.mixed[a] += first * qj;
            out.by_j += first * jj;
            for b in 0..self.count() {
                let second = scale * by_pair[pair(a.max(b), a.min(b))];
                let [_, q_b, j_b] = inputs[b];
                out.by_squares[a][b] += second * q_a * q_b;
                out.mixed[a] += second * q_a * j_b;
                out.by_j += second * j_a * j_b;
            }
        }
        (slopes, out)
    }

    /// `sum_a 2 s_a F M_a` and `sum_a 2 s_a H M_a`, of what F M and H M are.
    fn combined(&self, parts: &[Mat3; MOST_INPUTS], s: &[f64; MOST_INPUTS]) -> [Mat3; 2] {
        let mut out = [Mat3::zeros(); 2];
        for ((part, s), input) in parts.iter().zip(s).zip(&self.network.inputs) {
            match input.square_of() {
                SquareOf::F => out[0] += part * (2.0 * s),
                SquareOf::H => out[1] += part * (2.0 * s),
                SquareOf::Neither => {}
            }
        }
        out
    }

    fn conjugates(&self, at: MaterialPoint, halves: &[Mat3; MOST_INPUTS], slopes: &Slopes<f64>, j: f64) -> Conjugates {
        let [f, h] = self.combined(halves, &slopes.by_square);
        Conjugates { f, h, j: slopes.by_j + volumetric(self.bulk.at(at), j)[1] }
    }

    fn blocks(
        &self,
        at: MaterialPoint,
        halves: &[Mat3; MOST_INPUTS],
        slopes: &Slopes<f64>,
        curvatures: &Curvatures,
        j: f64,
    ) -> Curvature {
        let (mut ff, mut hh, mut fh) = (Tangent::zero(), Tangent::zero(), Tangent::zero());
        let (mut has_f, mut has_h) = (false, false);
        let inputs = &self.network.inputs;
        for (a, input) in inputs.iter().enumerate() {
            let metric = || self.metric(at, *input) * (2.0 * slopes.by_square[a]);
            match input.square_of() {
                SquareOf::F => {
                    has_f = true;
                    ff.add_metric(&metric());
                }
                SquareOf::H => {
                    has_h = true;
                    hh.add_metric(&metric());
                }
                SquareOf::Neither => continue,
            }
            for (b, other) in inputs.iter().enumerate() {
                let factor = 4.0 * curvatures.by_squares[a][b];
                match (input.square_of(), other.square_of()) {
                    (SquareOf::F, SquareOf::F) => ff.add_outer(&halves[a], &halves[b], factor),
                    (SquareOf::H, SquareOf::H) => hh.add_outer(&halves[a], &halves[b], factor),
                    (SquareOf::F, SquareOf::H) => fh.add_outer(&halves[a], &halves[b], factor),
                    _ => {}
                }
            }
        }
        let [fj, hj] = self.combined(halves, &curvatures.mixed);
        let block = |there: bool, tangent: Tangent| if there { Block::Full(Box::new(tangent)) } else { Block::Zero };
        Curvature {
            ff: block(has_f, ff),
            hh: block(has_h, hh),
            jj: curvatures.by_j + volumetric(self.bulk.at(at), j)[2],
            fh: block(has_f && has_h, fh),
            fj: has_f.then_some(fj),
            hj: has_h.then_some(hj),
        }
    }
}

impl ConvexDensity for ConvexNetwork {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        let squares = self.squares(&self.halves(at, f, h), f, h);
        let (_, changes) = self.inputs(&squares, j);
        self.scale.at(at) * (self.network.value(changes) + self.release(j).0) + volumetric(self.bulk.at(at), j)[0]
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let halves = self.halves(at, f, h);
        let slopes = self.slopes(self.scale.at(at), &self.squares(&halves, f, h), j);
        self.conjugates(at, &halves, &slopes, j)
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature {
        let halves = self.halves(at, f, h);
        let (slopes, curvatures) = self.both(self.scale.at(at), &self.squares(&halves, f, h), j);
        self.blocks(at, &halves, &slopes, &curvatures, j)
    }

    /// First and second ones from one pass through the network.
    fn partials(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64, want: Want) -> Partials {
        let value = if want.energy { self.value(at, f, h, j) } else { 0.0 };
        if !want.tangent {
            return Partials { value, first: want.stress.then(|| self.first(at, f, h, j)), second: None };
        }
        let halves = self.halves(at, f, h);
        let (slopes, curvatures) = self.both(self.scale.at(at), &self.squares(&halves, f, h), j);
        let first = self.conjugates(at, &halves, &slopes, j);
        Partials { value, first: Some(first), second: Some(self.blocks(at, &halves, &slopes, &curvatures, j)) }
    }

    /// With `W_q` and `W_J` in hyper-dual numbers along both changes, and `q' = 2 F M`, `q''[A] = 2 A M`: no third derivative of q.
    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        h: &Mat3,
        j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let halves = self.halves(at, f, h);
        let [by_a, by_b] = [a, b].map(|change| self.halves(at, &change.f, &change.h));
        let squares = self.squares(&halves, f, h);
        let [along_a, along_b] = [a, b].map(|change| self.squares(&halves, &change.f, &change.h));
        let along_both = self.squares(&by_a, &b.f, &b.h);
        let squares: [HyperDual; MOST_INPUTS] =
            std::array::from_fn(|k| HyperDual([squares[k], 2.0 * along_a[k], 2.0 * along_b[k], 2.0 * along_both[k]]));
        let slopes = self.slopes(self.scale.at(at), &squares, HyperDual([j, a.j, b.j, 0.0]));
        let [f_both, h_both] = self.combined(&halves, &slopes.by_square.map(|s| s.both()));
        let [f_a, h_a] = self.combined(&by_b, &slopes.by_square.map(|s| s.along(0)));
        let [f_b, h_b] = self.combined(&by_a, &slopes.by_square.map(|s| s.along(1)));
        let volume = Conjugates::third_by_j(volumetric(self.bulk.at(at), j)[3], [a, b]);
        Ok(Conjugates { f: f_both + f_a + f_b, h: h_both + h_a + h_b, j: volume.j + slopes.by_j.both() })
    }

    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        let grows = |input: NetworkInput, exponent: f64| if self.network.grows_in(input) { exponent } else { 0.0 };
        let p = grows(NetworkInput::FirstIsochoric, 1.5).max(grows(NetworkInput::First, 2.0));
        let q = grows(NetworkInput::SecondIsochoric, 1.5).max(grows(NetworkInput::Second, 2.0));
        Some(Existence { polyconvex: true, resists_collapse: true, growth: Growth { p, q, r: 2.0 } })
    }

    /// Twice the multiple of `|F|^2` in the last layer, beside which the rest stays convex; zero without one.
    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        Some(TensionBound::isotropic(2.0 * self.scale.at(at) * self.network.linear_in(NetworkInput::First)))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.scale.check_len(Self::NAME, "scale", cells, points)?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)?;
        self.fiber.as_ref().map_or(Ok(()), |fiber| fiber.check_len(Self::NAME, "fiber", cells, points))
    }

    fn fiber(&self, at: MaterialPoint) -> Option<Vec3> {
        self.fiber.as_ref().map(|fiber| fiber.at(at))
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let tangent = check::evaluate(self, at, &Kinematics::rest(), &[]).tangent;
        Some(Moduli::of_rest(&tangent, self.fiber(at)))
    }
}

impl LinearInModuli for ConvexNetwork {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("scale", self.scale.clone()), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        ConvexNetwork { scale: theta[0].into(), bulk: theta[1].into(), ..self.clone() }
    }
}
