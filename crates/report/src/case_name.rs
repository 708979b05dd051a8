//! What a case is called.

use std::path::Path;

/// The name of a case file without its directories and its extension: what a case without a title is called, and its directory of
/// results. A case without a name is called `case`.
#[must_use]
pub fn case_name(file: &str) -> String {
    match Path::new(file).file_stem() {
        Some(stem) => stem.to_string_lossy().into_owned(),
        None => "case".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::case_name;

    #[test]
    fn directories_and_the_extension_are_left_out() {
        assert_eq!(case_name("cases/bar.v2.json"), "bar.v2");
        assert_eq!(case_name("bar"), "bar");
        assert_eq!(case_name(""), "case");
    }
}
