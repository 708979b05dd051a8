//! [`GridArray`]: an array of a grid of VTK, in either format.

use super::CORRUPT;
use crate::error::ReadError;
use crate::source::Source;

/// The numbers of an array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Numbers {
    Integers(Vec<i64>),
    Reals(Vec<f64>),
}

impl Numbers {
    pub fn len(&self) -> usize {
        match self {
            Numbers::Integers(values) => values.len(),
            Numbers::Reals(values) => values.len(),
        }
    }

    pub fn into_reals(self) -> Vec<f64> {
        match self {
            Numbers::Integers(values) => values.into_iter().map(|value| value as f64).collect(),
            Numbers::Reals(values) => values,
        }
    }
}

/// An array by its name, and where it stands.
pub(crate) struct GridArray {
    pub name: String,
    pub components: usize,
    pub numbers: Numbers,
    /// The array by its name, for messages.
    pub section: String,
    pub byte: usize,
}

impl GridArray {
    pub fn malformed(&self, source: &Source, what: impl Into<String>) -> ReadError {
        source.malformed(self.byte, self.section.clone(), what, CORRUPT)
    }

    /// One 32-bit integer for each of so many entities.
    pub fn tags(&self, source: &Source, entities: usize) -> Result<Vec<i32>, ReadError> {
        if self.components != 1 || self.numbers.len() != entities {
            let what = format!("{} values stand where one for each of {entities} cells is needed", self.numbers.len());
            return Err(self.malformed(source, what));
        }
        let values = self.numbers.clone().into_reals().into_iter().enumerate();
        let tag = |(cell, value): (usize, f64)| {
            let tag = value as i32;
            let what = || format!("the value of cell {cell} is {value}, which is no 32-bit integer");
            if f64::from(tag) == value { Ok(tag) } else { Err(self.malformed(source, what())) }
        };
        values.map(tag).collect()
    }

    /// Rows of so many integers, each below its limit.
    pub fn rows<const N: usize>(&self, source: &Source, limits: [usize; N]) -> Result<Vec<[usize; N]>, ReadError> {
        let Numbers::Integers(values) = &self.numbers else {
            return Err(self.malformed(source, "group members must be integers"));
        };
        if self.components != N || values.len() % N != 0 {
            return Err(self.malformed(source, format!("{} needs rows of {N}", self.section)));
        }
        let row = |row: &[i64]| {
            let mut out = [0; N];
            for ((entry, value), limit) in out.iter_mut().zip(row).zip(limits) {
                let within = usize::try_from(*value).ok().filter(|value| *value < limit);
                let what = || format!("the entry {value} is out of range (below {limit} is needed)");
                *entry = within.ok_or_else(|| self.malformed(source, what()))?;
            }
            Ok(out)
        };
        values.chunks_exact(N).map(row).collect()
    }
}
