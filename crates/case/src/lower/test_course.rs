//! The course of a table of test data: what it says at rest, and whether it unloads again.

use nastic_fit::Test;
use nastic_language::number::short;

/// Deformations below this share of the largest are at rest, but none above [`SMALL`].
const AT_REST: f64 = 5e-3;
/// At this strain a stiff rubber has stresses of its own.
const SMALL: f64 = 2e-3;
/// Stresses at rest above this share of the largest are an offset.
const OFFSET: f64 = 0.05;
/// A deformation that falls by this share of the largest behind a rise as large is an unloading.
const UNLOADED: f64 = 0.1;

/// What is doubtful in the course of a table, by its file.
pub(super) fn doubtful(test: &Test, file: &str) -> Vec<String> {
    // shear begins at 0, stretches and ratios of volumes at 1
    let rest = if matches!(test.mode, nastic_fit::Mode::SimpleShear) { 0.0 } else { 1.0 };
    let points: Vec<[f64; 2]> = test.points.iter().map(|[x, y]| [x - rest, *y]).collect();
    [offset(&points), unloads(&points).map(cycles)]
        .into_iter()
        .flatten()
        .map(|what| format!("{file}: {what}"))
        .collect()
}

/// A stress where there is no deformation.
fn offset(points: &[[f64; 2]]) -> Option<String> {
    let most = |k: usize| points.iter().map(|point| point[k].abs()).fold(0.0, f64::max);
    let [largest, strongest] = [most(0), most(1)];
    let at_rest = points.iter().filter(|[x, _]| x.abs() <= (AT_REST * largest).min(SMALL)).map(|[_, y]| *y);
    let stress = at_rest.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    (stress.abs() > OFFSET * strongest).then(|| {
        format!(
            "the stress is {} Pa at rest, {:.0} % of the largest, where every law is free of it: subtract a preload or an offset of the \
             load cell, or let the deformation begin where the stress does",
            short(format!("{stress:.2e}").parse().unwrap_or(stress)),
            100.0 * stress.abs() / strongest
        )
    })
}

/// How often a deformation falls again behind a rise on the same side of rest, over two rows or more: in one it begins anew. None if it never does.
fn unloads(points: &[[f64; 2]]) -> Option<usize> {
    let least = UNLOADED * points.iter().map(|[x, _]| x.abs()).fold(0.0, f64::max);
    let (mut count, mut side) = (0, 0.0);
    // of the rise under way its beginning and its end; of the fall behind it the last row, how many it has, and whether it was counted
    let (mut low, mut high, mut last, mut rows, mut told) = (0.0, 0.0, 0.0, 0, false);
    for [x, _] in points.iter().filter(|[x, _]| x.abs() > 0.0) {
        let size = x.abs();
        if x.signum() != side || size > last {
            if x.signum() != side || rows > 0 {
                low = if x.signum() != side { size } else { last };
                high = size;
            }
            (side, rows, told, high) = (x.signum(), 0, false, size.max(high));
        } else if size < last {
            rows += 1;
            if !told && rows > 1 && high - low > least && high - size > least {
                (count, told) = (count + 1, true);
            }
        }
        last = size;
    }
    (count > 0).then_some(count)
}

fn cycles(count: usize) -> String {
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    format!(
        "the specimen is unloaded {times}: laws of elasticity have one curve and are fitted through the middle of both. Keep the rows of one \
         branch, of a preconditioned specimen the last loading"
    )
}
