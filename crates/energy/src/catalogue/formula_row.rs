use std::borrow::Cow;

use super::{Made, MaterialRow, Parameter};
use crate::FormulaLaw;
use crate::formula::Invariant::{Fiber, First, Jacobian, Second};
use crate::formula::Step::{self, Add, Divide, Exp, Log, Maximum, Multiply, Number, Power, Subtract};

pub const FORMULA: MaterialRow = MaterialRow {
    name: FormulaLaw::NAME,
    about: "an energy as a formula of the invariants I1, I2, J and, with a fibre, I4",
    existence: "",
    reinforcing: false,
    forms: &[
        &[Parameter::energy("energy", MOONEY_RIVLIN), Parameter::numbers("parameters", MODULI).optional()],
        &[
            Parameter::energy("energy", FIBERS),
            Parameter::numbers("parameters", FIBER_MODULI).optional(),
            Parameter::direction("fiber", [0.6, 0.8, 0.0]),
        ],
    ],
    fit: &[],
    make: |given| {
        let fiber = given.direction_or_none("fiber");
        Ok(Made::formula(FormulaLaw::new(given.energy("energy")?, &given.numbers("parameters"), fiber)?))
    },
};

const fn named(name: &'static str) -> Step {
    Step::Parameter(Cow::Borrowed(name))
}

/// `mu1 (I1 - 3) + mu2 (I2 - 3) + mu3 (J - 1)^2 - 2 (mu1 + 2 mu2) log J`
const MOONEY_RIVLIN: &[Step] = &[
    named("mu1"),
    Step::Invariant(First),
    Number(3.0),
    Subtract,
    Multiply,
    named("mu2"),
    Step::Invariant(Second),
    Number(3.0),
    Subtract,
    Multiply,
    Add,
    named("mu3"),
    Step::Invariant(Jacobian),
    Number(1.0),
    Subtract,
    Number(2.0),
    Power,
    Multiply,
    Add,
    Number(2.0),
    named("mu1"),
    Number(2.0),
    named("mu2"),
    Multiply,
    Add,
    Multiply,
    Step::Invariant(Jacobian),
    Log,
    Multiply,
    Subtract,
];
const MODULI: &[(&str, f64)] = &[("mu1", 1e5), ("mu2", 2e4), ("mu3", 3e5)];

/// `mu/2 (J^(-2/3) I1 - 3) + k/4 (J^2 - 1 - 2 log J) + c (exp(b max(I4 - 1, 0)^4) - 1)`: a matrix with fibres that bear tension alone.
const FIBERS: &[Step] = &[
    named("mu"),
    Number(2.0),
    Divide,
    Step::Invariant(Jacobian),
    Number(-2.0 / 3.0),
    Power,
    Step::Invariant(First),
    Multiply,
    Number(3.0),
    Subtract,
    Multiply,
    named("k"),
    Number(4.0),
    Divide,
    Step::Invariant(Jacobian),
    Number(2.0),
    Power,
    Number(1.0),
    Subtract,
    Number(2.0),
    Step::Invariant(Jacobian),
    Log,
    Multiply,
    Subtract,
    Multiply,
    Add,
    named("c"),
    named("b"),
    Step::Invariant(Fiber),
    Number(1.0),
    Subtract,
    Number(0.0),
    Maximum,
    Number(4.0),
    Power,
    Multiply,
    Exp,
    Number(1.0),
    Subtract,
    Multiply,
    Add,
];
const FIBER_MODULI: &[(&str, f64)] = &[("mu", 1e5), ("k", 1e6), ("c", 1e4), ("b", 1e-4)];
