//! A motion in words: its steps, masses and dissipation.

use super::line::{Line, line};
use super::parameters::scalar;
use crate::lower::CaseProblem;
use nastic_control::{ControlBlock, Timeline};
use nastic_language::number::{count, grouped, quantity, short, vector};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::{Beginning, KnotInterpolation, Material, Parameter, SpringMeasure, Time, When};

/// Steps, start and dissipation of a motion; nothing of an equilibrium.
pub fn time(problem: &CaseProblem) -> Vec<Line> {
    let Some(time) = &problem.case.time else { return vec![] };
    let units = problem.units();
    let of = |value: f64| quantity(value, Dimension::TIME, units);
    let leads = || problem.members().filter_map(|member| member.reduced().timeline()).map(Timeline::steps).max();
    let each = match (time.step, time.tolerance) {
        (Some(step), _) => format!("{} of {} to {}", count(leads().unwrap_or(0), "step"), of(step), of(time.end)),
        (None, tolerance) => format!(
            "steps to {}, found before the motion runs: an error of at most {} each, none longer than {}; they lead through {}",
            of(time.end),
            quantity(tolerance.unwrap_or(0.0), Dimension::LENGTH, units),
            of(time.longest()),
            count(leads().unwrap_or(0) + 1, "given instant")
        ),
    };
    let parameters = [("gamma", time.gamma), ("beta", time.beta), ("rho", time.rho)];
    let parameters = parameters.into_iter().filter_map(|(name, value)| Some(format!(" {name} {}", short(value?))));
    let parameters: String = parameters.collect();
    let steps = format!("{each}, scheme {}{parameters}, {} masses", time.scheme().name(), time.mass.name());
    let begin = match time.start {
        Beginning::Equilibrium => "the equilibrium under loads and controls at t = 0",
        Beginning::Rest => "the undeformed body",
    };
    let velocity = if time.velocity.is_some() { ", with a given velocity" } else { ", at rest" };
    let mut out = vec![line("time", steps), line("time", format!("begins at {begin}{velocity}"))];
    if !problem.lacks_steps() {
        out.push(line("time", states(problem, time)));
    }
    if let Some(damping) = &time.rayleigh {
        let (mass, stiffness) = (quantity(damping.mass, Dimension::RATE, units), of(damping.stiffness));
        out.push(line("time", format!("Rayleigh damping: {mass} of the mass, {stiffness} of the stiffness at rest")));
    }
    out
}

/// The memory of the states, and how many are written.
fn states(problem: &CaseProblem, time: &Time) -> String {
    let footprints = problem.members().filter_map(|member| member.reduced().motion_footprint().ok().flatten());
    let (bytes, again) = footprints.fold((0, 0), |(b, r), one| (b + one.bytes, r + one.recomputed_steps));
    let kept = bytes as f64 / 1e6;
    let again =
        if again > 0 { format!(", {} steps computed again for a derivative", grouped(again)) } else { String::new() };
    let shown = time.shown(&time.instants()).into_iter().filter(|shown| *shown).count();
    format!("the states of a motion take {kept:.1} MB{again}; {} are written", count(shown, "state"))
}

/// What a material has beside its law: density and viscosity.
pub(super) fn inertia(material: &Material, units: &Units) -> String {
    let mut parts = Vec::new();
    if let Some(density) = material.density {
        parts.push(format!("density {}", quantity(density, Dimension::DENSITY, units)));
    }
    for branch in &material.maxwell {
        let shear = scalar(&branch.shear, Dimension::PRESSURE, units);
        let relaxation = scalar(&branch.relaxation, Dimension::TIME, units);
        let measure = match branch.measure {
            SpringMeasure::Hencky => "",
            SpringMeasure::NeoHooke => ", neo-Hookean spring",
        };
        parts.push(format!("Maxwell branch of shear {shear}, relaxation {relaxation}{measure}"));
    }
    if let Some(dashpot) = &material.kelvin_voigt {
        let of = |value: &Option<Parameter>| {
            value.as_ref().map_or("0".to_owned(), |value| scalar(value, Dimension::VISCOSITY, units))
        };
        parts.push(format!("Kelvin-Voigt viscosities: shear {}, bulk {}", of(&dashpot.shear), of(&dashpot.bulk)));
    }
    parts.into_iter().map(|part| format!("; {part}")).collect()
}

/// The knots of a control, where it changes in time.
pub(super) fn knots(problem: &CaseProblem, block: &ControlBlock, name: &str) -> String {
    let Some(knots) = &block.knots else { return String::new() };
    let control = problem
        .members()
        .find_map(|member| member.case().controls.iter().find(|control| control.name() == name).cloned());
    let interpolation = match control.as_ref().and_then(|control| control.in_time.as_ref()) {
        Some(in_time) if in_time.interpolation == KnotInterpolation::Constant => "constant between",
        _ => "linear between",
    };
    let rate = control
        .as_ref()
        .and_then(|control| control.rate.as_ref())
        .map_or(String::new(), |rate| format!(", rate at most {}", rate.text()));
    format!(" in time at {}, {interpolation}{rate}", count(knots.len(), "value"))
}

/// When a cost counts, where the case says so.
pub(super) fn when(when: Option<&When>) -> String {
    match when {
        None => String::new(),
        Some(When::End) => ", at the end".to_owned(),
        Some(When::Integral) => ", its integral over the time".to_owned(),
        Some(When::At(instants)) if instants.len() > 6 => format!(", at {} instants", grouped(instants.len())),
        Some(When::At(instants)) => format!(", at t = {}", vector(instants)),
        Some(When::TimeAbove(scale)) => format!(", the time above about {}", short(*scale)),
    }
}
