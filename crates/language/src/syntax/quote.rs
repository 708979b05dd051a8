//! Text of the user's inside a message.

/// Longer texts are cut: a message is read by a person.
const LONGEST: usize = 80;

/// In quotes, on one line, without control characters: what is quoted cannot disturb the terminal.
pub fn quoted(text: &str) -> String {
    let long = text.chars().count() > LONGEST;
    let shown: String = text.chars().take(LONGEST).collect();
    let shown = shown.chars().map(visible).collect::<String>();
    format!("\"{shown}{}\"", if long { "..." } else { "" })
}

fn visible(c: char) -> char {
    if c.is_control() { '\u{fffd}' } else { c }
}
