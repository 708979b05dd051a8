//! [`Number`]: a number of a result.

use crate::record::nullable::nullable;
use crate::record::{Absent, ByName};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::ops::Deref;

/// A number; `null` where it is not finite or not known; left out (the default) where nothing is said of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Number {
    value: Option<f64>,
    is_stated: bool,
}

/// Numbers by name, in the order of the file.
pub type Numbers = ByName<Number>;

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Some(value).into()
    }
}

impl From<Option<f64>> for Number {
    fn from(value: Option<f64>) -> Self {
        Self { value: value.filter(|value| value.is_finite()), is_stated: true }
    }
}

impl From<Number> for Option<f64> {
    fn from(number: Number) -> Self {
        number.value
    }
}

impl Deref for Number {
    type Target = Option<f64>;

    fn deref(&self) -> &Option<f64> {
        &self.value
    }
}

impl Absent for Number {
    fn is_absent(&self) -> bool {
        !self.is_stated
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::<f64>::deserialize(deserializer).map(Self::from)
    }
}

impl JsonSchema for Number {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        nullable::<f64>(generator)
    }
}

/// The number of a name.
#[must_use]
pub fn number_of(numbers: &Numbers, name: &str) -> Option<f64> {
    numbers.get(name).and_then(|number| **number)
}

/// A list of numbers.
#[must_use]
pub fn numbers(values: &[f64]) -> Vec<Number> {
    values.iter().copied().map(Number::from).collect()
}
