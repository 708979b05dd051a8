//! What a Taylor test found, as tables.

use super::second::SecondOrder;
use std::fmt;

/// What the remainders say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// r1 falls fast enough.
    Right,
    /// It does not.
    Wrong,
    /// r1 is at round-off even for the longest step while r0 is far above it: the cost is linear along the curve and
    /// the derivative right.
    Linear,
    /// Of a second derivative: r2 is at round-off even for the longest step while r0 or r1 is far above it, and the second
    /// derivative right.
    Quadratic,
    /// Too few remainders stand clear of round-off, or too few steps could be evaluated.
    Undecided,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Right => "right",
            Self::Wrong => "WRONG",
            Self::Linear => "right (linear cost)",
            Self::Quadratic => "right (quadratic cost)",
            Self::Undecided => "undecided: remainders at round-off",
        })
    }
}

/// One step size.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The step t.
    pub t: f64,
    /// j(m(t)); none if it could not be evaluated.
    pub cost: Option<f64>,
    /// |j(m(t)) - j(m)|.
    pub r0: f64,
    /// |j(m(t)) - j(m) - t dj.d|.
    pub r1: f64,
    /// Whether the fitted order rests on this row.
    pub used: bool,
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.cost {
            Some(_) => {
                let mark = if self.used { " *" } else { "" };
                write!(f, "{:8.1e}  {:11.4e}  {:11.4e}{mark}", self.t, self.r0, self.r1)
            }
            None => write!(f, "{:8.1e}  failed", self.t),
        }
    }
}

/// The test along one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct TaylorDirection {
    /// Seed of the direction.
    pub seed: u64,
    /// The direction d.
    pub direction: Vec<f64>,
    /// dj.d.
    pub slope: f64,
    /// The slope of j(m(t)) at t = 0 that its values at the smallest steps show: what dj.d should be.
    pub observed: f64,
    /// Estimated noise of j.
    pub noise: f64,
    /// One row per step, longest first.
    pub rows: Vec<Row>,
    /// Fitted order of r0.
    pub order0: f64,
    /// Fitted order of r1; NaN when too few rows are clear of the noise.
    pub order1: f64,
    /// What it says.
    pub verdict: Verdict,
    /// What was found of the second derivative, where it was tested.
    pub second: Option<SecondOrder>,
}

impl fmt::Display for TaylorDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first: Vec<String> = self.direction.iter().take(3).map(|d| format!("{d:.3e}")).collect();
        let more = if self.direction.len() > 3 { ", .." } else { "" };
        writeln!(f, "direction of seed {}: [{}{more}], dj.d = {:.9e}", self.seed, first.join(", "), self.slope)?;
        writeln!(f, "{:>8}  {:>11}  {:>11}", "t", "r0", "r1")?;
        for row in &self.rows {
            writeln!(f, "{row}")?;
        }
        write!(
            f,
            "orders {:.3} and {:.3} (rows *), noise {:.1e}: {}",
            self.order0, self.order1, self.noise, self.verdict
        )?;
        match &self.second {
            Some(second) => write!(f, "\n{second}"),
            None => Ok(()),
        }
    }
}

/// The test along all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct TaylorReport {
    /// The cost at the control.
    pub cost: f64,
    /// Direction by direction.
    pub directions: Vec<TaylorDirection>,
}

impl TaylorReport {
    /// Wrong if any direction is; undecided if none can decide.
    pub fn verdict(&self) -> Verdict {
        let is = |verdict| self.directions.iter().any(|d| d.verdict == verdict);
        [Verdict::Wrong, Verdict::Right, Verdict::Linear].into_iter().find(|v| is(*v)).unwrap_or(Verdict::Undecided)
    }

    /// The same of the second derivative; `None` where it was not tested.
    pub fn second_verdict(&self) -> Option<Verdict> {
        let found: Vec<Verdict> = self.directions.iter().filter_map(|d| Some(d.second.as_ref()?.verdict)).collect();
        let order = [Verdict::Wrong, Verdict::Right, Verdict::Quadratic, Verdict::Undecided];
        order.into_iter().find(|v| found.contains(v))
    }

    /// Whether the derivative was seen to be right, and nowhere wrong; the second one too, where it was tested.
    pub fn passed(&self) -> bool {
        matches!(self.verdict(), Verdict::Right | Verdict::Linear)
            && matches!(self.second_verdict(), None | Some(Verdict::Right | Verdict::Quadratic))
    }
}

impl fmt::Display for TaylorReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Taylor test at cost {:.9e}", self.cost)?;
        for direction in &self.directions {
            writeln!(f, "{direction}")?;
        }
        write!(f, "verdict: {}", self.verdict())
    }
}
