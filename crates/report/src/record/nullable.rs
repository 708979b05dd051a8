//! [`Nullable`]: a value of a result that may be `null`.

use crate::record::Absent;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::borrow::Cow;
use std::ops::Deref;

/// What marks a schema whose values may really be null, beside those of keys that are left out.
pub(super) const NULLABLE: &str = "nullable";

/// Of `null` or a value.
pub(super) fn nullable<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let mut schema = Option::<T>::json_schema(generator);
    schema.insert(NULLABLE.to_owned(), Value::Bool(true));
    schema
}

/// A value; `null` where there is none; left out (the default) where nothing is said of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nullable<T> {
    value: Option<T>,
    is_stated: bool,
}

impl<T> Default for Nullable<T> {
    fn default() -> Self {
        Self { value: None, is_stated: false }
    }
}

impl<T> From<Option<T>> for Nullable<T> {
    fn from(value: Option<T>) -> Self {
        Self { value, is_stated: true }
    }
}

impl<T> Nullable<T> {
    /// Whether something is said of it.
    pub fn is_stated(&self) -> bool {
        self.is_stated
    }
}

impl<T> Deref for Nullable<T> {
    type Target = Option<T>;

    fn deref(&self) -> &Option<T> {
        &self.value
    }
}

impl<T> Absent for Nullable<T> {
    fn is_absent(&self) -> bool {
        !self.is_stated
    }
}

impl<T: Serialize> Serialize for Nullable<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Nullable<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::deserialize(deserializer).map(Self::from)
    }
}

impl<T: JsonSchema> JsonSchema for Nullable<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Nullable_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        nullable::<T>(generator)
    }
}
