//! The table of the reduced Hessian's spectrum.

use crate::html::{paragraph, section, table};
use crate::number::{number, short};
use crate::record::{Number, RangeRecord, RunRecord, SpectrumRecord};

/// A negative eigenvalue below this share of the largest is no saddle: the terminal draws the same line.
const MATTERS: f64 = 1e-3;
/// Characters of the longest bar.
const BAR: f64 = 20.0;

/// Eigenvalues at the optimum, what each says of the control, and how far the control is determined.
pub(crate) fn spectrum(result: &RunRecord) -> String {
    let Some(found) = &result.optimum.spectrum else { return String::new() };
    if let Some(why) = &found.failed {
        return section("spectrum", "Spectrum of the reduced Hessian", &paragraph(&format!("Not found: {why}.")));
    }
    let Some(values) = &found.eigenvalues else { return String::new() };
    let largest = values.first().and_then(|value| **value).unwrap_or(0.0);
    let of = |list: &[Number], k: usize| list.get(k).and_then(|value| **value);
    let row = |(k, value): (usize, &Number)| {
        let share = value.map_or(0.0, |value| if largest > 0.0 { value / largest } else { 0.0 });
        let mut row = vec![(k + 1).to_string(), number(*value, ""), bar(share)];
        row.extend([
            number(of(found.residuals.as_deref().unwrap_or_default(), k), ""),
            number(of(found.half_widths.as_deref().unwrap_or_default(), k), ""),
        ]);
        row.extend(found.shares.iter().flatten().map(|(_, share)| percent(of(share, k))));
        row
    };
    let rows: Vec<Vec<String>> = values.iter().enumerate().map(row).collect();
    let names: Vec<String> = found.shares.iter().flatten().map(|(name, _)| format!("share of {name}")).collect();
    let head = ["direction", "eigenvalue", "to the largest, ten decades", "residual", "half-width"];
    let head: Vec<&str> = head.into_iter().chain(names.iter().map(String::as_str)).collect();
    let width = |(name, range): (&String, &RangeRecord)| {
        let unit = result
            .controls
            .iter()
            .flatten()
            .find(|(known, _)| *known == name)
            .map(|(_, control)| control)
            .and_then(|control| control.unit.as_deref())
            .unwrap_or_default();
        vec![name.clone(), number(range.min, unit), number(range.max, unit)]
    };
    let widths: Vec<Vec<String>> = found.half_width.iter().flatten().map(width).collect();
    let content = paragraph(&shown(found, values))
        + &table(&head, &rows)
        + &table(&["control", "least half-width", "largest half-width"], &widths);
    section("spectrum", "Spectrum of the reduced Hessian", &content)
}

/// In words.
fn shown(found: &SpectrumRecord, values: &[Number]) -> String {
    let (count, rise) = (values.len(), found.cost_rise.map_or_else(String::new, short));
    let whole = |n: Option<usize>| n.map_or_else(|| "null".to_owned(), |n| n.to_string());
    let negative = found.negative.unwrap_or(0);
    let mut text = format!(
        "{count} of {} directions free of bounds: the first {} hold 99 % of their curvature, {} have an eigenvalue above 0.001 of the largest. \
         Half-widths: how far the control may differ until the cost rises by {rise}, by the quadratic model; those of the controls are lower \
         bounds, for directions beyond are left out.",
        whole(found.free),
        whole(found.most),
        whole(found.above)
    );
    if negative > 0 {
        let largest = values.first().and_then(|value| **value).map_or(f64::NAN, f64::abs);
        let share = -found.lowest.unwrap_or(f64::NAN) / largest;
        text += &match share < MATTERS {
            true => format!(
                " At least {negative} of the eigenvalues are negative, to -{} of the largest: directions that the target hardly determines.",
                short(share)
            ),
            false => format!(
                " At least {negative} of the eigenvalues are negative: the control is a saddle within the free directions, no minimum."
            ),
        };
    }
    text
}

/// A bar on a scale of ten decades.
fn bar(share: f64) -> String {
    let length = if share > 0.0 { (BAR * (1.0 + share.log10() / 10.0)).round().max(0.0) } else { 0.0 };
    "█".repeat(length as usize)
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_slightly_negative_eigenvalue_is_no_saddle() {
        let page = |lowest: f64| {
            let result = json!({ "spectrum": { "eigenvalues": [2.0], "negative": 1, "lowest": lowest } });
            spectrum(&RunRecord::of(&result).unwrap())
        };
        assert!(page(-1.0).contains("is a saddle within the free directions"));
        let slight = page(-1e-4);
        assert!(!slight.contains("saddle") && slight.contains("that the target hardly determines"), "{slight}");
    }
}
