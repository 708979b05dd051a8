//! Constants of laws as results have them.

use nastic_case::describe::{catalogue_of, scalar, vector_field};
use nastic_case::lower::CaseProblem;
use nastic_energy::catalogue;
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::Input;
use nastic_mesh::GroupNames;
use nastic_report::record::{ConstantRecord, LawRecord, NamesRecord};
use std::collections::BTreeMap;

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
        Input::Energy(_) | Input::Numbers(_) | Input::Modes(_) | Input::Network(_) => {
            ConstantRecord::Word(input.to_string())
        }
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
