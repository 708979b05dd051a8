//! Terms of the cost and the values of their keys in words.

use super::costs::obstacle;
use nastic_control::CostWords;
use nastic_language::expression::Formula;
use nastic_language::number::{count, short};
use nastic_language::schema::{CostTerm, MeshSource, Target, TermValue};

/// What a term measures.
pub(super) fn in_words(term: &CostTerm) -> String {
    let Some(words) = term.form.words else { return term.form.about.to_owned() };
    let mut values = CostWords::default();
    for (key, value) in &term.values {
        values.texts.insert(key, value_in_words(value));
        if let TermValue::Count(count) = value {
            values.counts.insert(key, u32::try_from(*count).unwrap_or(u32::MAX));
        }
    }
    words(&values)
}

fn value_in_words(value: &TermValue) -> String {
    let vector = |v: [f64; 3]| v.map(short).join(", ");
    match value {
        TermValue::Names(names) => names.to_string(),
        TermValue::Point(point) => vector(point.xyz()),
        TermValue::Line(line) => count(line.len(), "point"),
        TermValue::Direction(direction) => vector(direction.xyz()),
        TermValue::Number(number) => short(*number),
        TermValue::Count(count) => count.to_string(),
        TermValue::Word(word) => (*word).to_owned(),
        TermValue::Position(position) => {
            let value = |y: &Formula| y.constant().map_or_else(|| y.text().to_owned(), short);
            let wanted = ["x", "y", "z"].iter().zip(position.entries());
            wanted.filter_map(|(c, y)| Some(format!("{c} = {}", value(y?)))).collect::<Vec<_>>().join(", ")
        }
        TermValue::Path(table) => {
            let components = ["x", "y", "z"].iter().zip(table.components());
            let named: Vec<String> = components.filter_map(|(c, column)| Some(format!("{c} = {}", column?))).collect();
            format!("{} of {} over the time", named.join(", "), table.file)
        }
        TermValue::Target(Target::Formulas(entries)) => {
            format!("({})", entries.iter().map(Formula::text).collect::<Vec<_>>().join(", "))
        }
        TermValue::Target(Target::Array(file)) => file.file.clone(),
        TermValue::Target(Target::Nodes(nodes)) => mesh(&nodes.nodes),
        TermValue::Mesh(source) => mesh(source),
        TermValue::Obstacle(shape) => obstacle(shape),
        TermValue::Contact(name) | TermValue::Control(name) => name.clone(),
    }
}

fn mesh(source: &MeshSource) -> String {
    match source {
        MeshSource::File(file) => file.file.clone(),
        MeshSource::Box(_) => "a box".to_owned(),
        MeshSource::Boxes(_) => "boxes".to_owned(),
    }
}
