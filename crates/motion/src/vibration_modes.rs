//! [`VibrationMode`]: small vibrations about an equilibrium.

use nastic_body::error::{FemError, StateError};
use nastic_body::state::State;
use nastic_equilibrium::model::{Feature, Model};
use nastic_equilibrium::search::options::SolveOptions;
use nastic_equilibrium::stability::modes::normalized;
use nastic_linear::{MassMatrix, SparseMatrix};

/// A solution `u + phi exp(i w t)` of the undamped motion about an equilibrium u, linearised: `K phi = w^2 M phi`, K
/// the static tangent at u with its loads and controls, M the mass of the model, consistent or lumped as its
/// [`Inertia`](nastic_forces::inertia::Inertia) is.
#[derive(Debug, Clone, PartialEq)]
pub struct VibrationMode {
    /// `w^2` in 1/s^2; negative where the equilibrium is not stable.
    pub square: f64,
    /// What rounding of the tangent may change `w^2` by.
    pub rounding: f64,
    /// Whether the pivots of a factor show that no lower one is missing, as [`Modes::counted`](nastic_equilibrium::stability::modes::Modes::counted).
    pub counted: bool,
    /// Of modes without a factor: the iterations that found all of them, and the relative error of the shape
    /// ([`ByProducts`](nastic_linear::ByProducts)).
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

/// [`TimeStepping::vibration_modes`](crate::TimeStepping::vibration_modes).
pub(crate) fn vibration_modes(
    model: &Model,
    state: &State,
    count: usize,
    how: &SolveOptions,
) -> Result<Vec<VibrationMode>, StateError> {
    model.properties().refuse_further_fields(Feature::Motion, "vibration modes")?;
    let (dim, mut mass) = (model.discretization().dim(), model.energies().mass_under(&state.controls)?);
    mass.eliminate(model.supports.fixed(), 0.0);
    check_positive(model, &mass)?;
    let found = model.stability().lowest_modes(state, MassMatrix::Sparse(&mass), count, how)?;
    let (counted, how_found) = (found.counted, found.by_products);
    let pairs = found.values.into_iter().zip(found.rounding).zip(found.vectors);
    let mode = |(k, ((square, rounding), vector)): (usize, ((f64, f64), Vec<f64>))| {
        let by_products = how_found.as_ref().and_then(|found| Some((found.iterations, *found.errors.get(k)?)));
        let shape = normalized(vector);
        let mut momentum = vec![0.0; shape.len()];
        mass.multiply_on(&shape, &mut momentum, how.parallel);
        let modal_mass = model.unknowns().dot(&shape, &momentum);
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
fn check_positive(model: &Model, mass: &SparseMatrix) -> Result<(), FemError> {
    let diagonal = mass.diagonal();
    let free = |dof: &usize| !model.supports.fixed()[*dof];
    let massive = |mass: f64| mass.is_finite() && mass > 0.0;
    let Some(dof) = (0..diagonal.len()).filter(free).find(|&dof| !massive(diagonal[dof])) else { return Ok(()) };
    let node = dof / model.discretization().dim();
    let what = format!("vibrations need a mass, but node {node} has none; give the body a density (inertia)");
    Err(FemError::Meaningless { what })
}
