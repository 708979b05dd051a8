//! Starts: random ones, uniform over what is admitted, and those of an earlier run.

use super::context::Context;
use crate::lower::control_field::{Admitted, ControlField};
use crate::lower::problem::CaseProblem;
use nastic_language::schema::{Case, ControlsFile};
use nastic_language::syntax::{At, quoted};
use nastic_numeric::Random;
use nastic_opt::Bounds;
use serde_json::{Map, Value};

/// Complains about controls that have no random start where the case asks for some.
pub(super) fn check(case: &Case, controls: &[ControlField], context: &mut Context<'_>) {
    if case.optimizer.starts < 2 {
        return;
    }
    for field in controls {
        let missing = match unbounded(field) {
            None => continue,
            Some(Unbounded::Below) => "\"lower\"",
            Some(Unbounded::Above) => "\"upper\"",
            Some(Unbounded::Length) => "\"norm\" or \"max_norm\"",
        };
        let message = format!("random starts (optimizer/starts) are drawn within the bounds: give {missing}");
        context.complain(&field.at, message);
    }
}

/// What keeps a control from being drawn at random.
pub(super) enum Unbounded {
    /// Some value has no lower bound.
    Below,
    /// Some value has no upper bound.
    Above,
    /// Vectors may be of any length.
    Length,
}

/// What a random value of a control lacks, if anything.
pub(super) fn unbounded(field: &ControlField) -> Option<Unbounded> {
    match field.admitted {
        Admitted::Between { lower, .. } if !lower.is_finite() || field.log && lower <= 0.0 => Some(Unbounded::Below),
        Admitted::Between { upper, .. } if !upper.is_finite() => Some(Unbounded::Above),
        Admitted::Any => Some(Unbounded::Length),
        _ => None,
    }
}

impl CaseProblem {
    /// A random control vector: scalars uniform within their bounds, vectors of a given length uniform on the sphere,
    /// others uniform in the ball (in the plane, for a plane body). The same for the same seed on every machine.
    #[must_use]
    pub fn random_start(&self, seed: u64) -> Vec<f64> {
        let (mut random, dim) = (Random::new(seed), self.mesh().dim());
        let mut out = Vec::with_capacity(self.start.len());
        for (block, field) in self.ensemble.blocks().iter().zip(&self.controls) {
            let n = self.ensemble.members()[block.owner].problem().layout().blocks()[block.field].components;
            // Of vectors in a plane body the third component stays zero.
            let (vectors, dim) = (block.len / n, dim.min(n));
            let entries = |v: [f64; 3]| v.into_iter().take(n);
            out.extend(match (&field.bounds, field.admitted) {
                (Some(bounds), _) => between(&mut random, bounds, block.len),
                (None, Admitted::Norm(norm)) => {
                    on_sphere(&mut random, norm, vectors, dim).into_iter().flat_map(entries).collect()
                }
                (None, Admitted::MaxNorm(most)) => {
                    in_ball(&mut random, most, vectors, dim).into_iter().flat_map(entries).collect()
                }
                // Refused when the case was lowered.
                (None, _) => block.of(&self.start).to_vec(),
            });
        }
        out
    }
}

/// The values of one control in an earlier `controls.json`, in the order that it has there: that of the same mesh.
pub(super) fn of_file(
    file: &ControlsFile,
    name: &str,
    length: usize,
    at: &At,
    context: &mut Context<'_>,
) -> Option<Vec<f64>> {
    let path = context.file(&file.file);
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()));
    let all = text.and_then(|text| serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.file)));
    let all: Map<String, Value> = context.take(&at.key("file"), all)?;
    let name = file.control.as_deref().unwrap_or(name);
    let Some(values) = all.get(name).and_then(Value::as_array) else {
        let known: Vec<&str> = all.keys().map(String::as_str).collect();
        let message = format!("control {} not found in {}; it has: {}", quoted(name), file.file, known.join(", "));
        context.complain(at, message);
        return None;
    };
    let numbers: Vec<f64> = values.iter().filter_map(Value::as_f64).collect();
    if numbers.len() != length || values.len() != length {
        let message = format!(
            "{} has {} numbers for {}, and {length} are needed: use it with the mesh and the space that it was made with (of another \"grid\" \
             give the cells of that one beside \"file\")",
            file.file,
            numbers.len(),
            quoted(name)
        );
        context.complain(at, message);
        return None;
    }
    Some(numbers)
}

fn between(random: &mut Random, bounds: &Bounds, count: usize) -> Vec<f64> {
    let value = |i: usize| {
        let (lower, upper) = bounds.at(i);
        (lower + (upper - lower) * random.unit()).clamp(lower, upper)
    };
    (0..count).map(value).collect()
}

/// Vectors of one length and random directions, uniform on the sphere (in the plane: on the circle).
pub(super) fn on_sphere(random: &mut Random, norm: f64, count: usize, dim: usize) -> Vec<[f64; 3]> {
    let vector = |_| {
        let v = unit_ball(random, dim, 0.1);
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x * norm / length)
    };
    (0..count).map(vector).collect()
}

fn in_ball(random: &mut Random, most: f64, count: usize, dim: usize) -> Vec<[f64; 3]> {
    // Rounding shall not carry one past the radius.
    (0..count).map(|_| unit_ball(random, dim, 0.0).map(|x| x * most * (1.0 - 1e-12))).collect()
}

/// A vector of length `least` to one, uniform there.
fn unit_ball(random: &mut Random, dim: usize, least: f64) -> [f64; 3] {
    loop {
        let mut v = [0.0; 3];
        v.iter_mut().take(dim).for_each(|x| *x = random.symmetric());
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (least..=1.0).contains(&length) {
            return v;
        }
    }
}
