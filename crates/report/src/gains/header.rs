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
    text + STEP
}

const STEP: &str = "/* One step: from the outputs y as measured, the controls m are replaced by the next ones. */
static inline void nastic_gains_step(const double y[NASTIC_GAINS_OUTPUTS], double m[NASTIC_GAINS_CONTROLS])
{
    int i, j;
    for (j = 0; j < NASTIC_GAINS_CONTROLS; ++j) {
        double next = m[j];
        for (i = 0; i < NASTIC_GAINS_OUTPUTS; ++i) {
            next -= nastic_gains_matrix[j][i] * (y[i] - nastic_gains_targets[i]);
        }
        if (next < nastic_gains_lower[j]) {
            next = nastic_gains_lower[j];
        }
        if (next > nastic_gains_upper[j]) {
            next = nastic_gains_upper[j];
        }
        m[j] = next;
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
