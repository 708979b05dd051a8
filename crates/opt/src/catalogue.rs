//! Optimisers by name.

use crate::lbfgs::Lbfgs;
use crate::mma::Mma;
use crate::newton_cg::NewtonCg;
use crate::optimizer::{Optimizer, Options};
use crate::projected_gradient::ProjectedGradient;
use crate::spectral::Spectral;

/// A row of the catalogue: a name of case files and how to build what it names.
#[derive(Clone, Copy, Debug)]
pub struct OptimizerRow {
    /// The name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The optimiser with these options and defaults for the rest.
    pub build: fn(Options) -> Box<dyn Optimizer>,
}

/// Every optimiser of this crate.
pub const CATALOGUE: &[OptimizerRow] = &[
    OptimizerRow {
        name: "projected_gradient",
        about: "Projected gradient with Armijo backtracking.",
        build: |options| Box::new(ProjectedGradient { options }),
    },
    OptimizerRow {
        name: "spectral",
        about: "Projected gradient with Barzilai-Borwein steps, non-monotone.",
        build: |options| Box::new(Spectral { options, ..Spectral::default() }),
    },
    OptimizerRow {
        name: "lbfgs",
        about: "Limited-memory quasi-Newton with bounds.",
        build: |options| Box::new(Lbfgs { options, ..Lbfgs::default() }),
    },
    OptimizerRow {
        name: "mma",
        about: "Moving asymptotes within bounds; holds constraints itself.",
        build: |options| Box::new(Mma { options, ..Mma::default() }),
    },
    OptimizerRow {
        name: "gauss_newton",
        about: "Trust-region Newton with the state linearised: for tracking costs.",
        build: |options| Box::new(NewtonCg { options, ..NewtonCg::gauss_newton() }),
    },
    OptimizerRow {
        name: "newton_cg",
        about: "Trust-region Newton with exact second derivatives.",
        build: |options| Box::new(NewtonCg { options, ..NewtonCg::exact() }),
    },
];

/// The optimiser of that name.
pub fn by_name(name: &str, options: Options) -> Option<Box<dyn Optimizer>> {
    CATALOGUE.iter().find(|entry| entry.name == name).map(|entry| (entry.build)(options))
}
