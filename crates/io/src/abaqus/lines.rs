//! [`Lines`]: keywords and data lines of an input file.

use std::path::Path;

use crate::error::{At, ReadError};
use crate::source::brief;

/// A keyword line: `*ELSET, ELSET=tip, GENERATE`.
pub(super) struct Keyword {
    /// In capitals, without the star, one blank between words.
    pub name: String,
    /// Parameters by name in capitals; empty values of those that have none.
    parameters: Vec<(String, String)>,
    pub line: u64,
}

impl Keyword {
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    pub fn has(&self, name: &str) -> bool {
        self.parameter(name).is_some()
    }
}

/// The lines of a file without comments.
pub(super) struct Lines<'a> {
    file: &'a Path,
    lines: std::iter::Peekable<std::vec::IntoIter<(u64, &'a str)>>,
    /// The line read last.
    line: u64,
    /// The keyword read last, for messages.
    section: String,
}

impl<'a> Lines<'a> {
    pub fn new(file: &'a Path, text: &'a str) -> Self {
        let lines = text.lines().enumerate().map(|(k, line)| (k as u64 + 1, line.trim()));
        let lines: Vec<_> = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with("**")).collect();
        Self { file, lines: lines.into_iter().peekable(), line: 1, section: "the file".to_owned() }
    }

    /// The next keyword; data lines before it are passed over.
    pub fn keyword(&mut self) -> Option<Keyword> {
        let (line, text) = self.lines.by_ref().find(|(_, text)| text.starts_with('*'))?;
        let mut text = text[1..].to_owned();
        // a comma at the end continues it
        while text.ends_with(',') {
            match self.lines.next_if(|(_, next)| !next.starts_with('*')) {
                Some((_, next)) => text.push_str(next),
                None => break,
            }
        }
        let mut words = text.split(',').map(str::trim);
        let capitals = |word: &str| word.split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let name = capitals(words.next().unwrap_or_default());
        let parameters = words.filter(|word| !word.is_empty()).map(|word| {
            let (name, value) = word.split_once('=').unwrap_or((word, ""));
            (capitals(name), value.trim().trim_matches('"').to_owned())
        });
        let keyword = Keyword { name, parameters: parameters.collect(), line };
        (self.line, self.section) = (line, format!("*{}", brief(&keyword.name)));
        Some(keyword)
    }

    /// The words of the next data line of this keyword.
    pub fn data(&mut self) -> Option<Vec<&'a str>> {
        let (line, text) = self.lines.next_if(|(_, text)| !text.starts_with('*'))?;
        self.line = line;
        let text = text.strip_suffix(',').unwrap_or(text);
        Some(text.split(',').map(|word| word.trim().trim_matches('"')).collect())
    }

    /// A label: a whole number above zero.
    pub fn label(&self, word: &str) -> Result<u64, ReadError> {
        let label = word.parse().ok().filter(|label| *label > 0);
        label.ok_or_else(|| {
            self.malformed(format!("`{}` where the number of a node or element was expected", brief(word)))
        })
    }

    /// A real number, of Fortran too: `1.5D-3`.
    pub fn real(&self, word: &str) -> Result<f64, ReadError> {
        if word.is_empty() {
            return Ok(0.0);
        }
        let number = word.parse().ok().or_else(|| word.replace(['d', 'D'], "e").parse().ok());
        let number = number.filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.malformed(format!("`{}` where a number was expected", brief(word))))
    }

    pub fn malformed(&self, what: impl Into<String>) -> ReadError {
        ReadError::Malformed {
            file: self.file.to_owned(),
            section: self.section.clone(),
            at: At::Line(self.line),
            what: what.into(),
            advice: "is it an input file of Abaqus or CalculiX? Check it there, or write it again".to_owned(),
        }
    }

    pub fn unsupported(&self, what: impl Into<String>, advice: &str) -> ReadError {
        ReadError::Unsupported {
            file: self.file.to_owned(),
            section: self.section.clone(),
            at: At::Line(self.line),
            what: what.into(),
            advice: advice.to_owned(),
        }
    }
}
