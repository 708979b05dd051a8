use std::borrow::Cow;
use std::fmt;

/// What an energy formula may depend on, with `C = F^T F` and the unit vector `f` of the fibre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invariant {
    /// `I1 = tr C = |F|^2`
    First,
    /// `I2 = ((tr C)^2 - tr C^2) / 2 = |H|^2`
    Second,
    /// `J = det F`
    Jacobian,
    /// `I4 = C : f f = |F f|^2`
    Fiber,
}

impl Invariant {
    /// All of them, in the order of their derivatives.
    pub const ALL: [Self; 4] = [Self::First, Self::Second, Self::Jacobian, Self::Fiber];
}

/// A step of an energy formula for a stack machine: operands are pushed, an operation takes the last ones and pushes its value.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A number.
    Number(f64),
    /// An invariant of the deformation.
    Invariant(Invariant),
    /// A parameter by its name.
    Parameter(Cow<'static, str>),
    /// `-a`
    Negate,
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a b`
    Multiply,
    /// `a / b`
    Divide,
    /// `a^b`
    Power,
    /// The smaller one.
    Minimum,
    /// The larger one.
    Maximum,
    /// 1 where `a < b`, else 0.
    Less,
    /// 1 where `a <= b`, else 0.
    LessOrEqual,
    /// `exp a`
    Exp,
    /// The natural logarithm.
    Log,
    /// The square root.
    Sqrt,
    /// `sin a`
    Sin,
    /// `cos a`
    Cos,
    /// `|a|`
    Abs,
}

/// An energy density as a formula of invariants and parameters, as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// The text, for messages.
    pub text: String,
    /// Its operations in the order of evaluation.
    pub steps: Vec<Step>,
}

impl Expression {
    /// Of these steps.
    pub fn new(text: impl Into<String>, steps: impl Into<Vec<Step>>) -> Self {
        Self { text: text.into(), steps: steps.into() }
    }

    /// The parameters it names, each once, in the order of their names.
    pub fn parameters(&self) -> Vec<&str> {
        let named =
            self.steps.iter().filter_map(|step| if let Step::Parameter(name) = step { Some(&**name) } else { None });
        let mut names: Vec<&str> = named.collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Whether it depends on an invariant.
    pub fn depends_on(&self, invariant: Invariant) -> bool {
        self.steps.contains(&Step::Invariant(invariant))
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
