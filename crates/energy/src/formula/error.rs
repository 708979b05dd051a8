use std::fmt;

/// What keeps a formula from being the energy of a law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("formula: \"{text}\" {problem}")]
pub struct FormulaError {
    /// The formula.
    pub text: String,
    /// What is wrong with it.
    pub problem: FormulaProblem,
}

/// See [`FormulaError`].
#[derive(Clone, Debug, PartialEq)]
pub enum FormulaProblem {
    /// A parameter without a value.
    NoValue {
        /// Its name.
        name: String,
        /// Those with one.
        given: Vec<String>,
    },
    /// A parameter that the formula does not name.
    Unused(String),
    /// `I4` without a fibre.
    NoFiber,
    /// A fibre without `I4`.
    UnusedFiber,
    /// Steps that leave no value, or more than one.
    NoFormula,
    /// Too many operations.
    TooLong {
        /// How many there may be.
        most: usize,
    },
    /// More parameters that vary over the body than there may be.
    TooManyFields {
        /// How many there may be.
        most: usize,
    },
    /// No finite value of the energy or its derivatives at rest.
    NoValueAtRest(String),
    /// `W(I) != 0`.
    EnergyAtRest {
        /// `W(I)`, J/m^3.
        energy: f64,
    },
    /// `P(I) != 0`.
    StressAtRest {
        /// The part `p I` of it, across the fibre.
        pressure: f64,
        /// What it has more along the fibre.
        along: f64,
        /// The norm of `dP/dF` at rest.
        stiffness: f64,
    },
    /// An energy or a stress that jumps.
    Jump {
        /// `the energy` or `the stress`.
        of: &'static str,
        /// The size of the jump over the stiffness there.
        size: f64,
        /// Invariants where it does: I1, I2, J, I4.
        at: [f64; 4],
    },
}

impl fmt::Display for FormulaProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoValue { name, given } if given.is_empty() => {
                write!(f, "names {name}, which has no value; give it among its parameters")
            }
            Self::NoValue { name, given } => {
                write!(f, "names {name}, which has no value; its parameters are {}", given.join(", "))
            }
            Self::Unused(name) => write!(f, "does not name the parameter {name}; remove it, or use it"),
            Self::NoFiber => {
                f.write_str("names an invariant of the fibre; give its direction, as \"fiber\": [1, 0, 0]")
            }
            Self::UnusedFiber => {
                f.write_str("names no invariant of the fibre; remove the direction, or use I4, I4b or E_ff")
            }
            Self::NoFormula => f.write_str("is no formula: it leaves no value, or more than one"),
            Self::TooLong { most } => {
                write!(f, "is too long: with its derivatives it takes more than {most} operations")
            }
            Self::TooManyFields { most } => write!(f, "has more than {most} parameters that vary over the body"),
            Self::NoValueAtRest(what) => {
                write!(f, "or one of its first two derivatives has no finite value at rest, F = I: {what}")
            }
            Self::EnergyAtRest { energy } => {
                write!(f, "is {energy:e} (unit of stress) at rest, F = I, where an energy is 0: subtract that")
            }
            Self::StressAtRest { pressure, along, stiffness } => {
                write!(f, "has the stress {pressure:e} I")?;
                if *along != 0.0 {
                    write!(f, " and {along:e} more along the fibre")?;
                }
                let norm = 3.0 * pressure * pressure + 2.0 * pressure * along + along * along;
                let share = norm.max(0.0).sqrt() / stiffness;
                write!(f, " at rest, F = I ({share:.1e} of its stiffness there), which must be free of stress: ")?;
                match *along != 0.0 {
                    true => write!(f, "subtract {pressure:e} * log(J) + {along:e} * (I4 - 1) / 2"),
                    false => write!(f, "subtract {pressure:e} * log(J)"),
                }
            }
            Self::Jump { of, size, at: [i1, i2, j, i4] } => write!(
                f,
                "is not smooth enough: {of} jumps by {size:.1e} of the stiffness at I1 = {i1:.6}, I2 = {i2:.6}, J = {j:.6}, I4 = {i4:.6}; \
                 take branches that meet with the same value and slope, as max(x, 0)^3 does"
            ),
        }
    }
}
