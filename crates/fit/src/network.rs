//! [`NetworkData`]: responses of networks and their derivatives by all weights, without a law at every point.

use nalgebra_of_levenberg_marquardt::DMatrix;
use nastic_energy::ConvexNetwork;
use nastic_energy::catalogue::NetworkShape;
use nastic_energy::network::{Network, NetworkLayer, SquareOf};
use nastic_tensor::cofactor;

use crate::data::Data;
use crate::{FitError, Law};

/// At constant volume the response to a test is the derivative of the network's energy along a direction of its inputs, `y = sum_a c_a N_a(x)`: inputs x and factors c of
/// every point, found once.
#[derive(Debug)]
pub(crate) struct NetworkData {
    shape: NetworkShape,
    inputs: Vec<Vec<f64>>,
    factors: Vec<Vec<f64>>,
}

/// Of the laws `c_a` are found with, in their scale.
const BULK: f64 = 1e3;

/// A layer at a point: arguments t of its units with their changes along c, and values z.
#[derive(Clone, Default)]
struct Passed {
    slope: Vec<f64>,
    curvature: Vec<f64>,
    along: Vec<f64>,
    value: Vec<f64>,
    value_along: Vec<f64>,
}

impl NetworkData {
    /// Of a law that is a network.
    pub fn new(law: Law, data: &Data) -> Result<Option<Self>, FitError> {
        let Some(shape) = law.network() else { return Ok(None) };
        let count = data.targets.len();
        let (mut inputs, mut factors) = (vec![vec![]; count], vec![vec![]; count]);
        for &input in shape.inputs {
            let linear = NetworkLayer { through: vec![vec![1.0]], ..NetworkLayer::default() };
            let own = ConvexNetwork::new(&Network { inputs: vec![input], layers: vec![linear] }, 1.0, BULK, None)?;
            let gradients = data.gradients(&own).unwrap_or_default();
            let [answers, _] = data.answers(&own, &gradients).unwrap_or_default();
            for (n, (f, answer)) in gradients.iter().zip(answers).enumerate() {
                let square = if input.square_of() == SquareOf::H { cofactor(f) } else { *f }.norm_squared();
                inputs[n].push(input.value(square, 1.0)[0] - input.value(3.0, 1.0)[0]);
                factors[n].push(answer);
            }
        }
        Ok(Some(NetworkData { shape, inputs, factors }))
    }

    /// Responses of the network with these numbers; `None` where they are none.
    pub fn responses(&self, numbers: &[f64]) -> Option<Vec<f64>> {
        let of = |n: usize| self.pass(numbers, n).last().map_or(0.0, |last| self.response(numbers, last));
        let out: Vec<f64> = (0..self.inputs.len()).map(of).collect();
        out.iter().all(|y| y.is_finite()).then_some(out)
    }

    /// Derivatives of the responses by the numbers, a row per point: backwards through the layers.
    pub fn slopes(&self, numbers: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.inputs.len(), numbers.len());
        for n in 0..self.inputs.len() {
            let passed = self.pass(numbers, n);
            let Some(last) = passed.last() else { continue };
            let mut end = numbers.len();
            let mut by_value = vec![0.0; last.value.len()];
            let mut by_along = self.last_weights(numbers).to_vec();
            end -= by_along.len();
            last.value_along.iter().enumerate().for_each(|(j, z)| out[(n, end + j)] = *z);
            for (k, own) in passed.iter().enumerate().rev() {
                let (below, below_along) = match k {
                    0 => (&self.inputs[n], &self.factors[n]),
                    _ => (&passed[k - 1].value, &passed[k - 1].value_along),
                };
                let (units, columns) = (own.value.len(), below.len());
                let first = end - units * (columns + 1);
                let (mut next, mut next_along) = (vec![0.0; columns], vec![0.0; columns]);
                for i in 0..units {
                    let along = by_along[i] * own.slope[i];
                    let value = by_along[i] * own.curvature[i] * own.along[i] + by_value[i] * own.slope[i];
                    out[(n, first + units * columns + i)] = value;
                    for j in 0..columns {
                        let place = first + i * columns + j;
                        out[(n, place)] = value * below[j] + along * below_along[j];
                        next[j] += numbers[place] * value;
                        next_along[j] += numbers[place] * along;
                    }
                }
                (by_value, by_along, end) = (next, next_along, first);
            }
        }
        out
    }

    fn last_weights<'n>(&self, numbers: &'n [f64]) -> &'n [f64] {
        let units = self.shape.units.last().map_or(0, |units| *units);
        &numbers[numbers.len() - units..]
    }

    fn response(&self, numbers: &[f64], last: &Passed) -> f64 {
        self.last_weights(numbers).iter().zip(&last.value_along).map(|(weight, z)| weight * z).sum()
    }

    /// All hidden layers at a point.
    fn pass(&self, numbers: &[f64], n: usize) -> Vec<Passed> {
        let mut out: Vec<Passed> = Vec::with_capacity(self.shape.units.len());
        let mut first = 0;
        for &units in self.shape.units {
            let (below, below_along) = match out.last() {
                None => (&self.inputs[n], &self.factors[n]),
                Some(before) => (&before.value, &before.value_along),
            };
            let columns = below.len();
            let mut own = Passed::default();
            for i in 0..units {
                let row = &numbers[first + i * columns..first + (i + 1) * columns];
                let sum = |of: &[f64]| row.iter().zip(of).map(|(weight, z)| weight * z).sum::<f64>();
                let (t, along) = (numbers[first + units * columns + i] + sum(below), sum(below_along));
                let e = (-t.abs()).exp();
                let p = 1.0 / (1.0 + e);
                let slope = if t >= 0.0 { p } else { e * p };
                own.slope.push(slope);
                own.curvature.push(e * p * p);
                own.along.push(along);
                own.value.push(t.max(0.0) + e.ln_1p());
                own.value_along.push(slope * along);
            }
            first += units * (columns + 1);
            out.push(own);
        }
        out
    }
}
