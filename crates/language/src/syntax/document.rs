//! A case file as a tree.

use crate::catalogue::Catalogue;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::node::{Node, Property, SourcePosition, Value};
use crate::syntax::parse::parse;
use crate::syntax::path::At;
use crate::syntax::setting::{Setting, complaint};
use nastic_mesh::Mesh;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Blocks an option may reach into although the case leaves them out.
const OPTIONAL_BLOCKS: [&str; 4] = ["units", "optimizer", "gains", "output"];

/// A parsed case file with its overrides: every value knows the line, or the `--set`, it came from.
#[derive(Clone, Debug)]
pub struct Document {
    name: String,
    root: Node,
    /// Problems that do not keep the rest from being read.
    problems: Vec<Diagnostic>,
    /// The names that may stand in it.
    catalogue: Arc<Catalogue>,
    /// Meshes that stand for files of these names.
    meshes: Arc<BTreeMap<String, Arc<Mesh>>>,
}

impl Document {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, is not UTF-8, or is no JSON.
    pub fn open(path: &Path) -> Result<Self, Diagnostics> {
        let name = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&name, &text),
            Err(error) => {
                let message = format!("cannot be read: {error}");
                Err(Diagnostic { file: name, path: String::new(), line: 0, column: 0, message }.into())
            }
        }
    }

    /// Reads a text; `name` is the file's name for messages and for paths relative to it.
    ///
    /// # Errors
    ///
    /// A text that is no JSON, with the line where that shows.
    pub fn parse(name: &str, text: &str) -> Result<Self, Diagnostics> {
        let mut problems = Vec::new();
        match parse(name, text, &mut problems) {
            Some(root) => {
                Ok(Self { name: name.to_string(), root, problems, catalogue: Arc::default(), meshes: Arc::default() })
            }
            None => Err(Diagnostics::new(problems)),
        }
    }

    /// A case that a program made; `name` as in [`Self::parse`]. Problems have no lines.
    #[must_use]
    pub fn from_json(name: &str, case: &serde_json::Value) -> Self {
        Self {
            name: name.to_string(),
            root: Node::from_json(case),
            problems: Vec::new(),
            catalogue: Arc::default(),
            meshes: Arc::default(),
        }
    }

    /// With meshes that a program made, in the place of files of these names. A name belongs to the case's identity (its hash):
    /// other meshes should have other names.
    #[must_use]
    pub fn with_meshes(mut self, meshes: BTreeMap<String, Arc<Mesh>>) -> Self {
        self.meshes = Arc::new(meshes);
        self
    }

    /// The mesh that stands for a file.
    #[must_use]
    pub fn mesh(&self, file: &str) -> Option<&Arc<Mesh>> {
        self.meshes.get(file)
    }

    /// To be read with these names; with the standard ones if never called.
    #[must_use]
    pub fn with_catalogue(mut self, catalogue: &Catalogue) -> Self {
        self.catalogue = Arc::new(catalogue.clone());
        self
    }

    /// The names that may stand in it.
    #[must_use]
    pub fn catalogue(&self) -> &Catalogue {
        &self.catalogue
    }

    /// Applies an option `path=value`; the value is JSON if it reads as JSON, otherwise a text.
    ///
    /// # Errors
    ///
    /// A path whose parent does not exist, with the nearest that does.
    pub fn set(&mut self, option: &str) -> Result<(), Diagnostics> {
        let setting = Setting::option(option)?;
        self.supply_block(&setting);
        setting.apply(&mut self.root).map_err(|message| setting.complaint(&self.name, &message).into())
    }

    /// This document with other values: one scenario, one load case.
    ///
    /// # Errors
    ///
    /// All settings whose parents do not exist.
    pub fn with(&self, settings: &[Setting]) -> Result<Self, Diagnostics> {
        let mut variant = self.clone();
        let mut problems = Vec::new();
        for setting in settings {
            if let Err(message) = setting.apply(&mut variant.root) {
                problems.push(setting.complaint(&self.name, &message));
            }
        }
        Diagnostics::new(problems).into_result().map(|()| variant)
    }

    /// The file's name as given.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole tree.
    #[must_use]
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// A file named in the case: relative names count from the case file's directory.
    #[must_use]
    pub fn resolve(&self, file: &str) -> PathBuf {
        Path::new(&self.name).parent().unwrap_or(Path::new("")).join(file)
    }

    /// The problem `message` at a path: for errors found only later, with the mesh at hand. A path that is not in the
    /// file (a value left out) takes the line of the block it would stand in.
    #[must_use]
    pub fn complain(&self, at: &At, message: impl Into<String>) -> Diagnostic {
        let mut near = at.clone();
        let node = loop {
            match self.root.find(near.as_str()) {
                Some(node) => break node,
                None => near = near.parent(),
            }
        };
        self.problem(&node.place, at, message)
    }

    /// The case without comments and layout, with all overrides: equal texts are equal cases.
    #[must_use]
    pub fn canonical(&self) -> String {
        self.json().to_string()
    }

    /// The case with its overrides, without comments.
    #[must_use]
    pub fn json(&self) -> serde_json::Value {
        self.root.to_json()
    }

    /// The problem `message` at a place.
    pub(crate) fn problem(&self, place: &SourcePosition, at: &At, message: impl Into<String>) -> Diagnostic {
        complaint(place, &self.name, at.as_str(), &message.into())
    }

    /// This document without some blocks.
    #[must_use]
    pub fn without(&self, blocks: &[&str]) -> Self {
        let mut out = self.clone();
        if let Value::Object(members) = &mut out.root.value {
            members.retain(|member| !blocks.contains(&member.key.as_str()));
        }
        out
    }

    /// Problems that do not keep the rest from being read: keys given twice, numbers out of range. The reader of the case
    /// reports them too.
    #[must_use]
    pub fn problems(&self) -> &[Diagnostic] {
        &self.problems
    }

    fn supply_block(&mut self, setting: &Setting) {
        let block = setting.path.split('/').next().unwrap_or("");
        let Value::Object(members) = &mut self.root.value else { return };
        if setting.path == block || !OPTIONAL_BLOCKS.contains(&block) || members.iter().any(|m| m.key == block) {
            return;
        }
        let place = setting.node.place.clone();
        let node = Node { value: Value::Object(Vec::new()), place: place.clone() };
        members.push(Property { key: block.to_string(), place, node });
    }
}
