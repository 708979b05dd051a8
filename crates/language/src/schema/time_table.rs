//! Values over the time from a CSV file.

use crate::quantity::Want;
use crate::schema::json::Definitions;
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

object! {
    /// Columns of a CSV file over its column "t": linear between the rows, constant before the first and behind the last; all in the case's units.
    pub struct TimeTable one of [column, columns] {
        /// The file, relative to the case.
        pub file: String,
        /// The column of a scalar.
        pub column: Option<String>,
        /// Those of a vector, of x, y and z in this order; null leaves a component of a position free.
        pub columns: Option<Vec<ColumnName>>,
    }
}

/// A column, or null.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnName(pub Option<String>);

impl Read for ColumnName {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Null => Some(ColumnName(None)),
            _ => String::read(node, at, want, reader).map(|name| ColumnName(Some(name))),
        }
    }

    fn schema(_: Want, _: &mut Definitions) -> Json {
        json!({ "type": ["string", "null"], "minLength": 1 })
    }
}

impl TimeTable {
    /// Whether a node is one: an object that names a CSV file.
    pub(crate) fn is_named_by(node: &Node) -> bool {
        let Value::Object(members) = &node.value else { return false };
        members.iter().any(|member| {
            member.key == "file" && matches!(&member.node.value, Value::Text(file) if file.ends_with(".csv"))
        })
    }

    /// Reads one where values change in time, of a scalar or of a vector; `None` after a complaint.
    pub(crate) fn read_for(vector: Option<bool>, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Self> {
        let table = Self::read_for_position(vector, node, at, reader)?;
        if table.columns.iter().flatten().any(|column| column.0.is_none()) {
            reader.complain_at(&at.key("columns"), "a column for every component was expected, found null");
            return None;
        }
        Some(table)
    }

    /// The same, where components may be free.
    pub(crate) fn read_for_position(
        vector: Option<bool>,
        node: &Node,
        at: &At,
        reader: &mut Reader<'_>,
    ) -> Option<Self> {
        let table = <Self as Read>::read(node, at, Want::ANY, reader)?;
        if reader.document.root().find("time").is_none() {
            let message = "values over the time, and the case is static: give \"time\": { \"end\": \"1 s\", \"step\": \"10 ms\" }";
            reader.complain(node, at, message);
            return None;
        }
        if let Some(columns) = table.columns.as_ref().filter(|columns| !(2..=3).contains(&columns.len())) {
            let message = format!("two or three columns were expected, found {}", columns.len());
            reader.complain_at(&at.key("columns"), message);
            return None;
        }
        if table.columns.as_ref().is_some_and(|columns| columns.iter().all(|column| column.0.is_none())) {
            reader.complain_at(&at.key("columns"), "no component has a column");
            return None;
        }
        match vector {
            Some(true) if table.columns.is_none() => reader.complain_at(at, "a vector needs \"columns\": two or three"),
            Some(false) if table.column.is_none() => reader.complain_at(at, "a scalar needs one \"column\""),
            _ => return Some(table),
        }
        None
    }

    /// Its columns by component, `None` where it is free; one of a scalar.
    pub fn components(&self) -> Vec<Option<&str>> {
        let several = self.columns.iter().flatten().map(|column| column.0.as_deref());
        self.column.iter().map(|name| Some(name.as_str())).chain(several).collect()
    }

    /// Names of its columns.
    pub fn names(&self) -> Vec<&str> {
        self.components().into_iter().flatten().collect()
    }
}
