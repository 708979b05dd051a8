//! Parameters of laws at points.

use super::context::Context;
use super::field::SamplePoints;
use nastic_energy::ShapeMode;
use nastic_energy::catalogue::Inputs;
use nastic_energy::network::Network;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Input, NetworkFile, NetworkSource};
use nastic_language::syntax::{At, Document};
use std::collections::BTreeMap;

/// The parameters of a law or actuation, sampled.
pub(super) fn inputs(
    parameters: &BTreeMap<&'static str, Input>,
    at: &At,
    points: &SamplePoints<'_>,
    context: &mut Context<'_>,
) -> Option<Inputs> {
    let mut out = Some(Inputs::new());
    for (name, input) in parameters {
        let at = at.key(name);
        // One that fails does not keep the others from being looked at.
        let with = match input {
            Input::Number(value) => {
                points.number(value, &at, context).map(|field| out.clone().map(|i| i.number(name, field)))
            }
            Input::Direction(value) => {
                points.direction(value, &at, context).map(|field| out.clone().map(|i| i.direction(name, field)))
            }
            Input::Word(word) => Some(out.clone().map(|i| i.choice(name, word))),
            Input::Energy(formula) => Some(out.clone().map(|i| i.energy(name, formula.expression().clone()))),
            Input::Numbers(values) => {
                let fields: Vec<_> = values
                    .iter()
                    .map(|(key, value)| Some((key.clone(), points.number(value, &at.key(key), context)?)))
                    .collect();
                let fields: Option<BTreeMap<_, _>> = fields.into_iter().collect();
                fields.map(|fields| out.clone().map(|i| i.numbers(name, fields)))
            }
            Input::Network(NetworkSource::Written(block)) => {
                Some(out.clone().map(|i| i.network(name, block.network())))
            }
            Input::Network(NetworkSource::File(file)) => from_file(file, &at, context).map(|(network, scale)| {
                // one beside it replaces that of the file
                let has_scale = parameters.contains_key(SCALE);
                out.clone()
                    .map(|i| i.network(name, network))
                    .map(|i| if has_scale { i } else { i.number(SCALE, scale) })
            }),
            Input::Modes(fields) => {
                let modes: Vec<_> =
                    fields.iter().map(|(key, field)| points.mode(key, field, &at.key(key), context)).collect();
                let modes: Option<Vec<ShapeMode>> = modes.into_iter().collect();
                modes.map(|modes| out.clone().map(|i| i.modes(name, modes)))
            }
        };
        out = with.flatten();
    }
    out
}

/// Key of the factor of a network.
const SCALE: &str = "scale";

/// The network of a file, and its scale in the case's units.
fn from_file(name: &str, at: &At, context: &mut Context<'_>) -> Option<(Network, f64)> {
    let path = context.file(name);
    let read = Document::open(&path).and_then(|document| NetworkFile::read_document(&document));
    match read {
        Ok(file) => {
            let (network, scale) = file.network();
            Some((network, context.units.in_case(scale, Dimension::PRESSURE)))
        }
        Err(problems) => {
            for problem in problems.list() {
                context.complain(at, format!("{}: {}", problem.place(), problem.message));
            }
            None
        }
    }
}
