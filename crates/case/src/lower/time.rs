//! The instants of a motion and how it begins; knots and instants of what changes in it.

use super::array::{self, Entity};
use super::context::Context;
use crate::schema::{self, Beginning, Case, InTime, KnotInterpolation, VectorField, vector_at};
use nastic_control::{Interpolation, Knots, MotionMemory, Reduced, Timeline, When};
use nastic_fem::Solid;

/// Makes the problem one in time, where the case says so.
pub(super) fn apply(case: &Case, reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    let Some(time) = &case.time else { return Some(reduced) };
    let scheme = context.take(&time.at.key("scheme"), time.scheme.scheme())?;
    let mut timeline = context.take(&time.at, Timeline::uniform(scheme, time.end, time.steps()))?;
    if time.start == Beginning::Rest {
        timeline = timeline.from_rest();
    }
    if let Some(megabytes) = time.memory {
        timeline = timeline.keep(MotionMemory::AtMost { bytes: (megabytes * 1e6) as usize });
    }
    if time.velocity.is_some() {
        timeline = timeline.velocity(velocity(case, reduced.solid(), context)?);
    }
    context.take(&time.at, reduced.in_time(timeline))
}

/// The velocity at t = 0 of every node, zero where the body is held.
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
    let mut flat: Vec<f64> = values.iter().flat_map(|v| v[..dim].to_vec()).collect();
    solid.supports().clear(&mut flat);
    flat.resize(solid.model().unknowns().len(), 0.0);
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
    let of_controls = matches!(cost, schema::Cost::ControlNorm(_) | schema::Cost::ControlSmoothness(_));
    match cost.when() {
        None if of_controls => When::Integral,
        None | Some(schema::When::End) => When::End,
        Some(schema::When::Integral) => When::Integral,
        Some(schema::When::At(instants)) => When::At(instants.clone()),
        Some(schema::When::TimeAbove(scale)) => When::TimeAbove { scale: *scale },
    }
}
