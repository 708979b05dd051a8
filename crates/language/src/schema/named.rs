//! Values that name a row of another crate's catalogue: cell kinds, optimisers and time schemes.

use crate::quantity::Want;
use crate::schema::json::Definitions;
use crate::schema::read::{Choice, Read, Reader};
use crate::syntax::{At, Node};
use nastic_fem::Scheme;
use nastic_fem::schemes::{Entry, SCHEMES};
use nastic_mesh::CellKind;
use nastic_opt::CATALOGUE;
use serde_json::Value as Json;

/// A type of cells that bodies are made of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Element(pub CellKind);

/// An optimisation method.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Method(&'static str);

impl Method {
    /// The name in the case.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.0
    }

    /// The method of this name, if case files have it.
    pub fn named(name: &str) -> Option<Self> {
        CATALOGUE.iter().find(|row| row.name == name).map(|row| Self(row.name))
    }
}

impl Default for Method {
    fn default() -> Self {
        Method("lbfgs")
    }
}

/// A time scheme.
#[derive(Clone, Copy, Debug)]
pub struct SchemeName(&'static Entry);

impl SchemeName {
    /// The name in the case.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.0.name
    }

    /// What is taken beside contact where the case names none.
    pub(crate) fn beside_contact() -> Self {
        Self::named("backward_euler").unwrap_or_default()
    }

    /// The scheme of this name.
    fn named(name: &str) -> Option<Self> {
        SCHEMES.iter().find(|row| row.name == name).map(Self)
    }

    /// The scheme itself.
    ///
    /// # Errors
    /// None of the catalogue's own parameters.
    pub(crate) fn scheme(&self) -> Result<Scheme, nastic_fem::FemError> {
        (self.0.build)()
    }
}

impl PartialEq for SchemeName {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Default for SchemeName {
    fn default() -> Self {
        Self::named("tr_bdf2").unwrap_or(Self(&SCHEMES[0]))
    }
}

impl Read for SchemeName {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        name(node, at, reader, &schemes()).and_then(Self::named)
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.choice(&schemes())
    }

    fn to_json(&self) -> Option<Json> {
        Some(self.name().into())
    }
}

impl Read for Element {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        name(node, at, reader, &elements()).and_then(CellKind::from_name).map(Element)
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.choice(&elements())
    }

    fn to_json(&self) -> Option<Json> {
        Some(self.0.name().into())
    }
}

impl Read for Method {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        name(node, at, reader, &methods()).map(Method)
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.choice(&methods())
    }

    fn to_json(&self) -> Option<Json> {
        Some(self.0.into())
    }
}

/// One of the names.
fn name(node: &Node, at: &At, reader: &mut Reader<'_>, rows: &[Choice]) -> Option<&'static str> {
    let names: Vec<&'static str> = rows.iter().map(|row| row.name).collect();
    reader.word(node, at, "name", &names)
}

fn elements() -> Vec<Choice> {
    let bodies = CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1);
    bodies.map(|kind| Choice { name: kind.name(), about: kind.about(), schema: None }).collect()
}

fn schemes() -> Vec<Choice> {
    SCHEMES.iter().map(|row| Choice { name: row.name, about: row.about, schema: None }).collect()
}

fn methods() -> Vec<Choice> {
    CATALOGUE.iter().map(|row| Choice { name: row.name, about: row.about, schema: None }).collect()
}
