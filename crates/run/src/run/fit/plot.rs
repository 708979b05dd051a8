//! Data and curves of all laws.

use crate::run::fit::entry::Fitted;
use nastic_fit::{Mode, Response, Test, curve};
use nastic_picture::{Chart, Curve};

/// Points of a curve.
const POINTS: usize = 80;
const MEGA: f64 = 1e6;
/// Laws in colours of their own; lines of further ones are dashed.
const COLOURS: usize = 12;
/// Widths of lines: of the best law, and of others.
const WIDTHS: [f64; 2] = [6.0, 3.0];

/// Which tests a chart shows.
type Belongs = fn(&Test) -> bool;

/// Kinds of charts.
const GROUPS: [(&str, Belongs); 4] = [
    ("stretch", |test| test.mode.deformation() == "stretch" && test.response != Response::Pressure),
    ("simple_shear", |test| test.mode == Mode::SimpleShear),
    ("inflation", |test| matches!(test.mode, Mode::Inflation { .. })),
    ("volumetric", |test| test.mode == Mode::Volumetric),
];

/// The chart that comes first, whatever it shows.
const FIRST: &str = "fit.svg";

fn file_of(group: &str) -> String {
    format!("fit_{group}.svg")
}

/// All names that charts may have.
pub(super) fn files() -> impl Iterator<Item = String> {
    std::iter::once(FIRST.to_owned()).chain(GROUPS.iter().map(|(name, _)| file_of(name)))
}

/// Charts by file name: stresses over stretches first (or what there is), other kinds of tests in charts of their own.
pub(super) fn charts(fitted: &[Fitted], tests: &[Test], title: Option<&str>) -> Vec<(String, Chart)> {
    let mut out: Vec<(String, Chart)> = Vec::new();
    for (name, belongs) in GROUPS {
        let own: Vec<&Test> = tests.iter().filter(|test| belongs(test)).collect();
        if own.is_empty() {
            continue;
        }
        let file = if out.is_empty() { FIRST.to_owned() } else { file_of(name) };
        out.push((file, chart(fitted, &own, title)));
    }
    out
}

fn chart(fitted: &[Fitted], tests: &[&Test], title: Option<&str>) -> Chart {
    let title = format!("{}: readings (points) and laws, the best first", title.unwrap_or("Tests"));
    let pressure = tests[0].response == Response::Pressure;
    let y = if pressure { "pressure (MPa)" } else { "stress (MPa)" };
    let mut chart = Chart::new(&title, tests[0].mode.deformation(), y);
    for (k, one) in fitted.iter().enumerate() {
        let label = one.fit.law.label();
        let drawn = tests.iter().filter_map(|test| curve_of(one, test));
        for (n, points) in drawn.enumerate() {
            let points = points.into_iter().map(|(x, y)| (x, y / MEGA, k < COLOURS));
            chart = chart.curve(Curve::line(if n == 0 { &label } else { "" }, WIDTHS[k.min(1)], points));
        }
    }
    // the readings, above the curves in sight; the last of each test with its name
    for test in tests {
        let cauchy = if test.response == Response::Cauchy { " (Cauchy)" } else { "" };
        for (k, [x, y]) in test.points.iter().enumerate() {
            let is_named = tests.len() > 1 && k + 1 == test.points.len();
            let name = if is_named { format!("{}{cauchy}", test.name) } else { String::new() };
            chart = chart.dot(*x, y / MEGA, &name);
        }
    }
    chart
}

/// What a law answers to a test, from rest through its readings.
fn curve_of(one: &Fitted, test: &Test) -> Option<Vec<(f64, f64)>> {
    let values = one.fit.values();
    let made = match test.mode {
        Mode::Volumetric => one.fit.law.build(&values, one.bulk.value),
        _ => one.fit.law.incompressible(&values),
    };
    let rest = if test.mode == Mode::SimpleShear { 0.0 } else { 1.0 };
    let [low, high] =
        test.points.iter().fold([rest, rest], |[low, high], [x, _]| [f64::min(low, *x), f64::max(high, *x)]);
    let at: Vec<f64> = (0..=POINTS).map(|k| low + (high - low) * k as f64 / POINTS as f64).collect();
    let responses = curve(&*made.ok()?, test.mode, test.fibers.unwrap_or_default(), test.response, &at);
    Some(at.into_iter().zip(responses).collect())
}
