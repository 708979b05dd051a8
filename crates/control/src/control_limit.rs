//! [`ControlLimit`]: a limit point between a control whose state is known and another.

use crate::control_block::ControlBlock;
use crate::layout::Layout;
use nastic_numeric::format::short;
use nastic_numeric::vector::norm;
use std::fmt;

/// Control fields that a message names.
const NAMED: usize = 3;

/// A limit point on the straight way from a control whose state is known to another: there the path of equilibria turns back.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlLimit {
    /// The share of the way at which it is.
    pub share: f64,
    /// The control fields that change on the way, with their values there.
    pub at: Vec<ControlAt>,
}

/// The values of a control field at a limit point.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlAt {
    /// Its name.
    pub name: String,
    /// The least and the greatest value; of vectors of their lengths.
    pub range: [f64; 2],
    /// The unit.
    pub unit: String,
}

impl ControlLimit {
    /// At a share of the way between two control vectors.
    pub(crate) fn new(layout: &Layout, [from, to]: [&[f64]; 2], share: f64) -> Self {
        let m: Vec<f64> = from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect();
        let changes = |block: &&ControlBlock| block.of(from) != block.of(to);
        ControlLimit {
            share,
            at: layout.blocks().iter().filter(changes).map(|block| ControlAt::new(block, &m)).collect(),
        }
    }
}

impl ControlAt {
    pub(crate) fn new(block: &ControlBlock, m: &[f64]) -> Self {
        let size = |value: &[f64]| if let [one] = value { *one } else { norm(value) };
        let sizes = block.of(m).chunks_exact(block.components).map(size);
        let range = sizes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        ControlAt { name: block.shown.name.clone(), range, unit: block.shown.unit.clone() }
    }
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
        let named: Vec<String> = self.at.iter().take(NAMED).map(ToString::to_string).collect();
        let rest = self.at.len().saturating_sub(NAMED);
        let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
        write!(f, "limit point at {}{more} ({:.3} % of the step)", named.join(", "), 100.0 * self.share)
    }
}
