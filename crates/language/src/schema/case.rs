//! The whole case, and the rows of its blocks that add a contribution each.

mod medium;
mod spring;

pub use medium::Medium;
pub use spring::{Ground, Spring, SpringEnd};

use crate::quantity::{Units, Want};
use crate::schema::actuation::Actuation;
use crate::schema::actuation_words;
use crate::schema::block::Block;
use crate::schema::check::{self, block};
use crate::schema::constraint::Constraint;
use crate::schema::contact::Contact;
use crate::schema::control::Control;
use crate::schema::cost::Cost;
use crate::schema::design::{Design, DesignKind};
use crate::schema::electrode::Electrode;
use crate::schema::expectation::Expectation;
use crate::schema::gains::Gains;
use crate::schema::hints::Hint;
use crate::schema::load::Load;
use crate::schema::load_case::LoadCase;
use crate::schema::material::Material;
use crate::schema::mesh::MeshSource;
use crate::schema::named_part::{NamedRegion, NamedSurface};
use crate::schema::obstacle::Obstacle;
use crate::schema::optimizer::Optimizer;
use crate::schema::read::{Read, Reader};
use crate::schema::scenario::{Risk, Scenarios};
use crate::schema::support::Support;
use crate::schema::time::Time;
use crate::schema::value::Vector;
use crate::syntax::{At, Diagnostic, Diagnostics, Document, Node, Property, Value};
use std::collections::BTreeMap;

/// Blocks a variant of the case may change; everything else is shared.
pub(crate) const CHANGEABLE: [&str; 10] =
    ["materials", "supports", "springs", "media", "obstacles", "contact", "loads", "actuation", "electrodes", "costs"];

/// What people try in the place of the blocks that add a contribution each.
pub(crate) const HINTS: &[&[Hint]] = &[spring::HINTS, medium::HINTS, actuation_words::HINTS];

object! {
    /// A case: a soft body, what moves it, what it shall become.
    pub struct Case {
        /// Version of the case format: 1.
        pub nastic: u64,
        /// For people.
        pub title: Option<String>,
        /// The consistent system of plain numbers, of the mesh and of results.
        pub units: Units,
        /// The body.
        pub mesh: MeshSource,
        /// Surfaces of the body by where they are, of a mesh without groups.
        pub surfaces: Vec<NamedSurface> = Vec::new(),
        /// Regions of the body by where they are.
        pub regions: Vec<NamedRegion> = Vec::new(),
        /// Passive laws, one per region.
        pub materials: Vec<Material>,
        /// What holds the body.
        pub supports: Vec<Support> = Vec::new(),
        /// Springs between points of the body, and from it to the ground.
        pub springs: Vec<Spring> = Vec::new(),
        /// What fills voids and keeps their cells from folding.
        pub media: Vec<Medium> = Vec::new(),
        /// What the body may touch, or keeps clear of.
        pub obstacles: Vec<Obstacle> = Vec::new(),
        /// Surfaces that obstacles push back.
        pub contact: Vec<Contact> = Vec::new(),
        /// Dead loads.
        pub loads: Vec<Load> = Vec::new(),
        /// What moves the body from within.
        pub actuation: Vec<Actuation> = Vec::new(),
        /// Nodes with one electric potential; read, they stand among the actuations.
        pub electrodes: Vec<Electrode> = Vec::new(),
        /// What the optimiser may change.
        pub controls: Vec<Control> = Vec::new(),
        /// What the optimiser makes small: the sum.
        pub costs: Vec<Cost> = Vec::new(),
        /// What the optimum must fulfil, in every load case of every scenario.
        pub constraints: Vec<Constraint> = Vec::new(),
        /// Several states that share the design.
        pub load_cases: Vec<LoadCase> = Vec::new(),
        /// Scenarios that share the control.
        pub scenarios: Scenarios,
        /// What of the scenarios' costs is made small.
        pub risk: Risk = Risk::Mean,
        /// A motion instead of an equilibrium.
        pub time: Option<Time>,
        /// How.
        pub optimizer: Optimizer,
        /// How outputs change the controls, of `nastic gains`.
        pub gains: Gains,
        /// What solves the linear systems; left out, what counts of work expect to be cheaper.
        pub linear_solver: Option<LinearSolver>,
        /// Points to report.
        pub probes: Vec<Probe> = Vec::new(),
        /// Values the results must have, by their path in `result.json`.
        pub expect: BTreeMap<String, Expectation> = BTreeMap::new(),
        /// What is written where.
        pub output: Output,
        /// For editors: where the JSON Schema of case files is, as `nastic schema` prints it.
        pub schema("$schema"): Option<String>,
    }
}

choice! {
    /// What solves the linear systems of bodies with a symmetric tangent stiffness.
    pub enum LinearSolver {
        /// A sparse factor, kept as preconditioner of conjugate gradients while it serves.
        "direct" => Direct,
        /// Conjugate gradients with multigrid: memory in proportion to the unknowns.
        "multigrid" => Multigrid,
    }
}

object! {
    /// A point of the body to report.
    pub struct Probe {
        /// Name in results.
        pub name: String,
        /// Reference position.
        pub point: Vector as LENGTH,
    }
}

object! {
    /// What is written where.
    pub struct Output {
        /// Directory of all results; `--out` comes first.
        pub directory: Option<String>,
        /// A snapshot is written every so many iterations; 0 for none.
        pub every: usize = 10,
        /// A checkpoint is written every so many iterations; 0 for none. The optimiser forgets its factors there.
        pub checkpoint: usize = 10,
    }
}

/// A case as far as it can be read, and all that is wrong with its form.
pub struct Reading {
    /// Without the entries of lists that cannot be read; `None` where even the mesh cannot be read.
    pub case: Option<Case>,
    /// The mistakes.
    pub problems: Vec<Diagnostic>,
}

impl Case {
    /// Reads a document and checks all that needs no mesh.
    ///
    /// # Errors
    ///
    /// All problems of the file at once: unknown, missing and repeated keys, wrong types, wrong units, unknown names,
    /// contradictions; those of the scenarios' and load cases' variants too.
    pub fn read(document: &Document) -> Result<Self, Diagnostics> {
        let Reading { case, problems } = Self::read_all(document);
        Diagnostics::new(problems).into_result()?;
        case.ok_or_else(Diagnostics::default)
    }

    /// What can be read, whole if there are no problems.
    pub fn read_all(document: &Document) -> Reading {
        let mut reader = Self::reader(document, units(document));
        reader.problems.extend(document.problems().iter().cloned());
        let case = Self::read_document(&mut reader);
        let readable = check::check(&mut reader);
        Reading { case: case.or(readable), problems: reader.problems }
    }

    /// Reads a variant of a case that was read before: other values, the same blocks.
    ///
    /// # Errors
    ///
    /// Values that do not fit their places.
    pub fn read_variant(document: &Document, units: Units) -> Result<Self, Diagnostics> {
        let mut reader = Self::reader(document, units);
        let case = Self::read_document(&mut reader);
        Diagnostics::new(reader.problems).into_result()?;
        case.ok_or_else(Diagnostics::default)
    }

    /// All numbers in front of laws, of materials and then of actuations.
    pub fn designs(&self) -> impl Iterator<Item = &Design> {
        let of_actuations = self.actuation.iter().flat_map(|actuation| actuation.design());
        self.materials.iter().flat_map(|material| &material.design).chain(of_actuations)
    }

    /// Whether a number in front of a law has this name.
    #[must_use]
    pub fn has_design(&self, name: &str) -> bool {
        self.designs().any(|design| design.name == name)
    }

    /// Whether a number in front of laws is 0 or 1 where it is made: a density, a mixture or an electrode, and no filler.
    #[must_use]
    pub fn is_made(&self, name: &str) -> bool {
        let has = |kind: DesignKind| self.designs().any(|own| own.name == name && own.kind == kind);
        let made = [DesignKind::Density, DesignKind::Mixture, DesignKind::Electrode];
        made.into_iter().any(&has) && !has(DesignKind::Filler)
    }

    /// Entries that add a contribution each to the body, in the order of the case's keys.
    pub fn blocks(&self) -> impl Iterator<Item = &dyn Block> {
        let springs = self.springs.iter().map(|own| own as &dyn Block);
        springs.chain(self.media.iter().map(|own| own as &dyn Block))
    }

    /// A reader of cases.
    pub(super) fn reader(document: &Document, units: Units) -> Reader<'_> {
        Reader { hints: HINTS, ..Reader::new(document, units) }
    }

    /// Without the checks between blocks.
    pub(crate) fn read_document(reader: &mut Reader<'_>) -> Option<Self> {
        let mut case = <Self as Read>::read(reader.document.root(), &At::root(), Want::ANY, reader)?;
        let touches = !case.contact.is_empty();
        case.time.iter_mut().for_each(|time| time.choose_scheme(touches));
        case.gather_electrodes();
        Some(case)
    }

    /// The case as far as it can be read, with stand-ins for what must be there: so much shows what else is wrong.
    pub(super) fn readable(reader: &Reader<'_>) -> Option<Self> {
        let root = reader.document.root();
        let place = &root.place;
        let mut members = match &root.value {
            Value::Object(members) => members.clone(),
            _ => vec![],
        };
        let mut stand_in = |is_read: bool, key: &str, value: Value| {
            if !is_read {
                let node = Node { value, place: place.clone() };
                members.retain(|member| member.key != key);
                members.push(Property { key: key.to_owned(), place: place.clone(), node });
            }
        };
        stand_in(block::<u64>(reader, "nastic").is_some(), "nastic", Value::Number(check::VERSION));
        stand_in(block::<MeshSource>(reader, "mesh").is_some(), "mesh", Value::Text("none".to_owned()));
        stand_in(block::<Vec<Material>>(reader, "materials").is_some(), "materials", Value::Array(vec![]));
        let root = Node { value: Value::Object(members), place: place.clone() };
        let mut case =
            <Self as Read>::read(&root, &At::root(), Want::ANY, &mut Reader::new(reader.document, reader.units))?;
        case.gather_electrodes();
        Some(case)
    }

    /// Electrodes stand behind the actuations: names, controls, fixed values and descriptions are alike.
    fn gather_electrodes(&mut self) {
        self.actuation.extend(self.electrodes.drain(..).map(|electrode| electrode.0));
    }
}

/// The units come first: everything else is read with them. Problems in them are reported by the full reading.
pub(crate) fn units(document: &Document) -> Units {
    let mut silent = Reader::new(document, Units::default());
    let node = document.root().find("units");
    node.and_then(|node| Units::read(node, &At::root(), Want::ANY, &mut silent)).unwrap_or_default()
}
