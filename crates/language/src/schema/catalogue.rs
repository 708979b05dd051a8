//! Blocks whose keys come from the catalogue of laws and actuations: a new row there is a new name here.

use crate::expression::{EnergyFormula, Formula, dimension_of};
use crate::quantity::Want;
use crate::schema::direction;
use crate::schema::field::{Parameter, VectorField, check_unit};
use crate::schema::json::{Definitions, annotated, any_of};
use crate::schema::network::{NetworkSource, check_scale};
use crate::schema::read::{Key, Read, Reader};
use crate::schema::time_table::TimeTable;
use crate::syntax::{At, Node, Property, Value};
use nastic_energy::SlotGroup;
use nastic_energy::catalogue::{self, ActuationRow, Takes, distinct};
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;
use std::fmt;

/// A parameter of a law or actuation, as its catalogue row takes it.
#[derive(Clone, PartialEq, Debug)]
pub enum Input {
    /// A number, which may vary over the body.
    Number(Parameter),
    /// A unit vector of the reference body.
    Direction(VectorField),
    /// One of a few words.
    Word(&'static str),
    /// An energy as a formula.
    Energy(EnergyFormula),
    /// Numbers by names of the user's, which may vary over the body.
    Numbers(BTreeMap<String, Parameter>),
    /// A convex neural network.
    Network(NetworkSource),
    /// Displacement fields of the body by names of the user's.
    Modes(BTreeMap<String, VectorField>),
}

impl Input {
    /// The number, if it is one.
    #[must_use]
    pub fn number(&self) -> Option<&Parameter> {
        if let Self::Number(value) = self { Some(value) } else { None }
    }

    /// The number of this name among several, if there is one.
    #[must_use]
    pub fn number_named(&self, name: &str) -> Option<&Parameter> {
        if let Self::Numbers(values) = self { values.get(name) } else { None }
    }

    /// The direction, if it is one.
    #[must_use]
    pub fn direction(&self) -> Option<&VectorField> {
        if let Self::Direction(value) = self { Some(value) } else { None }
    }
}

/// As written.
impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Direction(field) => f.write_str(&shown(field)),
            Self::Modes(fields) => {
                let texts: Vec<String> =
                    fields.iter().map(|(name, field)| format!("{name} = {}", shown(field))).collect();
                f.write_str(&texts.join(", "))
            }
            Self::Word(word) => f.write_str(word),
            Self::Network(network) => write!(f, "{network}"),
            Self::Energy(formula) => write!(f, "{formula}"),
            Self::Numbers(values) => {
                let texts: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
                f.write_str(&texts.join(", "))
            }
        }
    }
}

fn shown(field: &VectorField) -> String {
    match field {
        VectorField::Formulas(entries) => {
            let texts: Vec<&str> = entries.iter().map(Formula::text).collect();
            format!("({})", texts.join(", "))
        }
        VectorField::Array(file) => format!("array {} of {}", file.array, file.file),
    }
}

/// Sets of parameters, one of which a row takes.
pub(crate) type Forms = &'static [&'static [catalogue::Parameter]];

/// What of an actuation a control may set, or a fixed value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SlotName {
    /// Its key in the block.
    pub key: &'static str,
    pub(crate) want: Want,
    pub(crate) vector: bool,
    pub(crate) not_negative: bool,
}

/// The control slots of an actuation; the components of a vector are one. None of what has them by names of the user's.
pub(crate) fn slots(row: &ActuationRow) -> Vec<SlotName> {
    if row.parameters().iter().any(|key| matches!(key.takes, Takes::Modes { .. })) {
        return vec![];
    }
    let Some(example) = row.examples().into_iter().next().and_then(|inputs| row.build(&inputs).ok()) else {
        return vec![];
    };
    slot_names(example.slots())
}

/// Slots by name; the components of a vector are one.
pub(crate) fn slot_names(slots: &[nastic_energy::Slot]) -> Vec<SlotName> {
    let name = |group: SlotGroup| SlotName {
        key: group.name,
        want: want(group.unit),
        vector: group.is_vector(),
        not_negative: group.not_negative,
    };
    SlotGroup::of(slots).into_iter().map(name).collect()
}

/// The parameters of a block, of exactly one form.
pub(crate) fn read_inputs(
    owner: &str,
    forms: Forms,
    node: &Node,
    at: &At,
    reader: &mut Reader<'_>,
) -> Option<BTreeMap<&'static str, Input>> {
    let members = reader.members(node, at)?;
    let fits = check_form(owner, forms, node, members, at, reader);
    let mut out = BTreeMap::new();
    for parameter in distinct(forms) {
        let Some(member) = members.iter().find(|member| member.key == parameter.name) else { continue };
        let at = at.key(parameter.name);
        let input = match parameter.takes {
            Takes::Energy { .. } => read_energy(&member.node, &at, forms, members, reader),
            _ => read_input(parameter, &member.node, &at, reader),
        };
        if let Some(Input::Network(network)) = &input {
            check_scale(network, members.iter().any(|member| member.key == "scale"), node, &at.parent(), reader);
        }
        if let Some(input) = input {
            out.insert(parameter.name, input);
        }
    }
    fits.then_some(out)
}

fn read_input(parameter: &catalogue::Parameter, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Input> {
    match parameter.takes {
        Takes::Number { unit, .. } => Parameter::read(node, at, want(unit), reader).map(Input::Number),
        Takes::Choice { of } => reader.word(node, at, parameter.name, of).map(Input::Word),
        Takes::Direction { .. } => {
            let direction = direction::read_field(node, at, reader)?;
            check_unit(&direction, at, reader);
            Some(Input::Direction(direction))
        }
        Takes::Numbers { .. } => {
            let mut out = BTreeMap::new();
            for member in reader.members(node, at)? {
                if let Some(why) = EnergyFormula::refuses_name(&member.key) {
                    reader.complain(&member.node, &at.key(&member.key), why);
                } else if let Some(value) = Parameter::read(&member.node, &at.key(&member.key), Want::ANY, reader) {
                    out.insert(member.key.clone(), value);
                }
            }
            Some(Input::Numbers(out))
        }
        Takes::Network { .. } => NetworkSource::read(node, at, Want::ANY, reader).map(Input::Network),
        Takes::Modes { .. } => read_modes(node, at, reader).map(Input::Modes),
        // read_energy
        Takes::Energy { .. } => None,
    }
}

/// Fields by names, of which there is one at least.
fn read_modes(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<BTreeMap<String, VectorField>> {
    let members = reader.members(node, at)?;
    if members.is_empty() {
        reader.complain(node, at, "at least one field is needed, as \"thickness\": [0, 0, \"Z / 10 mm\"]");
        return None;
    }
    let mut out = BTreeMap::new();
    for member in members {
        let at = at.key(&member.key);
        if member.key.is_empty() {
            reader.complain(&member.node, &at, "a field needs a name, that of its amplitude");
        }
        out.insert(member.key.clone(), VectorField::read(&member.node, &at, Want::NUMBER, reader)?);
    }
    Some(out)
}

/// An energy, whose names are those of the numbers that stand beside it.
fn read_energy(node: &Node, at: &At, forms: Forms, members: &[Property], reader: &mut Reader<'_>) -> Option<Input> {
    let Value::Text(text) = &node.value else {
        reader.expected(node, at, "a text with a formula, as \"mu / 2 * (I1 - 3 - 2 * log(J))\",");
        return None;
    };
    let numbers = distinct(forms).into_iter().find(|key| matches!(key.takes, Takes::Numbers { .. }));
    let beside = numbers.and_then(|key| members.iter().find(|member| member.key == key.name));
    let named: &[Property] = match beside.map(|member| &member.node.value) {
        Some(Value::Object(named)) => named,
        _ => &[],
    };
    // what is wrong with one of them is said where it stands
    let formulas: Vec<(&str, Option<Formula>)> = named
        .iter()
        .map(|member| match &member.node.value {
            Value::Text(text) => (member.key.as_str(), Formula::parse(text, &reader.units).ok()),
            _ => (member.key.as_str(), None),
        })
        .collect();
    let parameters: Vec<(&str, Option<&Formula>)> = formulas.iter().map(|(name, f)| (*name, f.as_ref())).collect();
    match EnergyFormula::parse(text, &reader.units, &parameters) {
        Ok(formula) => Some(Input::Energy(formula)),
        Err(error) => {
            reader.complain(node, at, error.to_string());
            None
        }
    }
}

/// True if all keys belong to one form and none of its own is missing.
fn check_form(owner: &str, forms: Forms, node: &Node, members: &[Property], at: &At, reader: &mut Reader<'_>) -> bool {
    let has = |name: &str| members.iter().any(|member| member.key == name);
    let given: Vec<&str> = distinct(forms).iter().map(|p| p.name).filter(|name| has(name)).collect();
    let missing = |form: &[catalogue::Parameter]| -> Vec<&str> {
        form.iter().filter(|p| !p.optional && !has(p.name)).map(|p| p.name).collect()
    };
    let strange =
        |form: &[catalogue::Parameter]| given.iter().filter(|name| !form.iter().any(|p| p.name == **name)).count();
    // The form that was meant shares the most keys and lacks the fewest.
    let Some(best) = forms.iter().min_by_key(|form| (strange(form), missing(form).len())) else { return true };
    let lacking = missing(best);
    let described = catalogue::describe(forms);
    if strange(best) > 0 {
        let found = given.join(", ");
        reader.complain(node, at, format!("\"{owner}\" takes {described}, found {{{found}}}"));
    } else if !lacking.is_empty() {
        let lacking = lacking.join("\", \"");
        reader.complain(node, at, format!("missing key \"{lacking}\": \"{owner}\" takes {described}"));
    }
    strange(best) == 0 && lacking.is_empty()
}

/// What a value in this unit of the catalogue demands of a case.
pub(crate) fn want(unit: &str) -> Want {
    dimension_of(unit).map_or(Want::ANY, Want::a)
}

const ENERGY: &str = "Energy per reference volume as a formula of the invariants I1, I2, J, of I1b, I2b (isochoric) and, with a fibre, of I4, I4b, E_ff, with \
                      the parameters by name: \"mu / 2 * (I1 - 3 - 2 * log(J)) + k / 2 * (J - 1)^2\".";
const MODES: &str = "Displacement fields by names, pure numbers: along each the body's nodes move by its amplitude, the control \"NAME.MODE\", a length.";
const NETWORK: &str = "A convex neural network of invariants, or the name of its JSON file, relative to the case.";
const NUMBERS: &str = "The parameters that the energy names.";

/// The block with these fixed keys and one form's parameters.
pub(crate) fn form_schema(
    about: &str,
    mut keys: Vec<Key>,
    form: &'static [catalogue::Parameter],
    definitions: &mut Definitions,
) -> Json {
    for parameter in form {
        let schema = match parameter.takes {
            Takes::Number { unit, .. } => {
                let about = if matches!(unit, "" | "1") { "A number.".to_owned() } else { format!("In {unit}.") };
                annotated(Parameter::schema(want(unit), definitions), &about, None)
            }
            Takes::Direction { .. } => direction::field_schema(definitions),
            Takes::Choice { of } => json!({ "enum": of, "default": of.first() }),
            Takes::Energy { .. } => json!({ "type": "string", "description": ENERGY }),
            Takes::Numbers { .. } => {
                annotated(BTreeMap::<String, Parameter>::schema(Want::ANY, definitions), NUMBERS, None)
            }
            Takes::Network { .. } => annotated(NetworkSource::schema(Want::ANY, definitions), NETWORK, None),
            Takes::Modes { .. } => {
                annotated(BTreeMap::<String, VectorField>::schema(Want::NUMBER, definitions), MODES, None)
            }
        };
        keys.push(Key::as_is(parameter.name, !parameter.optional, schema));
    }
    row_schema(about, keys)
}

/// The block of a row with these keys.
pub(crate) fn row_schema(about: &str, keys: Vec<Key>) -> Json {
    let required: Vec<&str> = keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    let properties: Map<String, Json> = keys.into_iter().map(|key| (key.name.to_owned(), key.described())).collect();
    json!({
        "type": "object",
        "description": about,
        "required": required,
        "properties": properties,
        "additionalProperties": false,
    })
}

/// The schema of a slot's fixed value.
pub(crate) fn slot_schema(slot: &SlotName, definitions: &mut Definitions) -> Key {
    let sign = match slot.key {
        _ if slot.not_negative => " It only pulls: not negative.",
        "tension" => " A positive one lengthens, a negative one contracts.",
        _ => "",
    };
    let about = format!("The {} where it is no control.{sign}", slot.key);
    let own = if slot.vector {
        VectorField::schema(slot.want, definitions)
    } else {
        Parameter::schema(slot.want, definitions)
    };
    let schema = any_of(vec![own, TimeTable::schema(slot.want, definitions)]);
    Key { name: slot.key, about, required: false, default: None, schema }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_energy::ShapeModes;

    #[test]
    fn every_unit_of_the_catalogue_has_a_dimension() {
        let forms = catalogue::materials().iter().flat_map(|row| row.forms);
        let forms = forms.chain(catalogue::actuations().iter().flat_map(|row| row.forms));
        for parameter in forms.copied().flatten() {
            if let Takes::Number { unit, .. } = parameter.takes {
                assert!(want(unit) != Want::ANY, "{}: {unit}", parameter.name);
            }
        }
        for row in catalogue::actuations() {
            assert!(!slots(row).is_empty() || row.name == ShapeModes::NAME, "{}", row.name);
            assert!(slots(row).iter().all(|slot| slot.want != Want::ANY), "{}", row.name);
        }
    }

    #[test]
    fn components_of_a_slot_are_one_vector() {
        let magnet = catalogue::actuation("magnet").unwrap();
        let names: Vec<_> = slots(magnet).iter().map(|slot| (slot.key, slot.vector)).collect();
        assert_eq!(names, [("remanence", true), ("field", true)]);
        let turgor = catalogue::actuation("turgor").unwrap();
        assert_eq!(
            slots(turgor),
            [SlotName { key: "pressure", want: Want::PRESSURE, vector: false, not_negative: false }]
        );
    }
}
