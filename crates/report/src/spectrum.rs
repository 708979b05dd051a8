//! The table of the reduced Hessian's spectrum.

use crate::html::{paragraph, section, table};
use crate::number::{number, short};
use serde_json::Value;

/// A negative eigenvalue below this share of the largest is no saddle: the terminal draws the same line.
const MATTERS: f64 = 1e-3;
/// Characters of the longest bar.
const BAR: f64 = 20.0;

/// Eigenvalues at the optimum, what each says of the control, and how far the control is determined.
pub(crate) fn spectrum(result: &Value) -> String {
    let found = &result["spectrum"];
    if let Some(why) = found["failed"].as_str() {
        return section("spectrum", "Spectrum of the reduced Hessian", &paragraph(&format!("Not found: {why}.")));
    }
    let Some(values) = found["eigenvalues"].as_array() else { return String::new() };
    let largest = values.first().and_then(Value::as_f64).unwrap_or(0.0);
    let shares: Vec<(&String, &Value)> = found["shares"].as_object().into_iter().flatten().collect();
    let row = |(k, value): (usize, &Value)| {
        let share = value.as_f64().map_or(0.0, |value| if largest > 0.0 { value / largest } else { 0.0 });
        let mut row = vec![(k + 1).to_string(), number(value, ""), bar(share)];
        row.extend([number(&found["residuals"][k], ""), number(&found["half_widths"][k], "")]);
        row.extend(shares.iter().map(|(_, share)| percent(&share[k])));
        row
    };
    let rows: Vec<Vec<String>> = values.iter().enumerate().map(row).collect();
    let of: Vec<String> = shares.iter().map(|(name, _)| format!("share of {name}")).collect();
    let head = ["direction", "eigenvalue", "to the largest, ten decades", "residual", "half-width"];
    let head: Vec<&str> = head.into_iter().chain(of.iter().map(String::as_str)).collect();
    let widths = found["half_width"].as_object().into_iter().flatten();
    let width = |(name, range): (&String, &Value)| {
        let unit = result["controls"][name]["unit"].as_str().unwrap_or_default();
        vec![name.clone(), number(&range["min"], unit), number(&range["max"], unit)]
    };
    let widths: Vec<Vec<String>> = widths.map(width).collect();
    let content = paragraph(&told(found, values.len()))
        + &table(&head, &rows)
        + &table(&["control", "least half-width", "largest half-width"], &widths);
    section("spectrum", "Spectrum of the reduced Hessian", &content)
}

/// In words.
fn told(found: &Value, count: usize) -> String {
    let rise = found["cost_rise"].as_f64().map_or_else(String::new, short);
    let mut text = format!(
        "{count} of {} directions free of bounds: the first {} hold 99 % of their curvature, {} have an eigenvalue above 0.001 of the largest. \
         Half-widths: how far the control may differ until the cost rises by {rise}, by the quadratic model; those of the controls are lower \
         bounds, for directions beyond are left out.",
        found["free"], found["most"], found["above"]
    );
    if found["negative"].as_u64().is_some_and(|negative| negative > 0) {
        let largest = found["eigenvalues"][0].as_f64().map_or(f64::NAN, f64::abs);
        let share = -found["lowest"].as_f64().unwrap_or(f64::NAN) / largest;
        text += &match share < MATTERS {
            true => format!(
                " At least {} of the eigenvalues are negative, to -{} of the largest: directions that the target hardly determines.",
                found["negative"],
                short(share)
            ),
            false => format!(
                " At least {} of the eigenvalues are negative: the control is a saddle within the free directions, no minimum.",
                found["negative"]
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

fn percent(share: &Value) -> String {
    share.as_f64().map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_slightly_negative_eigenvalue_is_no_saddle() {
        let page =
            |lowest: f64| spectrum(&json!({ "spectrum": { "eigenvalues": [2.0], "negative": 1, "lowest": lowest } }));
        assert!(page(-1.0).contains("is a saddle within the free directions"));
        let slight = page(-1e-4);
        assert!(!slight.contains("saddle") && slight.contains("that the target hardly determines"), "{slight}");
    }
}
