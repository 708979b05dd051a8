//! The dimension of a formula.

use crate::expression::program::{Binary, Function, Op, Step};
use crate::expression::token::CaseProblem;
use crate::quantity::Dimension;

/// What is known about an operand.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Kind {
    dimension: Dimension,
    /// A number without unit took part in the product; it may carry any dimension.
    plain: bool,
    /// A coordinate or the time took part.
    coordinate: bool,
    /// A unit was written.
    unit: bool,
}

/// A name that stands for a value, beside or instead of the coordinates.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) kind: Kind,
}

impl Kind {
    pub(super) const PLAIN: Self = Self { dimension: Dimension::NONE, plain: true, coordinate: false, unit: false };
    pub(super) const RATIO: Self = Self { dimension: Dimension::NONE, plain: false, coordinate: false, unit: false };

    /// True if this operand may stand for any dimension.
    ///
    /// "-150e3 * Z / 0.2" hides a pressure in 150e3 and a length in 0.2. Without a coordinate a plain number beside a
    /// unit is a mere factor: "2 * 3 mm" stays a length.
    fn flexible(self) -> bool {
        let hidden = self.plain && (self.coordinate || self.dimension.is_none());
        hidden || (self.dimension.is_none() && !self.unit)
    }

    pub(super) fn dimension(self) -> Dimension {
        self.dimension
    }

    /// Why this cannot be what is wanted.
    pub(super) fn refuses(self, wanted: Dimension) -> Option<String> {
        if self.dimension == wanted || self.flexible() {
            return None;
        }
        let examples = if wanted.is_none() { String::new() } else { format!(" ({})", wanted.examples()) };
        Some(format!("is {}, {wanted} is wanted{examples}", self.dimension))
    }

    fn join(self, other: Self, dimension: Dimension) -> Self {
        Self {
            dimension,
            plain: self.plain || other.plain,
            coordinate: self.coordinate || other.coordinate,
            unit: self.unit || other.unit,
        }
    }
}

/// The kind of the whole formula, or the first contradiction in it.
pub(super) fn analyse(steps: &[Step], variables: &[Variable]) -> Result<Kind, CaseProblem> {
    let mut stack: Vec<(Kind, Option<f64>)> = Vec::with_capacity(8);
    for step in steps {
        let next = match step.op {
            Op::Plain(value) => (Kind::PLAIN, Some(value)),
            Op::Measured(_, dimension) => (Kind { dimension, unit: true, ..Kind::RATIO }, None),
            Op::Coordinate(_) => (Kind { dimension: Dimension::LENGTH, coordinate: true, ..Kind::RATIO }, None),
            Op::Time => (Kind { dimension: Dimension::TIME, coordinate: true, ..Kind::RATIO }, None),
            Op::Variable(k) => (variables.get(k).map_or(Kind::PLAIN, |variable| variable.kind), None),
            Op::Negate => {
                let (kind, exponent) = pop(&mut stack);
                (kind, exponent.map(|value| -value))
            }
            Op::Call(function) => {
                let (kind, _) = pop(&mut stack);
                (call(function, kind, step.column)?, None)
            }
            Op::Compare(_) => {
                let ((b, _), (a, _)) = (pop(&mut stack), pop(&mut stack));
                let both = unify(a, b, "compared", step.column)?;
                (Kind { coordinate: both.coordinate, ..Kind::RATIO }, None)
            }
            Op::Binary(binary) => {
                let ((b, y), (a, x)) = (pop(&mut stack), pop(&mut stack));
                (combine(binary, a, b, y, step.column)?, fold(binary, x, y))
            }
        };
        stack.push(next);
    }
    Ok(pop(&mut stack).0)
}

fn pop(stack: &mut Vec<(Kind, Option<f64>)>) -> (Kind, Option<f64>) {
    stack.pop().unwrap_or((Kind::PLAIN, None))
}

/// Keeps exponents like 1/2 constant.
fn fold(binary: Binary, x: Option<f64>, y: Option<f64>) -> Option<f64> {
    let (x, y) = (x?, y?);
    match binary {
        Binary::Add => Some(x + y),
        Binary::Subtract => Some(x - y),
        Binary::Multiply => Some(x * y),
        Binary::Divide => Some(x / y),
        Binary::Power | Binary::Min | Binary::Max => None,
    }
}

fn combine(binary: Binary, a: Kind, b: Kind, exponent: Option<f64>, column: usize) -> Result<Kind, CaseProblem> {
    let huge = || CaseProblem { column, message: "a dimension beyond every sensible power".to_string() };
    match binary {
        Binary::Add => unify(a, b, "added", column),
        Binary::Subtract => unify(a, b, "subtracted", column),
        Binary::Min | Binary::Max => unify(a, b, "compared", column),
        Binary::Multiply => Ok(a.join(b, a.dimension.times(b.dimension).ok_or_else(huge)?)),
        Binary::Divide => Ok(a.join(b, a.dimension.over(b.dimension).ok_or_else(huge)?)),
        Binary::Power => raise(a, b, exponent, column),
    }
}

fn unify(a: Kind, b: Kind, verb: &str, column: usize) -> Result<Kind, CaseProblem> {
    let fixed = match (a.flexible(), b.flexible()) {
        _ if a.dimension == b.dimension => return Ok(Kind { plain: a.plain && b.plain, ..a.join(b, a.dimension) }),
        (true, true) => return Ok(Kind { plain: true, ..a.join(b, Dimension::NONE) }),
        (false, true) => a,
        (true, false) => b,
        (false, false) => {
            let message = format!("{} and {} cannot be {verb}", a.dimension, b.dimension);
            return Err(CaseProblem { column, message });
        }
    };
    Ok(Kind { plain: fixed.plain, ..a.join(b, fixed.dimension) })
}

fn call(function: Function, x: Kind, column: usize) -> Result<Kind, CaseProblem> {
    match function {
        Function::Abs => Ok(x),
        Function::Sqrt => raise(x, Kind::PLAIN, Some(0.5), column),
        _ if x.dimension.is_none() || x.flexible() || !x.unit => Ok(Kind { coordinate: x.coordinate, ..Kind::RATIO }),
        _ => {
            let message = format!("\"{}\" takes a plain number, this is {}", function.name(), x.dimension);
            Err(CaseProblem { column, message })
        }
    }
}

fn raise(base: Kind, exponent: Kind, value: Option<f64>, column: usize) -> Result<Kind, CaseProblem> {
    if !(exponent.dimension.is_none() || exponent.flexible() || !exponent.unit) {
        let message = format!("an exponent must be a plain number, this is {}", exponent.dimension);
        return Err(CaseProblem { column, message });
    }
    let coordinate = base.coordinate || exponent.coordinate;
    if base.dimension.is_none() {
        return Ok(Kind { coordinate, ..base });
    }
    match value.and_then(|power| base.dimension.power(power)) {
        Some(dimension) => Ok(Kind { dimension, coordinate, ..base }),
        None if base.flexible() || !base.unit => Ok(Kind { coordinate, ..Kind::PLAIN }),
        None => {
            let message = format!("the exponent of {} must be a constant like 2 or 1/2", base.dimension);
            Err(CaseProblem { column, message })
        }
    }
}
