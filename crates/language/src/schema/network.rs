//! Convex neural networks in a case.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Value};
use nastic_energy::network::{Network, NetworkInput, NetworkLayer};
use serde_json::{Value as Json, json};
use std::fmt;

object! {
    /// A convex neural network of invariants: N = B z + A x of the last layer, z = softplus(B z_before + A x + b) of those before.
    pub struct NetworkBlock checked by check_block {
        /// Its inputs x, each less its value at rest: I1b, I2b^1.5, with a fibre I4b, I5b^1.5; or I1, I2, J, with a fibre I4, I5.
        pub inputs: Vec<InputName>,
        /// The layers, the last of one unit.
        pub layers: Vec<LayerBlock>,
    }
}

object! {
    /// A layer; weights are not negative, but those of J.
    pub struct LayerBlock {
        /// A: for each unit a list with a weight per input; zero if left out.
        pub through: Vec<Vec<f64>> as NUMBER = vec![],
        /// B: for each unit a list with a weight per unit of the layer before; none of the first layer.
        pub before: Vec<Vec<f64>> as NUMBER = vec![],
        /// b: one per unit; that of the last layer drops out, for the energy vanishes at rest.
        pub bias: Vec<f64> as NUMBER = vec![],
    }
}

/// An input by its name.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InputName(pub NetworkInput);

impl Read for InputName {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let name = reader.word(node, at, "input", &NetworkInput::ALL.map(NetworkInput::name))?;
        NetworkInput::ALL.into_iter().find(|input| input.name() == name).map(InputName)
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        json!({ "enum": NetworkInput::ALL.map(NetworkInput::name) })
    }
}

/// Where the network of a law stands.
#[derive(Clone, PartialEq, Debug)]
pub enum NetworkSource {
    /// In a file, relative to the case.
    File(String),
    /// In the case.
    Written(NetworkBlock),
}

/// `weights.json`, or `I1b, I2b^1.5 through 4, 4 units`.
impl fmt::Display for NetworkSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(name) => f.write_str(name),
            Self::Written(block) => {
                let inputs: Vec<&str> = block.inputs.iter().map(|input| input.0.name()).collect();
                let hidden = &block.layers[..block.layers.len().saturating_sub(1)];
                let units: Vec<String> = hidden.iter().map(|layer| layer.bias.len().to_string()).collect();
                match units.is_empty() {
                    true => write!(f, "linear in {}", inputs.join(", ")),
                    false => write!(f, "{} through {} units", inputs.join(", "), units.join(", ")),
                }
            }
        }
    }
}

impl Read for NetworkSource {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Object(_) => NetworkBlock::read(node, at, want, reader).map(Self::Written),
            Value::Text(_) => String::read(node, at, want, reader).map(Self::File),
            _ => {
                reader.expected(node, at, "a network { \"inputs\": .., \"layers\": .. } or the name of its file");
                None
            }
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![String::schema(want, definitions), NetworkBlock::schema(want, definitions)])
    }
}

impl NetworkBlock {
    /// The same for the law.
    #[must_use]
    pub fn network(&self) -> Network {
        network(&self.inputs, &self.layers)
    }
}

/// A network as a case has it, its numbers with ten digits.
#[must_use]
pub fn network_json(network: &Network) -> Json {
    let rounded = |value: &f64| format!("{value:.9e}").parse::<f64>().unwrap_or(*value);
    let row = |row: &Vec<f64>| Json::from(row.iter().map(rounded).collect::<Vec<_>>());
    let layer = |layer: &NetworkLayer| {
        let rows = |rows: &[Vec<f64>]| Json::from(rows.iter().map(row).collect::<Vec<_>>());
        let all = [("through", rows(&layer.through)), ("before", rows(&layer.before)), ("bias", row(&layer.bias))];
        let given = all.into_iter().filter(|(_, rows)| rows.as_array().is_some_and(|rows| !rows.is_empty()));
        Json::Object(given.map(|(key, rows)| (key.to_owned(), rows)).collect())
    };
    let inputs: Vec<&str> = network.inputs.iter().map(|input| input.name()).collect();
    json!({ "inputs": inputs, "layers": network.layers.iter().map(layer).collect::<Vec<_>>() })
}

/// The same for the law.
pub(crate) fn network(inputs: &[InputName], layers: &[LayerBlock]) -> Network {
    let layer = |own: &LayerBlock| NetworkLayer {
        through: own.through.clone(),
        before: own.before.clone(),
        bias: own.bias.clone(),
    };
    Network { inputs: inputs.iter().map(|input| input.0).collect(), layers: layers.iter().map(layer).collect() }
}

fn check_block(block: &NetworkBlock, reader: &mut Reader<'_>) {
    check(&block.at, &block.network(), reader);
}

/// What is wrong with a network is said where it stands.
pub(crate) fn check(at: &At, network: &Network, reader: &mut Reader<'_>) {
    if let Err(error) = network.check() {
        reader.complain_at(&error.path().iter().fold(at.clone(), |at, key| at.key(key)), error.to_string());
    }
}

/// A material whose network stands in the case has its scale there too.
pub(crate) fn check_scale(network: &NetworkSource, has_scale: bool, node: &Node, at: &At, reader: &mut Reader<'_>) {
    if matches!(network, NetworkSource::Written(_)) && !has_scale {
        reader.complain(node, at, "missing key \"scale\": the factor of a network that stands in the case, a pressure");
    }
}
