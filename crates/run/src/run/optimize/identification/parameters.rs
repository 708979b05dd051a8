//! [`Parameter`]: a value of a control that readings shall determine.

use nastic_case::lower::{CaseProblem, ControlField};
use nastic_numeric::format::scientific;
use nastic_report::record::ParameterRecord;

/// The quantile of the normal distribution that leaves 2.5 % above it.
const QUANTILE: f64 = 1.959_963_984_540_054;

/// A value of a control, with its unknown: the value, or its logarithm.
pub(super) struct Parameter {
    pub name: String,
    /// The number of its control.
    pub control: usize,
    /// Whether it is the only value of its control.
    pub is_alone: bool,
    pub value: f64,
    pub unknown: f64,
    pub log: bool,
    pub unit: String,
    /// A change of the unknown that counts as one: the deviation of its prior; of a logarithm 1; else the larger of start and value, 1 where both are zero.
    pub scale: f64,
    /// Mean and deviation of what is known of the unknown beforehand.
    pub prior: Option<[f64; 2]>,
    /// The bounds of the unknown.
    pub bounds: [f64; 2],
}

/// All parameters, at a control vector.
pub(super) fn of(problem: &CaseProblem, m: &[f64]) -> Vec<Parameter> {
    let mut out = Vec::new();
    for (control, (block, field)) in problem.ensemble.blocks().iter().zip(&problem.controls).enumerate() {
        let (unknowns, start) = (block.of(m), block.of(&problem.start));
        let values = problem.control_block(block).free_values_of(unknowns);
        let prior = prior(problem, field);
        for (i, (&unknown, &value)) in unknowns.iter().zip(&values).enumerate() {
            let size = Some(start[i].abs().max(unknown.abs())).filter(|size| *size > 0.0);
            let own = if field.log { 1.0 } else { size.unwrap_or(1.0) };
            out.push(Parameter {
                name: if block.len == 1 { field.name.clone() } else { format!("{}/{i}", field.name) },
                control,
                is_alone: block.len == 1,
                value,
                unknown,
                log: field.log,
                unit: if field.unit == "1" { String::new() } else { field.unit.clone() },
                prior,
                scale: prior.map_or(own, |[_, deviation]| deviation),
                bounds: field.bounds.as_ref().map_or([f64::NEG_INFINITY, f64::INFINITY], |bounds| {
                    let (lower, upper) = bounds.at(i);
                    [lower, upper]
                }),
            });
        }
    }
    out
}

/// Mean and deviation of the unknowns of a control, where the case has a prior of it.
pub(super) fn prior(problem: &CaseProblem, field: &ControlField) -> Option<[f64; 2]> {
    let own = problem.case.load_cases.iter().flat_map(|shot| &shot.controls);
    let control = problem.case.controls.iter().chain(own).find(|control| control.at == field.at)?;
    let prior = control.prior.as_ref()?;
    let (mean, deviation) = (prior.mean.constant()?, prior.deviation.constant()?);
    Some(if field.log { [mean.ln(), deviation / mean] } else { [mean, deviation] })
}

impl Parameter {
    /// Its squared distance from the mean of its prior, in deviations.
    pub fn squares(&self) -> Option<f64> {
        self.prior.map(|[mean, deviation]| ((self.unknown - mean) / deviation).powi(2))
    }

    /// Its value where its unknown is another.
    pub fn value_at(&self, unknown: f64) -> f64 {
        if self.log { unknown.exp() } else { unknown }
    }

    /// A value as it stands in cases.
    pub fn text(&self, value: f64) -> String {
        // ten digits, written without an exponent
        let number: f64 = scientific(value, 9).parse().unwrap_or(value);
        if self.unit.is_empty() { number.to_string() } else { format!("{number} {}", self.unit) }
    }

    /// A change of its unknown as a share of its value.
    pub fn share(&self, change: f64) -> f64 {
        if self.log { change } else { change / self.value }
    }

    pub fn is_on_bound(&self) -> bool {
        self.bounds.contains(&self.unknown)
    }

    /// It with the deviation of its unknown.
    pub fn record(&self, deviation: Option<f64>) -> ParameterRecord {
        let end = |sign: f64| move |deviation: f64| self.value_at(self.unknown + sign * QUANTILE * deviation);
        let interval = deviation.map(|own| vec![end(-1.0)(own).into(), end(1.0)(own).into()]);
        ParameterRecord {
            value: self.value.into(),
            unit: self.unit.clone(),
            deviation: deviation.map(|own| if self.log { own * self.value } else { own }).into(),
            interval,
            on_bound: (deviation.is_none() && self.is_on_bound()).then_some(true),
        }
    }
}
