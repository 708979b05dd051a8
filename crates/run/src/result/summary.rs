//! The parts of `result.json`.

use crate::result::member_report::MemberReport;
use nastic_case::lower::{Admitted, CaseMember, CaseProblem, ControlField};
use nastic_control::{Basis, ControlBlock, ControlError, CostPoint, EnsembleBlock, FigureKind, Space};
use nastic_energy::SlotGroup;
use nastic_fem::{Demand, Inadmissible, Instant, SolveReport, State};
use nastic_numeric::vector::norm;
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// `{ "total": ..., "terms": { NAME: ... } }` of a member.
pub(crate) fn cost(report: &MemberReport<'_>) -> Value {
    let names = report.member.reduced().term_names();
    let entries: Map<String, Value> =
        names.into_iter().zip(&report.terms).map(|(name, value)| (name, json!(value))).collect();
    json!({ "total": report.terms.iter().sum::<f64>(), "terms": entries })
}

/// What costs report of themselves, of these kinds: `{ TERM: { FIGURE: ... } }`.
fn reported(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
    is_told: fn(FigureKind) -> bool,
) -> Result<Map<String, Value>, ControlError> {
    let mut out = Map::new();
    for (name, cost) in member.reduced().term_names().into_iter().zip(costs) {
        let own = cost.figures()?.into_iter().filter(|figure| is_told(figure.kind));
        let own: Map<String, Value> = own.map(|figure| (figure.kind.name().to_owned(), json!(figure.value))).collect();
        if !own.is_empty() {
            out.insert(name, Value::Object(own));
        }
    }
    Ok(out)
}

/// `{ "smoothed": ..., "true": ..., "self": ... }` of the first such cost, and of each under its name where there are
/// several.
pub(crate) fn hausdorff(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
) -> Result<Map<String, Value>, ControlError> {
    let all = reported(member, costs, FigureKind::is_hausdorff)?;
    let mut out = all.values().next().and_then(Value::as_object).cloned().unwrap_or_default();
    if all.len() > 1 {
        out.extend(all);
    }
    Ok(out)
}

/// `{ TERM: { "root_mean_square": ..., "largest": ... } }`: distances of tracked points from their targets.
pub(crate) fn tracking(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
) -> Result<Map<String, Value>, ControlError> {
    reported(member, costs, FigureKind::is_tracking)
}

/// `{ TERM: { "angle": ... } }`: what other costs report of themselves.
pub(crate) fn figures(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
) -> Result<Map<String, Value>, ControlError> {
    reported(member, costs, |kind| matches!(kind, FigureKind::Other(_)))
}

/// `{ "euclidean": ..., "metric": ... }`
pub(crate) fn derivative_norm(problem: &CaseProblem, derivative: &[f64]) -> Value {
    json!({ "euclidean": norm(derivative), "metric": problem.inner_product().map(|product| product.dual_norm(derivative)) })
}

/// `{ NAME: { "point": [...], "displacement": [...], "position": [...] } }`
fn probes(member: CaseMember<'_>, state: &State) -> Value {
    let dim = member.mesh().dim();
    let of = |probe: &nastic_case::lower::LocatedProbe| {
        let u = probe.displacement(&state.u, dim);
        let position: [f64; 3] = std::array::from_fn(|k| probe.point[k] + u[k]);
        (probe.name.clone(), json!({ "point": probe.point, "displacement": u, "position": position }))
    };
    Value::Object(member.problem().probes.iter().map(of).collect())
}

/// `{ NAME: [..] }`: the part of every control in a control vector or a derivative.
pub(crate) fn control_values(problem: &CaseProblem, m: &[f64]) -> Value {
    let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
    blocks.map(|(block, field)| (field.name.clone(), json!(block.of(m)))).collect::<Map<_, _>>().into()
}

/// The values of a control that has few: of the space `uniform` a number (a vector: a list), of `region` one for each by
/// name; null in other spaces.
fn values(basis: &Basis, values: &[f64], components: usize) -> Value {
    let mut each = values.chunks_exact(components).map(|v| if components == 1 { json!(v[0]) } else { json!(v) });
    match basis.space() {
        Space::Uniform => each.next().unwrap_or_default(),
        Space::Region => {
            each.enumerate().map(|(k, value)| (basis.region(k).to_owned(), value)).collect::<Map<_, _>>().into()
        }
        Space::Cell | Space::Point | Space::Node | Space::Grid(_) => Value::Null,
    }
}

/// `{ NAME: { "array", "slot", "space", "unit", "unknowns", "min", "max", "lower", "upper", "active", "active_share", "total_variation", "grid" } }`;
/// lengths of vectors where the control is one.
pub(crate) fn controls(problem: &CaseProblem, m: &[f64]) -> Value {
    let of = |(block, field): (&EnsembleBlock, &ControlField)| {
        let n = owner(problem, block).components;
        let size = |v: &[f64]| if n == 1 { v[0] } else { norm(v) };
        let sizes: Vec<f64> = block.of(m).chunks_exact(n).map(size).collect();
        let (min, max) = sizes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let active = active(block.of(m), n, field);
        let share = active as f64 / sizes.len().max(1) as f64;
        let own = owner(problem, block);
        let slot = slot(problem.member(block.owner), own);
        let (lower, upper) = match field.admitted {
            Admitted::Between { lower, upper } => (finite(lower), finite(upper)),
            Admitted::Norm(length) => (Some(length), Some(length)),
            Admitted::MaxNorm(most) => (None, Some(most)),
            Admitted::Any => (None, None),
        };
        let mut entry = json!({
            "array": field.array, "slot": slot, "space": own.basis.space().name(), "unit": field.unit,
            "unknowns": block.len, "min": min, "max": max, "lower": lower, "upper": upper,
            "active": active, "active_share": share,
        });
        if !own.basis.is_of_contribution() && own.knots.is_none() {
            let disc = problem.member(block.owner).solid().discretization();
            entry["total_variation"] = json!(own.total_variation(disc, block.of(m)));
        }
        if let Some(grid) = own.basis.grid() {
            entry["grid"] = json!(grid.cells());
        }
        let each = |values_of: &[f64]| values(&own.basis, values_of, n);
        let few = match &own.knots {
            None => each(block.of(m)),
            Some(knots) => {
                entry["instants"] = json!(knots.instants());
                block.of(m).chunks_exact(own.size()).map(each).filter(|values| !values.is_null()).collect()
            }
        };
        if !few.is_null() && few != json!([]) {
            entry["values"] = few;
        }
        (field.name.clone(), entry)
    };
    Value::Object(problem.ensemble.blocks().iter().zip(&problem.controls).map(of).collect())
}

/// The name of the slots that a control drives; `None` for a contribution that is no field.
pub(crate) fn slot(member: CaseMember<'_>, block: &ControlBlock) -> Option<&'static str> {
    let controllable = member.solid().model().controllable();
    SlotGroup::of(controllable.get(block.targets[0].actuation)?.slots)
        .into_iter()
        .find(|group| group.first == block.targets[0].slot)
        .map(|group| group.name)
}

/// Whether negative values of a control have no meaning: of muscles and tendons.
pub(crate) fn only_pulls(member: CaseMember<'_>, block: &ControlBlock) -> bool {
    let controllable = member.solid().model().controllable();
    controllable
        .get(block.targets[0].actuation)
        .and_then(|own| own.slots.get(block.targets[0].slot))
        .is_some_and(|slot| slot.not_negative)
}

fn finite(bound: f64) -> Option<f64> {
    bound.is_finite().then_some(bound)
}

/// How many values of a control field lie on a bound; vectors count once.
pub(crate) fn active(values: &[f64], components: usize, field: &ControlField) -> usize {
    if field.bounds.is_some() {
        let is_active =
            |(i, v): (usize, &[f64])| v.iter().enumerate().any(|(c, x)| is_active(components * i + c, *x, field));
        return values.chunks_exact(components).enumerate().filter(|at| is_active(*at)).count();
    }
    let size = |v: &[f64]| if components == 1 { v[0] } else { norm(v) };
    let sizes = values.chunks_exact(components).map(size).enumerate();
    sizes.filter(|(i, x)| is_active(*i, *x, field)).count()
}

/// A control field as the first member that uses it has it.
pub(crate) fn owner<'p>(problem: &'p CaseProblem, block: &EnsembleBlock) -> &'p ControlBlock {
    &problem.member(block.owner).layout().blocks()[block.field]
}

/// Whether a value lies on a bound; on a sphere every vector does, which says nothing.
fn is_active(unknown: usize, value: f64, field: &ControlField) -> bool {
    match (&field.bounds, field.admitted) {
        (Some(bounds), _) => {
            let (lower, upper) = bounds.at(unknown);
            value <= lower || value >= upper
        }
        (None, Admitted::MaxNorm(most)) => value >= most * (1.0 - 1e-12),
        (None, _) => false,
    }
}

/// `{ SUPPORT: [x, y, z] }`: the forces the supports exert on the body.
fn reactions(member: CaseMember<'_>, state: &State) -> Result<Value, Inadmissible> {
    let solid = member.solid();
    let at = Instant::of(state);
    let residual = solid.model().evaluate(&at, Demand { energy: false, force: true })?.force;
    let entries = solid.supports().reactions(&residual).into_iter().map(|(name, force)| (name, json!(force)));
    Ok(Value::Object(entries.collect()))
}

/// `{ CONTRIBUTION: { "pressure": .., "volume": .. } }`; nothing where no contribution reports anything.
fn contributions(member: CaseMember<'_>, state: &State) -> Result<Map<String, Value>, Inadmissible> {
    let at = Instant::of(state);
    let mut out = Map::new();
    for (name, quantity, value) in member.solid().model().quantities(&at)? {
        out.entry(name).or_insert_with(|| json!({}))[quantity] = json!(value);
    }
    Ok(out)
}

/// The potential of passive laws, actuations and loads at a state of a motion, with relaxed viscous laws.
pub(crate) fn potential(member: CaseMember<'_>, state: &State) -> f64 {
    let model = member.solid().model();
    let at = Instant::new(&state.u, &state.controls, 1.0);
    model.evaluate(&at, Demand { energy: true, force: false }).map_or(f64::NAN, |sums| sums.energy)
}

/// `min_J`, `potential`, probes, what contributions report: what a state says without another factor.
pub(crate) fn shape(member: CaseMember<'_>, state: &State) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("min_J".into(), json!(state.report.min_j));
    out.insert("residual".into(), json!(state.report.residual));
    let potential = match member.reduced().timeline() {
        None => state.report.energy,
        Some(_) => potential(member, state),
    };
    out.insert("potential".into(), json!(potential));
    out.insert("probes".into(), probes(member, state));
    if let Ok(found) = contributions(member, state).map(|found| (!found.is_empty()).then_some(found)) {
        out.extend(found.map(|found| ("contributions".to_owned(), Value::Object(found))));
    }
    out
}

/// What a state says of itself: `min_J`, `potential`, reactions, probes, what contributions report.
pub(crate) fn state(member: CaseMember<'_>, state: &State) -> Map<String, Value> {
    let mut out = shape(member, state);
    if member.reduced().timeline().is_some() {
        return out; // in motion supports hold masses and viscous forces too
    }
    out.insert("reactions".into(), reactions(member, state).unwrap_or(Value::Null));
    out
}

/// What it took.
pub(crate) fn work(report: &SolveReport) -> Map<String, Value> {
    let entries = [
        ("newton_iterations", report.newton),
        ("factorisations", report.factorisations),
        ("reused_factorisations", report.reused),
        ("back_substitutions", report.back_substitutions),
        ("multigrid_hierarchies", report.hierarchies),
        ("multigrid_cycles", report.cycles),
        ("load_steps_cut", report.cuts),
    ];
    let mut out: Map<String, Value> = entries.into_iter().map(|(key, value)| (key.to_owned(), json!(value))).collect();
    out.insert("linear_solver".into(), json!(report.solver.to_string()));
    out
}
