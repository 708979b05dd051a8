//! [`Law`]: the feedback at the start of a case.

use super::control_values;
use nastic_case::lower::{CaseMember, LocatedProbe};
use nastic_control::{ControlError, Evaluated, Output, OutputJacobian, Partials, ReducedWorkspace};
use nastic_language::expression::dimension_of;
use nastic_opt::{Feedback, FeedbackInputs, MovedDirection};
use nastic_report::record::{GainsDirectionRecord, GainsOutputRecord, GainsRecord, numbers};

/// A singular value below this share of the largest is zero within the accuracy of linear solves.
const ROUNDING: f64 = 1e-8;
/// A row of S that changes its output by less than this share of its size is zero: what is left where nothing moves it.
const NOISE: f64 = 1e-9;
/// Dampings that are tried for one with which the law converges.
const DAMPINGS: [f64; 7] = [1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The law with what it needs of the case.
pub(super) struct Law {
    pub feedback: Feedback,
    pub targets: Vec<f64>,
    pub weights: Vec<f64>,
    pub bounds: Vec<[f64; 2]>,
    damping: f64,
    pub scales: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
}

impl Law {
    /// The law at an equilibrium of the case's own body, `None` where no control moves an output that has a target; and what is known of it.
    pub fn find(own: CaseMember<'_>, at: &Evaluated) -> Result<(Option<Self>, GainsRecord), ControlError> {
        let problem = own.problem();
        let mut all = own.reduced().outputs(at)?;
        all.extend(problem.probes.iter().flat_map(|probe| of_probe(own, probe, at)));
        let (aimed, watched): (Vec<Output>, Vec<Output>) = all.into_iter().partition(|one| one.target.is_some());
        let partials: Vec<&Partials> = aimed.iter().chain(&watched).map(|one| &one.partials).collect();
        let mut controls = control_values::of(problem, &at.m);
        let scales: Vec<f64> = controls.iter().filter_map(|one| *one.scale).collect();
        let mut found = own.reduced().output_jacobian(at, &partials, &scales, &mut ReducedWorkspace::default())?;
        without_noise(&mut found, &scales);
        let label = |unit: &str| match dimension_of(unit).filter(|_| !unit.is_empty()) {
            Some(dimension) => problem.units().label(dimension),
            None => unit.to_owned(),
        };
        let record = |(one, row): (&Output, &Vec<f64>)| GainsOutputRecord {
            name: one.name.clone(),
            unit: label(one.unit),
            value: one.value.into(),
            target: one.target.map_or_else(Default::default, |target| target.value.into()),
            weight: one.target.map_or_else(Default::default, |target| target.weight.into()),
            sensitivities: numbers(row),
        };
        let mut records: Vec<GainsOutputRecord> = aimed.iter().chain(&watched).zip(&found.rows).map(record).collect();
        let rest = records.split_off(aimed.len());
        found.rows.truncate(aimed.len());
        let bounds = control_values::all_bounds(problem);
        // what its bounds hold moves nothing
        let held = |j: &usize| bounds[*j][0] == bounds[*j][1];
        (0..bounds.len()).filter(held).for_each(|j| found.rows.iter_mut().for_each(|row| row[j] = 0.0));
        let damping = problem.case.gains.damping;
        let targets: Vec<_> = aimed.iter().filter_map(|one| one.target).collect();
        let weights: Vec<f64> = targets.iter().map(|target| target.weight).collect();
        let jacobian = &found.rows;
        let inputs = FeedbackInputs { jacobian, weights: &weights, scales: &scales, damping, rounding: ROUNDING };
        let feedback = Feedback::of(&inputs);
        for (control, penalty) in controls.iter_mut().zip(feedback.iter().flat_map(|own| &own.penalty)) {
            control.penalty = (*penalty).into();
        }
        let known = GainsRecord {
            damping: damping.into(),
            by: if found.by_adjoints { "adjoints" } else { "tangents" }.to_owned(),
            controls,
            outputs: records,
            watched: Some(rest).filter(|rest| !rest.is_empty()),
            ..GainsRecord::default()
        };
        let Some(feedback) = feedback else { return Ok((None, known)) };
        let known = with_law(known, &feedback);
        let targets = targets.iter().map(|target| target.value).collect();
        Ok((Some(Law { feedback, targets, weights, bounds, damping, scales, jacobian: found.rows }), known))
    }

    /// The smallest larger damping of a few with which the law converges on bodies with these derivatives.
    pub fn converging(&self, jacobians: &[&[Vec<f64>]]) -> Option<f64> {
        let converges = |damping: &f64| {
            let (jacobian, weights, scales) = (&self.jacobian, &self.weights, &self.scales);
            let inputs = FeedbackInputs { jacobian, weights, scales, damping: *damping, rounding: ROUNDING };
            let law = Feedback::of(&inputs);
            law.is_some_and(|law| jacobians.iter().all(|own| law.contraction(own).is_some_and(|rate| rate < 1.0)))
        };
        DAMPINGS.into_iter().filter(|damping| *damping > self.damping).find(converges)
    }

    /// `y - y*` at an equilibrium, with the partial derivatives of y.
    pub fn errors(&self, member: CaseMember<'_>, at: &Evaluated) -> Result<(Vec<f64>, Vec<Output>), ControlError> {
        let outputs = followed(member, at)?;
        if outputs.len() != self.targets.len() {
            let what = format!(
                "{} with targets where the case's own body has {}: scenarios of \"gains\" have the same costs",
                outputs.len(),
                self.targets.len()
            );
            return Err(ControlError::Cost { what });
        }
        let aims =
            outputs.iter().filter_map(|one| Some((one, one.target?))).zip(self.targets.iter().zip(&self.weights));
        for ((one, own), (target, weight)) in aims {
            if own.value != *target || own.weight != *weight {
                let what = format!(
                    "\"{}\" has the target {} and the weight {} here, {target} and {weight} in the case itself: \"gains\" has one list of targets for all bodies",
                    one.name, own.value, own.weight
                );
                return Err(ControlError::Cost { what });
            }
        }
        Ok((outputs.iter().zip(&self.targets).map(|(one, target)| one.value - target).collect(), outputs))
    }

    /// `sqrt(sum Q e^2)`.
    pub fn size(&self, errors: &[f64]) -> f64 {
        errors.iter().zip(&self.weights).map(|(error, weight)| weight * error * error).sum::<f64>().sqrt()
    }

    /// The size of the part of errors that controls do not change on a body with these derivatives.
    pub fn unreachable(&self, jacobian: &[Vec<f64>], errors: &[f64]) -> Option<f64> {
        let (weights, scales) = (&self.weights, &self.scales);
        let own = Feedback::of(&FeedbackInputs { jacobian, weights, scales, damping: 0.0, rounding: ROUNDING })?;
        let weighted: Vec<f64> = errors.iter().zip(weights).map(|(error, weight)| weight.sqrt() * error).collect();
        let along = |v: &Vec<f64>| v.iter().zip(&weighted).map(|(v, error)| v * error).sum::<f64>().powi(2);
        Some(own.unmoved.iter().map(along).fold(0.0, |all, one| all + one).sqrt())
    }
}

/// The outputs of a body that have targets.
fn followed(member: CaseMember<'_>, at: &Evaluated) -> Result<Vec<Output>, ControlError> {
    Ok(member.reduced().outputs(at)?.into_iter().filter(|one| one.target.is_some()).collect())
}

/// Makes rows zero that are noise.
fn without_noise(found: &mut OutputJacobian, scales: &[f64]) {
    for (row, size) in found.rows.iter_mut().zip(&found.sizes) {
        let most = row.iter().zip(scales).map(|(own, scale)| (own * scale).abs()).fold(0.0, f64::max);
        if most <= NOISE * size {
            row.fill(0.0);
        }
    }
}

/// The record with the law.
fn with_law(record: GainsRecord, law: &Feedback) -> GainsRecord {
    let largest = law.moved.first().map_or(0.0, |one| one.value);
    let damped = record.damping.unwrap_or(0.0) * largest * largest;
    let direction = |one: &MovedDirection| GainsDirectionRecord {
        value: one.value.into(),
        shrinks: (damped / (one.value * one.value + damped)).into(),
        outputs: numbers(&one.outputs),
        controls: numbers(&one.controls),
    };
    GainsRecord {
        gain: law.gain.iter().map(|row| numbers(row)).collect(),
        directions: law.moved.iter().map(direction).collect(),
        unmoved: Some(law.unmoved.iter().map(|v| numbers(v)).collect()).filter(|all: &Vec<_>| !all.is_empty()),
        ..record
    }
}

/// The displacement of a probe.
fn of_probe(own: CaseMember<'_>, probe: &LocatedProbe, at: &Evaluated) -> Vec<Output> {
    let dim = own.mesh().dim();
    let moved = probe.displacement(&at.state().u, dim);
    let component = |i: usize| {
        let mut partials = Partials::zero(at.state().u.len(), at.m.len());
        probe.located.weights.iter().for_each(|&(node, share)| partials.u[node as usize * dim + i] += share);
        Output::watched(format!("{}.displacement.{}", probe.name, AXES[i]), moved[i], "m", partials)
    };
    (0..dim).map(component).collect()
}
