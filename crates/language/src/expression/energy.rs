//! Energies of a law: formulas of the invariants of a deformation and of parameters.

use crate::expression::analysis::{Kind, Variable, analyse};
use crate::expression::formula::{Formula, FormulaError};
use crate::expression::parser::{fixed_names, parse};
use crate::expression::program::{Binary, Comparison, Function, Op, Step};
use crate::expression::token::CaseProblem;
use crate::quantity::{Dimension, Unit, Units};
use crate::syntax::quoted;
use nastic_energy::formula::{Expression, Invariant, Step as LawStep};
use std::borrow::Cow;
use std::fmt;

/// An energy per volume as a formula of invariants and parameters, checked for its units.
#[derive(Clone, PartialEq, Debug)]
pub struct EnergyFormula {
    expression: Expression,
}

/// The invariants by their names, and what they are made of.
const INVARIANTS: [&str; 8] = ["I1", "I2", "J", "I4", "I1b", "I2b", "I4b", "E_ff"];

impl EnergyFormula {
    /// Reads a text with these parameters by name: `None` for one that has no formula of its own, such as an array of a file.
    ///
    /// # Errors
    ///
    /// What was expected and in which column; contradicting dimensions; a whole that is no energy per volume; comparisons by `==` and `!=`.
    pub fn parse(text: &str, units: &Units, parameters: &[(&str, Option<&Formula>)]) -> Result<Self, FormulaError> {
        let refuse = |CaseProblem { column, message }| FormulaError { text: text.to_string(), column, message };
        let own = parameters.iter().map(|(name, formula)| Variable {
            name: (*name).to_owned(),
            kind: formula.map_or(Kind::PLAIN, Formula::kind),
        });
        let invariants = INVARIANTS.iter().map(|name| Variable { name: (*name).to_owned(), kind: Kind::RATIO });
        let variables: Vec<Variable> = invariants.chain(own).collect();
        let steps = parse(text, units, Some(&variables)).map_err(refuse)?;
        let kind = analyse(&steps, &variables).map_err(refuse)?;
        if let Some(why) = kind.refuses(Dimension::PRESSURE) {
            let message = format!("an energy per volume has the unit of a pressure; the formula {why}, counted");
            return Err(refuse(CaseProblem { column: 1, message }));
        }
        let mut out = Vec::with_capacity(steps.len());
        for step in &steps {
            lowered(step, &variables, &mut out).map_err(refuse)?;
        }
        Ok(Self { expression: Expression::new(text, out) })
    }

    /// Why a parameter cannot have this name.
    #[must_use]
    pub fn refuses_name(name: &str) -> Option<String> {
        let is_name = name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !is_name {
            return Some(format!("{} is no name: letters, digits and _ are, a letter first", quoted(name)));
        }
        if INVARIANTS.contains(&name) {
            return Some(format!("{} is an invariant of the deformation: take another name", quoted(name)));
        }
        // no energy of a law has a temperature, and K is a bulk modulus
        let is_unit = Unit::named(name).is_some_and(|unit| unit.dimension != Dimension::TEMPERATURE);
        let known = is_unit || (fixed_names().contains(&name) && Unit::named(name).is_none());
        known.then(|| format!("{} is a unit or a function: take another name, as {name}1", quoted(name)))
    }

    /// What a law is made of.
    #[must_use]
    pub fn expression(&self) -> &Expression {
        &self.expression
    }
}

impl fmt::Display for EnergyFormula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", quoted(&self.expression.text))
    }
}

/// The steps of the law for one step of the formula.
fn lowered(step: &Step, variables: &[Variable], out: &mut Vec<LawStep>) -> Result<(), CaseProblem> {
    out.push(match step.op {
        Op::Plain(value) | Op::Measured(value, _) => LawStep::Number(value),
        Op::Variable(k) => {
            let name = variables.get(k).map_or("", |variable| variable.name.as_str());
            invariant(name, out);
            return match INVARIANTS.contains(&name) {
                true => Ok(()),
                false => {
                    out.push(LawStep::Parameter(Cow::Owned(name.to_owned())));
                    Ok(())
                }
            };
        }
        // the parser knows no coordinates here
        Op::Coordinate(_) | Op::Time => LawStep::Number(0.0),
        Op::Negate => LawStep::Negate,
        Op::Binary(Binary::Add) => LawStep::Add,
        Op::Binary(Binary::Subtract) => LawStep::Subtract,
        Op::Binary(Binary::Multiply) => LawStep::Multiply,
        Op::Binary(Binary::Divide) => LawStep::Divide,
        Op::Binary(Binary::Power) => LawStep::Power,
        Op::Binary(Binary::Min) => LawStep::Minimum,
        Op::Binary(Binary::Max) => LawStep::Maximum,
        Op::Compare(Comparison::Less) => LawStep::Less,
        Op::Compare(Comparison::LessOrEqual) => LawStep::LessOrEqual,
        // a > b is 1 - (a <= b)
        Op::Compare(Comparison::Greater) => return not(LawStep::LessOrEqual, out),
        Op::Compare(Comparison::GreaterOrEqual) => return not(LawStep::Less, out),
        Op::Compare(Comparison::Equal | Comparison::NotEqual) => {
            let message = "an energy cannot ask whether two numbers are equal: they never are; compare with < or >";
            return Err(CaseProblem { column: step.column, message: message.to_owned() });
        }
        Op::Call(Function::Sin) => LawStep::Sin,
        Op::Call(Function::Cos) => LawStep::Cos,
        Op::Call(Function::Exp) => LawStep::Exp,
        Op::Call(Function::Log) => LawStep::Log,
        Op::Call(Function::Sqrt) => LawStep::Sqrt,
        Op::Call(Function::Abs) => LawStep::Abs,
        Op::Call(Function::Tan) => {
            let message = "an energy knows no tan: write sin(x) / cos(x)".to_owned();
            return Err(CaseProblem { column: step.column, message });
        }
    });
    Ok(())
}

/// `1 - comparison`
fn not(comparison: LawStep, out: &mut Vec<LawStep>) -> Result<(), CaseProblem> {
    out.extend([comparison, LawStep::Negate, LawStep::Number(1.0), LawStep::Add]);
    Ok(())
}

/// The steps of an invariant; none for another name.
fn invariant(name: &str, out: &mut Vec<LawStep>) {
    let of = |invariant| LawStep::Invariant(invariant);
    let scaled = |own: Invariant, power: f64| {
        let scale = [of(Invariant::Jacobian), LawStep::Number(power), LawStep::Power];
        scale.into_iter().chain([of(own), LawStep::Multiply]).collect::<Vec<_>>()
    };
    match name {
        "I1" => out.push(of(Invariant::First)),
        "I2" => out.push(of(Invariant::Second)),
        "J" => out.push(of(Invariant::Jacobian)),
        "I4" => out.push(of(Invariant::Fiber)),
        "I1b" => out.extend(scaled(Invariant::First, -2.0 / 3.0)),
        "I2b" => out.extend(scaled(Invariant::Second, -4.0 / 3.0)),
        "I4b" => out.extend(scaled(Invariant::Fiber, -2.0 / 3.0)),
        "E_ff" => out.extend([
            of(Invariant::Fiber),
            LawStep::Number(1.0),
            LawStep::Subtract,
            LawStep::Number(0.5),
            LawStep::Multiply,
        ]),
        _ => {}
    }
}
