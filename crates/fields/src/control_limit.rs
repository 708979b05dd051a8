//! [`ControlLimit`]: a limit point between a control whose state is known and another.

use nastic_numeric::format::short;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Control fields that a message names.
const MAX_NAMED_FIELDS: usize = 3;

/// A limit point on the straight way from a control whose state is known to another: there the path of equilibria turns back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlLimit {
    /// The share of the way at which it is.
    pub share: f64,
    /// The control fields that change on the way, with their values there.
    pub at: Vec<ControlAt>,
}

/// The values of a control field at a limit point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlAt {
    /// Its name.
    pub name: String,
    /// The least and the greatest value; of vectors of their lengths.
    pub range: [f64; 2],
    /// The unit.
    pub unit: String,
}

/// `left = 0.00843 MPa`, `tension from -1200 to 300 Pa`.
impl fmt::Display for ControlAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([low, high], unit) = (self.range.map(short), &self.unit);
        let space = if unit.is_empty() || unit == "1" { "" } else { " " };
        let unit = if unit == "1" { "" } else { unit };
        match low == high {
            true => write!(f, "{} = {low}{space}{unit}", self.name),
            false => write!(f, "{} from {low} to {high}{space}{unit}", self.name),
        }
    }
}

/// `limit point at left = 0.00843 MPa (17.1 % of the step)`.
impl fmt::Display for ControlLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named: Vec<String> = self.at.iter().take(MAX_NAMED_FIELDS).map(ToString::to_string).collect();
        let rest = self.at.len().saturating_sub(MAX_NAMED_FIELDS);
        let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
        write!(f, "limit point at {}{more} ({:.3} % of the step)", named.join(", "), 100.0 * self.share)
    }
}
