//! Every law and actuation by its name in case files, with its parameters, their units and an example of each.
//!
//! A row makes a member known to case files and to the contract tests alike, so neither can be forgotten.
//!
//! ```
//! use nastic_energy::catalogue::{Inputs, material};
//! # fn main() -> Result<(), nastic_energy::EnergyError> {
//! let inputs = Inputs::new().number("young", 1e5).number("poisson", 0.4).number("share", 0.8);
//! let law = material("mooney_rivlin")?.build(&inputs)?;
//! # let _ = law;
//! let wrong = material("mooney_rivlin")?.build(&Inputs::new().number("yuong", 1e5)).unwrap_err();
//! assert!(wrong.to_string().contains("did you mean `young`?"), "{wrong}");
//! # Ok(())
//! # }
//! ```

mod actuation_rows;
mod choose;
mod conversions;
mod fit_form;
mod fits;
mod formula_row;
mod inputs;
mod network_fits;
mod network_row;
mod rows;

use std::collections::BTreeMap;
use std::sync::Arc;

use nastic_tensor::Mat3;

use crate::by_parameters::Given;
use crate::formula::Step;
use crate::network::{ExampleLayer, NetworkInput};
use crate::{
    ByParameters, Conversion, ConvexDensity, EnergyError, EnergyTerm, FormulaLaw, LinearInModuli, Parametrised,
};

use choose::choose;
pub use choose::{describe, distinct};
pub use fit_form::{FitForm, FitNumber, FitStarts, FitVolume, Free, NetworkShape};
pub use inputs::{CheckedInputs, Inputs};

/// A parameter of a law, as case files write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// What kind of value it takes.
    pub takes: Takes,
    /// Whether it may be left out.
    pub optional: bool,
}

/// What a parameter takes, with an example of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Takes {
    /// A number, which may vary over the body.
    Number {
        /// `Pa`, `1` for a pure number ...
        unit: &'static str,
        /// An example, in SI units.
        example: f64,
    },
    /// A unit vector of the reference body, which may vary over it.
    Direction {
        /// An example.
        example: [f64; 3],
    },
    /// One of a few words; the first is taken when it is left out.
    Choice {
        /// The words.
        of: &'static [&'static str],
    },
    /// An energy density (J/m^3) as a formula of invariants and of the parameters that stand under the other key of its form, [`Takes::Numbers`].
    Energy {
        /// An example.
        example: &'static [Step],
    },
    /// Numbers by names that the user chooses, each of which may vary over the body.
    Numbers {
        /// An example, in SI units.
        example: &'static [(&'static str, f64)],
    },
    /// A convex neural network of invariants.
    Network {
        /// Inputs of an example.
        inputs: &'static [NetworkInput],
        /// Its layers.
        layers: &'static [ExampleLayer],
    },
    /// Displacement fields of the body by names that the user chooses, pure numbers, by which its shape changes.
    Modes {
        /// Rows of the gradient of an example, 1/m.
        example: &'static [(&'static str, [[f64; 3]; 3])],
    },
}

impl Parameter {
    /// A number in this unit (`Pa`, `m`, `T`, `1` for a pure number ...), with an example in SI units.
    pub const fn number(name: &'static str, unit: &'static str, example: f64) -> Self {
        Parameter { name, takes: Takes::Number { unit, example }, optional: false }
    }

    /// A unit vector of the reference body.
    pub const fn direction(name: &'static str, example: [f64; 3]) -> Self {
        Parameter { name, takes: Takes::Direction { example }, optional: false }
    }

    /// One of a few words.
    pub const fn choice(name: &'static str, of: &'static [&'static str]) -> Self {
        Parameter { name, takes: Takes::Choice { of }, optional: false }
    }

    /// An energy as a formula.
    pub const fn energy(name: &'static str, example: &'static [Step]) -> Self {
        Parameter { name, takes: Takes::Energy { example }, optional: false }
    }

    /// Numbers by names of the user's.
    pub const fn numbers(name: &'static str, example: &'static [(&'static str, f64)]) -> Self {
        Parameter { name, takes: Takes::Numbers { example }, optional: false }
    }

    /// A convex neural network.
    pub const fn network(name: &'static str, inputs: &'static [NetworkInput], layers: &'static [ExampleLayer]) -> Self {
        Parameter { name, takes: Takes::Network { inputs, layers }, optional: false }
    }

    /// Displacement fields by names of the user's.
    pub const fn modes(name: &'static str, example: &'static [(&'static str, [[f64; 3]; 3])]) -> Self {
        Parameter { name, takes: Takes::Modes { example }, optional: false }
    }

    /// The same, which may be left out.
    pub const fn optional(self) -> Self {
        Parameter { optional: true, ..self }
    }
}

/// How a law is made of its parameters.
pub type MakeMaterial = fn(&CheckedInputs<'_>) -> Result<Made, EnergyError>;
/// How an actuation is made of its parameters.
pub type MakeActuation = fn(&CheckedInputs<'_>) -> Result<Arc<dyn EnergyTerm>, EnergyError>;

/// A passive law.
#[derive(Clone, Copy, Debug)]
pub struct MaterialRow {
    /// Its name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// For which parameters it fulfils which of the conditions of [`Existence`](crate::Existence); empty where that is not known.
    pub existence: &'static str,
    /// Whether it is no body's material by itself but adds to that of another law on the same cells.
    pub reinforcing: bool,
    /// The sets of parameters it takes, its own coefficients first.
    pub forms: &'static [&'static [Parameter]],
    /// How it is fitted to tests, once for every number of terms or families; empty of a law that cannot be.
    pub fit: &'static [FitForm],
    make: MakeMaterial,
}

/// An actuation.
#[derive(Clone, Copy, Debug)]
pub struct ActuationRow {
    /// Its name in case files.
    pub name: &'static str,
    /// What it is, in a few words, with the sign of its control.
    pub about: &'static str,
    /// The sets of parameters it takes, apart from its control slots.
    pub forms: &'static [&'static [Parameter]],
    /// Positive control values and the displacement gradient they drive a free body at rest towards.
    pub example: Example,
    make: MakeActuation,
}

/// What a positive control does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// One value per slot, in SI units.
    pub controls: &'static [f64],
    /// Rows of a displacement gradient most of their work goes into, for the example parameters.
    pub towards: [[f64; 3]; 3],
}

impl Example {
    /// The displacement gradient as a matrix.
    pub fn gradient(&self) -> Mat3 {
        Mat3::from_fn(|i, j| self.towards[i][j])
    }
}

/// A law, once for those who evaluate it and once for those who examine its convexity.
#[derive(Debug)]
pub struct Made {
    term: Arc<dyn EnergyTerm>,
    density: Option<Arc<dyn ConvexDensity>>,
    /// With its moduli, or the parameters of its formula, as slots.
    parametrised: Result<Arc<dyn EnergyTerm>, EnergyError>,
    conversions: &'static [Conversion],
}

impl Made {
    /// Of a law written as a function of `F`, `H` and `J`.
    pub fn density(law: impl ConvexDensity + 'static) -> Self {
        let law = Arc::new(law);
        Made { density: Some(law.clone()), ..Made::term(law) }
    }

    /// Of such a law that is linear in its moduli, which may be unknowns.
    pub fn linear(law: impl LinearInModuli) -> Self {
        Made { parametrised: Ok(Arc::new(Parametrised::new(law.clone()))), ..Made::density(law) }
    }

    /// Of a formula, whose parameters may be unknowns.
    pub fn formula(law: FormulaLaw) -> Self {
        let parametrised = law.parametrised().map(|law| Arc::new(law) as Arc<dyn EnergyTerm>);
        Made { parametrised, ..Made::term(law) }
    }

    /// The same with ways of its own from the numbers of other forms to the moduli.
    #[must_use]
    pub fn by(self, conversions: &'static [Conversion]) -> Self {
        Made { conversions, ..self }
    }

    /// Of any other law.
    pub fn term(law: impl EnergyTerm + 'static) -> Self {
        let parametrised = Err(EnergyError::NoParameters { owner: std::any::type_name_of_val(&law) });
        Made { term: Arc::new(law), density: None, parametrised, conversions: &[] }
    }
}

/// All passive laws.
pub fn materials() -> &'static [MaterialRow] {
    rows::MATERIALS
}

/// All actuations.
pub fn actuations() -> &'static [ActuationRow] {
    actuation_rows::ACTUATIONS
}

/// The law of a name.
///
/// # Errors
/// [`EnergyError::UnknownName`] lists the names and offers the nearest.
pub fn material(name: &str) -> Result<&'static MaterialRow, EnergyError> {
    materials()
        .iter()
        .find(|row| row.name == name)
        .ok_or_else(|| unknown("law", name, materials().iter().map(|row| row.name).collect()))
}

/// The actuation of a name.
///
/// # Errors
/// [`EnergyError::UnknownName`] lists the names and offers the nearest.
pub fn actuation(name: &str) -> Result<&'static ActuationRow, EnergyError> {
    actuations()
        .iter()
        .find(|row| row.name == name)
        .ok_or_else(|| unknown("actuation", name, actuations().iter().map(|row| row.name).collect()))
}

impl MaterialRow {
    /// A row for a law of one's own; `forms` are the sets of parameters it takes.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        forms: &'static [&'static [Parameter]],
        make: MakeMaterial,
    ) -> Self {
        MaterialRow { name, about, existence: "", reinforcing: false, forms, fit: &[], make }
    }

    /// The same law, which is fitted to tests so.
    pub const fn fitted(self, fit: &'static [FitForm]) -> Self {
        MaterialRow { fit, ..self }
    }

    /// The law with these parameters, which must be exactly one of its [`forms`](Self::forms).
    ///
    /// # Errors
    /// An [`EnergyError`] that names the parameter: unknown, missing, of the wrong kind, out of range, or of another set.
    pub fn build(&self, inputs: &Inputs) -> Result<Arc<dyn EnergyTerm>, EnergyError> {
        Ok(self.made(inputs)?.term)
    }

    /// The law with some of the numbers that it is written with as slots of the role [`Role::Design`](crate::Role), at rest as they are
    /// written; the others are held. It can be any modulus in which the law is linear, whatever the moduli are made of (`young`, `poisson`), and any
    /// parameter of a formula.
    ///
    /// # Errors
    /// As [`build`](Self::build); [`EnergyError::NoParameters`] of a law that has none, [`EnergyError::NotLinear`] of another number.
    pub fn parametrised(&self, inputs: &Inputs, names: &[&str]) -> Result<Arc<dyn EnergyTerm>, EnergyError> {
        let made = self.made(inputs)?;
        let law = made.parametrised?;
        let units = self.forms.iter().copied().flatten().filter_map(|p| match p.takes {
            Takes::Number { unit, .. } => Some((p.name, unit)),
            _ => None,
        });
        let units: BTreeMap<&str, &'static str> = units.collect();
        let given = inputs.all_numbers().into_iter().map(|(name, values)| Given {
            name,
            unit: units.get(name).copied().unwrap_or_default(),
            values,
        });
        let conversions = [made.conversions, conversions::SHARED].concat();
        Ok(Arc::new(ByParameters::new(self.name, law, given.collect(), &conversions, names)?))
    }

    /// The same law as a function of `F`, `H` and `J`, for [`check::convex_density`](crate::check::convex_density);
    /// `None` for a law that is not written as one.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn density(&self, inputs: &Inputs) -> Result<Option<Arc<dyn ConvexDensity>>, EnergyError> {
        Ok(self.made(inputs)?.density)
    }

    /// Example inputs, one per form and word of a choice.
    pub fn examples(&self) -> Vec<Inputs> {
        self.forms.iter().flat_map(|form| with_words(form)).collect()
    }

    /// All keys any form takes, each once.
    pub fn parameters(&self) -> Vec<&'static Parameter> {
        distinct(self.forms)
    }

    fn made(&self, inputs: &Inputs) -> Result<Made, EnergyError> {
        (self.make)(&choose(self.name, self.forms, inputs)?)
    }
}

impl ActuationRow {
    /// A row for an actuation of one's own; `forms` are the sets of parameters it takes.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        forms: &'static [&'static [Parameter]],
        example: Example,
        make: MakeActuation,
    ) -> Self {
        ActuationRow { name, about, forms, example, make }
    }

    /// The actuation with these parameters.
    ///
    /// # Errors
    /// As [`MaterialRow::build`].
    pub fn build(&self, inputs: &Inputs) -> Result<Arc<dyn EnergyTerm>, EnergyError> {
        (self.make)(&choose(self.name, self.forms, inputs)?)
    }

    /// Example inputs, one per form and word of a choice.
    pub fn examples(&self) -> Vec<Inputs> {
        self.forms.iter().flat_map(|form| with_words(form)).collect()
    }

    /// All keys any form takes, each once.
    pub fn parameters(&self) -> Vec<&'static Parameter> {
        distinct(self.forms)
    }
}

fn with_words(form: &[Parameter]) -> Vec<Inputs> {
    let mut out = vec![Inputs::examples(form)];
    for parameter in form {
        if let Takes::Choice { of } = parameter.takes {
            out = out.iter().flat_map(|i| of.iter().map(|word| i.clone().choice(parameter.name, word))).collect();
        }
    }
    out
}

fn unknown(what: &str, found: &str, known: Vec<&'static str>) -> EnergyError {
    EnergyError::UnknownName { what: what.to_owned(), found: found.to_owned(), known }
}
