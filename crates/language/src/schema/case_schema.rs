//! The JSON Schema of case files.

use crate::catalogue::Catalogue;
use crate::schema::case::Case;
use crate::schema::json::Definitions;
use serde_json::Value;

/// The JSON Schema of case files with these names. Comments and trailing commas, which case files may have, are outside
/// its scope.
#[must_use]
pub fn json_schema(catalogue: &Catalogue) -> Value {
    Definitions::document::<Case>("nastic case", catalogue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{case, hints};

    /// Names that examples give to groups and actuations, and values.
    const EXAMPLES: [&str; 10] = ["clamp", "body", "air", "chamber", "tip", "floor", "skin", "NAME", "X", "Y"];

    #[test]
    fn hints_name_what_there_is() {
        let schema = json_schema(&Catalogue::standard()).to_string();
        for hint in hints::HINTS.iter().chain(case::HINTS.iter().copied().flatten()) {
            for quoted in hint.say.split('"').skip(1).step_by(2) {
                let word = quoted.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                let known = !word || EXAMPLES.contains(&quoted) || schema.contains(&format!("\"{quoted}\""));
                assert!(known, "\"{quoted}\" in: {}", hint.say);
            }
            assert!(hint.words.iter().all(|word| *word == word.to_lowercase()), "{:?}", hint.words);
        }
    }
}
