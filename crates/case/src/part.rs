//! [`Part`]: one of N interleaved parts of many runs, and [`Share`]: what of them a process does.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// The K-th of N interleaved parts: of runs numbered from 0 those with number = K - 1 modulo N.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Part {
    number: usize,
    of: usize,
}

/// What is no part.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("\"{text}\" is no part: give K/N with whole numbers 1 <= K <= N, as 2/5 for the second of five parts")]
pub struct PartError {
    /// What was given.
    pub text: String,
}

/// What of several runs (those of a sweep, the starts of an optimisation) a process does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Share {
    /// All of them, and their common results.
    #[default]
    Whole,
    /// One part, without common results: other processes may work on other parts at the same time.
    Part(Part),
    /// No run: the common results, from what parts have left.
    Join,
}

impl Part {
    /// That of a rank, of which there are so many.
    #[must_use]
    pub fn of_rank(rank: usize, ranks: usize) -> Self {
        Self { number: rank + 1, of: ranks }
    }

    /// Whether it has the run of this number, from 0.
    #[must_use]
    pub fn has(self, run: usize) -> bool {
        run % self.of == self.number - 1
    }

    /// Whether it is the first.
    #[must_use]
    pub fn is_first(self) -> bool {
        self.number == 1
    }
}

impl FromStr for Part {
    type Err = PartError;

    fn from_str(text: &str) -> Result<Self, PartError> {
        let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err(PartError { text: text.to_owned() }),
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{}/{}", self.number, self.of))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_disjoint_and_complete() {
        for of in 1..=5 {
            let parts: Vec<Part> = (1..=of).map(|k| format!("{k}/{of}").parse().unwrap()).collect();
            assert!((0..12).all(|run| parts.iter().filter(|part| part.has(run)).count() == 1), "{of}");
        }
        let third: Part = "3/5".parse().unwrap();
        assert_eq!((0..12).filter(|run| third.has(*run)).collect::<Vec<_>>(), [2, 7]);
        for text in ["0/3", "4/3", "1/0", "2", "a/b", "-1/3", ""] {
            assert!(text.parse::<Part>().unwrap_err().to_string().contains("K/N"), "{text}");
        }
    }
}
