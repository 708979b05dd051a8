//! The steps from a [`Case`] to a [`CaseProblem`], in their order.

use crate::lower::context::{Context, Findings};
use crate::lower::member::Label;
use crate::lower::probe::LocatedProbe;
use crate::lower::problem::CaseProblem;
use crate::lower::scenario::Scenario;
use crate::lower::target_shape::TargetShape;
use crate::lower::variant::Variant;
use crate::lower::{
    body, constraint, control, cost, design, elements, first_order, magnitude, mesh, pressures, prior, probe, scenario,
    scenarios, sizes, slack, start, survey, tension, time_table, variant, weight,
};
use crate::warning::Warning;
use nastic_control::Reduced;
use nastic_ensemble::{Ensemble, EnsembleError, LoadCase};
use nastic_fem::Discretization;
use nastic_language::schema::{Case, Reading};
use nastic_language::syntax::{At, Diagnostic, Diagnostics, Document, quoted};
use serde_json::{Map, Value};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

impl CaseProblem {
    /// Reads all that a case names and builds the problem. A raised flag ends state solves.
    ///
    /// # Errors
    /// All problems found, each with its path and line.
    pub fn lower(document: Document, cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        Self::lower_through(document, cancel, &[], false)
    }

    /// The same of a body whose rigid motions may be free, for what solves no equilibrium: modes of the undeformed body.
    ///
    /// # Errors
    /// As of [`lower`](Self::lower), but for rigid motions.
    pub fn lower_free(document: Document, cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        Self::lower_through(document, cancel, &[], true)
    }

    /// The same, with the instants of the time steps of every member, where they were found, and whether rigid motions may be free.
    pub(super) fn lower_through(
        document: Document,
        cancel: Arc<AtomicBool>,
        instants: &[Vec<f64>],
        free: bool,
    ) -> Result<Self, Diagnostics> {
        let case = match Case::read_all(&document) {
            Reading { case: Some(case), problems } if problems.is_empty() => case,
            Reading { case, problems } => return Err(all_problems(case.as_ref(), problems, &document)),
        };
        let mut context = Context::new(&document, case.units);
        context.free = free;
        let lowered = members(&case, &document, cancel, instants, &mut context);
        let files = context.files();
        let Findings { problems, warnings, notes } = context.found;
        let Lowered { ensemble, labels, differences, controls, probes, ordering } = match (lowered, problems.is_empty())
        {
            (Some(lowered), true) => lowered,
            _ => return Err(Diagnostics::new(problems)),
        };
        let warnings = warnings.iter().map(|(kind, shown)| Warning::at(kind, shown)).collect();
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
    cancel: Arc<AtomicBool>,
    instants: &[Vec<f64>],
    context: &mut Context<'_>,
) -> Option<Lowered> {
    let Some(mesh) = mesh::body(case, context) else {
        // What else is missing is reported along with it.
        cost::load_targets(case, context);
        return None;
    };
    let began = Instant::now();
    let disc = context.take(&mesh::at(case), Discretization::new(mesh.clone()))?;
    let ordering = began.elapsed();
    survey::names(document, &mesh, context);
    let probes = probe::locate(case, &mesh, context);
    let scenarios = scenarios::scenarios(case, document, &disc, context)?;
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
        pressures::check_bounds(case, &controls.controls, body.solid(), context);
        magnitude::check_controls(case, &controls.controls, context);
    }
    if context.is_sound() {
        start::check(case, &controls.controls, context);
    }
    if !context.is_sound() {
        return None;
    }
    let (ensemble, labels) = join(case, &scenarios, variants, bodies, targets, cancel, context)?;
    for (member, label) in ensemble.members().iter().zip(&labels) {
        let start = ensemble.local(member, &controls.start).unwrap_or_default();
        if let Err(error) = member.problem().check_own_controls(&start) {
            context.complain(&at_of_moved(&label.case, &error.to_string()), error.to_string());
            return None;
        }
    }
    let differences = scenarios.into_iter().map(|scenario| scenario.values).collect();
    Some(Lowered { ensemble, labels, differences, controls, probes, ordering })
}

/// The block of the obstacle, or of the actuation, that a message names.
fn at_of_moved(case: &Case, message: &str) -> At {
    let says = |name: &str| message.contains(&quoted(name));
    let touched = case.contact.iter().find(|contact| says(&contact.name()));
    let obstacle = touched.and_then(|contact| case.obstacles.iter().find(|own| contact.is_on(&own.name)));
    let moved = case.actuation.iter().find(|actuation| says(&actuation.name));
    obstacle.map(|own| own.at.clone()).or(moved.map(|own| own.at.clone())).unwrap_or_else(At::root)
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
            sizes::check_moduli(&variant.case, body.solid(), context);
            sizes::check_poissons_ratios(&variant.case, body.solid(), context);
            sizes::check_stiffness(&variant.case, body.solid(), context);
            slack::check(&variant.case, body.solid(), context);
            weight::check(&variant.case, body.solid(), context);
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
        design::check_means(&variant.case, &body, context);
        design::check_volumes(&variant.case, fields, &body, context);
        let (body, shapes) = cost::add(&variant.case, aims, body, context)?;
        let body = prior::add(variants, variant, case.controls.len(), body, context)?;
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
    if let (Some(block), [only]) = (first_order::block(case), scenarios) {
        builder = builder.first_order(first_order::risk(block, only));
    }
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
