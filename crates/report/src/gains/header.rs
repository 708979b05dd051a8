//! `gains.h`: the law as a C header.

use crate::record::{GainsRecord, Number};
use std::fmt::Write;

/// What stands for a bound that is not there: the largest number of double precision.
const NONE: f64 = f64::MAX;

/// The law in C99 without dependencies: constants in the order of `gains.json`, and a function that steps.
#[must_use]
pub fn header(found: &GainsRecord) -> String {
    let GainsRecord { controls, outputs, gain, .. } = found;
    let mut text = format!(
        "/* Made by nastic gains: quasi-static feedback m <- m - L (y - y*), within the bounds of m.\n *\n * y, {} numbers:\n",
        outputs.len()
    );
    let line = |text: &mut String, k: usize, name: &str, unit: &str| {
        // a write into a text does not fail
        let _ =
            writeln!(text, " *   {k}: {}, in {}", plain(name), if unit.is_empty() { "1".into() } else { plain(unit) });
    };
    for (k, one) in outputs.iter().enumerate() {
        line(&mut text, k, &one.name, &one.unit);
    }
    let _ = write!(text, " *\n * m, {} numbers:\n", controls.len());
    for (k, one) in controls.iter().enumerate() {
        line(&mut text, k, &one.name, &one.unit);
    }
    let _ = write!(
        text,
        " */\n#ifndef NASTIC_GAINS_H\n#define NASTIC_GAINS_H\n\n#define NASTIC_GAINS_OUTPUTS {}\n#define NASTIC_GAINS_CONTROLS {}\n\n",
        outputs.len(),
        controls.len()
    );
    let list = |name: &str, size: &str, about: &str, values: Vec<f64>| {
        format!("/* {about} */\nstatic const double nastic_gains_{name}[{size}] = {{{}}};\n\n", row(&values))
    };
    let [y, m] = ["NASTIC_GAINS_OUTPUTS", "NASTIC_GAINS_CONTROLS"];
    let of = |value: &Number, other: f64| value.unwrap_or(other);
    text += &list("targets", y, "y*", outputs.iter().map(|one| of(&one.target, 0.0)).collect());
    text += &list("start", m, "m to begin with", controls.iter().map(|one| of(&one.value, 0.0)).collect());
    text += &list("lower", m, "bounds of m", controls.iter().map(|one| of(&one.lower, -NONE)).collect());
    text += &list("upper", m, "bounds of m", controls.iter().map(|one| of(&one.upper, NONE)).collect());
    let matrix = |name: &str, sizes: String, about: &str, rows: Vec<Vec<Number>>| {
        let rows = rows.iter().map(|own| row(&own.iter().map(|value| of(value, 0.0)).collect::<Vec<f64>>()));
        let rows: Vec<String> = rows.map(|own| format!("    {{{own}}}")).collect();
        format!("/* {about} */\nstatic const double nastic_gains_{name}{sizes} = {{\n{}\n}};\n\n", rows.join(",\n"))
    };
    let sensitivities = outputs.iter().map(|one| one.sensitivities.clone()).collect();
    text += &matrix("sensitivity", format!("[{y}][{m}]"), "S = dy/dm at the start", sensitivities);
    text += &matrix("matrix", format!("[{m}][{y}]"), "L", gain.clone());
    text +=
        &list("scale", m, "a change of m that counts as one", controls.iter().map(|one| of(&one.scale, 1.0)).collect());
    let [slope, curvature] = quadratic(found);
    text += &matrix("slope", format!("[{m}][{y}]"), "S^T Q", slope);
    text += &matrix("curvature", format!("[{m}][{m}]"), "S^T Q S + R", curvature);
    text + STEP
}

/// `S^T Q` and `S^T Q S + R`, by rows.
fn quadratic(found: &GainsRecord) -> [Vec<Vec<Number>>; 2] {
    let GainsRecord { controls, outputs, .. } = found;
    let s = |i: usize, j: usize| outputs[i].sensitivities.get(j).and_then(|own| **own).unwrap_or(0.0);
    let slope = |j: usize, i: usize| s(i, j) * outputs[i].weight.unwrap_or(0.0);
    let entry = |j: usize, k: usize| {
        let own = (0..outputs.len()).map(|i| slope(j, i) * s(i, k)).sum::<f64>();
        if j == k { own + controls[j].penalty.unwrap_or(0.0) } else { own }
    };
    let rows = |columns: usize, of: &dyn Fn(usize, usize) -> f64| {
        (0..controls.len()).map(|j| (0..columns).map(|k| of(j, k).into()).collect()).collect()
    };
    [rows(outputs.len(), &slope), rows(controls.len(), &entry)]
}

const STEP: &str =
    "/* One step: from the outputs y as measured, the controls m are replaced by the next ones, those with which
 * 1/2 |y - y* + S d|_Q^2 + 1/2 d.R d is least within the bounds: m - L (y - y*) where these do not cut it, else by
 * coordinates in turn. A reading that is no finite number leaves m as it is. */
static inline void nastic_gains_step(const double y[NASTIC_GAINS_OUTPUTS], double m[NASTIC_GAINS_CONTROLS])
{
    double next[NASTIC_GAINS_CONTROLS], slope[NASTIC_GAINS_CONTROLS];
    int i, j, k, cut = 0, sweep;
    for (i = 0; i < NASTIC_GAINS_OUTPUTS; ++i) {
        if (!(y[i] - y[i] == 0.0)) {
            return;
        }
    }
    for (j = 0; j < NASTIC_GAINS_CONTROLS; ++j) {
        double whole = m[j];
        slope[j] = 0.0;
        for (i = 0; i < NASTIC_GAINS_OUTPUTS; ++i) {
            const double error = y[i] - nastic_gains_targets[i];
            whole -= nastic_gains_matrix[j][i] * error;
            slope[j] += nastic_gains_slope[j][i] * error;
        }
        next[j] = whole;
        if (next[j] < nastic_gains_lower[j]) {
            next[j] = nastic_gains_lower[j];
        }
        if (next[j] > nastic_gains_upper[j]) {
            next[j] = nastic_gains_upper[j];
        }
        cut = cut || next[j] < whole || next[j] > whole;
    }
    for (sweep = 0; cut && sweep < 1000; ++sweep) {
        cut = 0;
        for (j = 0; j < NASTIC_GAINS_CONTROLS; ++j) {
            double pull = slope[j], change, value;
            if (!(nastic_gains_curvature[j][j] > 0.0)) {
                continue;
            }
            for (k = 0; k < NASTIC_GAINS_CONTROLS; ++k) {
                pull += nastic_gains_curvature[j][k] * (next[k] - m[k]);
            }
            value = next[j] - pull / nastic_gains_curvature[j][j];
            if (value < nastic_gains_lower[j]) {
                value = nastic_gains_lower[j];
            }
            if (value > nastic_gains_upper[j]) {
                value = nastic_gains_upper[j];
            }
            change = value - next[j];
            next[j] = value;
            if (change > 1e-13 * nastic_gains_scale[j] || change < -1e-13 * nastic_gains_scale[j]) {
                cut = 1;
            }
        }
    }
    for (j = 0; j < NASTIC_GAINS_CONTROLS; ++j) {
        m[j] = next[j];
    }
}

#endif /* NASTIC_GAINS_H */
";

/// Numbers that read back to the bit.
fn row(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:e}")).collect::<Vec<_>>().join(", ")
}

/// A name without what ends a comment, begins another or is no ASCII.
fn plain(name: &str) -> String {
    let keep = |c: char| c.is_ascii_alphanumeric() || " ._-+^".contains(c);
    // a unit is a quotient now and then
    name.replace('/', " per ").chars().map(|c| if keep(c) { c } else { '_' }).collect()
}
