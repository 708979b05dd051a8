use nastic_tensor::Scalar;

use super::activation::{logistic, slope, softplus};
use super::{Network, NetworkError, NetworkInput};
use crate::formula::Number;

/// Inputs at most: those of a compressible network with a fibre.
pub const MOST_INPUTS: usize = 5;
/// Pairs of inputs at most.
pub const PAIRS: usize = MOST_INPUTS * (MOST_INPUTS + 1) / 2;

/// The place of a pair of inputs, `a >= b`, among all pairs.
#[inline]
pub const fn pair(a: usize, b: usize) -> usize {
    a * (a + 1) / 2 + b
}

/// A layer with its weights row by row.
#[derive(Clone, Debug)]
struct Rows {
    units: usize,
    before: usize,
    through: Vec<f64>,
    weights: Vec<f64>,
    bias: Vec<f64>,
}

/// A network N that was checked, with what makes it free of stress along its fibre at rest.
#[derive(Clone, Debug)]
pub struct CheckedNetwork {
    /// With the one that makes it free of stress.
    pub(crate) inputs: Vec<NetworkInput>,
    layers: Vec<Rows>,
    /// N at rest, and its derivatives there.
    rest: f64,
    pub(crate) slopes_at_rest: [f64; MOST_INPUTS],
}

/// A unit's argument or value with its first derivatives, and in numbers the second.
#[derive(Clone, Copy)]
struct Unit<T> {
    value: T,
    slope: [T; MOST_INPUTS],
}

#[derive(Clone, Copy)]
struct Curved {
    value: f64,
    slope: [f64; MOST_INPUTS],
    curvature: [f64; PAIRS],
}

impl CheckedNetwork {
    /// # Errors
    /// The entry that keeps the network from being convex.
    pub fn new(network: &Network) -> Result<Self, NetworkError> {
        network.check()?;
        let layers: Vec<Rows> = network.layers.iter().enumerate().map(|(k, _)| rows(network, k)).collect();
        let inputs = network.inputs.clone();
        let mut own = CheckedNetwork { inputs, layers, rest: 0.0, slopes_at_rest: [0.0; MOST_INPUTS] };
        own.slopes_at_rest = own.gradient([0.0; MOST_INPUTS]).1;
        own.balance();
        let (rest, slopes) = own.gradient([0.0; MOST_INPUTS]);
        (own.rest, own.slopes_at_rest) = (rest, slopes);
        Ok(own)
    }

    /// Adds a multiple, not negative, of the input whose stress along the fibre at rest is opposite.
    fn balance(&mut self) {
        let along = |own: &Self| -> f64 {
            own.inputs.iter().zip(own.slopes_at_rest).map(|(input, slope)| slope * input.at_rest()[1]).sum()
        };
        let sum = along(self);
        let pulls = |input: &NetworkInput| input.at_rest()[1] * sum > 0.0;
        let Some(missing) = self.inputs.iter().copied().find(pulls).and_then(NetworkInput::opposite) else { return };
        let column = self.inputs.iter().position(|input| *input == missing).unwrap_or_else(|| self.widen(missing));
        if let Some(last) = self.layers.last_mut() {
            last.through[column] -= sum / missing.at_rest()[1];
        }
    }

    /// Another input, of weights zero.
    fn widen(&mut self, input: NetworkInput) -> usize {
        let old = self.inputs.len();
        self.inputs.push(input);
        for layer in &mut self.layers {
            layer.through = layer.through.chunks(old).flat_map(|row| row.iter().copied().chain([0.0])).collect();
        }
        old
    }

    /// The shear modulus at rest of the energy N, without what a fibre adds: `2 N_1 + 3 sqrt(3) N_2` of the isochoric inputs, `2 N_1 + 2 N_2` of the others.
    pub fn shear(&self) -> f64 {
        let of = |input: NetworkInput| match input {
            NetworkInput::FirstIsochoric | NetworkInput::First | NetworkInput::Second => 2.0,
            NetworkInput::SecondIsochoric => 27f64.sqrt(),
            _ => 0.0,
        };
        self.inputs.iter().zip(self.slopes_at_rest).map(|(input, slope)| of(*input) * slope).sum()
    }

    /// The weight with which an input enters the last layer.
    pub(crate) fn linear_in(&self, input: NetworkInput) -> f64 {
        let column = self.inputs.iter().position(|own| *own == input);
        column.zip(self.layers.last()).map_or(0.0, |(column, last)| last.through[column])
    }

    /// Whether N grows without bound with an input.
    pub(crate) fn grows_in(&self, input: NetworkInput) -> bool {
        let Some(column) = self.inputs.iter().position(|own| *own == input) else { return false };
        let mut before: Vec<bool> = Vec::new();
        for layer in &self.layers {
            let unit = |row: usize| {
                let own = layer.through[row * self.inputs.len() + column] > 0.0;
                let weights = &layer.weights[row * layer.before..(row + 1) * layer.before];
                own || weights.iter().zip(&before).any(|(weight, grows)| *weight > 0.0 && *grows)
            };
            before = (0..layer.units).map(unit).collect();
        }
        before.contains(&true)
    }

    /// `N(x) - N(0)`.
    pub(crate) fn value(&self, x: [f64; MOST_INPUTS]) -> f64 {
        self.gradient(x).0 - self.rest
    }

    /// `N`, not less its value at rest, and `dN/dx_a`, at inputs less their values at rest.
    pub fn gradient<T: Number + Scalar>(&self, x: [T; MOST_INPUTS]) -> (T, [T; MOST_INPUTS]) {
        let mut before: Vec<Unit<T>> = Vec::new();
        for (k, layer) in self.layers.iter().enumerate() {
            let is_last = k + 1 == self.layers.len();
            let unit = |row: usize| {
                let mut t = self.argument(layer, row, &x, &before);
                if !is_last {
                    let first = slope(t.value);
                    t.value = softplus(t.value);
                    t.slope.iter_mut().take(self.inputs.len()).for_each(|by| *by = first * *by);
                }
                t
            };
            before = (0..layer.units).map(unit).collect();
        }
        before.first().map_or((T::of(0.0), [T::of(0.0); MOST_INPUTS]), |last| (last.value, last.slope))
    }

    fn argument<T: Number + Scalar>(
        &self,
        layer: &Rows,
        row: usize,
        x: &[T; MOST_INPUTS],
        before: &[Unit<T>],
    ) -> Unit<T> {
        let n = self.inputs.len();
        let mut t = Unit { value: T::of(layer.bias[row]), slope: [T::of(0.0); MOST_INPUTS] };
        for (a, weight) in layer.through[row * n..(row + 1) * n].iter().enumerate() {
            t.value = t.value + T::of(*weight) * x[a];
            t.slope[a] = T::of(*weight);
        }
        for (z, weight) in before.iter().zip(&layer.weights[row * layer.before..]) {
            let weight = T::of(*weight);
            t.value = t.value + weight * z.value;
            t.slope.iter_mut().zip(z.slope).take(n).for_each(|(by, z)| *by = *by + weight * z);
        }
        t
    }

    /// `dN/dx_a`, and `d2N/dx_a dx_b` at the place of the [`pair`].
    pub(crate) fn curvature(&self, x: [f64; MOST_INPUTS]) -> ([f64; MOST_INPUTS], [f64; PAIRS]) {
        let n = self.inputs.len();
        let mut before: Vec<Curved> = Vec::new();
        for (k, layer) in self.layers.iter().enumerate() {
            let (is_last, is_next_to_last) = (k + 1 == self.layers.len(), k + 2 == self.layers.len());
            let unit = |row: usize| {
                let mut t = curved(layer, row, n, &x, &before);
                if !is_last {
                    let [first, second] = logistic(t.value);
                    for a in 0..n {
                        for b in 0..=a {
                            let own = &mut t.curvature[pair(a, b)];
                            *own = first * *own + second * t.slope[a] * t.slope[b];
                        }
                    }
                    t.slope.iter_mut().take(n).for_each(|by| *by *= first);
                    // nobody asks for the value of the last layer
                    t.value = if is_next_to_last { 0.0 } else { softplus(t.value) };
                }
                t
            };
            before = (0..layer.units).map(unit).collect();
        }
        before.first().map_or(([0.0; MOST_INPUTS], [0.0; PAIRS]), |last| (last.slope, last.curvature))
    }
}

#[inline]
fn curved(layer: &Rows, row: usize, n: usize, x: &[f64; MOST_INPUTS], before: &[Curved]) -> Curved {
    let mut t = Curved { value: layer.bias[row], slope: [0.0; MOST_INPUTS], curvature: [0.0; PAIRS] };
    for (a, weight) in layer.through[row * n..(row + 1) * n].iter().enumerate() {
        t.value += weight * x[a];
        t.slope[a] = *weight;
    }
    let pairs = pair(n, 0);
    for (z, weight) in before.iter().zip(&layer.weights[row * layer.before..]) {
        t.value += weight * z.value;
        t.slope.iter_mut().zip(z.slope).take(n).for_each(|(by, z)| *by += weight * z);
        t.curvature.iter_mut().zip(z.curvature).take(pairs).for_each(|(by, z)| *by += weight * z);
    }
    t
}

fn rows(network: &Network, k: usize) -> Rows {
    let (own, inputs) = (&network.layers[k], network.inputs.len());
    let is_last = k + 1 == network.layers.len();
    let units = if is_last { 1 } else { own.units() };
    let before = if k == 0 { 0 } else { network.layers[k - 1].units() };
    let flat = |rows: &[Vec<f64>], columns: usize| match rows.is_empty() {
        true => vec![0.0; units * columns],
        false => rows.iter().flat_map(|row| row.iter().copied()).collect(),
    };
    // the bias of the last layer drops out
    let bias = if is_last { vec![0.0] } else { own.bias.clone() };
    Rows { units, before, through: flat(&own.through, inputs), weights: flat(&own.before, before), bias }
}
