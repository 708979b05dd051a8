//! The actuations in words and as JSON.

use crate::describe::parameters::law;
use nastic_case::describe::{Line, catalogue_of, line, parameters, scalar, vector_field};
use nastic_case::lower::CaseProblem;
use nastic_fem::catalogue::{FormValues, Key, KeyKind};
use nastic_fem::{BodyEnergy, BodyPoint};
use nastic_language::expression::dimension_of;
use nastic_language::number::quantity;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Actuation, Fixed, Means, at_rest, point_in_words as point};
use nastic_report::record::{BodyPointRecord, ByName, ConstantRecord, LawRecord, Number};

/// What drives the body, in words.
pub fn actuation(problem: &CaseProblem) -> Vec<Line> {
    let mut out = Vec::new();
    for actuation in &problem.case.actuation {
        let units = problem.units();
        let place = match &actuation.means {
            Means::Law { row, region, parameters: given, design } => {
                let values = parameters(given, &catalogue_of(row.forms), units);
                let values = Some(values).filter(|values| !values.is_empty());
                let all = values.into_iter().chain(design.iter().map(|own| format!("design {own}")));
                all.fold(region.to_string(), |all, one| format!("{all}; {one}"))
            }
            Means::Contribution { values, form, .. } => {
                let shown = |(key, names): (&&str, &Vec<String>)| format!("{key} {}", names.join(", "));
                let names = values.names.iter().filter(|(_, names)| !names.is_empty()).map(shown);
                let through = |points: &Vec<BodyPoint>| points.iter().map(point).collect::<Vec<_>>().join(", ");
                let points = values.points.iter().map(|(key, points)| format!("{key} {}", through(points)));
                let units_of = |key: &str| form.keys.iter().find(|known| known.name == key).map(dimension);
                let number = |(key, value): (&&str, &f64)| {
                    format!("{key} {}", quantity(*value, units_of(key).unwrap_or(Dimension::NONE), units))
                };
                let numbers = values.numbers.iter().map(number);
                let flags = values.flags.iter().map(ToString::to_string);
                let place = |(key, place): (&&str, &[f64; 3])| format!("{key} {}", point(&BodyPoint::At(*place)));
                let points = points.chain(values.places.iter().map(place));
                names.chain(points).chain(numbers).chain(flags).collect::<Vec<_>>().join("; ")
            }
        };
        out.push(line("actuation", format!("{}: {} on {place}", actuation.name, actuation.kind())));
        out.push(line("actuation", format!("  {}", actuation.about())));
        if let Some(volume) = at_rest(problem.solid(), &actuation.name, "volume") {
            let dimension = if problem.mesh().dim() == 2 { AREA } else { VOLUME };
            out.push(line("actuation", format!("  volume at rest {}", quantity(volume, dimension, units))));
        }
        if let Some(length) = at_rest(problem.solid(), &actuation.name, "length") {
            out.push(line("actuation", format!("  length at rest {}", quantity(length, Dimension::LENGTH, units))));
        }
        if let Some(limit) = limit(problem, &actuation.name, BodyEnergy::fiber_limit) {
            let limit = quantity(limit, Dimension::PRESSURE, units);
            out.push(line("actuation", format!("  the law stays polyconvex up to a tension of {limit}")));
        }
        if let Some((beside, joint)) = together(problem, &actuation.name) {
            let joint = quantity(joint, Dimension::PRESSURE, units);
            let beside = beside.join(", ");
            out.push(line("actuation", format!("  with that of {beside} on the same cells, all alike, up to {joint}")));
        }
        for (key, fixed) in &actuation.fixed {
            let value = match fixed {
                Fixed::Scalar(value) => scalar(value, Dimension::NONE, units),
                Fixed::Vector(value) => vector_field(value),
                Fixed::Table(table) => format!("{} of {} over the time", table.names().join(", "), table.file),
            };
            out.push(line("actuation", format!("  fixed {key} {value}")));
        }
    }
    out
}

/// The actuations as results have them.
pub(super) fn records(problem: &CaseProblem) -> Vec<LawRecord> {
    let of = |a: &Actuation| {
        let entry = match &a.means {
            Means::Law { row, region, parameters, design } => {
                let design = super::in_words(design);
                LawRecord { design, ..law(problem, region, row.name, parameters, row.forms) }
            }
            Means::Contribution { kind, values, .. } => LawRecord {
                kind: Some((*kind).to_owned()),
                keys: keys(values),
                reference_volume: at_rest(problem.solid(), &a.name, "volume").map(Number::from).unwrap_or_default(),
                reference_length: at_rest(problem.solid(), &a.name, "length").map(Number::from).unwrap_or_default(),
                ..LawRecord::default()
            },
        };
        let (beside, joint) = together(problem, &a.name).unzip();
        LawRecord {
            name: Some(a.name.clone()),
            fiber_limit: limit(problem, &a.name, BodyEnergy::fiber_limit).into(),
            joint_fiber_limit: joint.map(Number::from).unwrap_or_default(),
            beside,
            ..entry
        }
    };
    problem.case.actuation.iter().map(of).collect()
}

/// The keys of a contribution with their values.
fn keys(values: &FormValues) -> ByName<ConstantRecord> {
    let mut out = ByName::default();
    let mut put = |key: &str, value: ConstantRecord| out.insert(key.to_owned(), value);
    values.names.iter().for_each(|(key, names)| drop(put(key, ConstantRecord::Names(names.clone()))));
    values.flags.iter().for_each(|key| drop(put(key, ConstantRecord::Flag(true))));
    for (key, points) in &values.points {
        put(key, ConstantRecord::Points(points.iter().map(body_point).collect()));
    }
    values.places.iter().for_each(|(key, place)| drop(put(key, ConstantRecord::Vector(*place))));
    values.numbers.iter().for_each(|(key, number)| drop(put(key, ConstantRecord::Number(*number))));
    out
}

/// A point as results have it.
pub(super) fn body_point(point: &BodyPoint) -> BodyPointRecord {
    match point {
        BodyPoint::At(place) => BodyPointRecord::Place(*place),
        BodyPoint::Nodes(name) => BodyPointRecord::Nodes(name.clone()),
    }
}

/// The smallest bound on a tension of all members.
fn limit(problem: &CaseProblem, actuation: &str, bound: impl Fn(&BodyEnergy, usize) -> Option<f64>) -> Option<f64> {
    let of = |body: &BodyEnergy| bound(body, number(body, actuation)?);
    problem.members().filter_map(|member| of(member.solid().body())).reduce(f64::min)
}

/// The families beside one on its cells, and what all of them may reach at once.
fn together(problem: &CaseProblem, actuation: &str) -> Option<(Vec<String>, f64)> {
    let body = problem.solid().body();
    let joint = limit(problem, actuation, BodyEnergy::joint_fiber_limit)?;
    let beside: Vec<String> = body.families_beside(number(body, actuation)?).into_iter().map(str::to_owned).collect();
    (!beside.is_empty()).then_some((beside, joint))
}

fn number(body: &BodyEnergy, actuation: &str) -> Option<usize> {
    body.actuations().iter().position(|attached| attached.name == actuation)
}

const VOLUME: Dimension = Dimension::of(3, 0, 0, 0);
/// In plane strain.
const AREA: Dimension = Dimension::of(2, 0, 0, 0);

fn dimension(key: &Key) -> Dimension {
    match key.kind {
        KeyKind::Number { unit, .. } | KeyKind::Positive { unit } => dimension_of(unit).unwrap_or(Dimension::NONE),
        _ => Dimension::NONE,
    }
}
