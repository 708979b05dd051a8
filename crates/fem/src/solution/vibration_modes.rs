//! [`VibrationMode`]: small vibrations about an equilibrium.

use crate::error::{FemError, StateError};
use crate::model::Model;
use crate::solution::modes::normalized;
use crate::solution::options::SolveOptions;
use crate::solution::state::State;
use nastic_linear::{MassMatrix, SparseMatrix};

/// A solution `u + phi exp(i w t)` of the undamped motion about an equilibrium u, linearised: `K phi = w^2 M phi`, K
/// the static tangent at u with its loads and controls, M the mass of the model, consistent or lumped as its
/// [`Inertia`](crate::Inertia) is.
#[derive(Debug, Clone, PartialEq)]
pub struct VibrationMode {
    /// `w^2` in 1/s^2; negative where the equilibrium is not stable.
    pub square: f64,
    /// What rounding of the tangent may change `w^2` by.
    pub rounding: f64,
    /// Whether the pivots of a factor show that no lower one is missing, as [`Modes::counted`](crate::Modes::counted).
    pub counted: bool,
    /// Of modes without a factor: the iterations that found all of them, and the relative error of the shape
    /// ([`ByProducts`](crate::ByProducts)).
    pub by_products: Option<(usize, f64)>,
    /// `phi . M phi` in kg, in plane strain per unit of thickness.
    pub modal_mass: f64,
    /// Shares of its kinetic energy along x, y, z (0 in the plane): `phi_c . (M phi)_c / (phi . M phi)`.
    pub directions: [f64; 3],
    /// phi, flat like displacements, zero on the supports, with a largest component of exactly 1.
    pub shape: Vec<f64>,
}

/// What a small displacement along a mode does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeKind {
    /// `w^2 < 0`: it grows as `exp(rate t)`, `rate = sqrt(-w^2)` in 1/s.
    Unstable {
        /// 1/s
        rate: f64,
    },
    /// `w^2 = 0` to rounding: nothing drives it back, as the rigid motions of a free body.
    Neutral,
    /// `w^2 > 0`.
    Vibration {
        /// w in rad/s; `w/(2 pi)` in Hz.
        angular_frequency: f64,
    },
}

impl VibrationMode {
    /// What it does, by the sign of `w^2`.
    pub fn kind(&self) -> ModeKind {
        if self.square.abs() <= self.rounding {
            ModeKind::Neutral
        } else if self.square < 0.0 {
            ModeKind::Unstable { rate: (-self.square).sqrt() }
        } else {
            ModeKind::Vibration { angular_frequency: self.square.sqrt() }
        }
    }
}

impl Model {
    /// The `count` modes of the algebraically smallest `w^2` about a state, ascending, and all with a negative one in
    /// any case.
    ///
    /// Neither damping nor, in a state of a motion, its velocity counts; of viscous laws the stiffness that the state
    /// has, relaxed in an equilibrium. Of multiple frequencies every mode is found; which basis of their span is
    /// returned has no meaning. The Galerkin method with the consistent mass gives frequencies from above, with a
    /// relative error of `O(h^(2p))` on cells of order p. A lumped mass adds an error of its own: the first bending
    /// frequency of a free beam of 12 hex20 is 1.3 % too low with it, 0.1 % too high with the consistent one.
    ///
    /// # Errors
    /// [`FemError::Meaningless`] for nodes without mass; otherwise as [`modes`](Self::modes).
    pub fn vibration_modes(
        &self,
        state: &State,
        count: usize,
        how: &SolveOptions,
    ) -> Result<Vec<VibrationMode>, StateError> {
        let (dim, mut mass) = (self.discretization().dim(), self.mass()?);
        mass.eliminate(self.supports.fixed(), 0.0);
        self.check_positive(&mass)?;
        let found = self.lowest_modes(state, MassMatrix::Sparse(&mass), count, how)?;
        let (counted, how_found) = (found.counted, found.by_products);
        let pairs = found.values.into_iter().zip(found.rounding).zip(found.vectors);
        let mode = |(k, ((square, rounding), vector)): (usize, ((f64, f64), Vec<f64>))| {
            let by_products = how_found.as_ref().and_then(|found| Some((found.iterations, *found.errors.get(k)?)));
            let shape = normalized(vector);
            let mut momentum = vec![0.0; shape.len()];
            mass.multiply_on(&shape, &mut momentum, how.parallel);
            let modal_mass = self.unknowns().dot(&shape, &momentum);
            let along = |c: usize| shape.iter().zip(&momentum).skip(c).step_by(dim).map(|(x, p)| x * p).sum::<f64>();
            let directions = [0, 1, 2].map(|c| if c < dim { along(c) / modal_mass } else { 0.0 });
            VibrationMode { square, rounding, counted, by_products, modal_mass, directions, shape }
        };
        let mut modes: Vec<VibrationMode> = pairs.enumerate().map(mode).collect();
        // the pivots of a singular tangent have the signs of rounding errors
        let unstable = modes.iter().filter(|mode| matches!(mode.kind(), ModeKind::Unstable { .. })).count();
        modes.truncate(count.max(unstable));
        Ok(modes)
    }

    /// Refuses nodes that are free and have no mass.
    fn check_positive(&self, mass: &SparseMatrix) -> Result<(), FemError> {
        let diagonal = mass.diagonal();
        let free = |dof: &usize| !self.supports.fixed()[*dof];
        let massive = |mass: f64| mass.is_finite() && mass > 0.0;
        let Some(dof) = (0..diagonal.len()).filter(free).find(|&dof| !massive(diagonal[dof])) else { return Ok(()) };
        let node = dof / self.discretization().dim();
        let what = format!("vibrations need a mass, but node {node} has none; give the body a density (inertia)");
        Err(FemError::Meaningless { what })
    }
}
