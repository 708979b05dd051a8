//! The tables of identified parameters.

use crate::html::{paragraph, section, table};
use crate::number::number;
use crate::record::{ParameterRecord, RunRecord, ShotRecord};

/// Parameters with their intervals, what deserves attention, and the residuals of every shot.
pub(crate) fn identification(result: &RunRecord) -> String {
    const TITLE: &str = "Parameters from readings";
    let Some(found) = &result.optimum.identification else { return String::new() };
    if let Some(why) = &found.failed {
        return section("identification", TITLE, &paragraph(&format!("Not found: {why}.")));
    }
    let length = result.units.length.as_str();
    let parameter = |(name, one): (&String, &ParameterRecord)| {
        let end = |k: usize| number(one.interval.as_ref().and_then(|ends| **ends.get(k)?), &one.unit);
        let own = [one.value, one.deviation].map(|value| number(*value, &one.unit));
        [vec![name.clone()], own.to_vec(), vec![end(0), end(1)]].concat()
    };
    let shot = |(name, shot): (&String, &ShotRecord)| {
        let lengths = [shot.rms, shot.largest].map(|value| number(*value, length)).to_vec();
        let marker = shot.marker.as_ref().cloned().unwrap_or_default();
        let counts = vec![name.clone(), shot.readings.to_string(), number(*shot.squares, "")];
        [counts, lengths, vec![marker]].concat()
    };
    let parameters: Vec<Vec<String>> = found.parameters.iter().flatten().map(parameter).collect();
    let shots: Vec<Vec<String>> = found.shots.iter().flatten().map(shot).collect();
    let remarks: String = found.remarks.iter().flatten().map(|remark| paragraph(&format!("{remark}."))).collect();
    let fit = format!("Weighted squares per degree of freedom: {}.", number(*found.per_freedom, ""));
    let content = paragraph(&fit)
        + &remarks
        + &table(&["parameter", "value", "deviation", "95 % from", "to"], &parameters)
        + &table(&["shot", "readings", "weighted squares", "rms", "largest", "marker"], &shots);
    section("identification", TITLE, &content)
}
