//! A formula as a sequence of steps for a stack machine: no recursion, so no input can exhaust the stack.

use crate::quantity::Dimension;

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Op {
    /// A number without unit.
    Plain(f64),
    /// A number with its unit, already in the case's system.
    Measured(f64, Dimension),
    /// X, Y or Z.
    Coordinate(usize),
    /// t
    Time,
    /// One of the names of its own that a formula may have.
    Variable(usize),
    Negate,
    Binary(Binary),
    Compare(Comparison),
    Call(Function),
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
    Sqrt,
    Abs,
}

impl Function {
    pub(super) const ALL: [(&'static str, Self); 7] = [
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("exp", Self::Exp),
        ("log", Self::Log),
        ("sqrt", Self::Sqrt),
        ("abs", Self::Abs),
    ];

    pub(super) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }
}

/// One step and the column (from 1) of the sign or name it came from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Step {
    pub(super) op: Op,
    pub(super) column: usize,
}
