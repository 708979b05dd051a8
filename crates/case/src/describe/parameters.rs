//! Constants of laws in words.

use nastic_energy::catalogue;
use nastic_energy::catalogue::Takes;
use nastic_language::expression::dimension_of;
use nastic_language::number::{quantity, vector};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::{Input, Parameter, VectorField};
use std::collections::BTreeMap;

/// The parameters of all forms by name.
pub fn catalogue_of(forms: &'static [&'static [catalogue::Parameter]]) -> BTreeMap<&'static str, Dimension> {
    let dimension = |p: &catalogue::Parameter| match p.takes {
        Takes::Number { unit, .. } => dimension_of(unit).unwrap_or(Dimension::NONE),
        _ => Dimension::NONE,
    };
    forms.iter().copied().flatten().map(|p| (p.name, dimension(p))).collect()
}

/// Parameters with their values and units.
pub fn parameters(
    inputs: &BTreeMap<&'static str, Input>,
    dimensions: &BTreeMap<&'static str, Dimension>,
    units: &Units,
) -> String {
    let of = |(name, input): (&&'static str, &Input)| {
        let value = match input {
            Input::Number(value) => scalar(value, dimensions.get(name).copied().unwrap_or(Dimension::NONE), units),
            Input::Direction(value) => vector_field(value),
            Input::Word(word) => (*word).to_owned(),
            Input::Energy(_) | Input::Numbers(_) | Input::Modes(_) | Input::Network(_) => input.to_string(),
        };
        format!("{name} {value}")
    };
    inputs.iter().map(of).collect::<Vec<_>>().join(", ")
}

/// The value of a scalar field.
pub fn scalar(value: &Parameter, dimension: Dimension, units: &Units) -> String {
    match value {
        Parameter::Formula(formula) => match formula.constant() {
            Some(value) => quantity(value, dimension, units),
            None => format!("\"{}\"", formula.text()),
        },
        Parameter::Array(file) => format!("array {} of {}", file.array, file.file),
        Parameter::Cells(_) => "by cell".to_owned(),
    }
}

/// The value of a vector field.
pub fn vector_field(value: &VectorField) -> String {
    match (value.constant(), value) {
        (Some(constant), _) => vector(&constant),
        (None, VectorField::Formulas(entries)) => {
            let texts: Vec<String> = entries.iter().map(|entry| format!("\"{}\"", entry.text())).collect();
            format!("({})", texts.join(", "))
        }
        (None, VectorField::Array(file)) => format!("array {} of {}", file.array, file.file),
    }
}
