//! [`AugmentedState`]: a saved run under constraints.

use super::outer::Outer;
use crate::bytes::{Reader, SavedRunError, Writer};
use crate::state::RunState;

const MAGIC: &str = "nastic-augmented-run-1";

/// Everything a run under constraints needs to go on to the bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AugmentedState {
    /// The optimiser's run.
    pub run: RunState,
    pub(super) outer: Option<SavedOuter>,
}

/// The constraints' part of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SavedOuter {
    pub outer: Outer,
    pub multipliers: Vec<f64>,
    pub penalty: f64,
}

impl AugmentedState {
    /// Little-endian bytes: numbers as they are, lists with their length first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.bytes(&self.run.to_bytes());
        out.count(usize::from(self.outer.is_some()));
        if let Some(SavedOuter { outer, multipliers, penalty }) = &self.outer {
            let Outer { updates, first_penalty, first_gradient, measure, violation, stagnant, grew, limit } = outer;
            [*updates, *stagnant, usize::from(*grew), *limit].into_iter().for_each(|n| out.count(n));
            [*first_penalty, *first_gradient, *measure, *violation, *penalty].into_iter().for_each(|x| out.float(x));
            out.floats(multipliers);
        }
        out.finish()
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// # Errors
    /// Bytes of something else, truncated or damaged ones.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let run = RunState::from_bytes(&input.list()?)?;
        let outer = if input.flag()? { Some(read_outer(&mut input)?) } else { None };
        input.finish()?;
        Ok(Self { run, outer })
    }
}

fn read_outer(input: &mut Reader<'_>) -> Result<SavedOuter, SavedRunError> {
    let (updates, stagnant, grew, limit) = (input.number()?, input.number()?, input.flag()?, input.number()?);
    let (first_penalty, first_gradient) = (input.float()?, input.float()?);
    let (measure, violation, penalty) = (input.float()?, input.float()?, input.float()?);
    let outer = Outer { updates, first_penalty, first_gradient, measure, violation, stagnant, grew, limit };
    Ok(SavedOuter { outer, multipliers: input.floats()?, penalty })
}
