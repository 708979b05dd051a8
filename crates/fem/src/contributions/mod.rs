//! What the residual is made of: [`Contribution`]s, summed by [`Model`](crate::Model).

pub(crate) mod body_energy;
pub mod catalogue;
mod cavity;
mod check;
pub(crate) mod controls;
pub(crate) mod dead_load;
pub(crate) mod inertia;
pub(crate) mod instant;
pub(crate) mod rayleigh_damping;
pub(crate) mod sensitivities;

use crate::error::{FemError, InvertedAt, SecondDerivativeError};
pub use cavity::Cavity;
pub use check::check_contribution;
pub use controls::Controls;
pub use inertia::Inertia;
pub use instant::{Instant, TimeStep};
use nastic_energy::Slot;
use nastic_linear::{SparseMatrix, Symmetry};
pub use sensitivities::{Increment, SecondSensitivities, Sensitivities};
use std::fmt::Debug;

/// A term of the residual `r(u) = sum_c r_c(u; controls, load, v, a)`, whose zero is an equilibrium.
///
/// Contract, checked by [`check_contribution`]: `r` is the derivative of the potential where there
/// is one, the tangent is the derivative of `r` (by `u`, with `v` and `a` as the time step gives them), `vjp` that of
/// `lambda . r` by everything else, `second_vjp`, where it is there, that of both; the same input gives the same bits (for any number of threads, which is not checked there).
///
/// Vectors are flat, `dim * node + component`, supported unknowns included.
pub trait Contribution: Debug + Send + Sync {
    /// What it is called in messages and results.
    fn name(&self) -> &str;

    /// Whether its tangent is symmetric.
    fn symmetry(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    /// Whether its residual is the derivative of a potential, in a time step of an incremental one; where one contribution
    /// has none, Newton's method searches for a smaller residual instead of a smaller potential.
    fn has_potential(&self) -> bool {
        self.symmetry() == Symmetry::Symmetric
    }

    /// Sets of nodes that it couples with each other beyond those that share a cell.
    fn couplings(&self) -> Vec<Vec<u32>> {
        Vec::new()
    }

    /// Whether the supports hold what it needs held; by unknown, whether it is held.
    ///
    /// # Errors
    /// What has to be held.
    fn check(&self, _fixed: &[bool]) -> Result<(), FemError> {
        Ok(())
    }

    /// Its controls: numbers for the whole contribution, one per slot (see [`Instant::control`]).
    fn slots(&self) -> &[Slot] {
        &[]
    }

    /// Named numbers worth reporting of a state: the volume of a cavity, say.
    fn quantities(&self, _at: &Instant) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// Size of what its controls act on (a volume, say): their weight in the inner product of the control space.
    fn measure(&self) -> f64 {
        1.0
    }

    /// Adds potential (in a time step the incremental one) and residual, as wanted, and what their rounding is measured against.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), InvertedAt>;

    /// Adds the tangent, supports not eliminated.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), InvertedAt>;

    /// Adds the product of its tangent with v, where it can say it without a matrix; false where it cannot.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    fn add_tangent_product(&self, _at: &Instant, _v: &[f64], _out: &mut [f64]) -> Result<bool, InvertedAt> {
        Ok(false)
    }

    /// Adds its mass matrix `dr/da`, which is symmetric and does not change: what accelerations follow from where a motion begins.
    fn add_mass(&self, _mass: &mut SparseMatrix) {}

    /// The longest step `s <= 1` along du that it bears.
    ///
    /// # Errors
    /// [`InvertedAt`] where u itself is not admissible.
    fn max_step(&self, _at: &Instant, _du: &[f64]) -> Result<f64, InvertedAt> {
        Ok(1.0)
    }

    /// Adds `lambda . dr/d(controls, velocity, acceleration)`.
    ///
    /// # Errors
    /// [`InvertedAt`] where J <= 0.
    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), InvertedAt>;

    /// Adds `dr/dm v`, the change of the residual along a change v of the controls. A contribution with slots implements it for
    /// second derivatives of costs.
    ///
    /// # Errors
    /// [`SecondDerivativeError`] where it does not, or J <= 0.
    fn add_control_product(&self, _at: &Instant, _v: &Controls, _out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        if self.slots().is_empty() { Ok(()) } else { Err(no_second_derivatives(self.name(), "add_control_product")) }
    }

    /// Adds the change of `K^T lambda` and of `lambda . dr/dm` along a change of u and of the controls: second derivatives of
    /// `lambda . r`, symmetric as a whole. Second derivatives of costs ask for it.
    ///
    /// # Errors
    /// [`SecondDerivativeError`] where it is not implemented, or J <= 0.
    fn second_vjp(
        &self,
        _at: &Instant,
        _lambda: &[f64],
        _along: &Increment,
        _into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Err(no_second_derivatives(self.name(), "second_vjp"))
    }

    /// Internal variables at the end of a time step, appended to those of the state.
    fn commit(&self, _at: &Instant, _internal: &mut Vec<f64>) {}
}

fn no_second_derivatives(name: &str, method: &'static str) -> SecondDerivativeError {
    SecondDerivativeError::Contribution { name: name.to_owned(), method }
}

/// What is wanted of a contribution; forces and the potential come together cheaper than one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Demand {
    /// The potential energy.
    pub energy: bool,
    /// The residual force.
    pub force: bool,
}

/// Sums over contributions.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// Potential energy.
    pub energy: f64,
    /// Sum of absolute terms of the energy: what its rounding error is measured against.
    pub energy_scale: f64,
    /// Residual force `r`, flat; empty unless asked for.
    pub force: Vec<f64>,
    /// Sum of absolute forces, flat: of every cell those of the passive laws and of the actuations each by itself (in a free
    /// body they cancel), and of every other contribution. What a residual's smallness is measured against.
    pub force_scale: Vec<f64>,
    /// Smallest J.
    pub min_j: f64,
}

impl Sums {
    /// Zero, with residuals of a length (0 where none is wanted).
    pub fn zero(dofs: usize) -> Self {
        Sums {
            energy: 0.0,
            energy_scale: 0.0,
            force: vec![0.0; dofs],
            force_scale: vec![0.0; dofs],
            min_j: f64::INFINITY,
        }
    }
}
