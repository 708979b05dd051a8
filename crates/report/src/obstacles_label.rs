//! [`obstacles_label`]: what obstacles are called in legends.

/// Names that a legend has room for.
const NAMED: usize = 4;

/// What the obstacles of these names are called in a legend, all together: they have one colour.
#[must_use]
pub fn obstacles_label(names: &[String]) -> String {
    let more = names.len().saturating_sub(NAMED);
    match (names.len(), more) {
        (0 | 1, _) => "obstacle".to_owned(),
        (_, 0) => format!("obstacles {}", names.join(", ")),
        _ => format!("obstacles {} and {more} more", names[..NAMED].join(", ")),
    }
}
