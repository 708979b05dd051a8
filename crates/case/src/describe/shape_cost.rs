//! Terms of the cost and the values of their keys in words.

use super::costs::obstacle;
use nastic_control::CostWords;
use nastic_language::expression::Formula;
use nastic_language::number::{count, short};
use nastic_language::schema::{CostTerm, KeyValue, MarkerTable, MeshSource, Target};

/// What a term measures.
pub(super) fn in_words(term: &CostTerm) -> String {
    let Some(words) = term.form.words else { return term.form.about.to_owned() };
    let mut values = CostWords::default();
    for (key, value) in &term.values {
        values.texts.insert(key, value_in_words(value));
        if let KeyValue::Count(count) = value {
            values.counts.insert(key, u32::try_from(*count).unwrap_or(u32::MAX));
        }
    }
    words(&values)
}

fn value_in_words(value: &KeyValue) -> String {
    let vector = |v: [f64; 3]| v.map(short).join(", ");
    match value {
        KeyValue::Names(names) => names.to_string(),
        KeyValue::Point(point) => vector(point.xyz()),
        KeyValue::Line(line) => count(line.len(), "point"),
        KeyValue::Points(points) => count(points.len(), "point"),
        KeyValue::Components(fix) => {
            fix.components().iter().map(|&i| ["x", "y", "z"][i]).collect::<Vec<_>>().join(", ")
        }
        KeyValue::Flag(flag) => flag.to_string(),
        KeyValue::Direction(direction) => vector(direction.xyz()),
        KeyValue::Number(number) => short(*number),
        KeyValue::Count(count) => count.to_string(),
        KeyValue::Word(word) => (*word).to_owned(),
        KeyValue::Markers(MarkerTable::File(file)) => format!("the markers of {file}"),
        KeyValue::Markers(MarkerTable::Rows(rows)) => count(rows.len(), "marker"),
        KeyValue::Position(position) => {
            let value = |y: &Formula| y.constant().map_or_else(|| y.text().to_owned(), short);
            let wanted = ["x", "y", "z"].iter().zip(position.entries());
            wanted.filter_map(|(c, y)| Some(format!("{c} = {}", value(y?)))).collect::<Vec<_>>().join(", ")
        }
        KeyValue::Path(table) => {
            let components = ["x", "y", "z"].iter().zip(table.components());
            let named: Vec<String> = components.filter_map(|(c, column)| Some(format!("{c} = {}", column?))).collect();
            format!("{} of {} over the time", named.join(", "), table.file)
        }
        KeyValue::Target(Target::Formulas(entries)) => {
            format!("({})", entries.iter().map(Formula::text).collect::<Vec<_>>().join(", "))
        }
        KeyValue::Target(Target::Array(file)) => file.file.clone(),
        KeyValue::Target(Target::Nodes(nodes)) => mesh(&nodes.nodes),
        KeyValue::Mesh(source) => mesh(source),
        KeyValue::Obstacle(shape) => obstacle(shape),
        KeyValue::Contact(name) | KeyValue::Control(name) => name.clone(),
    }
}

fn mesh(source: &MeshSource) -> String {
    match source {
        MeshSource::File(file) => file.file.clone(),
        MeshSource::Box(_) => "a box".to_owned(),
        MeshSource::Boxes(_) => "boxes".to_owned(),
    }
}
