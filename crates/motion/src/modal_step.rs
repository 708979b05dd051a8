//! [`ModalStep`]: the lowest modes over a step, from the exact solution of their linearised equations.

use nalgebra::DMatrix;
use nastic_body::contribution::Demand;
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, StateError};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use nastic_linear::{MassMatrix, Space};
use nastic_numeric::vector::axpy;
use std::sync::Arc;

/// What the modes `W^T M W = 1`, `K W = M W diag(lambda)` of the tangent at the beginning of a step do until its end: with
/// displacements `u_n + W q + ..` the solution of
///
/// ```text
/// q'' + W^T C W q' + diag(lambda) q = -W^T r(u_n, 0, 0; m_{n+1}),    q(0) = 0,    q'(0) = W^T M v_n
/// ```
///
/// by the exponential of its matrix. Of damping that couples them with the other modes they feel their own part alone.
pub(crate) struct ModalStep {
    space: Arc<Space>,
    /// W, zero on the supports.
    shapes: Vec<Vec<f64>>,
    /// `M W`.
    momenta: Vec<Vec<f64>>,
    /// `q(h)`
    displacement: Vec<f64>,
    /// `q'(h)`
    velocity: Vec<f64>,
    dt: f64,
}

/// The `count` lowest modes, and all unstable ones, over a step from a state under these controls.
///
/// # Errors
/// As [`modes`](Self::modes).
pub(crate) fn modal_step(
    model: &Model,
    count: usize,
    begin: &State,
    controls: &Controls,
    step: &TimeStep,
    how: &SolveOptions,
) -> Result<ModalStep, StateError> {
    let mut mass = model.energies().mass_under(controls)?;
    mass.eliminate(model.supports.fixed(), 0.0);
    let history = step.history.clone();
    let state = State { controls: Arc::new(controls.clone()), history, ..begin.clone() };
    let free = model.supports.fixed().iter().filter(|fixed| !**fixed).count();
    let modes = model.stability().lowest_modes(
        &state,
        MassMatrix::Sparse(&mass),
        count.min(free),
        &model.stability().counting(how),
    )?;
    let times_mass = |x: &[f64]| {
        let mut out = vec![0.0; x.len()];
        mass.multiply_on(x, &mut out, how.parallel);
        out
    };
    let momenta: Vec<Vec<f64>> = modes.vectors.iter().map(|shape| times_mass(shape)).collect();
    let inverted = |at: Inadmissible| StateError::inadmissible(at, 1.0, 0, Box::new(begin.clone()));
    let at = Instant { parallel: how.parallel, remembered: &step.history, ..Instant::new(&begin.u, controls, 1.0) };
    let force = model.evaluate(&at, Demand { energy: false, force: true }).map_err(inverted)?.force;
    let mut damping = DMatrix::zeros(momenta.len(), momenta.len());
    for (k, shape) in modes.vectors.iter().enumerate() {
        // the transpose of C, which is symmetric
        let damped = model.vjp(&at.in_step(step), shape).map_err(inverted)?.velocity;
        modes.vectors.iter().enumerate().for_each(|(i, other)| damping[(i, k)] = model.unknowns().dot(other, &damped));
    }
    let begins = begin.velocity.as_deref().map_or(&[][..], Vec::as_slice);
    let along = |v: &[f64], by: &[f64]| if by.is_empty() { 0.0 } else { model.unknowns().dot(v, by) };
    let start: Vec<f64> = momenta.iter().map(|momentum| along(momentum, begins)).collect();
    let push: Vec<f64> = modes.vectors.iter().map(|shape| -model.unknowns().dot(shape, &force)).collect();
    let (displacement, velocity) = oscillation(step.dt, &modes.values, &damping, &start, &push);
    Ok(ModalStep {
        shapes: modes.vectors,
        momenta,
        displacement,
        velocity,
        dt: step.dt,
        space: model.unknowns().clone(),
    })
}

impl ModalStep {
    /// Puts the exact displacement in the place of the modes' part of a step.
    pub fn replace(&self, step: &mut [f64]) {
        let parts: Vec<f64> = self.momenta.iter().map(|momentum| self.space.dot(momentum, step)).collect();
        for ((shape, part), q) in self.shapes.iter().zip(parts).zip(&self.displacement) {
            axpy(q - part, shape, step);
        }
    }

    /// The same for a velocity that is the step over its length.
    pub fn replace_rate(&self, velocity: &mut [f64]) {
        for ((shape, q), rate) in self.shapes.iter().zip(&self.displacement).zip(&self.velocity) {
            axpy(rate - q / self.dt, shape, velocity);
        }
    }
}

/// q and q' at h of `q'' + C q' + diag(values) q = push`, `q(0) = 0`, `q'(0) = start`.
///
/// Of `y = (s q, q')`, s = sqrt |lambda| or 1/h if that is more, the matrix is skew but for damping: powers of its exponential do not grow.
fn oscillation(h: f64, values: &[f64], damping: &DMatrix<f64>, start: &[f64], push: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = values.len();
    let scale: Vec<f64> = values.iter().map(|value| value.abs().sqrt().max(1.0 / h)).collect();
    let mut matrix = DMatrix::zeros(2 * n + 1, 2 * n + 1);
    for i in 0..n {
        matrix[(i, n + i)] = h * scale[i];
        matrix[(n + i, i)] = -h * values[i] / scale[i];
        (0..n).for_each(|k| matrix[(n + i, n + k)] = -h * damping[(i, k)]);
        matrix[(n + i, 2 * n)] = h * push[i];
    }
    let flow = matrix.exp();
    let end = |i: usize| (0..n).map(|k| flow[(i, n + k)] * start[k]).sum::<f64>() + flow[(i, 2 * n)];
    ((0..n).map(|i| end(i) / scale[i]).collect(), (0..n).map(|i| end(n + i)).collect())
}
