//! From a [`Case`] to a [`CaseProblem`]: meshes read, formulas evaluated where they are needed, names looked up.
//!
//! Every problem names its path and line; as many as possible are found before giving up. A case becomes an
//! [`Ensemble`] of members, one for every load case of every scenario; a plain case is an ensemble of one.

mod actuation;
mod adaptive_steps;
mod array;
mod assembled;
mod bending;
mod body;
mod constraint;
mod context;
mod control;
mod control_grid;
mod control_start;
mod cost;
mod elements;
mod field;
mod inertia;
mod load;
mod material;
mod member;
mod mesh;
mod named;
mod named_cost;
mod optimizer;
mod place;
mod probe;
mod random;
mod scenario;
mod shape_cost;
mod sizes;
mod spring;
mod start;
mod support;
mod survey;
mod tension;
mod time;
mod time_table;
mod variant;

pub(crate) use actuation::CONTRACTION;
pub use adaptive_steps::StepsError;
pub use assembled::AssemblyError;
pub(crate) use assembled::{Admission, Assembled, ControlProblem};
pub use control::{Admitted, ControlField};
pub(crate) use control_grid::grid_cells;
pub use cost::TargetShape;
pub use member::CaseMember;
pub(crate) use mesh::again as mesh_again;
pub use probe::LocatedProbe;
pub(crate) use variant::file_name;

use crate::quantity::Units;
use crate::schema::{Case, Reading, Unstable};
use crate::syntax::{At, Diagnostic, Diagnostics, Document};
use crate::warning::Warning;
use context::{Context, Found};
use member::Label;
use nastic_control::{Ensemble, EnsembleError, LoadCase, Metric, Reduced};
use nastic_fem::{Discretization, Solid};
use nastic_mesh::Mesh;
use nastic_opt::{InnerProduct, Objective, Optimizer, Problem as _, Product};
use scenario::Scenario;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use variant::Variant;

/// A case made ready to compute: what every command works on.
#[derive(Debug)]
pub struct CaseProblem {
    /// The file, with its overrides.
    pub document: Document,
    /// Its blocks.
    pub case: Case,
    /// Bodies, controls and costs of all members.
    pub ensemble: Ensemble,
    /// The control fields, in the order of the ensemble's blocks: those all share in file order, then those of load cases.
    pub controls: Vec<ControlField>,
    /// Control vector to start from.
    pub start: Vec<f64>,
    /// Where the control vector must stay.
    pub set: Product,
    /// Points to report.
    pub probes: Vec<LocatedProbe>,
    /// What deserves attention in the case, before anything is solved.
    pub warnings: Vec<Warning>,
    /// What was mended when meshes were read, and the sizes of obstacles that are meshes.
    pub notes: Vec<String>,
    /// All files that were read, the case itself left out.
    pub files: Vec<PathBuf>,
    /// Wall time of the tangent's pattern and elimination order, which belong to solving rather than to reading.
    pub ordering: Duration,
    labels: Vec<Label>,
    /// What differs in every scenario.
    differences: Vec<Map<String, Value>>,
    /// Whether a program made the problem, and `document` says only what it is.
    of_program: bool,
    /// Whether the time steps are those that were found.
    has_steps: bool,
}

impl CaseProblem {
    /// Reads all that a case names and builds the problem. A raised flag ends state solves.
    ///
    /// # Errors
    /// All problems found, each with its path and line.
    pub fn lower(document: Document, cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        Self::lower_through(document, cancel, &[])
    }

    /// The same, with the instants of the time steps of every member, where they were found.
    fn lower_through(document: Document, cancel: Arc<AtomicBool>, instants: &[Vec<f64>]) -> Result<Self, Diagnostics> {
        let case = match Case::read_all(&document) {
            Reading { case: Some(case), problems } if problems.is_empty() => case,
            Reading { case, problems } => return Err(all_problems(case.as_ref(), problems, &document)),
        };
        let mut context = Context::new(&document, case.units);
        let lowered = members(&case, &document, (cancel, instants), &mut context);
        let files = context.files();
        let Found { problems, warnings, notes } = context.found;
        let Lowered { ensemble, labels, differences, controls, probes, ordering } = match (lowered, problems.is_empty())
        {
            (Some(lowered), true) => lowered,
            _ => return Err(Diagnostics::new(problems)),
        };
        let warnings = warnings.iter().map(|(kind, told)| Warning::at(kind, told)).collect();
        let control::Lowered { controls, start, set, .. } = controls;
        let (of_program, has_steps) = (false, false);
        Ok(Self {
            case,
            ensemble,
            controls,
            start,
            set,
            probes,
            warnings,
            notes,
            files,
            ordering,
            labels,
            differences,
            document,
            of_program,
            has_steps,
        })
    }

    /// The case file as it was named; `None` where a program made the problem.
    #[must_use]
    pub fn case_file(&self) -> Option<&str> {
        (!self.of_program).then(|| self.document.name())
    }

    /// The body of the first member.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        self.member(0).solid()
    }

    /// The mesh, which all members share.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        self.solid().mesh()
    }

    /// The units of all numbers.
    #[must_use]
    pub fn units(&self) -> &Units {
        &self.case.units
    }

    /// What differs in a scenario: paths and values.
    #[must_use]
    pub fn differences(&self, scenario: usize) -> &Map<String, Value> {
        &self.differences[scenario]
    }

    /// Whether anything is to be made small.
    #[must_use]
    pub fn has_costs(&self) -> bool {
        self.members().any(|member| !member.reduced().costs().is_empty())
    }

    /// Number of continuation stages.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.ensemble.stages()
    }

    /// The optimiser of the case.
    ///
    /// # Errors
    /// A method that is not supported; [`Self::lower`] has refused it already.
    pub fn optimizer(&self) -> Result<Box<dyn Optimizer>, Diagnostics> {
        optimizer::build(&self.case)
            .ok_or_else(|| self.document.complain(&self.case.optimizer.at.key("method"), "not supported yet").into())
    }

    /// Lets unstable equilibria fail where the case says so (`"unstable": "refuse"`): for whoever optimises.
    pub fn refuse_unstable_if_asked(&mut self) {
        if self.case.optimizer.unstable == Unstable::Refuse {
            self.ensemble.refuse_unstable(true);
        }
    }

    /// The inner product of controls.
    #[must_use]
    pub fn metric(&self) -> Metric {
        optimizer::metric(&self.case)
    }

    /// The problem `message` at a path of the case.
    #[must_use]
    pub fn complain(&self, key: &str, message: impl Into<String>) -> Diagnostics {
        self.document.complain(&At::root().key(key), message).into()
    }

    /// The inner product of the controls; nothing where there are none.
    #[must_use]
    pub fn inner_product(&self) -> Option<Arc<dyn InnerProduct>> {
        self.ensemble.inner_product().ok()
    }
}

/// Mistakes of form, and what else is wrong with a case as far as it can be read.
fn all_problems(case: Option<&Case>, mut problems: Vec<Diagnostic>, document: &Document) -> Diagnostics {
    if let Some(case) = case {
        let mut context = Context::new(document, case.units);
        survey::look(case, document, &mut context);
        problems.extend(context.found.problems);
    }
    Diagnostics::new(problems)
}

/// What becomes of a case.
struct Lowered {
    ensemble: Ensemble,
    labels: Vec<Label>,
    differences: Vec<Map<String, Value>>,
    controls: control::Lowered,
    probes: Vec<LocatedProbe>,
    ordering: Duration,
}

/// Everything but the case's own words; `None` after a complaint.
fn members(
    case: &Case,
    document: &Document,
    (cancel, instants): (Arc<AtomicBool>, &[Vec<f64>]),
    context: &mut Context<'_>,
) -> Option<Lowered> {
    let Some(mesh) = mesh::body(case, context) else {
        // What else is missing is told along with it.
        cost::load_targets(case, context);
        return None;
    };
    let began = Instant::now();
    let disc = context.take(&mesh::at(case), Discretization::new(mesh.clone()))?;
    let ordering = began.elapsed();
    survey::names(document, &mesh, context);
    let probes = probe::locate(case, &mesh, context);
    let scenarios = scenario::scenarios(case, document, &disc, context)?;
    let mut variants = match variant::all(case, document, &scenarios, context) {
        Ok(variants) => variants,
        Err(problems) => {
            context.found.problems.extend(problems.list().iter().cloned());
            return None;
        }
    };
    let mut found = Vec::new();
    for (variant, instants) in variants.iter_mut().zip(instants) {
        variant.instants = Some(instants.clone());
    }
    for variant in &mut variants {
        let mut own = context.variant(&variant.document);
        time_table::resolve(&mut variant.case, &mut own);
        found.push((variant.name.clone(), own.found));
    }
    context.found.absorb(found);
    let mut contexts: Vec<Context<'_>> = variants.iter().map(|variant| context.variant(&variant.document)).collect();
    let built = build(case, &variants, &disc, &mut contexts);
    let found = contexts.into_iter().map(|context| context.found);
    context.found.absorb(variants.iter().map(|variant| variant.name.clone()).zip(found).collect());
    let Built { bodies, targets, controls } = built?;
    if let Some(body) = bodies.first() {
        sizes::check_bounds(&controls.controls, body.solid(), context);
    }
    if context.is_sound() {
        start::check(case, &controls.controls, context);
    }
    if !context.is_sound() {
        return None;
    }
    let (ensemble, labels) = join(case, &scenarios, variants, bodies, targets, cancel, context)?;
    let differences = scenarios.into_iter().map(|scenario| scenario.values).collect();
    Some(Lowered { ensemble, labels, differences, controls, probes, ordering })
}

/// The members before they are joined.
struct Built {
    bodies: Vec<Reduced>,
    targets: Vec<Vec<TargetShape>>,
    controls: control::Lowered,
}

/// Bodies, then bounds, then costs: bounds and costs look at the bodies, and those of one that is not as written would
/// complain of their own.
fn build(case: &Case, variants: &[Variant], disc: &Arc<Discretization>, contexts: &mut [Context<'_>]) -> Option<Built> {
    let (mut aims, mut limits, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
    for (variant, context) in variants.iter().zip(contexts.iter_mut()) {
        let targets = cost::load_targets(&variant.case, context);
        limits.push(constraint::load_targets(&variant.case, context));
        bodies.push(body::lower(variant, disc, context));
        sizes::check(&variant.case, disc.mesh(), &targets, context);
        sizes::check_obstacles(&variant.case, disc.mesh(), context);
        if let Some(Some(body)) = bodies.last() {
            elements::check(&variant.case, body.solid(), context);
        }
        aims.push(targets);
    }
    let bodies: Vec<Reduced> = bodies.into_iter().collect::<Option<_>>()?;
    if !contexts.iter().all(|context| context.is_sound()) {
        return None;
    }
    let controls = control::lower(case.controls.len(), variants, &bodies, contexts);
    let fields = controls.as_ref().map_or(&[][..], |controls| &controls.controls);
    tension::warn_of_families(case.controls.len(), variants, &bodies, fields, contexts);
    let (mut out, mut targets) = (Vec::new(), Vec::new());
    let members = variants.iter().zip(bodies).zip(aims.into_iter().zip(limits)).zip(contexts);
    for (((variant, body), (aims, limits)), context) in members {
        let body = control::weigh(variant, case.controls.len(), body, fields, context)?;
        let (body, shapes) = cost::add(&variant.case, aims, body, context)?;
        let body = constraint::add(&variant.case, limits, body, context)?;
        cost::warn(&variant.case, &body, context);
        out.push(body);
        targets.push(shapes);
    }
    Some(Built { bodies: out, targets, controls: controls? })
}

/// The members side by side.
fn join(
    case: &Case,
    scenarios: &[Scenario],
    variants: Vec<Variant>,
    bodies: Vec<Reduced>,
    targets: Vec<Vec<TargetShape>>,
    cancel: Arc<AtomicBool>,
    context: &mut Context<'_>,
) -> Option<(Ensemble, Vec<Label>)> {
    let mut cases: Vec<Vec<LoadCase>> = scenarios.iter().map(|_| vec![]).collect();
    let mut labels = Vec::new();
    for ((variant, body), targets) in variants.into_iter().zip(bodies).zip(targets) {
        let own = variant.case.controls.iter().skip(case.controls.len());
        let part = LoadCase::new(&variant.case_name, variant.weight, body);
        cases[variant.scenario].push(own.fold(part, |part, control| part.own(&control.of)));
        let load_case = variant.load_case.map(|_| variant.case_name.clone());
        let (scenario, Variant { stem, case_stem, case, .. }) = (scenarios[variant.scenario].name.clone(), variant);
        labels.push(Label { scenario, load_case, stem, case_stem, case, targets });
    }
    let mut builder = Ensemble::new(scenario::risk(case)).cancelled_by(cancel);
    for (scenario, cases) in scenarios.iter().zip(cases) {
        builder = builder.scenario_of(scenario.name.as_deref().unwrap_or(""), scenario.probability, cases);
    }
    match builder.build() {
        Ok(ensemble) => Some((ensemble, labels)),
        Err(error) => {
            let at = match &error {
                EnsembleError::Risk(_) => scenario::risk_at(case),
                _ => At::root().key("controls"),
            };
            context.complain(&at, error.to_string());
            None
        }
    }
}
