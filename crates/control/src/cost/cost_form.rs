//! [`CostForm`]: how case files name a cost and its parameters.

use super::Cost;
use crate::error::ControlError;
use nastic_energy::catalogue::{Given, Parameter};
use nastic_fem::Solid;

/// How a cost is made for a body, of its parameters and its weight (at least zero), which its values include.
pub type MakeCost = fn(&Solid, &Given<'_>, f64) -> Result<Box<dyn Cost>, ControlError>;

/// How case files name a cost and give its parameters: of a built-in row of the catalogue, or of a cost that a program adds.
#[derive(Clone, Copy, Debug)]
pub struct CostForm {
    /// Its `kind` in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The sets of parameters it takes.
    pub forms: &'static [&'static [Parameter]],
    /// How it is made.
    pub make: MakeCost,
}
