//! What a state says of itself: costs, distances, deformation, forces, work.

use crate::member_report::MemberReport;
use nastic_case::electric;
use nastic_case::lower::{CaseMember, LocatedProbe};
use nastic_control::{ControlError, CostPoint, DistanceInTime, FigureKind};
use nastic_fem::{Demand, Inadmissible, Instant, SolveReport, State, StoredEnergy};
use nastic_report::record::{
    ByName, ContributionRecord, CostRecord, HausdorffRecord, Number, Numbers, ProbeRecord, ProbesRecord, StateRecord,
    StoredEnergyRecord, numbers,
};
use std::sync::Arc;

/// The cost of a member and its terms.
pub(crate) fn cost(report: &MemberReport<'_>) -> CostRecord {
    let names = report.member.reduced().term_names();
    let terms = names.into_iter().zip(&report.terms).map(|(name, value)| (name, (*value).into())).collect();
    CostRecord { total: report.terms.iter().sum::<f64>().into(), terms }
}

/// What costs report of themselves, of these kinds, by term.
fn reported(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
    is_reported: fn(FigureKind) -> bool,
) -> Result<ByName<Numbers>, ControlError> {
    let mut out = ByName::default();
    for (name, cost) in member.reduced().term_names().into_iter().zip(costs) {
        let own = cost.figures()?.into_iter().filter(|figure| is_reported(figure.kind));
        let own: Numbers = own.map(|figure| (figure.kind.name().to_owned(), figure.value.into())).collect();
        if !own.is_empty() {
            out.insert(name, own);
        }
    }
    Ok(out)
}

/// Distances of the first such cost, and of each under its name where there are several; nothing without one.
pub(crate) fn hausdorff(
    member: CaseMember<'_>,
    costs: &[Arc<dyn CostPoint>],
) -> Result<Option<HausdorffRecord>, ControlError> {
    let of = |own: &Numbers| {
        let number = |kind: FigureKind| own.get(kind.name()).copied().unwrap_or_default();
        HausdorffRecord {
            smoothed: number(FigureKind::SmoothedDistance),
            exact: number(FigureKind::TrueDistance),
            floor: number(FigureKind::SelfDistance),
            terms: ByName::default(),
        }
    };
    let all = reported(member, costs, FigureKind::is_hausdorff)?;
    let terms =
        if all.len() > 1 { all.iter().map(|(name, own)| (name.clone(), of(own))).collect() } else { ByName::default() };
    Ok(all.values().next().map(|first| HausdorffRecord { terms, ..of(first) }))
}

/// By term distances of tracked points from their targets.
pub(crate) fn tracking(member: CaseMember<'_>, costs: &[Arc<dyn CostPoint>]) -> Result<ByName<Numbers>, ControlError> {
    reported(member, costs, FigureKind::is_tracking)
}

/// By term what other costs report of themselves.
pub(crate) fn figures(member: CaseMember<'_>, costs: &[Arc<dyn CostPoint>]) -> Result<ByName<Numbers>, ControlError> {
    reported(member, costs, |kind| !kind.is_hausdorff() && !kind.is_tracking())
}

/// The distances over a motion, beside that at its end.
pub(crate) fn add_distances(
    figures: &mut ByName<Numbers>,
    member: CaseMember<'_>,
    distances: &[Option<DistanceInTime>],
) {
    for (name, distance) in member.reduced().term_names().into_iter().zip(distances) {
        if let (Some(own), Some(DistanceInTime { largest, root_mean_square })) = (figures.get_mut(&name), distance) {
            own.insert("position_distance_largest".to_owned(), (*largest).into());
            own.insert("position_distance_root_mean_square".to_owned(), (*root_mean_square).into());
        }
    }
}

fn probes(member: CaseMember<'_>, state: &State) -> ByName<ProbesRecord> {
    let dim = member.mesh().dim();
    let of = |probe: &LocatedProbe| {
        let u = probe.displacement(&member.solid().model().displacement(&state.u), dim);
        (probe.name.clone(), ProbesRecord::One(moved(probe, u)))
    };
    member.problem().probes.iter().map(of).collect()
}

/// A probe that moves by `u`.
pub(crate) fn moved(probe: &LocatedProbe, u: [f64; 3]) -> ProbeRecord {
    let position: [f64; 3] = std::array::from_fn(|k| probe.point[k] + u[k]);
    let [point, displacement, position] = [&probe.point, &u, &position].map(|x| numbers(x));
    ProbeRecord { point, displacement, position, deviation: None }
}

/// Schemes whose accelerations on surfaces that move are none, and one that carries no accelerations.
const MOVED_UNKNOWN: [&str; 2] = ["tr_bdf2", "trapezoidal"];
const ALL_UNKNOWN: &str = "implicit_midpoint";

/// The force of every support in a state, and in the step that led there; not a number where the scheme does not know it.
pub fn forces(member: CaseMember<'_>, before: Option<&State>, state: &State) -> Vec<(String, [f64; 3])> {
    let solid = member.solid();
    let unknown = || solid.supports().reactions(&vec![f64::NAN; state.u.len()]);
    let scheme = member.reduced().timeline().map_or("", |timeline| timeline.scheme().name());
    if scheme == ALL_UNKNOWN {
        return unknown();
    }
    let mut all = solid.reactions(before, state).unwrap_or_else(|_| unknown());
    let controllable = solid.model().controllable();
    let is_moved = |name: &str| controllable.iter().any(|own| own.holds && own.name == name);
    let open = |(name, _): &&mut (String, [f64; 3])| MOVED_UNKNOWN.contains(&scheme) && is_moved(name);
    all.iter_mut().filter(open).for_each(|(_, force)| *force = [f64::NAN; 3]);
    all
}

/// The same for results.
pub fn reactions(member: CaseMember<'_>, before: Option<&State>, state: &State) -> ByName<Vec<Number>> {
    named(&forces(member, before, state))
}

/// Forces by the names of supports.
pub fn named(forces: &[(String, [f64; 3])]) -> ByName<Vec<Number>> {
    forces.iter().map(|(name, force)| (name.clone(), numbers(force))).collect()
}

/// Stored energies for results.
pub fn energy(stored: StoredEnergy) -> StoredEnergyRecord {
    StoredEnergyRecord { elastic: stored.elastic.into(), contact: stored.contact.into() }
}

/// By contribution what it reports.
///
/// # Errors
/// A state that a contribution does not admit.
pub fn contributions(member: CaseMember<'_>, state: &State) -> Result<ByName<ContributionRecord>, Inadmissible> {
    let mut out = ByName::<Numbers>::default();
    for (name, quantity, value) in electric::quantities(member, &Instant::of(state))? {
        out.entry(name).or_default().insert(quantity.to_owned(), value.into());
    }
    Ok(out.into_iter().map(|(name, numbers)| (name, numbers.into())).collect())
}

/// The potential of passive laws, actuations and loads at a state of a motion, with relaxed viscous laws.
pub fn potential(member: CaseMember<'_>, state: &State) -> f64 {
    let model = member.solid().model();
    let at = Instant::new(&state.u, &state.controls, 1.0);
    model.evaluate(&at, Demand { energy: true, force: false }).map_or(f64::NAN, |sums| sums.energy)
}

/// What a state says without another factor: smallest J, potential, probes, what contributions report.
pub fn shape(member: CaseMember<'_>, state: &State) -> StateRecord {
    let potential = match member.reduced().timeline() {
        None => state.report.energy,
        Some(_) => potential(member, state),
    };
    StateRecord {
        min_j: state.report.min_j.into(),
        residual: state.report.residual.into(),
        potential: potential.into(),
        probes: Some(probes(member, state)),
        contributions: contributions(member, state).unwrap_or_default(),
        ..StateRecord::default()
    }
}

/// The same with the reactions and the stored energies of equilibria; those of a motion are known where its steps are.
pub(crate) fn state(member: CaseMember<'_>, state: &State) -> StateRecord {
    let is_equilibrium = member.reduced().timeline().is_none();
    let reactions = is_equilibrium.then(|| reactions(member, None, state));
    let stored = if is_equilibrium { member.solid().model().energies().stored_energy(state).ok() } else { None };
    StateRecord { reactions, energy: stored.map(energy), ..shape(member, state) }
}

/// Puts what it took into a state's entries.
pub fn add_work(state: &mut StateRecord, work: &SolveReport) {
    state.newton_iterations = Some(work.newton);
    state.factorisations = Some(work.factorisations);
    state.reused_factorisations = Some(work.reused);
    state.back_substitutions = Some(work.back_substitutions);
    state.multigrid_hierarchies = Some(work.hierarchies);
    state.multigrid_cycles = Some(work.cycles);
    state.unassembled_systems = Some(work.unassembled);
    state.load_steps_cut = Some(work.cuts);
    state.strategies =
        work.strategies.tried().map(|(strategy, count)| (strategy.name().to_owned(), count as usize)).collect();
    state.linear_solver = Some(work.solver.to_owned());
}
