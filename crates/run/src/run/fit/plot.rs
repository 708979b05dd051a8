//! Data and curves of the best law.

use crate::run::fit::entry::Fitted;
use nastic_fit::{Mode, Response, Test, curve};
use nastic_picture::{Chart, Curve};

/// Points of a curve.
const POINTS: usize = 80;
const MEGA: f64 = 1e6;

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
pub(super) fn charts(best: &Fitted, tests: &[Test], title: Option<&str>) -> Vec<(String, Chart)> {
    let mut out: Vec<(String, Chart)> = Vec::new();
    for (name, belongs) in GROUPS {
        let own: Vec<&Test> = tests.iter().filter(|test| belongs(test)).collect();
        if own.is_empty() {
            continue;
        }
        let file = if out.is_empty() { FIRST.to_owned() } else { file_of(name) };
        out.push((file, chart(best, &own, title)));
    }
    out
}

fn chart(best: &Fitted, tests: &[&Test], title: Option<&str>) -> Chart {
    let values = best.fit.values();
    let title = format!("{} (points) and {} (curves)", title.unwrap_or("Tests"), best.fit.law.label());
    let pressure = tests[0].response == Response::Pressure;
    let y = if pressure { "pressure (MPa)" } else { "stress (MPa)" };
    let mut chart = Chart::new(&title, tests[0].mode.deformation(), y);
    for test in tests {
        let volumetric = test.mode == Mode::Volumetric;
        let made = if volumetric {
            best.fit.law.build(&values, best.bulk.value)
        } else {
            best.fit.law.incompressible(&values)
        };
        let Ok(law) = made else { continue };
        let rest = if test.mode == Mode::SimpleShear { 0.0 } else { 1.0 };
        let [low, high] =
            test.points.iter().fold([rest, rest], |[low, high], [x, _]| [f64::min(low, *x), f64::max(high, *x)]);
        let at: Vec<f64> = (0..=POINTS).map(|k| low + (high - low) * k as f64 / POINTS as f64).collect();
        let responses = curve(&*law, test.mode, test.fibers.unwrap_or_default(), test.response, &at);
        let label =
            if test.response == Response::Cauchy { format!("{} (Cauchy)", test.name) } else { test.name.clone() };
        chart = chart.curve(Curve::new(&label, at.into_iter().zip(responses).map(|(x, y)| (x, y / MEGA, true))));
    }
    // the data, behind the curves in order and above them in sight
    for [x, y] in tests.iter().flat_map(|test| &test.points) {
        chart = chart.dot(*x, y / MEGA, "");
    }
    chart
}
