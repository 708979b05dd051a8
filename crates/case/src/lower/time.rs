//! The instants of a motion and how it begins; knots and instants of what changes in it.

use super::array::{self, Entity};
use super::context::Context;
use super::strides::{Course, width};
use nastic_control::{Counts, Interpolation, Knots, MotionMemory, Reduced, Timeline, When};
use nastic_fem::{Checkpoints, Solid, State, TimeStepping};
use nastic_language::number::short;
use nastic_language::schema;
use nastic_language::schema::{Beginning, Case, InTime, KnotInterpolation, Time, VectorField, vector_at};

/// Makes the problem one in time, where the case says so; `found`: the instants of steps that were found.
pub(super) fn apply(
    case: &Case,
    found: Option<&[f64]>,
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let Some(time) = &case.time else { return Some(reduced) };
    let scheme = context.take(&time.at.key("scheme"), time.built_scheme())?;
    context.take(&time.at.key("scheme"), reduced.solid().model().supports_motion(&scheme))?;
    let instants = found.map_or_else(|| required(case, time), <[f64]>::to_vec);
    let mut timeline = context.take(&time.at, Timeline::through(scheme, instants))?;
    if time.start == Beginning::Rest {
        timeline = timeline.from_rest();
    }
    if let Some(megabytes) = time.memory {
        check_memory(time, &timeline, reduced.solid(), context)?;
        timeline = timeline.keep(MotionMemory::AtMost { bytes: (megabytes * 1e6) as usize });
    }
    if time.velocity.is_some() {
        timeline = timeline.velocity(velocity(case, reduced.solid(), context)?);
    }
    context.take(&time.at, reduced.in_time(timeline))
}

/// Whether `memory` suffices for the least that a motion takes.
fn check_memory(time: &Time, timeline: &Timeline, solid: &Solid, context: &mut Context<'_>) -> Option<()> {
    let (at, megabytes) = (time.at.key("memory"), time.memory?);
    let (steps, segment, scheme) = (timeline.steps(), timeline.segment(), timeline.scheme());
    let least = context.take(&at, Checkpoints::at_most(1, steps, segment))?.bytes(solid.model(), scheme);
    let all = context.take(&at, Checkpoints::all(steps, segment))?.bytes(solid.model(), scheme);
    if megabytes * 1e6 >= least.min(all) as f64 {
        return Some(());
    }
    // rounded up, so that the reported number suffices
    let shown = |bytes: usize| short((bytes as f64 / 1e4).ceil() / 100.0);
    let message = format!(
        "{} MB are too few for the states of a motion: it takes at least {} MB (the states of {} steps and of one from which the others are \
         computed again), with all its states {} MB",
        short(megabytes),
        shown(least.min(all)),
        segment.min(steps),
        shown(all)
    );
    context.complain(&at, message);
    None
}

/// The instants that steps have to lead through: beside a tolerance also the knots of controls, where costs count and where constraints hold.
fn required(case: &Case, time: &Time) -> Vec<f64> {
    let mut out = time.instants();
    if time.tolerance.is_some() {
        for in_time in case.controls.iter().filter_map(|control| control.in_time.as_ref()) {
            let parts = (time.end / in_time.every).round().max(1.0) as usize;
            out.extend((0..=parts).map(|k| time.end * k as f64 / parts as f64));
        }
        let of_costs = case.costs.iter().filter_map(|cost| match cost.when() {
            Some(schema::When::At(instants)) => Some(instants),
            _ => None,
        });
        let of_constraints = case.constraints.iter().filter_map(|constraint| match &constraint.when {
            Some(schema::HoldsWhen::At(instants)) => Some(instants),
            _ => None,
        });
        let within = |t: &&f64| (0.0..=time.end).contains(*t);
        out.extend(of_costs.chain(of_constraints).flatten().filter(within));
        out.sort_by(f64::total_cmp);
        out.dedup_by(|later, earlier| *later - *earlier <= SAME * time.end);
        // the end itself, if an instant just before it was kept
        out.pop();
        out.push(time.end);
    }
    out
}

/// Instants closer than this share of the whole time are one.
const SAME: f64 = 1e-9;

/// The velocity at t = 0 of every node, zero where supports hold the body still.
fn velocity(case: &Case, solid: &Solid, context: &mut Context<'_>) -> Option<Vec<f64>> {
    let time = case.time.as_ref()?;
    let (at, field, mesh) = (time.at.key("velocity"), time.velocity.as_ref()?, solid.mesh());
    let values: Vec<[f64; 3]> = match field {
        VectorField::Formulas(entries) => {
            let values: Result<_, _> = mesh.points().iter().map(|x| vector_at(entries, *x)).collect();
            context.take(&at, values)?
        }
        VectorField::Array(file) => {
            let array = array::read(file, &at, &[2, 3], Entity::Node, case, mesh, context)?;
            if array.entity == Entity::Cell {
                context.complain(&at.key("array"), "a velocity by cell is none: one by node is wanted");
                return None;
            }
            let entry = |v: &[f64]| std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0));
            array.values.chunks_exact(array.components).map(entry).collect()
        }
    };
    let dim = mesh.dim();
    if dim == 2 && values.iter().any(|v| v[2] != 0.0) {
        context.complain(&at, "a velocity in plane strain has no z component");
        return None;
    }
    let fastest = values.iter().map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt()).fold(0.0, f64::max);
    let mut course = Course { mesh, at: &at, context };
    course.check_speed(fastest, "it begins with");
    let widths = case.obstacles.iter().filter_map(|touched| width(&touched.shape));
    if let (Some(width), Some(step)) = (widths.reduce(f64::min), time.step) {
        course.check_stride(fastest * step, width, "the body moves, at first,");
    }
    let mut flat: Vec<f64> = values.iter().flat_map(|v| v[..dim].to_vec()).collect();
    (0..flat.len()).filter(|dof| solid.supports().holds_still(*dof)).for_each(|dof| flat[dof] = 0.0);
    flat.resize(solid.model().unknowns().len(), 0.0);
    if time.start == Beginning::Rest {
        let begin = State { velocity: Some(flat.clone().into()), ..solid.rest() };
        context.take(&at, solid.model().check_velocity(&begin))?;
    }
    Some(flat)
}

/// The knots of a control.
pub(super) fn knots(in_time: &InTime, end: f64, context: &mut Context<'_>) -> Option<Knots> {
    let interpolation = match in_time.interpolation {
        KnotInterpolation::Linear => Interpolation::Linear,
        KnotInterpolation::Constant => Interpolation::Constant,
    };
    context.take(&in_time.at, Knots::every(in_time.every, end, interpolation))
}

/// When a cost counts; of one without a word about it at the end, of one of controls alone over the whole time.
pub(super) fn when(cost: &schema::Cost) -> When {
    let of_controls = cost.term().is_some_and(|term| term.form.counts == Counts::OverTime);
    match cost.when() {
        None if of_controls => When::Integral,
        None | Some(schema::When::End) => When::End,
        Some(schema::When::Integral) => When::Integral,
        Some(schema::When::At(instants)) => When::At(instants.clone()),
        Some(schema::When::TimeAbove(scale)) => When::TimeAbove { scale: *scale },
    }
}
