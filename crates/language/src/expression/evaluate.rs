//! Steps to a number.

use crate::expression::program::{Binary, Comparison, Function, Op, Step};
use crate::syntax::quoted;
use std::fmt;
use thiserror::Error;

/// Why a formula's value is NaN or infinite.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fault {
    /// x / 0
    DivisionByZero,
    /// sqrt of x < 0
    RootOfNegative,
    /// log of x <= 0
    LogOfNotPositive,
    /// A fractional power of x < 0, or 0 to a negative power.
    Power,
    /// Beyond the range of numbers.
    Overflow,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DivisionByZero => "division by zero",
            Self::RootOfNegative => "square root of a negative number",
            Self::LogOfNotPositive => "logarithm of a number that is not positive",
            Self::Power => "power without a real value",
            Self::Overflow => "value beyond the range of numbers",
        })
    }
}

/// A formula has no finite value at a point.
#[derive(Clone, PartialEq, Debug, Error)]
#[error("{fault} at column {column} of {}, at the point ({}, {}, {}){}", quoted(text), point[0], point[1], point[2], instant(*time))]
pub struct EvaluationError {
    /// The formula.
    pub text: String,
    /// Where in it, in characters from 1.
    pub column: usize,
    /// What happened.
    pub fault: Fault,
    /// Where in the body, in the case's units.
    pub point: [f64; 3],
    /// When, of a formula of t.
    pub time: Option<f64>,
}

fn instant(time: Option<f64>) -> String {
    time.map_or_else(String::new, |t| format!(", at t = {t}"))
}

/// The steps' value, or the fault and its column.
pub(super) fn evaluate(steps: &[Step], point: [f64; 3], time: f64) -> Result<f64, (Fault, usize)> {
    let mut stack = Vec::with_capacity(8);
    for step in steps {
        let value = match step.op {
            Op::Plain(value) | Op::Measured(value, _) => value,
            Op::Coordinate(axis) => point[axis],
            Op::Time => time,
            // an energy, which is evaluated by the law made of it
            Op::Variable(_) => f64::NAN,
            Op::Negate => -pop(&mut stack),
            Op::Call(function) => call(function, pop(&mut stack)).map_err(|fault| (fault, step.column))?,
            Op::Binary(binary) => {
                let (b, a) = (pop(&mut stack), pop(&mut stack));
                combine(binary, a, b).map_err(|fault| (fault, step.column))?
            }
            Op::Compare(comparison) => {
                let (b, a) = (pop(&mut stack), pop(&mut stack));
                f64::from(compare(comparison, a, b))
            }
        };
        if !value.is_finite() {
            return Err((Fault::Overflow, step.column));
        }
        stack.push(value);
    }
    Ok(pop(&mut stack))
}

/// The parser leaves as many operands as every step takes.
fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

fn combine(binary: Binary, a: f64, b: f64) -> Result<f64, Fault> {
    match binary {
        Binary::Add => Ok(a + b),
        Binary::Subtract => Ok(a - b),
        Binary::Multiply => Ok(a * b),
        Binary::Divide if b == 0.0 => Err(Fault::DivisionByZero),
        Binary::Divide => Ok(a / b),
        Binary::Power if (a < 0.0 && b.fract() != 0.0) || (a == 0.0 && b < 0.0) => Err(Fault::Power),
        Binary::Power => Ok(a.powf(b)),
        Binary::Min => Ok(a.min(b)),
        Binary::Max => Ok(a.max(b)),
    }
}

fn compare(comparison: Comparison, a: f64, b: f64) -> bool {
    match comparison {
        Comparison::Less => a < b,
        Comparison::LessOrEqual => a <= b,
        Comparison::Greater => a > b,
        Comparison::GreaterOrEqual => a >= b,
        Comparison::Equal => a == b,
        Comparison::NotEqual => a != b,
    }
}

fn call(function: Function, x: f64) -> Result<f64, Fault> {
    match function {
        Function::Sin => Ok(x.sin()),
        Function::Cos => Ok(x.cos()),
        Function::Tan => Ok(x.tan()),
        Function::Exp => Ok(x.exp()),
        Function::Log if x <= 0.0 => Err(Fault::LogOfNotPositive),
        Function::Log => Ok(x.ln()),
        Function::Sqrt if x < 0.0 => Err(Fault::RootOfNegative),
        Function::Sqrt => Ok(x.sqrt()),
        Function::Abs => Ok(x.abs()),
    }
}
