//! Constants of laws in words and for programs.

use nastic_case::lower::CaseProblem;
use nastic_energy::catalogue;
use nastic_energy::catalogue::Takes;
use nastic_language::expression::dimension_of;
use nastic_language::number::{quantity, vector};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::{Input, Parameter, VectorField};
use nastic_mesh::GroupNames;
use nastic_report::record::{ConstantRecord, LawRecord, NamesRecord};
use std::collections::BTreeMap;

/// The parameters of all forms by name.
pub(crate) fn catalogue_of(forms: &'static [&'static [catalogue::Parameter]]) -> BTreeMap<&'static str, Dimension> {
    let dimension = |p: &catalogue::Parameter| match p.takes {
        Takes::Number { unit, .. } => dimension_of(unit).unwrap_or(Dimension::NONE),
        _ => Dimension::NONE,
    };
    forms.iter().copied().flatten().map(|p| (p.name, dimension(p))).collect()
}

pub(crate) fn parameters(
    inputs: &BTreeMap<&'static str, Input>,
    dimensions: &BTreeMap<&'static str, Dimension>,
    units: &Units,
) -> String {
    let of = |(name, input): (&&'static str, &Input)| {
        let value = match input {
            Input::Number(value) => scalar(value, dimensions.get(name).copied().unwrap_or(Dimension::NONE), units),
            Input::Direction(value) => vector_field(value),
            Input::Word(word) => (*word).to_owned(),
            Input::Energy(_) | Input::Numbers(_) => input.to_string(),
        };
        format!("{name} {value}")
    };
    inputs.iter().map(of).collect::<Vec<_>>().join(", ")
}

pub(crate) fn scalar(value: &Parameter, dimension: Dimension, units: &Units) -> String {
    match value {
        Parameter::Formula(formula) => match formula.constant() {
            Some(value) => quantity(value, dimension, units),
            None => format!("\"{}\"", formula.text()),
        },
        Parameter::Array(file) => format!("array {} of {}", file.array, file.file),
        Parameter::Cells(_) => "by cell".to_owned(),
    }
}

pub(crate) fn vector_field(value: &VectorField) -> String {
    match (value.constant(), value) {
        (Some(constant), _) => vector(&constant),
        (None, VectorField::Formulas(entries)) => {
            let texts: Vec<String> = entries.iter().map(|entry| format!("\"{}\"", entry.text())).collect();
            format!("({})", texts.join(", "))
        }
        (None, VectorField::Array(file)) => format!("array {} of {}", file.array, file.file),
    }
}

/// A law with its constants in the case's units and in SI.
pub(crate) fn law(
    problem: &CaseProblem,
    region: &GroupNames,
    name: &str,
    inputs: &BTreeMap<&'static str, Input>,
    forms: &'static [&'static [catalogue::Parameter]],
) -> LawRecord {
    let (dimensions, units) = (catalogue_of(forms), problem.units());
    let of = |(name, input): (&&'static str, &Input)| {
        let dimension = dimensions.get(name).copied().unwrap_or(Dimension::NONE);
        ((*name).to_owned(), constant(input, dimension, units))
    };
    LawRecord {
        region: Some(names(region)),
        law: Some(name.to_owned()),
        parameters: Some(inputs.iter().map(of).collect()),
        ..LawRecord::default()
    }
}

fn constant(input: &Input, dimension: Dimension, units: &Units) -> ConstantRecord {
    match input {
        Input::Number(value) => match value.constant() {
            Some(constant) => ConstantRecord::Quantity {
                value: constant,
                unit: units.label(dimension),
                si: units.in_si(constant, dimension),
            },
            None => ConstantRecord::Varies { varies: scalar(value, dimension, units) },
        },
        Input::Direction(value) => match value.constant() {
            Some(constant) => ConstantRecord::Vector(constant),
            None => ConstantRecord::Varies { varies: vector_field(value) },
        },
        Input::Word(word) => ConstantRecord::Word((*word).to_owned()),
        Input::Energy(_) | Input::Numbers(_) => ConstantRecord::Word(input.to_string()),
    }
}

/// A name, or a list of several.
pub(crate) fn names(names: &GroupNames) -> NamesRecord {
    let list: Vec<&str> = names.iter().collect();
    match list.as_slice() {
        [one] => NamesRecord::One((*one).to_owned()),
        several => NamesRecord::Several(several.iter().map(ToString::to_string).collect()),
    }
}
