//! Where points shall go: all of them, or one.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::field::ArrayFile;
use crate::schema::json::{Definitions, any_of, vector};
use crate::schema::mesh::MeshSource;
use crate::schema::read::{Read, Reader};
use crate::schema::value::entries;
use crate::syntax::{At, Node, Value, quoted};
use serde_json::Value as Json;

/// Where points shall go.
#[derive(Clone, PartialEq, Debug)]
pub enum Target {
    /// The position as formulas of X, Y, Z.
    Formulas(Vec<Formula>),
    /// A displacement array of a file on the same mesh.
    Array(ArrayFile),
    /// The nodes of a mesh with the same numbering.
    Nodes(NodeTarget),
}

object! {
    /// Target positions node by node.
    pub struct NodeTarget {
        /// A mesh with the same numbering of nodes.
        pub nodes: MeshSource,
    }
}

object! {
    /// Coordinates of a position; those left out are free.
    pub struct Coordinates checked by check_coordinates {
        /// x
        pub x: Option<Formula> as LENGTH_IN_TIME,
        /// y
        pub y: Option<Formula> as LENGTH_IN_TIME,
        /// z
        pub z: Option<Formula> as LENGTH_IN_TIME,
    }
}

impl Target {
    /// Whether it changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        matches!(self, Self::Formulas(all) if all.iter().any(Formula::uses_time))
    }

    /// That at an instant.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        match self {
            Self::Formulas(entries) => Self::Formulas(entries.iter().map(|entry| entry.at_time(t)).collect()),
            other => other.clone(),
        }
    }
}

impl Coordinates {
    /// As an array.
    #[must_use]
    pub fn entries(&self) -> [Option<&Formula>; 3] {
        [self.x.as_ref(), self.y.as_ref(), self.z.as_ref()]
    }

    /// Of formulas of x, y and z, as many as there are; nothing where a component is free.
    #[must_use]
    pub fn of(formulas: Vec<Option<Formula>>, at: &At) -> Self {
        let mut formulas = formulas.into_iter();
        let mut next = || formulas.next().flatten();
        Self { x: next(), y: next(), z: next(), at: at.clone() }
    }

    /// Those at an instant.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        let at = |entry: &Option<Formula>| entry.as_ref().map(|formula| formula.at_time(t));
        Self { x: at(&self.x), y: at(&self.y), z: at(&self.z), at: self.at.clone() }
    }

    /// Whether they change in time.
    #[must_use]
    pub fn use_time(&self) -> bool {
        self.entries().into_iter().flatten().any(Formula::uses_time)
    }
}

impl Read for Target {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Array(_) => entries(node, at, Want::LENGTH_IN_TIME, reader).map(Self::Formulas),
            Value::Object(members) if members.iter().any(|member| member.key == "nodes") => {
                NodeTarget::read(node, at, Want::ANY, reader).map(Self::Nodes)
            }
            Value::Object(_) => ArrayFile::read(node, at, Want::ANY, reader).map(Self::Array),
            _ => {
                let forms = "[\"formula\", ...], { \"file\": ..., \"array\": ... } or { \"nodes\": ... }";
                reader.expected(node, at, forms);
                None
            }
        }
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![
            vector::<Formula>(Want::LENGTH, definitions),
            ArrayFile::schema(Want::ANY, definitions),
            NodeTarget::schema(Want::ANY, definitions),
        ])
    }
}

fn check_coordinates(block: &Coordinates, reader: &mut Reader<'_>) {
    for (axis, entry) in ["x", "y", "z"].into_iter().zip(block.entries()) {
        if let Some(formula) = entry.filter(|formula| formula.varies_in_space()) {
            let message = format!("{} depends on X, Y or Z, but one number is wanted", quoted(formula.text()));
            reader.complain_at(&block.at.key(axis), message);
        }
    }
    // what stands there under another name was complained about
    let node = reader.document.root().find(block.at.as_str());
    let is_empty = node.is_none_or(|node| matches!(&node.value, Value::Object(members) if members.is_empty()));
    if is_empty && block.entries().iter().all(Option::is_none) {
        reader.complain_at(&block.at, "at least one coordinate is wanted: { \"x\": ..., \"z\": ... }");
    }
}
