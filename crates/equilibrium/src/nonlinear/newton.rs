//! Equilibria by the [iteration](super::iteration) with the direction that suits a model.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Moves;
use crate::nonlinear::direction::bordered::Bordered;
use crate::nonlinear::direction::linearised::{Linearised, StepCorrection};
use crate::nonlinear::direction::plain::Plain;
use crate::nonlinear::direction::point_strains::WithPointStrains;
use crate::nonlinear::direction::rigid::AlongRigidMotions;
use crate::nonlinear::equations::{Drive, Equations};
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Iteration, Limits};
use crate::nonlinear::predicted_pressures::PredictedPressures;
use crate::search::options::SolveOptions;
use nastic_body::contribution::Sums;
use nastic_body::controls::Controls;
use nastic_body::error::StateError;
use nastic_body::instant::TimeStep;
use nastic_body::state::{SolveReport, State};
use nastic_body::strategy::Strategy;
use nastic_linear::LinearSolver;
use nastic_linear::solver::Curvature;

/// Iterations of an attempt with point strains.
const MAX_POINT_STRAIN_ITERATIONS: usize = 40;
/// Relative residual from which Newton's method on displacements takes over.
const POINT_STRAIN_TOLERANCE: f64 = 1e-6;
/// Rounding of the potential, as a share of the sum of its absolute terms.
const ENERGY_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Iterations of an attempt with predicted pressures.
const MAX_PREDICTED_ITERATIONS: usize = 25;
/// Shifted tangents of such an attempt.
const MAX_PREDICTED_SHIFTS: usize = 8;

impl Equations<'_> {
    /// From x to equilibrium, with the curvature of the last tangent (positive where none was needed); on failure x is the
    /// last iterate.
    pub fn solve(
        &self,
        x: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        self.solve_either_way(Limits::new(self.options.max_newton, self.options.accuracy), x, solver, report)
    }

    /// The same within limits where predicted pressures are not used or do not converge.
    pub fn solve_either_way(
        &self,
        limits: Limits,
        x: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        if let Some(last) = self.solve_with_pressures(x, &mut *solver, report)? {
            return Ok(last);
        }
        self.solve_within(limits, x, solver, report)
    }

    /// The same by the tangents of the displacement alone.
    pub fn solve_by_displacement(
        &self,
        x: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        self.solve_within(Limits::new(self.options.max_newton, self.options.accuracy), x, solver, report)
    }

    /// The same within limits.
    pub fn solve_within(
        &self,
        limits: Limits,
        x: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        if self.stays_rigid() {
            let mut direction = AlongRigidMotions::new(self, x, solver);
            return Iteration::new(self, limits).run(x, &mut direction, report);
        }
        if self.model.unknowns().multipliers() > 0 {
            let mut direction = Bordered::new(self, x, solver);
            return Iteration::new(self, limits).run(x, &mut direction, report);
        }
        let mut direction = Plain::new(self, x, solver);
        Iteration::new(self, limits).run(x, &mut direction, report)
    }

    /// From x to an equilibrium of less potential with predicted pressures; `None`, and x unchanged, where they are not used or do not converge.
    pub fn solve_with_pressures(
        &self,
        x: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Option<Curvature>, Stop> {
        // a tangent by products of cells would have to be assembled
        let of_entries = !(solver.state().takes_products && self.model.tangents().has_cell_products());
        let predicts = of_entries && self.predicts_pressures();
        let Some(pressures) = predicts.then(|| PredictedPressures::new(self)).flatten() else {
            return Ok(None);
        };
        report.strategies.count(Strategy::PredictedPressures);
        let (from, moves) = (x.clone(), self.jump(x).is_some());
        // at most half of the remaining budget
        let left = self.options.budget.map_or(usize::MAX, |budget| budget.saturating_sub(report.newton));
        let most = MAX_PREDICTED_ITERATIONS.min(self.options.max_newton).min(left / 2);
        let limits = Limits::new(most, self.options.accuracy);
        let limits = Limits { max_shifted_iterations: 0, max_shifts: MAX_PREDICTED_SHIFTS, ..limits };
        let mut direction = Plain::new(self, x, &mut *solver).with_pressures(pressures);
        let start = if moves { Ok(None) } else { self.evaluate(x).map(|start| Some(start.sums)) };
        let run = start.map_err(Stop::from).and_then(|start| {
            let last = Iteration::new(self, limits).run(x, &mut direction, report)?;
            let lower = start.is_none_or(|start| report.energy <= start.energy + rounding(&start));
            let sound = lower && last != Curvature::Negative;
            if sound { Ok(last) } else { Err(Stop::Slow { residual: report.residual }) }
        });
        match run {
            Ok(last) => Ok(Some(last)),
            Err(stop) if stop.is_final() => Err(stop),
            Err(_) => {
                report.unpredicted += 1;
                solver.clear();
                *x = from;
                Ok(None)
            }
        }
    }

    /// Whether steps may predict pressures: the search along them needs a potential.
    fn predicts_pressures(&self) -> bool {
        let unknowns = self.model.unknowns();
        let plain =
            unknowns.multipliers() == 0 && unknowns.has_one_nodal_field() && !self.model.ranks().is_over_ranks();
        plain && self.has_potential() && self.anchor.is_none()
    }

    /// From u, whose prescribed components are in place, to an equilibrium of less potential by independent strains at the quadrature
    /// points; on failure u is the last iterate.
    pub fn solve_with_point_strains(
        &self,
        u: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let start = self.evaluate(u)?.sums;
        let moves = self.jump(u).is_some() || self.model.unknowns().multipliers() > 0;
        // any number of tangents may be indefinite
        let limits = Limits {
            max_shifted_iterations: usize::MAX,
            ..Limits::new(MAX_POINT_STRAIN_ITERATIONS.min(self.options.max_newton), POINT_STRAIN_TOLERANCE)
        };
        let mut direction = WithPointStrains::new(self, u, &mut *solver)?;
        let curvature = Iteration::new(self, limits).run(u, &mut direction, report)?;
        let residual = report.residual;
        let last = self.solve_by_displacement(u, solver, report)?;
        let sound = curvature == Curvature::Positive && last == Curvature::Positive;
        let lower = sound && (moves || report.energy <= start.energy + rounding(&start));
        if lower { Ok(()) } else { Err(Stop::Slow { residual }) }
    }
}

impl Model {
    /// The equations of an equilibrium under controls and a load.
    pub(crate) fn equations<'a>(
        &'a self,
        controls: &'a Controls,
        load: f64,
        time_step: Option<&'a TimeStep>,
        share: f64,
        options: &'a SolveOptions<'a>,
    ) -> Equations<'a> {
        Equations {
            model: self,
            drive: Drive::Held { controls, load, time_step, share },
            options,
            anchor: None,
            flat_contacts: false,
        }
    }
}

/// Rounding of a potential.
fn rounding(sums: &Sums) -> f64 {
    ENERGY_ROUNDING * (sums.energy_scale + sums.energy.abs())
}

impl Moves<'_> {
    /// The solution of the equations of a time step, linearised at a state: `u - K^-1 r`, a whole step, except for the part that `replace` changes. The report has the remaining
    /// residual.
    ///
    /// # Errors
    /// [`StateError::Inadmissible`] where J <= 0 there, [`StateError::NoConvergence`] where the whole step is not admissible,
    /// [`StateError::Linear`] where K is not positive definite.
    pub fn iterate_once(
        &self,
        controls: &Controls,
        from: &State,
        how: &SolveOptions,
        time_step: &TimeStep,
        replace: Option<StepCorrection>,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        self.model.checks().check_controls(controls)?;
        if how.cancelled() {
            return Err(StateError::Cancelled);
        }
        let equations = self.model.equations(controls, 1.0, Some(time_step), 1.0, how);
        let mut report = SolveReport { load_steps: 1, ..SolveReport::default() };
        let mut u = from.u.to_vec();
        let mut direction =
            Linearised { equations: &equations, replace, solver: self.model.linear_solver(how, workspace) };
        let limits = Limits::new(1, how.accuracy);
        match Iteration::new(&equations, limits).once(&mut u, &mut direction, &mut report) {
            Ok(()) => Ok(State::equilibrium(u, controls.clone(), 1.0, report)),
            Err(stop) => {
                workspace.forget();
                Err(stop.into_error(report.newton, from))
            }
        }
    }
}
