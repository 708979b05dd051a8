//! Tokens to steps, by recursive descent with a depth limit.

use crate::expression::analysis::Variable;
use crate::expression::program::{Binary, Comparison, Function, Op, Step};
use crate::expression::token::{CaseProblem, Placed, TEMPERATURES, Token, tokens};
use crate::quantity::{UNITS, Unit, Units};
use crate::syntax::{nearest, quoted};

/// Parentheses, calls and powers may nest this deep: far beyond any honest formula, far below the stack.
const DEEPEST: usize = 64;

/// Units may carry powers up to this size.
const LARGEST_UNIT_POWER: f64 = 12.0;

/// What people write behind temperatures.
const CELSIUS: [&str; 5] = ["C", "degC", "Celsius", "celsius", "kelvin"];

const COMPARISONS: [(&str, Comparison); 6] = [
    ("<", Comparison::Less),
    ("<=", Comparison::LessOrEqual),
    (">", Comparison::Greater),
    (">=", Comparison::GreaterOrEqual),
    ("==", Comparison::Equal),
    ("!=", Comparison::NotEqual),
];

/// The steps of a text. Names are those of the coordinates and the time, or these `variables` in their place.
pub(super) fn parse(text: &str, units: &Units, variables: Option<&[Variable]>) -> Result<Vec<Step>, CaseProblem> {
    let mut parser = Parser { tokens: tokens(text)?, next: 0, depth: 0, steps: Vec::new(), units, variables };
    parser.comparison()?;
    match parser.peek() {
        Token::End => Ok(parser.steps),
        Token::Sign(")") => Err(parser.problem("this \")\" was never opened")),
        other => {
            let message = format!("an operator was expected, found {other}{}", parser.hint());
            Err(parser.problem(&message))
        }
    }
}

struct Parser<'a> {
    tokens: Vec<Placed>,
    next: usize,
    depth: usize,
    steps: Vec<Step>,
    units: &'a Units,
    variables: Option<&'a [Variable]>,
}

impl Parser<'_> {
    fn comparison(&mut self) -> Result<(), CaseProblem> {
        self.sum()?;
        let Some((comparison, column)) = self.comparison_sign() else { return Ok(()) };
        self.sum()?;
        self.push(Op::Compare(comparison), column);
        if self.comparison_sign().is_some() {
            self.next -= 1;
            return Err(self.problem("comparisons cannot be chained: multiply them, as in (0 < X) * (X < 1)"));
        }
        Ok(())
    }

    fn sum(&mut self) -> Result<(), CaseProblem> {
        self.product()?;
        while let Some((sign, column)) = self.take(&["+", "-"]) {
            self.product()?;
            self.push(Op::Binary(if sign == "+" { Binary::Add } else { Binary::Subtract }), column);
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), CaseProblem> {
        self.signed()?;
        while let Some((sign, column)) = self.take(&["*", "/"]) {
            self.signed()?;
            self.push(Op::Binary(if sign == "*" { Binary::Multiply } else { Binary::Divide }), column);
        }
        Ok(())
    }

    fn signed(&mut self) -> Result<(), CaseProblem> {
        let mut negative = None;
        while let Some((sign, column)) = self.take(&["+", "-"]) {
            if sign == "-" {
                negative = if negative.is_some() { None } else { Some(column) };
            }
        }
        self.power()?;
        if let Some(column) = negative {
            self.push(Op::Negate, column);
        }
        Ok(())
    }

    fn power(&mut self) -> Result<(), CaseProblem> {
        self.operand()?;
        if let Some((_, column)) = self.take(&["^"]) {
            self.nested(Self::signed)?;
            self.push(Op::Binary(Binary::Power), column);
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), CaseProblem> {
        let column = self.column();
        match self.peek().clone() {
            Token::Number(value) => {
                self.next += 1;
                match self.unit_suffix()? {
                    Some((unit, power)) => self.measured(value, unit, power, column),
                    None => self.push(Op::Plain(value), column),
                }
                Ok(())
            }
            Token::Sign("(") => {
                self.next += 1;
                self.nested(Self::comparison)?;
                self.close()?;
                self.scaled_by_suffix()
            }
            Token::Name(name) => {
                self.next += 1;
                self.named(&name, column)
            }
            other => Err(self.problem(&format!("a number, a name or \"(\" was expected, found {other}"))),
        }
    }

    fn named(&mut self, name: &str, column: usize) -> Result<(), CaseProblem> {
        let own = self.variables.and_then(|own| own.iter().position(|variable| variable.name == name));
        let in_space = self.variables.is_none();
        if let Some(k) = own {
            self.push(Op::Variable(k), column);
        } else if let Some(axis) = ["X", "Y", "Z"].iter().position(|axis| in_space && *axis == name) {
            self.push(Op::Coordinate(axis), column);
        } else if in_space && name == "t" {
            self.push(Op::Time, column);
        } else if name == "pi" {
            self.push(Op::Plain(std::f64::consts::PI), column);
        } else if let Some((_, function)) = Function::ALL.iter().find(|(known, _)| *known == name) {
            self.open(name)?;
            self.nested(Self::comparison)?;
            if *self.peek() == Token::Sign(",") {
                return Err(self.problem(&format!("\"{name}\" takes one argument")));
            }
            self.close()?;
            self.push(Op::Call(*function), column);
            return self.scaled_by_suffix();
        } else if name == "min" || name == "max" {
            self.extremum(if name == "min" { Binary::Min } else { Binary::Max }, name, column)?;
            return self.scaled_by_suffix();
        } else if let Some(unit) = Unit::named(name) {
            self.measured(1.0, unit, 1, column);
        } else {
            let message = format!("unknown name {}{}", quoted(name), nearest::clause(name, &self.names()));
            return Err(CaseProblem { column, message });
        }
        Ok(())
    }

    fn extremum(&mut self, binary: Binary, name: &str, column: usize) -> Result<(), CaseProblem> {
        self.open(name)?;
        self.nested(Self::comparison)?;
        let mut arguments = 1;
        while self.take(&[","]).is_some() {
            self.nested(Self::comparison)?;
            self.push(Op::Binary(binary), column);
            arguments += 1;
        }
        if arguments < 2 {
            return Err(self.problem(&format!("\"{name}\" needs at least two arguments")));
        }
        self.close()
    }

    /// `(...) kPa`, `sqrt(...) mm`
    fn scaled_by_suffix(&mut self) -> Result<(), CaseProblem> {
        let column = self.column();
        if let Some((unit, power)) = self.unit_suffix()? {
            self.measured(1.0, unit, power, column);
            self.push(Op::Binary(Binary::Multiply), column);
        }
        Ok(())
    }

    /// A unit right behind an operand, with its own whole power: 2 m^2 is two square metres, not four.
    fn unit_suffix(&mut self) -> Result<Option<(Unit, i32)>, CaseProblem> {
        let Token::Name(name) = self.peek() else { return Ok(None) };
        if self.variables.is_some_and(|own| own.iter().any(|variable| variable.name == *name)) {
            return Ok(None);
        }
        let Some(unit) = Unit::named(name) else { return Ok(None) };
        self.next += 1;
        if self.take(&["^"]).is_none() {
            return Ok(Some((unit, 1)));
        }
        let negative = self.take(&["-", "+"]).is_some_and(|(sign, _)| sign == "-");
        let Token::Number(power) = *self.peek() else {
            return Err(self.problem("the power of a unit must be a whole number"));
        };
        if power.fract() != 0.0 || power > LARGEST_UNIT_POWER {
            return Err(self.problem(&format!("the power of a unit must be a whole number up to {LARGEST_UNIT_POWER}")));
        }
        self.next += 1;
        if *self.peek() == Token::Sign("^") {
            return Err(self.problem("a power of a unit's power needs parentheses"));
        }
        Ok(Some((unit, if negative { -(power as i32) } else { power as i32 })))
    }

    fn measured(&mut self, value: f64, unit: Unit, power: i32, column: usize) {
        // Powers are bounded by unit_suffix, so the dimension exists.
        let dimension = unit.dimension.power(f64::from(power)).unwrap_or(unit.dimension);
        self.push(Op::Measured(self.units.value_of(value, unit, power), dimension), column);
    }

    fn nested(&mut self, rule: fn(&mut Self) -> Result<(), CaseProblem>) -> Result<(), CaseProblem> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.problem(&format!("nested deeper than {DEEPEST} levels")));
        }
        rule(self)?;
        self.depth -= 1;
        Ok(())
    }

    fn open(&mut self, name: &str) -> Result<(), CaseProblem> {
        match self.take(&["("]) {
            Some(_) => Ok(()),
            None => Err(self.problem(&format!("\"{name}\" is a function: \"(\" was expected, found {}", self.peek()))),
        }
    }

    fn close(&mut self) -> Result<(), CaseProblem> {
        match self.take(&[")"]) {
            Some(_) => Ok(()),
            None => {
                let message = format!("\")\" was expected, found {}{}", self.peek(), self.hint());
                Err(self.problem(&message))
            }
        }
    }

    /// Why something that looks right stands where an operator should.
    fn hint(&self) -> String {
        match self.peek() {
            Token::Name(name) if CELSIUS.contains(&name.as_str()) => format!(": {TEMPERATURES}"),
            Token::Name(name) if self.names().contains(&name.as_str()) => ": products need \"*\"".to_string(),
            Token::Name(name) if nearest::nearest(name, &self.names()).is_some() => {
                nearest::clause(name, &self.names())
            }
            // behind a number it can only have been a unit
            Token::Name(_) if matches!(self.before(), Some(Token::Number(_))) => {
                format!("; the units are {}", units().collect::<Vec<_>>().join(", "))
            }
            Token::Name(name) => nearest::clause(name, &self.names()),
            Token::Number(_) | Token::Sign("(") => ": products need \"*\"".to_string(),
            _ => String::new(),
        }
    }

    fn comparison_sign(&mut self) -> Option<(Comparison, usize)> {
        let (sign, column) = self.take(&COMPARISONS.map(|(sign, _)| sign))?;
        COMPARISONS.iter().find(|(known, _)| *known == sign).map(|(_, comparison)| (*comparison, column))
    }

    fn take(&mut self, signs: &[&str]) -> Option<(&'static str, usize)> {
        let Token::Sign(sign) = *self.peek() else { return None };
        let column = self.column();
        signs.contains(&sign).then(|| {
            self.next += 1;
            (sign, column)
        })
    }

    fn push(&mut self, op: Op, column: usize) {
        self.steps.push(Step { op, column });
    }

    /// Everything a name may be.
    fn names(&self) -> Vec<&str> {
        let own: Vec<&str> = match self.variables {
            Some(variables) => variables.iter().map(|variable| variable.name.as_str()).collect(),
            None => vec!["X", "Y", "Z", "t"],
        };
        own.into_iter().chain(fixed_names()).collect()
    }

    fn before(&self) -> Option<&Token> {
        self.next.checked_sub(1).and_then(|before| self.tokens.get(before)).map(|placed| &placed.token)
    }

    fn peek(&self) -> &Token {
        self.tokens.get(self.next).map_or(&Token::End, |placed| &placed.token)
    }

    fn column(&self) -> usize {
        self.tokens.get(self.next).or(self.tokens.last()).map_or(1, |placed| placed.column)
    }

    fn problem(&self, message: &str) -> CaseProblem {
        CaseProblem { column: self.column(), message: message.to_string() }
    }
}

/// What a name means whatever variables there are: constants, functions, units.
pub(super) fn fixed_names() -> Vec<&'static str> {
    let functions = Function::ALL.iter().map(|(name, _)| *name);
    ["pi"].into_iter().chain(functions).chain(["min", "max"]).chain(units()).collect()
}

fn units() -> impl Iterator<Item = &'static str> {
    UNITS.iter().map(|unit| unit.symbol)
}
