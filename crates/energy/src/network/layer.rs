use std::fmt;

use super::{CheckedNetwork, NetworkError, NetworkInput};

/// Units of a layer at most.
const MOST_UNITS: usize = 256;

/// A layer: `z = s(B z_before + A x + b)`, the last one `B z_before + A x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkLayer {
    /// A: a row per unit, a column per input; empty for zeros.
    pub through: Vec<Vec<f64>>,
    /// B: a row per unit, a column per unit of the layer before; empty in the first layer.
    pub before: Vec<Vec<f64>>,
    /// b: one per unit. That of the last layer drops out, for W(I) = 0, and may be empty.
    pub bias: Vec<f64>,
}

/// A network as it is written, not checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// x, each less its value at rest.
    pub inputs: Vec<NetworkInput>,
    /// At least one; the last has one row and no softplus.
    pub layers: Vec<NetworkLayer>,
}

/// A [`NetworkLayer`] that is written in a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExampleLayer {
    /// A.
    pub through: &'static [&'static [f64]],
    /// B.
    pub before: &'static [&'static [f64]],
    /// b.
    pub bias: &'static [f64],
}

/// Numbers of a [`NetworkLayer`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightKind {
    /// A.
    Through,
    /// B.
    Before,
    /// b.
    Bias,
}

impl fmt::Display for WeightKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            WeightKind::Through => "through",
            WeightKind::Before => "before",
            WeightKind::Bias => "bias",
        })
    }
}

/// The k-th layer among its neighbours.
#[derive(Clone, Copy)]
struct Place<'a> {
    layer: usize,
    own: &'a NetworkLayer,
    units: usize,
}

impl NetworkLayer {
    /// Its number of units: that of the longest of its lists.
    pub(super) fn units(&self) -> usize {
        self.through.len().max(self.before.len()).max(self.bias.len())
    }
}

impl From<&ExampleLayer> for NetworkLayer {
    fn from(example: &ExampleLayer) -> Self {
        let rows = |rows: &[&[f64]]| rows.iter().map(|row| row.to_vec()).collect();
        NetworkLayer { through: rows(example.through), before: rows(example.before), bias: example.bias.to_vec() }
    }
}

impl Network {
    /// Of layers that are written in a program.
    pub fn example(inputs: &[NetworkInput], layers: &[ExampleLayer]) -> Self {
        Network { inputs: inputs.to_vec(), layers: layers.iter().map(NetworkLayer::from).collect() }
    }

    /// Inputs, sizes, signs: whether its energy is polyconvex.
    ///
    /// # Errors
    /// The first entry that is wrong.
    pub fn check(&self) -> Result<(), NetworkError> {
        if self.inputs.is_empty() || self.layers.is_empty() {
            return Err(NetworkError::Empty { inputs: self.inputs.len(), layers: self.layers.len() });
        }
        self.check_inputs()?;
        let mut units_before = 0;
        for (layer, own) in self.layers.iter().enumerate() {
            let is_last = layer + 1 == self.layers.len();
            let units = if is_last { 1 } else { own.units() };
            if units > MOST_UNITS {
                return Err(NetworkError::TooWide { layer, units, most: MOST_UNITS });
            }
            let place = Place { layer, own, units };
            if !(is_last && own.bias.is_empty()) {
                place.sized(WeightKind::Bias, None, own.bias.len(), units, ONE_PER_UNIT)?;
            }
            place.check_matrix(WeightKind::Through, self.inputs.len(), layer == 0, |column| {
                self.inputs[column] == NetworkInput::Jacobian
            })?;
            place.check_matrix(WeightKind::Before, units_before, layer > 0, |_| false)?;
            if let Some((row, &value)) = own.bias.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                let entry = format!("[{row}]");
                return Err(NetworkError::NotFinite { layer, kind: WeightKind::Bias, entry, value });
            }
            units_before = units;
        }
        Ok(())
    }

    /// The shear modulus at rest of its energy, see [`CheckedNetwork::shear`]; zero of what is no convex network.
    pub fn shear(&self) -> f64 {
        CheckedNetwork::new(self).map_or(0.0, |network| network.shear())
    }

    fn check_inputs(&self) -> Result<(), NetworkError> {
        for (k, input) in self.inputs.iter().enumerate() {
            if self.inputs[..k].contains(input) {
                return Err(NetworkError::Twice { name: input.name() });
            }
            let other = self.inputs.iter().find(|other| other.is_isochoric() != input.is_isochoric());
            if let Some(other) = other {
                let [isochoric, other] = if input.is_isochoric() { [input, other] } else { [other, input] };
                return Err(NetworkError::Mixed { isochoric: isochoric.name(), other: other.name() });
            }
        }
        Ok(())
    }
}

const ONE_PER_UNIT: &str = "one for each unit of the layer (one of the last)";

impl Place<'_> {
    fn sized(
        self,
        kind: WeightKind,
        row: Option<usize>,
        found: usize,
        expected: usize,
        why: &'static str,
    ) -> Result<(), NetworkError> {
        if found == expected {
            return Ok(());
        }
        let entry = row.map_or(String::new(), |row| format!("[{row}]"));
        Err(NetworkError::Size { layer: self.layer, kind, entry, found, expected, why })
    }

    /// Rows, columns and signs; what is not needed may be empty.
    fn check_matrix(
        self,
        kind: WeightKind,
        columns: usize,
        needed: bool,
        any_sign: impl Fn(usize) -> bool,
    ) -> Result<(), NetworkError> {
        let (rows, why) = match kind {
            WeightKind::Before => (&self.own.before, "one for each unit of the layer before"),
            _ => (&self.own.through, "one for each input"),
        };
        if rows.is_empty() && !needed {
            return Ok(());
        }
        self.sized(kind, None, rows.len(), if columns == 0 { 0 } else { self.units }, ONE_PER_UNIT)?;
        for (row, weights) in rows.iter().enumerate() {
            self.sized(kind, Some(row), weights.len(), columns, why)?;
            for (column, &value) in weights.iter().enumerate() {
                let layer = self.layer;
                if !value.is_finite() {
                    let entry = format!("[{row}][{column}]");
                    return Err(NetworkError::NotFinite { layer, kind, entry, value });
                }
                if value < 0.0 && !any_sign(column) {
                    return Err(NetworkError::Negative { layer, kind, row, column, value });
                }
            }
        }
        Ok(())
    }
}
