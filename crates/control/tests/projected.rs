//! A body whose displacements are combinations of given modes (a Galerkin projection), as another implementor of [`Body`]: u = V q, V^T r(V q, m) = 0.

use crate::designs::Outcome;
use nalgebra::{DMatrix, DVector};
use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Body, Controls, Demand, FemError, Inadmissible, Instant, Solid, SolveOptions, SolveReport, State, StateError,
    StatePartials, Swept, Trajectory, Workspace,
};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Taylor};
use nastic_tensor::Vec3;
use std::sync::Arc;

/// Newton iterations, and halvings of a step, at most.
const MAX_ITERATIONS: usize = 60;
const MAX_HALVINGS: i32 = 30;

#[derive(Debug)]
struct Projection {
    solid: Solid,
    /// Columns of V, zero on supports.
    modes: DMatrix<f64>,
}

impl Projection {
    fn instant<'a>(u: &'a [f64], controls: &'a Controls) -> Instant<'a> {
        Instant::new(u, controls, 1.0)
    }

    /// `V^T r`.
    fn residual(&self, u: &[f64], controls: &Controls) -> Result<(DVector<f64>, f64), Inadmissible> {
        let demand = Demand { energy: true, force: true };
        let sums = self.solid.model().evaluate(&Self::instant(u, controls), demand)?;
        Ok((self.modes.tr_mul(&DVector::from_vec(sums.force)), sums.energy))
    }

    /// `V^T K V`.
    fn tangent(&self, u: &[f64], controls: &Controls) -> Result<DMatrix<f64>, Inadmissible> {
        let mut tangent = self.solid.model().tangents().matrix();
        self.solid.model().tangents().add_tangent(&Self::instant(u, controls), &mut tangent)?;
        let mut images = self.modes.clone();
        for (mode, mut image) in self.modes.column_iter().zip(images.column_iter_mut()) {
            tangent.multiply(mode.as_slice(), image.as_mut_slice());
        }
        Ok(self.modes.tr_mul(&images))
    }

    fn failed(&self, at: Inadmissible) -> StateError {
        StateError::inadmissible(at, 1.0, 0, Box::new(self.solid.rest()))
    }
}

impl Body for Projection {
    fn name(&self) -> &str {
        "projection"
    }

    fn solve(&self, controls: &Controls, how: &SolveOptions, _: &mut Workspace) -> Result<State, StateError> {
        let mut q = DVector::zeros(self.modes.ncols());
        if let Some(near) = how.near {
            q = self.modes.tr_mul(&DVector::from_column_slice(&near.u));
        }
        let at = |q: &DVector<f64>| (&self.modes * q).as_slice().to_vec();
        let failed = |error| self.failed(error);
        let (mut residual, mut energy) = self.residual(&at(&q), controls).map_err(failed)?;
        let mut newton = 0;
        for _ in 0..MAX_ITERATIONS {
            let tangent = self.tangent(&at(&q), controls).map_err(failed)?;
            let step = tangent.cholesky().map(|factor| factor.solve(&-&residual));
            let step = step.unwrap_or_else(|| -&residual / residual.norm());
            newton += 1;
            let slope = residual.dot(&step);
            let trial = (0..MAX_HALVINGS).find_map(|k| {
                let trial = &q + 0.5_f64.powi(k) * &step;
                let (r, e) = self.residual(&at(&trial), controls).ok()?;
                (e <= energy + 1e-4 * 0.5_f64.powi(k) * slope + 1e-13 * energy.abs()).then_some((trial, r, e))
            });
            let Some((next, r, e)) = trial else { break };
            (q, residual, energy) = (next, r, e);
            if step.norm() < 1e-13 {
                break;
            }
        }
        let report = SolveReport { newton, energy, min_j: 1.0, ..SolveReport::default() };
        Ok(State::equilibrium(at(&q), controls.clone(), 1.0, report))
    }

    fn adjoint(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        _: &SolveOptions,
        _: &mut Workspace,
    ) -> Result<Swept, StateError> {
        let (state, by_u) = (trajectory.end(), &partials[0].u);
        let failed = |error| self.failed(error);
        let tangent = self.tangent(&state.u, &state.controls).map_err(failed)?;
        let rhs = -self.modes.tr_mul(&DVector::from_column_slice(by_u));
        let singular = || FemError::Meaningless { what: "the projected tangent is singular".to_owned() };
        let q = tangent.lu().solve(&rhs).ok_or_else(singular)?;
        let lambda = (&self.modes * q).as_slice().to_vec();
        let at = Self::instant(&state.u, &state.controls);
        let found = self.solid.model().vjp(&at, &lambda).map_err(failed)?;
        Ok(Swept { lambda: vec![lambda], controls: vec![found.controls], report: SolveReport::default() })
    }

    fn negative_pivots(&self, state: &State, _: &SolveOptions) -> Result<usize, StateError> {
        let tangent = self.tangent(&state.u, &state.controls).map_err(|error| self.failed(error))?;
        Ok(tangent.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count())
    }
}

fn bar() -> Outcome<Solid> {
    let fibers = FiberTension::along(Vec3::x())?;
    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [6, 2, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::new(1e5, 4e5)?)?
        .actuate("body", "tension", fibers)?;
    Ok(body.clamp("x-")?.body_force("body", Vec3::new(0.0, 0.0, -2e3))?)
}

fn problem() -> Outcome<Reduced> {
    let target = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.04 * x[0]]);
    Ok(Reduced::new(bar()?).control("tension", Space::Cell)?.cost(Tracking::surface("x+", target))?)
}

/// The lowest modes at rest, orthonormal; of all free unknowns their unit vectors.
fn projection(count: Option<usize>) -> Outcome<Projection> {
    let solid = bar()?;
    let rest = solid.rest();
    let modes = match count {
        Some(count) => {
            let found = solid.modes(&rest, count, &SolveOptions::default())?;
            let columns: Vec<_> = found.shapes.into_iter().map(DVector::from_vec).collect();
            DMatrix::from_columns(&columns).qr().q()
        }
        None => {
            let fixed = solid.model().supports.fixed();
            let free: Vec<usize> = (0..rest.u.len()).filter(|&dof| !fixed[dof]).collect();
            DMatrix::from_fn(rest.u.len(), free.len(), |row, k| f64::from(u8::from(free[k] == row)))
        }
    };
    Ok(Projection { solid, modes })
}

fn tensions(problem: &Reduced) -> Vec<f64> {
    (0..problem.layout().len()).map(|cell| -2e4 * (1.0 + 0.3 * (cell as f64).sin())).collect()
}

#[test]
fn a_projection_on_all_unknowns_is_the_body_itself() -> Outcome {
    let (own, projected) = (problem()?, problem()?.projected(Arc::new(projection(None)?))?);
    let m = tensions(&own);
    let (a, b) = (own.at(&m)?, projected.at(&m)?);
    let apart = a.state().u.iter().zip(b.state().u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
    let derivative = |problem: &Reduced, point| problem.derivative_of_term(point, 0, &mut Default::default());
    let (a, b) = (derivative(&own, &a)?, derivative(&projected, &b)?);
    let size = a.iter().map(|d| d * d).sum::<f64>().sqrt();
    let apart = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!(apart < 1e-7 * size, "{apart:e} of {size:e}");
    Ok(())
}

#[test]
fn derivatives_of_a_projection_are_those_of_its_own_equilibria() -> Outcome {
    let projected = problem()?.projected(Arc::new(projection(Some(8))?))?;
    let m = tensions(&projected);
    let bounds = Bounds::new(vec![-6e4; m.len()], vec![0.0; m.len()])?;
    let report = Taylor { directions: 2, ..Taylor::default() }.test(&projected, &bounds, &m)?;
    assert!(report.passed() && report.directions.iter().all(|along| along.order1 > 1.95), "{report}");
    Ok(())
}

#[test]
fn more_modes_lead_nearer_to_the_body_and_all_to_it() -> Outcome {
    let own = problem()?;
    let m = tensions(&own);
    let exact = own.at(&m)?;
    let error = |count: usize| -> Outcome<f64> {
        let found = problem()?.projected(Arc::new(projection(Some(count))?))?.at(&m)?;
        Ok(found.state().u.iter().zip(exact.state().u.iter()).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    };
    let errors = [error(4)?, error(16)?, error(162)?];
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 1e-7, "{errors:?}");
    Ok(())
}

/// What a body answers is looked at.
#[test]
fn answers_that_are_no_states_are_refused() -> Outcome {
    #[derive(Debug)]
    struct Short(Projection);
    impl Body for Short {
        fn name(&self) -> &str {
            "short"
        }

        fn solve(&self, controls: &Controls, how: &SolveOptions, with: &mut Workspace) -> Result<State, StateError> {
            let state = self.0.solve(controls, how, with)?;
            Ok(State { u: state.u[1..].to_vec().into(), ..state })
        }

        fn adjoint(
            &self,
            trajectory: &Trajectory,
            partials: &[StatePartials],
            how: &SolveOptions,
            with: &mut Workspace,
        ) -> Result<Swept, StateError> {
            self.0.adjoint(trajectory, partials, how, with)
        }

        fn negative_pivots(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError> {
            self.0.negative_pivots(state, how)
        }
    }
    let problem = problem()?.projected(Arc::new(Short(projection(Some(4))?)))?;
    let refused = problem.at(&tensions(&problem)).map(drop).unwrap_err().to_string();
    assert!(refused.contains("short") && refused.contains("found no state"), "{refused}");
    Ok(())
}

#[test]
fn what_is_the_models_alone_is_refused_by_name() -> Outcome {
    let projected = problem()?.projected(Arc::new(projection(Some(4))?))?;
    let m = tensions(&projected);
    let point = projected.at(&m)?;
    let refused = projected.hessian_vector(&point, &m, &mut Default::default());
    let message = refused.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(message.contains("second derivatives") && message.contains("projection"), "{message}");
    Ok(())
}
