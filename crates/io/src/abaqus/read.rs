//! [`Reader`]: keyword after keyword to a [`Model`].

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::element::{ElementType, Family, element_type, ordered};
use super::lines::{Keyword, Lines};
use super::model::{Element, Model, Scope};
use super::place::Placement;
use crate::error::ReadError;
use crate::source::brief;
use nastic_mesh::CellKind;

/// Nodes and elements that instances may make of parts.
const MOST_COPIES: usize = 50_000_000;
/// Members that sets may have together.
pub(super) const MOST_MEMBERS: usize = 50_000_000;
/// Keywords that make nodes and elements without listing them, or turn the axes of those listed.
const GENERATORS: [&str; 8] = ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "IMPORT"];
/// Keywords that say nothing of the model.
const SILENT: [&str; 6] = ["HEADING", "PREPRINT", "ASSEMBLY", "END ASSEMBLY", "END PART", "END INSTANCE"];

/// What has been read so far.
pub(super) struct Reader<'a> {
    pub lines: Lines<'a>,
    pub root: Model,
    parts: BTreeMap<String, Model>,
    /// Name of the part that is open, in capitals.
    part: Option<String>,
    /// The instance that is open.
    pub instance: Option<Scope>,
    /// Names of instances in capitals, and as they are written.
    instances: BTreeMap<String, Scope>,
    pub instance_names: Vec<String>,
    /// Members of all sets that were looked at.
    pub members: usize,
    /// Line and name of the first type of shells.
    pub shells: Option<(u64, String)>,
    pub plane_stress: BTreeSet<String>,
    pub found: Found,
}

/// What deserves a note.
#[derive(Default)]
pub(super) struct Found {
    /// Keywords that are not read.
    pub unread: BTreeSet<String>,
    /// Elements that are no part of the mesh, by their type.
    pub passed_over: BTreeMap<String, usize>,
    /// Members of sets that the file does not define, by set.
    pub unknown: BTreeMap<String, usize>,
    /// Surfaces of kinds that are not read.
    pub surfaces: BTreeSet<String>,
    /// Sets whose numbers are those of another program.
    pub foreign: BTreeSet<String>,
    pub includes: Vec<String>,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, text: &'a str) -> Self {
        Self {
            lines: Lines::new(file, text),
            root: Model::default(),
            parts: BTreeMap::new(),
            part: None,
            instance: None,
            instances: BTreeMap::new(),
            instance_names: Vec::new(),
            members: 0,
            shells: None,
            plane_stress: BTreeSet::new(),
            found: Found::default(),
        }
    }

    /// The part that is open, or the file's own model.
    pub fn model(&mut self) -> &mut Model {
        let part = self.part.as_ref().and_then(|name| self.parts.get_mut(name));
        part.unwrap_or(&mut self.root)
    }

    /// The instance of that name.
    pub fn scope_of(&self, instance: &str) -> Option<Scope> {
        self.instances.get(&instance.to_uppercase()).copied()
    }

    pub fn all(&mut self) -> Result<(), ReadError> {
        while let Some(keyword) = self.lines.keyword() {
            self.section(&keyword)?;
        }
        Ok(())
    }

    fn section(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        match keyword.name.as_str() {
            "NODE" => self.nodes(keyword),
            "ELEMENT" => self.elements(keyword),
            "NSET" => self.set(keyword, true),
            "ELSET" => self.set(keyword, false),
            "SURFACE" => self.surface(keyword),
            "PART" => {
                let name = self.named(keyword, "NAME")?.to_uppercase();
                self.parts.entry(name.clone()).or_default();
                self.part = Some(name);
                Ok(())
            }
            "INSTANCE" => self.add_instance(keyword),
            name if GENERATORS.contains(&name) => {
                let advice = "write the model out by a preprocessor, with every node and element listed";
                Err(self.lines.unsupported(format!("*{name}"), advice))
            }
            name => {
                match name {
                    "END PART" => self.part = None,
                    "END INSTANCE" => self.instance = None,
                    "INCLUDE" => {
                        let input = keyword.parameter("INPUT").unwrap_or_default();
                        self.found.includes.push(format!("\"{}\" (line {})", brief(input), keyword.line));
                    }
                    _ => {}
                }
                if !SILENT.contains(&name) && name != "INCLUDE" {
                    self.found.unread.insert(format!("*{}", brief(name)));
                }
                Ok(())
            }
        }
    }

    /// A parameter that must be there.
    pub fn named<'k>(&self, keyword: &'k Keyword, parameter: &str) -> Result<&'k str, ReadError> {
        let name = keyword.parameter(parameter).filter(|name| !name.is_empty());
        name.ok_or_else(|| self.lines.malformed(format!("it has no {parameter}=")))
    }

    /// Refuses what stands elsewhere.
    pub fn listed_here(&self, keyword: &Keyword) -> Result<(), ReadError> {
        if keyword.has("INPUT") {
            let what =
                format!("data in another file (INPUT={})", brief(keyword.parameter("INPUT").unwrap_or_default()));
            return Err(self.lines.unsupported(what, "put its lines in the place of INPUT="));
        }
        if self.instance.is_some() && matches!(keyword.name.as_str(), "NODE" | "ELEMENT") {
            return Err(self.lines.unsupported("a list within *INSTANCE", "list nodes and elements in a *PART"));
        }
        Ok(())
    }

    fn nodes(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        self.listed_here(keyword)?;
        if keyword.parameter("SYSTEM").is_some_and(|system| !system.is_empty() && !system.eq_ignore_ascii_case("R")) {
            return Err(self.lines.unsupported("a system of polar coordinates", "write Cartesian coordinates"));
        }
        let mut added = Vec::new();
        while let Some(words) = self.lines.data() {
            let label = self.lines.label(words[0])?;
            let mut point = [0.0; 3];
            for (x, word) in point.iter_mut().zip(&words[1..]) {
                *x = self.lines.real(word)?;
            }
            let model = self.model();
            let next = model.points.len() as u32;
            match model.node_at.insert((0, label), next) {
                Some(before) if model.points[before as usize] == point => {
                    model.node_at.insert((0, label), before);
                    added.push(before);
                    continue;
                }
                Some(_) => return Err(self.lines.malformed(format!("node {label} is defined twice"))),
                None => {}
            }
            model.points.push(point);
            model.node_labels.push(label);
            added.push(next);
        }
        if let Some(name) = keyword.parameter("NSET") {
            self.model().node_sets.extend(0, name, false, &added);
        }
        Ok(())
    }

    fn elements(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        self.listed_here(keyword)?;
        let name = self.named(keyword, "TYPE")?.to_ascii_uppercase();
        let (kind, family) = match element_type(&name) {
            ElementType::Cell(kind, family) => (kind, family),
            ElementType::Foreign => {
                let advice =
                    "mesh with C3D4, C3D8, C3D10, C3D20 or C3D27 in space, CPE3, CPE4, CPE6 or CPE8 in plane strain";
                return Err(self.lines.unsupported(format!("the element type {}", brief(&name)), advice));
            }
            ElementType::PassedOver => {
                let count = std::iter::from_fn(|| self.lines.data()).count();
                *self.found.passed_over.entry(name).or_default() += count;
                return Ok(());
            }
        };
        if family == Family::PlaneStress {
            self.plane_stress.insert(name.clone());
        }
        if family == Family::Shell && self.shells.is_none() {
            self.shells = Some((keyword.line, name.clone()));
        }
        let mut added = Vec::new();
        let mut numbers: Vec<u64> = Vec::new();
        while let Some(words) = self.lines.data() {
            for word in words.iter().filter(|word| !word.is_empty()) {
                numbers.push(self.lines.label(word)?);
            }
            // fewer go on in the next line
            if numbers.len() > kind.nodes() {
                added.push(self.element(kind, family, &name, &numbers)?);
                numbers.clear();
            }
        }
        if !numbers.is_empty() {
            added.push(self.element(kind, family, &name, &numbers)?);
        }
        if let Some(name) = keyword.parameter("ELSET") {
            self.model().element_sets.extend(0, name, false, &added);
        }
        Ok(())
    }

    fn element(&mut self, kind: CellKind, family: Family, name: &str, numbers: &[u64]) -> Result<u32, ReadError> {
        let (label, nodes) = (numbers[0], &numbers[1..]);
        if nodes.len() != kind.nodes() {
            let what = format!("element {label} has {} nodes, {} needs {}", nodes.len(), brief(name), kind.nodes());
            return Err(self.lines.malformed(what));
        }
        let model = self.model();
        let found: Result<Vec<u32>, u64> =
            nodes.iter().map(|node| model.node_at.get(&(0, *node)).copied().ok_or(*node)).collect();
        let nodes = match found {
            Ok(nodes) => ordered(kind, &nodes, &model.points),
            Err(node) => {
                let what = format!("element {label} names node {node}, which is not defined before it");
                return Err(self.lines.malformed(what));
            }
        };
        let at = model.elements.len() as u32;
        if model.element_at.insert((0, label), at).is_some() {
            return Err(self.lines.malformed(format!("element {label} is defined twice")));
        }
        model.elements.push(Element { kind, family, nodes, label });
        Ok(at)
    }

    fn add_instance(&mut self, keyword: &Keyword) -> Result<(), ReadError> {
        let (name, part) = (self.named(keyword, "NAME")?, self.named(keyword, "PART")?);
        let rows: Vec<_> = std::iter::from_fn(|| self.lines.data()).collect();
        let rows: Vec<Vec<f64>> = rows
            .iter()
            .map(|words| words.iter().map(|word| self.lines.real(word)).collect::<Result<_, _>>())
            .collect::<Result<_, _>>()?;
        let placement = Placement::new(&rows).map_err(|what| self.lines.malformed(what))?;
        let Some(source) = self.parts.get(&part.to_uppercase()) else {
            return Err(self.lines.malformed(format!("there is no part \"{}\" before it", brief(part))));
        };
        let copies = self.root.points.len() + self.root.elements.len() + source.points.len() + source.elements.len();
        if copies > MOST_COPIES {
            let what = format!("a model of more than {MOST_COPIES} nodes and elements by instances");
            return Err(self.lines.unsupported(what, "write the assembly as one mesh"));
        }
        self.instance_names.push(name.to_owned());
        let scope = self.instance_names.len() as Scope;
        if self.instances.insert(name.to_uppercase(), scope).is_some() {
            return Err(self.lines.malformed(format!("a second instance \"{}\"", brief(name))));
        }
        self.root.add(source, scope, |point| placement.of(point));
        self.instance = Some(scope);
        self.part = None;
        Ok(())
    }
}
