//! [`Sheet`]: the lines of a CSV file as cells.

/// Lines that are neither empty nor remarks.
pub(super) struct Sheet<'t> {
    pub lines: Vec<Line<'t>>,
}

/// A line, from 1.
pub(super) struct Line<'t> {
    pub number: usize,
    pub text: &'t str,
}

/// A cell without quotes and blanks around it, with its column in the line, from 1.
pub(super) struct Cell {
    pub column: usize,
    pub text: String,
}

impl<'t> Sheet<'t> {
    pub fn new(text: &'t str) -> Self {
        let lines =
            text.trim_start_matches('\u{feff}').lines().enumerate().map(|(k, text)| Line { number: k + 1, text });
        let said = |line: &Line| !line.text.trim().is_empty() && !line.text.trim_start().starts_with('#');
        Self { lines: lines.filter(said).collect() }
    }
}

impl Line<'_> {
    /// What separates the cells of a line of columns.
    pub fn separator(&self) -> char {
        [';', '\t'].into_iter().find(|separator| self.text.contains(*separator)).unwrap_or(',')
    }

    /// The cells up to the last that is not empty; separators between quotes separate nothing.
    pub fn cells(&self, separator: char) -> Vec<Cell> {
        let mut cells = vec![];
        let (mut quoted, mut begin, mut start) = (false, 0, 1);
        let mut push = |text: &str, column: usize| {
            let blanks = text.chars().take_while(|c| c.is_whitespace()).count();
            let text = text.trim();
            let inner = text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
            cells.push(Cell { column: column + blanks, text: inner.unwrap_or(text).trim().to_owned() });
        };
        for (column, (at, letter)) in (1..).zip(self.text.char_indices()) {
            quoted ^= letter == '"';
            if letter == separator && !quoted {
                push(&self.text[begin..at], start);
                (begin, start) = (at + letter.len_utf8(), column + 1);
            }
        }
        push(&self.text[begin..], start);
        while cells.last().is_some_and(|cell| cell.text.is_empty()) {
            cells.pop();
        }
        cells
    }
}

/// A finite number; a comma that separates no cells is a decimal one.
pub(super) fn number(text: &str) -> Option<f64> {
    let point = text.replace(',', ".");
    let text = if text.matches(',').count() == 1 && !text.contains('.') { &point } else { text };
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The text of a file in UTF-8, in UTF-16 with its mark, else in Latin-1, as machines with names in other languages write it.
pub(super) fn decoded(bytes: Vec<u8>) -> String {
    let utf16 = |unit: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
        char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes.get(..2) {
        Some([0xff, 0xfe]) => utf16(u16::from_le_bytes),
        Some([0xfe, 0xff]) => utf16(u16::from_be_bytes),
        _ => String::from_utf8(bytes).unwrap_or_else(|error| error.as_bytes().iter().map(|b| char::from(*b)).collect()),
    }
}
