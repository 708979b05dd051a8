//! `nastic modes`: frequencies and shapes of small vibrations about an equilibrium or the undeformed body.

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::modes_request::ModesRequest;
use crate::run::report::remove_earlier;
use crate::run::session::{
    CommandContext, CommandFindings, CommandInput, Destination, Opened, START_ACCURACY, evaluate_start,
};
use crate::run::solve::equilibrium::report;
use crate::run::solve::modes::with_fields;
use crate::run::unmet;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{ControlError, StateFields};
use nastic_ensemble::EnsembleWorkspace;
use nastic_fem::{Controls, ModalDamping, ModeKind, SolveOptions, State, TimeStepping, VibrationMode};
use nastic_language::number::{quantity, short};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::Beginning;
use nastic_mesh::Snapshot;
use nastic_report::record::{ModesRecord, ModesUnits, Number, VibrationInSteps, numbers};
use nastic_result::collections::write_collections;
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::target_files::write_targets;
use nastic_result::title::title;
use nastic_result::{picture, snapshot};
use std::f64::consts::TAU;

/// Modes that are drawn.
const DRAWN: usize = 4;
/// The largest displacement of a mode that is drawn, as a share of the body's size.
const AMPLITUDE: f64 = 0.1;
/// `w^2`, and `phi . M phi` in space and of a unit of thickness.
const SQUARE: Dimension = Dimension::of(0, 0, -2, 0);
const MASS_PER_LENGTH: Dimension = Dimension::of(-2, 1, 2, 0);

/// A member's state, control vector and modes.
struct StateModes {
    state: State,
    m: Vec<f64>,
    modes: Vec<VibrationMode>,
    seen: Option<ModesInSteps>,
}

/// The modes as the steps of a case's motion move them.
struct ModesInSteps {
    scheme: &'static str,
    step: f64,
    /// None of modes that do not vibrate.
    modes: Vec<Option<ModalDamping>>,
}

pub(super) fn run(opened: &mut Opened<'_>, asked: ModesRequest) -> Result<Exit, RunError> {
    check(&opened.input.problem, asked.count).map_err(|error| opened.destination.refuse(error))?;
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    remove_earlier(input, destination)?;
    let time = input.problem.case.time.as_ref();
    // a motion from rest has no equilibrium to begin at
    let undeformed = asked.undeformed || time.is_some_and(|time| time.start == Beginning::Rest);
    let in_time = time.is_some();
    let mut inspections = Vec::new();
    let states: Vec<(State, Vec<f64>)> = if undeformed {
        let of = |member: CaseMember<'_>| at_rest(member, &input.problem.start);
        input.problem.members().map(of).collect()
    } else if in_time {
        findings.timed(console, "solve", |_| beginnings(input, destination))?
    } else {
        let point = evaluate_start(context, findings, &mut EnsembleWorkspace::default())?;
        inspections = findings.inspect(input, console, "equilibrium", &point);
        report(context, findings, &point, &inspections)?;
        unmet::look_at(context, findings, &point)?;
        point.members.iter().map(|at| (at.state().clone(), at.m.clone())).collect()
    };
    let found = findings.timed(console, "modes", |_| find(input, destination, states, asked.count))?;
    let about = match (undeformed, in_time) {
        (true, _) => "undeformed body",
        (false, true) => "equilibrium at t = 0",
        (false, false) => "equilibrium",
    };
    print_modes(&input.problem, console, findings, about, &found);
    findings.write(console, destination, |_, out| write(&input.problem, about, &found, &inspections, out))?;
    Ok(Exit::Done)
}

/// The equilibria that the motions begin at.
fn beginnings(input: &CommandInput, destination: &Destination) -> Result<Vec<(State, Vec<f64>)>, RunError> {
    let of = |member: CaseMember<'_>| {
        let m = member.local(&input.problem.start);
        let state = member.reduced().initial_state(&m, START_ACCURACY);
        let state = state.map_err(|error| destination.member_failed(input, member.index(), error))?;
        Ok((state.unwrap_or_else(|| member.solid().rest()), m))
    };
    input.problem.members().map(of).collect()
}

fn check(problem: &CaseProblem, count: usize) -> Result<(), RunError> {
    for member in problem.members() {
        let model = member.solid().model();
        // what is wrong with a mass is reported where modes are sought
        if model.energies().mass().is_ok_and(|mass| mass.diagonal().iter().all(|mass| *mass == 0.0)) {
            let what = "\"modes\" needs masses: give every material a \"density\", as in \"1000 kg/m^3\"".to_owned();
            return Err(problem.complain("materials", what).into());
        }
        let free = member.solid().supports().fixed().iter().filter(|&&fixed| !fixed).count();
        if count == 0 || count > free {
            let what = format!("--count {count}: the body has {free} free unknowns; ask for 1 to {free} modes");
            return Err(problem.complain("mesh", what).into());
        }
    }
    Ok(())
}

fn find(
    input: &CommandInput,
    destination: &Destination,
    states: Vec<(State, Vec<f64>)>,
    count: usize,
) -> Result<Vec<StateModes>, RunError> {
    let how = SolveOptions { cancel: Some(&input.cancel), ..SolveOptions::default() };
    let of = |(member, (state, m)): (CaseMember<'_>, (State, Vec<f64>))| {
        let modes = member.solid().model().vibration_modes(&state, count, &how);
        let modes =
            modes.map_err(|error| destination.member_failed(input, member.index(), ControlError::from(error)))?;
        let seen = seen(member, &modes);
        Ok(StateModes { state, m, modes, seen })
    };
    input.problem.members().zip(states).map(of).collect()
}

/// What the scheme and the Rayleigh damping of a motion make of the modes.
fn seen(member: CaseMember<'_>, modes: &[VibrationMode]) -> Option<ModesInSteps> {
    let (time, timeline) = (member.case().time.as_ref()?, member.reduced().timeline()?);
    if timeline.scheme().is_quasi_static() || member.problem().lacks_steps() {
        return None; // nothing vibrates in its steps, or they are not known
    }
    let step = time.step.unwrap_or_else(|| timeline.longest_step());
    let rayleigh = time.rayleigh.as_ref().map_or((0.0, 0.0), |damping| (damping.mass, damping.stiffness));
    let of = |(k, mode): (usize, &VibrationMode)| {
        let ModeKind::Vibration { angular_frequency: w } = mode.kind() else { return None };
        let seen = timeline.scheme().modal_damping(step, w, rayleigh.0, rayleigh.1).ok()?;
        let exact = ModalDamping { effective: seen.physical, frequency: seen.frequency.map(|_| 1.0), ..seen };
        Some(if k < timeline.scheme().exact_modes() { exact } else { seen })
    };
    Some(ModesInSteps { scheme: timeline.scheme().name(), step, modes: modes.iter().enumerate().map(of).collect() })
}

/// Lowest modes of a motion that are reported.
const SHOWN: usize = 3;

/// The lowest vibrations about the state that a motion begins at (undeformed and without controls, if it begins at rest), as its steps move them: said, and as the result has them.
pub(super) fn damping(
    input: &CommandInput,
    console: &Console,
    member: CaseMember<'_>,
    begin: &State,
) -> Option<VibrationInSteps> {
    if member.reduced().timeline()?.scheme().is_quasi_static() {
        return None;
    }
    let (solid, how) = (member.solid(), SolveOptions { cancel: Some(&input.cancel), ..SolveOptions::default() });
    let free = solid.supports().fixed().iter().filter(|&&fixed| !fixed).count();
    let rigid = if member.mesh().dim() == 3 { 6 } else { 3 };
    let wanted = if solid.check().is_ok() { SHOWN } else { SHOWN + rigid };
    // stresses of actuations in a body at rest are no equilibrium
    let from_rest = member.case().time.as_ref().is_some_and(|time| time.start == Beginning::Rest);
    let rest = from_rest.then(|| solid.model().rest_under(&begin.controls));
    let about = rest.as_ref().unwrap_or(begin);
    let modes = match solid.model().vibration_modes(about, wanted.min(free), &how) {
        Ok(modes) => modes,
        Err(error) => {
            console.say(format!("damping     of the lowest modes not known: {error}"));
            return None;
        }
    };
    let (seen, units) = (seen(member, &modes)?, input.problem.units());
    let mut head = "damping";
    for (k, (mode, seen)) in modes.iter().zip(&seen.modes).enumerate() {
        let Some(seen) = seen else { continue };
        let frequency = per_second(mode, units) / TAU;
        let ratio =
            seen.frequency.map_or_else(|| "none".to_owned(), |ratio| format!("{} Hz", short(frequency * ratio)));
        console.say(format!(
            "{head:<12}mode {}: {} Hz, seen as {ratio}; d/w of Rayleigh damping {}, with that of the steps {}",
            k + 1,
            short(frequency),
            short(seen.physical),
            short(seen.effective)
        ));
        head = "";
    }
    if member.case().materials.iter().any(|material| !material.maxwell.is_empty() || material.kelvin_voigt.is_some()) {
        console.say("            without what viscous laws add: these are the relaxed body's");
    }
    let frequencies = modes.iter().map(|mode| (per_second(mode, units) / TAU).into()).collect();
    Some(VibrationInSteps { frequencies: Some(frequencies), ..in_steps(&seen) })
}

/// Puts frequencies into the result and says them.
fn print_modes(
    problem: &CaseProblem,
    console: &Console,
    findings: &mut CommandFindings,
    about: &str,
    found: &[StateModes],
) {
    let (units, dim) = (*problem.units(), problem.mesh().dim());
    for (index, own) in found.iter().enumerate() {
        let in_steps = own.seen.as_ref().map(in_steps);
        let (member, record) = (problem.member(index), record(&own.modes, about, &units, dim));
        let (inside, how) = (member.inside(), record.how_found());
        findings.entries_of(member).modes = ModesRecord { in_steps, ..record };
        console.say(format!("modes       K phi = w^2 M phi about the {about}{inside}{how}"));
        console.say(format!("  {:>9} {:>16} {:>14} {:>22}", "mode", "frequency", "period", "along x, y, z"));
        for (k, mode) in own.modes.iter().enumerate() {
            console.say(row(k + 1, mode, &units, dim));
        }
        if let Some(seen) = &own.seen {
            say_in_steps(console, &units, seen);
        }
    }
}

fn in_steps(seen: &ModesInSteps) -> VibrationInSteps {
    let of = |value: fn(&ModalDamping) -> Option<f64>| {
        seen.modes.iter().map(|mode| mode.as_ref().and_then(value).into()).collect::<Vec<Number>>()
    };
    VibrationInSteps {
        scheme: seen.scheme.to_owned(),
        step: seen.step.into(),
        damping: of(|mode| Some(mode.physical)),
        damping_seen: of(|mode| Some(mode.effective)),
        frequency_ratio: of(|mode| mode.frequency),
        frequencies: None,
    }
}

fn say_in_steps(console: &Console, units: &Units, ModesInSteps { scheme, step, modes }: &ModesInSteps) {
    let step = quantity(*step, Dimension::TIME, units);
    console.say(format!("in steps    {scheme}, {step}: d/w of q'' + d q' + w^2 q = 0, twice the damping ratio"));
    console.say(format!("  {:>9} {:>16} {:>16} {:>20}", "mode", "d/w", "d/w in steps", "share of frequency"));
    for (k, mode) in modes.iter().enumerate() {
        let Some(mode) = mode else { continue };
        let ratio = mode.frequency.map_or_else(|| "-".to_owned(), short);
        let (physical, effective) = (short(mode.physical), short(mode.effective));
        console.say(format!("  {:>9} {physical:>16} {effective:>16} {ratio:>20}", k + 1));
    }
}

/// Hz of an angular frequency in the case's units, or 1/s of a rate.
fn per_second(mode: &VibrationMode, units: &Units) -> f64 {
    units.in_si(mode.square, SQUARE).abs().sqrt()
}

fn record(modes: &[VibrationMode], about: &str, units: &Units, dim: usize) -> ModesRecord {
    let (mass, mass_unit) = if dim == 3 { (Dimension::MASS, "kg") } else { (MASS_PER_LENGTH, "kg/m") };
    let of =
        |value: &dyn Fn(&VibrationMode) -> Option<f64>| Some(modes.iter().map(|mode| value(mode).into()).collect());
    let count = |is: fn(ModeKind) -> bool| Some(modes.iter().filter(|mode| is(mode.kind())).count());
    ModesRecord {
        about: Some(about.to_owned()),
        frequencies: of(&|mode| match mode.kind() {
            ModeKind::Vibration { .. } => Some(per_second(mode, units) / TAU),
            ModeKind::Neutral => Some(0.0),
            ModeKind::Unstable { .. } => None,
        }),
        growth_rates: of(&|mode| matches!(mode.kind(), ModeKind::Unstable { .. }).then(|| per_second(mode, units))),
        modal_masses: of(&|mode| Some(units.in_si(mode.modal_mass, mass))),
        directions: Some(modes.iter().map(|mode| numbers(&mode.directions[..dim])).collect()),
        counted: Some(modes.iter().all(|mode| mode.counted)),
        iterations: modes.iter().find_map(|mode| mode.by_products).map(|(iterations, _)| iterations),
        errors: modes.iter().map(|mode| mode.by_products.map(|(_, error)| error.into())).collect(),
        neutral: count(|kind| kind == ModeKind::Neutral),
        unstable: count(|kind| matches!(kind, ModeKind::Unstable { .. })),
        units: Some(ModesUnits {
            frequency: "Hz".to_owned(),
            growth_rate: "1/s".to_owned(),
            modal_mass: mass_unit.to_owned(),
        }),
        ..ModesRecord::default()
    }
}

fn row(number: usize, mode: &VibrationMode, units: &Units, dim: usize) -> String {
    let percent = |share: &f64| format!("{:.0} %", 100.0 * share);
    let along = mode.directions[..dim].iter().map(percent).collect::<Vec<_>>().join(", ");
    let rate = per_second(mode, units);
    let (frequency, period) = match mode.kind() {
        ModeKind::Vibration { .. } => (format!("{} Hz", short(rate / TAU)), format!("{} s", short(TAU / rate))),
        ModeKind::Neutral => ("0 Hz".to_owned(), "-".to_owned()),
        ModeKind::Unstable { .. } => ("UNSTABLE".to_owned(), format!("by e in {} s", short(1.0 / rate))),
    };
    format!("  {number:>9} {frequency:>16} {period:>14} {along:>22}")
}

fn write(
    problem: &CaseProblem,
    about: &str,
    found: &[StateModes],
    inspections: &[Inspection],
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    let mut files = Vec::new();
    for (member, own) in problem.members().zip(found) {
        let fields = StateFields::new(&own.state, &own.m, 0);
        let shot = snapshot::inspected(member, &fields, inspections.get(member.index()))?;
        let shot = with_fields(shot, own.modes.iter().map(|mode| mode.shape.as_slice()))?;
        files.extend(out.write_state(&member.file("start"), &shot)?);
        if member.part().scenario() == 0 {
            let drawn = own.modes.iter().take(DRAWN).enumerate();
            let drawn = drawn.map(|(k, mode)| Ok((label(k + 1, mode, problem.units()), moved(&shot, k + 1)?)));
            let drawn = drawn.collect::<Result<Vec<_>, ControlError>>()?;
            picture::write(member, picture::of_modes(member, &title(member), about, &shot, &drawn), out)?;
            files.extend(["picture.png", "picture.svg"].map(|name| member.case_file(name)));
        }
    }
    files.extend(write_targets(problem, out)?);
    files.extend(write_collections(problem, "start", out)?);
    Ok(files)
}

fn label(number: usize, mode: &VibrationMode, units: &Units) -> String {
    let rate = per_second(mode, units);
    match mode.kind() {
        ModeKind::Vibration { .. } => format!("mode {number}: {} Hz", short(rate / TAU)),
        ModeKind::Neutral => format!("mode {number}: 0 Hz"),
        ModeKind::Unstable { .. } => format!("mode {number}: unstable"),
    }
}

/// The state moved on along a mode.
fn moved(shot: &Snapshot, number: usize) -> Result<Snapshot, ControlError> {
    let array = |name: &str| shot.point_array(name).map(|array| array.values.as_slice()).unwrap_or_default();
    let scale = AMPLITUDE * shot.mesh.diagonal();
    let (u, mode) = (array("displacement"), array(&format!("mode_{number}")).to_vec());
    let values = u.iter().zip(mode).map(|(u, phi)| u + scale * phi).collect();
    Ok(Snapshot::new(shot.mesh.clone()).with_points("displacement", 3, values)?)
}

/// The body at rest, with its numbers that are controls as they start and no loads, and that control vector.
fn at_rest(member: CaseMember<'_>, start: &[f64]) -> (State, Vec<f64>) {
    let (solid, mut m) = (member.solid(), member.local(start));
    let controllable = solid.model().controllable();
    let layout = member.reduced().layout_in_stage(0);
    for block in layout.blocks() {
        let target = &block.targets[0];
        if !controllable[target.actuation].slots.get(target.slot).is_some_and(|slot| slot.is_design()) {
            m[block.first..block.first + block.len()].fill(0.0);
        }
    }
    let under = |controls: Controls| solid.model().rest_under(&controls);
    (layout.to_points(&m).map_or_else(|_| solid.rest(), under), m)
}
