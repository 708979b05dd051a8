//! [`Instants`]: at which instants of a motion a constraint holds.

use super::timeline::Timeline;
use nastic_fem::Begin;
use nastic_fields::ControlError;

/// The instants of a motion at which a constraint holds, each with values and multipliers of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Instants {
    /// The last one.
    End,
    /// All that controls can change: from t = 0 on, of a motion that begins at rest from the end of its first step on.
    All,
    /// These, to which steps lead.
    At(Vec<f64>),
}

impl Instants {
    /// Their numbers, ascending.
    pub(crate) fn numbers(&self, timeline: &Timeline) -> Result<Vec<usize>, ControlError> {
        let first = match timeline.begin() {
            Begin::Equilibrium => 0,
            Begin::Given => 1,
        };
        let mut numbers: Vec<usize> = match self {
            Instants::End => vec![timeline.steps()],
            Instants::All => (first..=timeline.steps()).collect(),
            Instants::At(times) if times.is_empty() => {
                return Err(ControlError::Cost { what: "a constraint at no instant: name one or more".to_owned() });
            }
            Instants::At(times) => times.iter().map(|t| timeline.index(*t)).collect::<Result<_, ControlError>>()?,
        };
        if numbers.iter().any(|n| *n < first) {
            let what = "a constraint at t = 0 of a motion that begins at rest, where no control has a say: name later instants";
            return Err(ControlError::Cost { what: what.to_owned() });
        }
        numbers.sort_unstable();
        numbers.dedup();
        Ok(numbers)
    }
}
