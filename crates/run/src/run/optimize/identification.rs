//! What readings say of the parameters at an optimum: asked for by `nastic identify`, in results, in `identified.json` and in words.

mod blocks;
mod parameters;
mod refusal;
mod remarks;
mod shots;

pub(super) use refusal::check;

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::optimize::minimization::domain;
use crate::run::session::{CommandFindings, CommandInput};
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::number::{count, short};
use nastic_language::schema::Command;
use nastic_opt::{Best, Covariance, Diagonal, Hessian, Spectrum, SpectrumOptions};
use nastic_report::record::{ByName, IdentificationRecord, Number, SeenDirectionRecord, numbers};
use nastic_result::files::Directory;
use parameters::Parameter;
use std::sync::Arc;

/// Name of the file.
const FILE: &str = "identified.json";
/// An eigenvalue below this share of the largest is zero within the accuracy of products, 1e-9 of each.
const ROUNDING: f64 = 1e-8;
/// Shots that are said.
const MOST_SHOTS: usize = 12;

/// What was found at an optimum.
pub(super) struct Identified {
    record: IdentificationRecord,
}

/// What the readings say at an optimum, if it was asked for. What fails then is said and noted: the optimum is not lost for it.
pub(super) fn find(
    input: &CommandInput,
    console: &Console,
    findings: &mut CommandFindings,
    best: &Best<EnsemblePoint>,
) -> Result<Option<Identified>, RunError> {
    if input.command != Command::Identify {
        return Ok(None);
    }
    console.phase("covariance of the parameters");
    let found = findings.timed(console, "covariance", |_| covariance(input, best));
    console.clear();
    let record = match found? {
        Ok((parameters, covariance)) => record(input, best, &parameters, &covariance)?,
        Err(why) => {
            console.say(format!("identify    failed: {why}"));
            IdentificationRecord { failed: Some(why), ..IdentificationRecord::default() }
        }
    };
    findings.record.optimum.identification = Some(record.clone());
    Ok(Some(Identified { record }))
}

type Found = (Vec<Parameter>, Covariance);

/// The parameters and their covariance, or why there is none.
fn covariance(input: &CommandInput, best: &Best<EnsemblePoint>) -> Result<Result<Found, String>, RunError> {
    let problem = &input.problem;
    let parameters = parameters::of(problem, &best.m);
    let scales: Vec<f64> = parameters.iter().map(|one| one.scale).collect();
    let metric = match Diagonal::new(scales.iter().map(|scale| scale.powi(-2)).collect()) {
        Ok(metric) => Arc::new(metric),
        Err(error) => return Ok(Err(error.to_string())),
    };
    let domain = nastic_opt::Domain { metric, ..domain(input)? };
    let options = SpectrumOptions { hessian: Hessian::GaussNewton, ..SpectrumOptions::leading(scales.len()) };
    let (mut point, mut workspace) = (best.point.clone(), EnsembleWorkspace::default());
    let spectrum = Spectrum::at(&problem.ensemble, &best.m, &mut point, &domain, &options, &mut workspace);
    Ok(match spectrum {
        Ok(spectrum) => Ok((parameters, Covariance::of(&spectrum, &scales, ROUNDING))),
        Err(error) => Err(error.to_string()),
    })
}

fn record(
    input: &CommandInput,
    best: &Best<EnsemblePoint>,
    parameters: &[Parameter],
    covariance: &Covariance,
) -> Result<IdentificationRecord, RunError> {
    let problem = &input.problem;
    let shots = shots::of(problem, &best.point)?;
    let readings: usize = shots.values().map(|shot| shot.readings).sum();
    let known: Vec<f64> = parameters.iter().filter_map(Parameter::squares).collect();
    let squares = shots.values().filter_map(|shot| *shot.squares).sum::<f64>() + known.iter().sum::<f64>();
    let freedom = (readings + known.len()).saturating_sub(covariance.seen());
    let per_freedom = (freedom > 0).then(|| squares / freedom as f64);
    let components = |of: &[f64]| -> ByName<Number> {
        parameters.iter().zip(of).map(|(one, part)| (one.name.clone(), (*part).into())).collect()
    };
    let directions = covariance
        .directions
        .iter()
        .map(|one| SeenDirectionRecord { deviation: one.deviation.into(), components: components(&one.components) });
    let count = parameters.len();
    let correlation = (0..count).map(|i| (0..count).map(|j| covariance.correlation(i, j).into()).collect());
    let own = parameters.iter().enumerate().map(|(i, one)| (one.name.clone(), one.record(covariance.deviation(i))));
    let (materials, scenarios) = blocks::of(problem, parameters, covariance);
    Ok(IdentificationRecord {
        failed: None,
        readings: Some(readings),
        priors: Some(known.len()).filter(|count| *count > 0),
        squares: squares.into(),
        per_freedom: per_freedom.into(),
        parameters: Some(own.collect()),
        correlation: Some(correlation.collect()),
        covariance: Some(covariance.entries.iter().map(|row| numbers(row)).collect()),
        directions: Some(directions.collect()),
        remarks: Some(remarks::of(
            parameters,
            covariance,
            &shots,
            &remarks::Fit { per_freedom, freedom, away: covariance.distance(&best.derivative) },
        )),
        shots: Some(shots),
        materials,
        scenarios,
    })
}

impl Identified {
    /// A few lines for people.
    pub fn say(&self, input: &CommandInput, console: &Console) {
        let IdentificationRecord {
            readings, priors, squares, per_freedom, parameters, shots, remarks, materials, ..
        } = &self.record;
        let (Some(readings), Some(parameters)) = (readings, parameters) else { return };
        let of = |number: &Number| number.map_or_else(|| "-".to_owned(), short);
        let unit = input.problem.units().length().symbol;
        let freedom = per_freedom.map_or_else(String::new, |per| format!(", {} per degree of freedom", short(per)));
        console.say(format!(
            "identify    {}{}, {}: weighted sum of squares {}{freedom}",
            count(*readings, "reading"),
            priors.map_or_else(String::new, |priors| format!(" and {}", count(priors, "prior"))),
            count(parameters.len(), "parameter"),
            of(squares)
        ));
        for (name, shot) in shots.iter().flatten().take(MOST_SHOTS) {
            if let Some(marker) = shot.marker.as_ref() {
                let (rms, largest) = (of(&shot.rms), of(&shot.largest));
                console.say(format!("shot        {name}: rms {rms} {unit}, largest {largest} {unit} ({marker})"));
            }
            for (cost, residual) in shot.others.iter().flatten() {
                console.say(format!("shot        {name}: {cost} missed by {} deviations", of(residual)));
            }
        }
        let more = shots.as_ref().map_or(0, |shots| shots.len().saturating_sub(MOST_SHOTS));
        if more > 0 {
            console.say(format!("            {more} more shots stand in {FILE}"));
        }
        for (name, one) in parameters {
            let unit = if one.unit.is_empty() { String::new() } else { format!(" {}", one.unit) };
            let known = match (&one.interval, one.on_bound) {
                (Some(interval), _) => {
                    let ends: Vec<String> = interval.iter().map(of).collect();
                    format!(" +- {}{unit}, 95 % from {}", of(&one.deviation), ends.join(" to "))
                }
                (None, Some(true)) => ", on its bound".to_owned(),
                (None, _) => ", not determined".to_owned(),
            };
            console.say(format!("parameter   {name} = {}{unit}{known}", of(&one.value)));
        }
        remarks.iter().flatten().for_each(|remark| console.say(format!("note        {remark}")));
        if let Some(materials) = materials {
            console.say(format!("\"materials\": {materials}"));
        }
    }

    /// `identified.json`: its name.
    pub fn write(&self, out: &Directory) -> Result<Vec<String>, RunError> {
        out.write_json(FILE, &self.record)?;
        Ok(vec![FILE.to_owned()])
    }
}
