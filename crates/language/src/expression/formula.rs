//! A checked formula, ready to evaluate.

use crate::expression::analysis::{Kind, analyse};
use crate::expression::evaluate::{EvaluationError, evaluate};
use crate::expression::parser::parse;
use crate::expression::program::{Op, Step};
use crate::expression::token::CaseProblem;
use crate::quantity::{Dimension, Units};
use crate::syntax::quoted;
use std::sync::Arc;
use thiserror::Error;

/// A number, or a formula of the reference coordinates X, Y, Z and the time t; values are in the case's units.
#[derive(Clone, PartialEq, Debug)]
pub struct Formula {
    text: String,
    steps: Vec<Step>,
    kind: Option<Kind>,
    constant: Option<f64>,
    /// The time at which a formula of t is evaluated.
    time: f64,
    /// Values over the time instead of steps.
    table: Option<Arc<[(f64, f64)]>>,
}

/// A text that is no formula, or contradicts itself.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("{message} at column {column} of {}", quoted(text))]
pub struct FormulaError {
    /// The text.
    pub text: String,
    /// Where in it, in characters from 1.
    pub column: usize,
    /// What is wrong there and what was expected.
    pub message: String,
}

impl Formula {
    /// A plain number, which fits every dimension.
    #[must_use]
    pub fn number(value: f64) -> Self {
        let steps = vec![Step { op: Op::Plain(value), column: 1 }];
        Self { text: value.to_string(), steps, kind: None, constant: Some(value), time: 0.0, table: None }
    }

    /// Reads a text; its units become numbers of the system `units`.
    ///
    /// # Errors
    ///
    /// What was expected and in which column; contradicting dimensions ("1 m + 1 Pa"); a constant without a finite
    /// value ("1 / 0").
    pub fn parse(text: &str, units: &Units) -> Result<Self, FormulaError> {
        let refuse = |CaseProblem { column, message }| FormulaError { text: text.to_string(), column, message };
        let steps = parse(text, units, None).map_err(refuse)?;
        let kind = analyse(&steps, &[]).map_err(refuse)?;
        let varies = steps.iter().any(|step| matches!(step.op, Op::Coordinate(_) | Op::Time));
        let constant = if varies {
            None
        } else {
            let fault = |(fault, column): (crate::expression::Fault, usize)| {
                refuse(CaseProblem { column, message: fault.to_string() })
            };
            Some(evaluate(&steps, [0.0; 3], 0.0).map_err(fault)?)
        };
        Ok(Self { text: text.to_string(), steps, kind: Some(kind), constant, time: 0.0, table: None })
    }

    /// Refuses a formula whose units or coordinates make it something else than `wanted`.
    ///
    /// # Errors
    ///
    /// `unit of the wrong kind: "5 mm" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)`
    pub fn check(&self, wanted: Dimension) -> Result<(), String> {
        match self.kind.and_then(|kind| kind.refuses(wanted)) {
            Some(why) => Err(format!("unit of the wrong kind: {} {why}", quoted(&self.text))),
            None => Ok(()),
        }
    }

    /// What it is as part of another formula, in which a name stands for it.
    pub(super) fn kind(&self) -> Kind {
        self.kind.unwrap_or(Kind::PLAIN)
    }

    /// As written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The value, if it is the same everywhere.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        self.constant
    }

    /// Values over the time in the case's units, `(t, value)` by ascending times, at least one: linear between them, constant before the first
    /// and behind the last.
    #[must_use]
    pub fn over_time(text: &str, table: Arc<[(f64, f64)]>) -> Self {
        Self { text: text.to_owned(), steps: vec![], kind: None, constant: None, time: 0.0, table: Some(table) }
    }

    /// Whether it changes in time.
    #[must_use]
    pub fn uses_time(&self) -> bool {
        if self.table.is_some() {
            return true;
        }
        self.steps.iter().any(|step| step.op == Op::Time)
    }

    /// Whether it changes from place to place.
    #[must_use]
    pub fn varies_in_space(&self) -> bool {
        self.steps.iter().any(|step| matches!(step.op, Op::Coordinate(_)))
    }

    /// The formula at an instant: [`Self::at`] takes `t` for the time. Before this it takes 0.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Self {
        Self { time: t, ..self.clone() }
    }

    /// The value at a reference point, both in the case's units.
    ///
    /// # Errors
    ///
    /// Division by zero, roots of negative numbers and the like, with the column and the point.
    pub fn at(&self, point: [f64; 3]) -> Result<f64, EvaluationError> {
        if let Some(table) = &self.table {
            return Ok(interpolated(table, self.time));
        }
        match self.constant {
            Some(value) => Ok(value),
            None => evaluate(&self.steps, point, self.time).map_err(|(fault, column)| EvaluationError {
                text: self.text.clone(),
                column,
                fault,
                point,
                time: self.uses_time().then_some(self.time),
            }),
        }
    }
}

/// Linear between the rows, constant beyond them.
fn interpolated(table: &[(f64, f64)], t: f64) -> f64 {
    let behind = table.partition_point(|(time, _)| *time < t);
    match (behind.checked_sub(1).and_then(|k| table.get(k)), table.get(behind)) {
        (Some((t0, a)), Some((t1, b))) => a + (b - a) * (t - t0) / (t1 - t0),
        (Some((_, value)), None) | (None, Some((_, value))) => *value,
        (None, None) => f64::NAN,
    }
}

/// The dimension of a compound unit: "Pa", "N/A^2", "1".
pub fn dimension_of(unit: &str) -> Option<Dimension> {
    if unit == "1" {
        return Some(Dimension::NONE);
    }
    let formula = Formula::parse(unit, &Units::default()).ok()?;
    formula.kind.map(Kind::dimension)
}
