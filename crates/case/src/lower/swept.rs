//! [`Swept`]: an option `--set path=a,b,c`, and what a list of them means together.

use crate::lower::file_name;
use nastic_language::quantity::Unit;
use nastic_language::syntax::{Diagnostic, Diagnostics, Setting};
use std::collections::BTreeSet;

/// Most runs of one sweep.
const MOST: usize = 10_000;
/// Characters of a value in the name of a directory.
const NAMED: usize = 40;

/// A path of the case and the values it takes, one after the other; a fixed option has one.
#[derive(Clone, Debug)]
pub struct Swept {
    /// The path, as typed.
    pub path: String,
    /// The values, as typed.
    pub values: Vec<String>,
    /// The path, as short as it can be distinguished from the others.
    pub label: String,
}

/// One value of every option, fixed ones included, and the name of the directory of its results.
#[derive(Clone, Debug)]
pub struct Combination {
    /// Name of the directory.
    pub directory: String,
    /// Indices of the values, in the order of the options.
    pub at: Vec<usize>,
}

impl Swept {
    /// All options, in order; at least one has several values.
    pub fn read(settings: &[String]) -> Result<Vec<Self>, Diagnostics> {
        let mut problems = Vec::new();
        let mut out: Vec<Self> = Vec::new();
        for text in settings {
            match Self::of(text) {
                Ok(one) => match out.iter().find(|known| known.path == one.path) {
                    Some(known) if known.is_swept() || one.is_swept() => {
                        problems.push(complaint(
                            text,
                            &one.path,
                            "this path has another --set: give all its values in one",
                        ));
                    }
                    _ => out.push(one),
                },
                Err(found) => problems.extend(found.list().iter().cloned()),
            }
        }
        if problems.is_empty() && !out.iter().any(Self::is_swept) {
            let message = "no option has several values: give them as --set path=a,b,c, separated by commas outside of \
                           brackets and quotes";
            problems.push(complaint("", "", message));
        }
        let runs = out.iter().try_fold(1_usize, |runs, one| runs.checked_mul(one.values.len()));
        if runs.is_none_or(|runs| runs > MOST) {
            problems.push(complaint("", "", &format!("more than {MOST} runs: leave out values")));
        }
        Diagnostics::new(problems).into_result()?;
        label(&mut out);
        Ok(out)
    }

    fn of(text: &str) -> Result<Self, Diagnostics> {
        let path = Setting::option(text)?.path;
        let values: Vec<String> =
            pieces(text.split_once('=').map_or("", |(_, values)| values)).into_iter().map(str::to_owned).collect();
        let complain = |message: &str| Err(complaint(text, &path, message).into());
        if values.len() > 1 && values.iter().any(String::is_empty) {
            return complain("a value is missing between commas; a text with commas stands in quotes: '\"a, b\"'");
        }
        let different: BTreeSet<&String> = values.iter().collect();
        if different.len() < values.len() {
            return complain("a value stands there twice");
        }
        if values.iter().any(|value| is_number(value)) && values.iter().any(|value| has_unit(value)) {
            return complain(
                "some values have a unit and others none: a unit belongs to the value before it alone, as in \"50 kPa,100 kPa\"",
            );
        }
        Ok(Self { label: path.clone(), path, values })
    }

    /// Whether it has several values.
    pub fn is_swept(&self) -> bool {
        self.values.len() > 1
    }

    /// The option of one value.
    pub fn setting(&self, index: usize) -> String {
        format!("{}={}", self.path, self.values[index])
    }
}

/// Whether it is a number without a unit; zero needs none.
fn is_number(value: &str) -> bool {
    value.trim().trim_matches('"').parse::<f64>().is_ok_and(|number| number != 0.0)
}

/// Whether it is a number with a unit behind it.
fn has_unit(value: &str) -> bool {
    let value = value.trim().trim_matches('"');
    value
        .split_once(char::is_whitespace)
        .is_some_and(|(number, unit)| number.parse::<f64>().is_ok() && Unit::named(unit.trim()).is_some())
}

/// All combinations of values: those of the last option vary fastest.
pub fn combinations(options: &[Swept]) -> Vec<Combination> {
    let runs = options.iter().map(|one| one.values.len()).product();
    let mut taken = BTreeSet::new();
    let of = |run: usize| {
        let mut rest = run;
        let mut at: Vec<usize> = options
            .iter()
            .rev()
            .map(|one| {
                let index = rest % one.values.len();
                rest /= one.values.len();
                index
            })
            .collect();
        at.reverse();
        let swept = options.iter().zip(&at).filter(|(one, _)| one.is_swept());
        let parts = swept.map(|(one, &k)| {
            let value: String = file_name(&one.values[k]).chars().take(NAMED).collect();
            format!("{}={value}", file_name(&one.label))
        });
        let name = parts.collect::<Vec<_>>().join(",");
        // Values that differ in other characters alone, or in case, have names of their own too.
        let numbered = (2..).map(|n| format!("{name}_{n}"));
        let free = std::iter::once(name.clone()).chain(numbered).find(|name| taken.insert(name.to_lowercase()));
        Combination { directory: free.unwrap_or(name), at }
    };
    (0..runs).map(of).collect()
}

/// The last part of a path is its label, where that is a name and no other swept path ends so.
fn label(options: &mut [Swept]) {
    let last = |path: &str| path.rsplit('/').next().unwrap_or("").to_owned();
    let all: Vec<String> = options.iter().filter(|one| one.is_swept()).map(|one| last(&one.path)).collect();
    for one in options {
        let short = last(&one.path);
        let is_name = !short.is_empty() && !short.bytes().all(|byte| byte.is_ascii_digit());
        if is_name && all.iter().filter(|other| **other == short).count() < 2 {
            one.label = short;
        }
    }
}

/// The pieces between commas that stand outside of brackets, braces, parentheses and quotes.
fn pieces(text: &str) -> Vec<&str> {
    let (mut out, mut begin, mut depth, mut quoted, mut escaped) = (Vec::new(), 0, 0_usize, false, false);
    for (at, c) in text.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            _ if quoted => {}
            '[' | '{' | '(' => depth += 1,
            ']' | '}' | ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                out.push(text[begin..at].trim());
                begin = at + 1;
            }
            _ => {}
        }
    }
    out.push(text[begin..].trim());
    out
}

fn complaint(text: &str, path: &str, message: &str) -> Diagnostic {
    let file = if text.is_empty() { "--set".to_owned() } else { format!("--set {text}") };
    Diagnostic { file, path: path.to_owned(), line: 0, column: 0, message: message.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_in_brackets_and_quotes_belong_to_a_value() {
        assert_eq!(pieces("90 kPa, 110 kPa"), ["90 kPa", "110 kPa"]);
        assert_eq!(pieces("[1,0,0],[0,1,0]"), ["[1,0,0]", "[0,1,0]"]);
        assert_eq!(pieces("[1,0,0]"), ["[1,0,0]"]);
        assert_eq!(pieces(r#"min(X, 1),{"a": [1, 2]},"b, \", c""#), ["min(X, 1)", r#"{"a": [1, 2]}"#, r#""b, \", c""#]);
        assert_eq!(pieces("a,"), ["a", ""]);
    }

    #[test]
    fn directories_tell_runs_apart() {
        let options = ["m/0/young=1 kPa,1_kPa,2 kPa", "b/cells/0=1,2", "title=fixed", "c/1/young=3,4"];
        let options = Swept::read(&options.map(str::to_owned)).unwrap();
        let runs = combinations(&options);
        assert_eq!(runs.len(), 12);
        assert_eq!(runs[1].directory, "m_0_young=1_kPa,b_cells_0=1,c_1_young=4");
        assert_eq!(runs[4].directory, "m_0_young=1_kPa,b_cells_0=1,c_1_young=3_2");
        assert_eq!(runs[11].at, [2, 1, 0, 1]);
    }

    #[test]
    fn what_cannot_be_swept_is_told() {
        for (settings, part) in [
            (vec!["a=1", "b=[1,2]"], "no option has several values"),
            (vec!["a=1,,2"], "missing between commas"),
            (vec!["a=1,2,1"], "twice"),
            (vec!["a=1,2", "a=3"], "another --set"),
            (vec!["a"], "path=value was expected"),
        ] {
            let settings: Vec<String> = settings.into_iter().map(str::to_owned).collect();
            let shown = Swept::read(&settings).unwrap_err().to_string();
            assert!(shown.contains(part), "{shown}");
        }
    }
}
