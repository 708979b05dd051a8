use std::collections::BTreeMap;

use nastic_tensor::{Mat3, Vec3};

use super::{Parameter, Takes};
use crate::formula::Expression;
use crate::network::Network;
use crate::slot::lasting;
use crate::{EnergyError, Field, ShapeMode};

/// Named parameters, as a case file gives them; numbers in consistent units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    values: BTreeMap<String, Value>,
}

#[derive(Clone, Debug, PartialEq)]
enum Value {
    Number(Field<f64>),
    Direction(Field<Vec3>),
    Choice(String),
    Energy(Expression),
    Numbers(BTreeMap<String, Field<f64>>),
    Network(Network),
    Modes(Vec<ShapeMode>),
}

impl Inputs {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// With a number, uniform or a field.
    #[must_use]
    pub fn number(self, name: &str, value: impl Into<Field<f64>>) -> Self {
        self.with(name, Value::Number(value.into()))
    }

    /// With a direction, uniform or a field.
    #[must_use]
    pub fn direction(self, name: &str, value: impl Into<Field<Vec3>>) -> Self {
        self.with(name, Value::Direction(value.into()))
    }

    /// With a word.
    #[must_use]
    pub fn choice(self, name: &str, word: &str) -> Self {
        self.with(name, Value::Choice(word.to_owned()))
    }

    /// With an energy.
    #[must_use]
    pub fn energy(self, name: &str, formula: Expression) -> Self {
        self.with(name, Value::Energy(formula))
    }

    /// With numbers by names.
    #[must_use]
    pub fn numbers(self, name: &str, values: BTreeMap<String, Field<f64>>) -> Self {
        self.with(name, Value::Numbers(values))
    }

    /// With a network.
    #[must_use]
    pub fn network(self, name: &str, network: Network) -> Self {
        self.with(name, Value::Network(network))
    }

    /// With displacement fields.
    #[must_use]
    pub fn modes(self, name: &str, modes: Vec<ShapeMode>) -> Self {
        self.with(name, Value::Modes(modes))
    }

    /// The example values of a parameter set.
    pub fn examples(form: &[Parameter]) -> Self {
        form.iter().fold(Self::new(), |inputs, p| match p.takes {
            Takes::Number { example, .. } => inputs.number(p.name, example),
            Takes::Direction { example } => inputs.direction(p.name, Vec3::from(example)),
            Takes::Choice { of } => inputs.choice(p.name, of.first().copied().unwrap_or_default()),
            Takes::Energy { example } => inputs.energy(p.name, Expression::new("the example", example)),
            Takes::Numbers { example } => {
                let numbers = example.iter().map(|(name, value)| ((*name).to_owned(), Field::Uniform(*value)));
                inputs.numbers(p.name, numbers.collect())
            }
            Takes::Network { inputs: names, layers } => inputs.network(p.name, Network::example(names, layers)),
            Takes::Modes { example } => {
                let mode = |(name, rows): &(&str, [[f64; 3]; 3])| {
                    let gradient = Field::Uniform(Mat3::from_fn(|i, j| rows[i][j]));
                    ShapeMode { name: (*name).to_owned(), gradient, nodal: [].into() }
                };
                inputs.modes(p.name, example.iter().map(mode).collect())
            }
        })
    }

    /// The names given, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.values.keys().map(String::as_str)
    }

    /// All numbers, also those by names of the user's, in the alphabetical order of their names.
    pub(super) fn all_numbers(&self) -> Vec<(&'static str, Field<f64>)> {
        let mut all: BTreeMap<&str, &Field<f64>> = BTreeMap::new();
        for (name, value) in &self.values {
            match value {
                Value::Number(field) => all.extend([(name.as_str(), field)]),
                Value::Numbers(fields) => all.extend(fields.iter().map(|(name, field)| (name.as_str(), field))),
                _ => {}
            }
        }
        all.into_iter().map(|(name, field)| (lasting(name), field.clone())).collect()
    }

    fn with(mut self, name: &str, value: Value) -> Self {
        self.values.insert(name.to_owned(), value);
        self
    }

    pub(super) fn check_kind(&self, owner: &'static str, parameter: &Parameter) -> Result<(), EnergyError> {
        let expected = match (&parameter.takes, self.values.get(parameter.name)) {
            (Takes::Number { .. }, None | Some(Value::Number(_))) => return Ok(()),
            (Takes::Direction { .. }, None | Some(Value::Direction(_))) => return Ok(()),
            (Takes::Choice { of }, Some(Value::Choice(word))) if !of.contains(&word.as_str()) => {
                return Err(super::unknown(&format!("{} of {owner}", parameter.name), word, of.to_vec()));
            }
            (Takes::Choice { .. }, None | Some(Value::Choice(_))) => return Ok(()),
            (Takes::Energy { .. }, None | Some(Value::Energy(_))) => return Ok(()),
            (Takes::Numbers { .. }, None | Some(Value::Numbers(_))) => return Ok(()),
            (Takes::Network { .. }, None | Some(Value::Network(_))) => return Ok(()),
            (Takes::Modes { .. }, None | Some(Value::Modes(_))) => return Ok(()),
            (Takes::Network { .. }, _) => "a network: inputs and layers",
            (Takes::Modes { .. }, _) => "displacement fields by their names",
            (Takes::Energy { .. }, _) => "a formula",
            (Takes::Numbers { .. }, _) => "numbers by their names",
            (Takes::Number { .. }, _) => "a number",
            (Takes::Direction { .. }, _) => "a direction",
            (Takes::Choice { .. }, _) => "a word",
        };
        Err(EnergyError::Kind { owner, name: parameter.name, expected })
    }
}

/// Inputs that were checked against one form of one law.
#[derive(Clone, Copy, Debug)]
pub struct CheckedInputs<'a> {
    owner: &'static str,
    form: &'static [Parameter],
    inputs: &'a Inputs,
}

impl<'a> CheckedInputs<'a> {
    pub(super) fn new(owner: &'static str, form: &'static [Parameter], inputs: &'a Inputs) -> Self {
        CheckedInputs { owner, form, inputs }
    }

    /// Whether the form meant has this parameter.
    pub fn form_has(&self, name: &str) -> bool {
        self.form.iter().any(|p| p.name == name)
    }

    /// A number, uniform or a field.
    ///
    /// # Errors
    /// [`EnergyError::Missing`].
    pub fn number(&self, name: &'static str) -> Result<Field<f64>, EnergyError> {
        match self.inputs.values.get(name) {
            Some(Value::Number(field)) => Ok(field.clone()),
            _ => Err(self.missing(name)),
        }
    }

    /// A direction, uniform or a field.
    ///
    /// # Errors
    /// [`EnergyError::Missing`].
    pub fn direction(&self, name: &'static str) -> Result<Field<Vec3>, EnergyError> {
        match self.inputs.values.get(name) {
            Some(Value::Direction(field)) => Ok(field.clone()),
            _ => Err(self.missing(name)),
        }
    }

    /// An energy.
    ///
    /// # Errors
    /// [`EnergyError::Missing`].
    pub fn energy(&self, name: &'static str) -> Result<&'a Expression, EnergyError> {
        match self.inputs.values.get(name) {
            Some(Value::Energy(formula)) => Ok(formula),
            _ => Err(self.missing(name)),
        }
    }

    /// A network.
    ///
    /// # Errors
    /// [`EnergyError::Missing`].
    pub fn network(&self, name: &'static str) -> Result<&'a Network, EnergyError> {
        match self.inputs.values.get(name) {
            Some(Value::Network(network)) => Ok(network),
            _ => Err(self.missing(name)),
        }
    }

    /// Numbers by their names; none where they are left out.
    pub fn numbers(&self, name: &str) -> BTreeMap<String, Field<f64>> {
        match self.inputs.values.get(name) {
            Some(Value::Numbers(values)) => values.clone(),
            _ => BTreeMap::new(),
        }
    }

    /// Displacement fields.
    ///
    /// # Errors
    /// [`EnergyError::Missing`].
    pub fn modes(&self, name: &'static str) -> Result<Vec<ShapeMode>, EnergyError> {
        match self.inputs.values.get(name) {
            Some(Value::Modes(modes)) => Ok(modes.clone()),
            _ => Err(self.missing(name)),
        }
    }

    /// A direction that may be left out.
    pub fn direction_or_none(&self, name: &str) -> Option<Field<Vec3>> {
        match self.inputs.values.get(name) {
            Some(Value::Direction(field)) => Some(field.clone()),
            _ => None,
        }
    }

    /// A number that may be left out.
    pub fn number_or(&self, name: &str, default: f64) -> Field<f64> {
        match self.inputs.values.get(name) {
            Some(Value::Number(field)) => field.clone(),
            _ => Field::Uniform(default),
        }
    }

    /// The word given, if any.
    pub fn word(&self, name: &str) -> Option<&'a str> {
        match self.inputs.values.get(name) {
            Some(Value::Choice(word)) => Some(word),
            _ => None,
        }
    }

    fn missing(&self, name: &'static str) -> EnergyError {
        let given = self.inputs.names().map(str::to_owned).collect();
        EnergyError::Missing { owner: self.owner, name, given, forms: super::choose::describe(&[self.form]) }
    }
}
