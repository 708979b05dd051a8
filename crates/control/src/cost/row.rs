//! [`CostRow`]: a cost of one's own as case files name it.

use super::Cost;
use crate::error::ControlError;
use nastic_energy::catalogue::{Given, Parameter};
use nastic_fem::Solid;

/// How a cost is made for a body, of its parameters and its weight (at least zero), which its values include.
pub type MakeCost = fn(&Solid, &Given<'_>, f64) -> Result<Box<dyn Cost>, ControlError>;

/// Rows of the costs that need no block of their own in the schema of case files: further built-in costs go here.
pub const COSTS: &[CostRow] = &[];

/// A cost that case files may name beside the built-in ones.
#[derive(Clone, Copy, Debug)]
pub struct CostRow {
    /// Its `kind` in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The sets of parameters it takes.
    pub forms: &'static [&'static [Parameter]],
    /// How it is made.
    pub make: MakeCost,
}
