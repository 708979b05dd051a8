//! Costs of positions, directions, curvatures and stretches in words.

use nastic_language::expression::Formula;
use nastic_language::number::short;
use nastic_language::schema::Cost;

/// What such a cost measures; nothing of others.
pub(super) fn shape_cost(cost: &Cost) -> String {
    match cost {
        Cost::Position(block) => {
            let named = block.surface.as_ref().or(block.region.as_ref()).or(block.nodes.as_ref());
            let place = match (&block.point, named) {
                (Some(point), _) => format!("the point ({})", vector(point.xyz())),
                (None, Some(names)) => format!("the mean of {names}"),
                (None, None) => String::new(),
            };
            let wanted = ["x", "y", "z"].iter().zip(block.target.entries());
            let value = |y: &Formula| y.constant().map_or_else(|| y.text().to_owned(), short);
            let wanted: Vec<String> = wanted.filter_map(|(c, y)| Some(format!("{c} = {}", value(y?)))).collect();
            format!("weight/2 |x - target|^2 of {place}, target {}", wanted.join(", "))
        }
        Cost::Orientation(block) => {
            format!("weight/2 int |n - ({})|^2 over {}", vector(block.direction.xyz()), block.surface)
        }
        Cost::Curvature(block) => {
            format!("weight/2 int (kappa - {})^2 along {} points", short(block.curvature), block.line.len())
        }
        Cost::Compliance(block) => {
            format!("displacement of {} along ({}) for a unit of force", block.surface, vector(block.direction.xyz()))
        }
        Cost::LargestStretch(block) => {
            let place = block.region.as_ref().map_or("the body".to_owned(), ToString::to_string);
            format!(
                "smoothed maximum of the principal stretches of {place}, power mean of exponent {}",
                2 * block.exponent
            )
        }
        _ => String::new(),
    }
}

fn vector(v: [f64; 3]) -> String {
    v.map(short).join(", ")
}
