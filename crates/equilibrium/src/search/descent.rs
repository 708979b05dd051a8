//! [`Descent`]: from an unstable equilibrium to a minimum of the potential.

use crate::linear_systems::workspace::Workspace;
use crate::model::views::Stability;
use crate::model::{Feature, Model};
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::Stop;
use crate::search::options::SolveOptions;
use nastic_body::error::{Cause, FemError, StateError};
use nastic_body::state::{SolveReport, State};
use nastic_numeric::vector::axpy;

/// A stable equilibrium below one that was not.
#[derive(Debug, Clone)]
pub struct Descent {
    /// The equilibrium; its report counts the work of the whole descent.
    pub state: State,
    /// How often it left a saddle: 0 where the first state was stable.
    pub saddles: usize,
}

/// Saddles from which it descends before it is given up.
const MAX_SADDLES: usize = 10;
/// Smallest displacement along a mode at which the potential is evaluated, as a share of the body's diagonal.
const MIN_DISPLACEMENT_RATIO: f64 = 1e-6;
/// Largest displacement along a mode, likewise.
const MAX_DISPLACEMENT_RATIO: f64 = 0.5;
/// Ratio of one displacement to the one before.
const DISPLACEMENT_GROWTH: f64 = 1.5;
/// Starts, as multiples of the displacement at which the potential is least: slender bodies stretch along the straight line,
/// so that this displacement is nearer to the saddle than the equilibrium is.
const START_MULTIPLES: [f64; 4] = [1.0, 3.0, 10.0, 30.0];
/// Decreases of the potential whose difference is below this share count as equal.
const ENERGY_TOLERANCE: f64 = 1e-6;

impl Model {
    /// An equilibrium of less potential, on either side of a saddle along a mode.
    fn below(
        &self,
        saddle: &State,
        mode: &[f64],
        how: &SolveOptions,
        workspace: &mut Workspace,
        work: &mut SolveReport,
    ) -> Result<Option<State>, StateError> {
        let mut sides = [1.0, -1.0].map(|side| self.lowest_along(saddle, mode, side, how));
        if sides[1].0 < sides[0].0 - ENERGY_TOLERANCE * (saddle.report.energy - sides[0].0).abs() {
            sides.swap(0, 1);
        }
        for multiple in START_MULTIPLES {
            for (_, amplitude) in sides {
                let mut u = saddle.u.to_vec();
                axpy(multiple * amplitude, mode, &mut u);
                let (controls, mut report) = (&*saddle.controls, SolveReport::default());
                let newton = self.equations(controls, 1.0, None, 1.0, how);
                if !newton.admissible_chord(&saddle.u, &u).is_ok_and(|share| share >= 1.0) {
                    continue;
                }
                let found = self.down(&newton, &mut u, workspace, &mut report);
                work.add_work(&report);
                match found {
                    Ok(_) if report.energy < saddle.report.energy && differs(&u, saddle, amplitude) => {
                        return Ok(Some(State::equilibrium(u, controls.clone(), 1.0, without_work(&report))));
                    }
                    // Back at the saddle, or nowhere: another start may lead down.
                    Ok(_) => workspace.forget(),
                    Err(stop) => match stop.final_error() {
                        Some(error) => return Err(error),
                        None => workspace.forget(),
                    },
                }
            }
        }
        Ok(None)
    }

    /// To an equilibrium of less potential by displacements or, where these are slow, by independent strains at the quadrature points: along the straight
    /// line a nearly incompressible body changes its volume.
    fn down(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let start = u.clone();
        match newton.solve(u, self.linear_solver(newton.options, workspace), report) {
            Err(Stop::Slow { .. }) if self.suits_point_strains() => {
                workspace.forget();
                *u = start;
                newton.solve_with_point_strains(u, self.linear_solver(newton.options, workspace), report)
            }
            found => found.map(|_| ()),
        }
    }

    /// The least value of the potential along one side of a mode before a cell inverts or another contribution refuses the straight move, and at which multiple of the
    /// mode. Not the first minimum: near the saddle rounding makes many.
    fn lowest_along(&self, state: &State, mode: &[f64], side: f64, how: &SolveOptions) -> (f64, f64) {
        let size = self.discretization().mesh().diagonal();
        let mut best = (f64::INFINITY, side * MIN_DISPLACEMENT_RATIO * size);
        let mut share = MIN_DISPLACEMENT_RATIO;
        while share <= MAX_DISPLACEMENT_RATIO {
            let mut u = state.u.to_vec();
            axpy(side * share * size, mode, &mut u);
            let energy = self.energy_beside(&u, state, how);
            if energy == f64::INFINITY {
                break;
            }
            if energy < best.0 {
                best = (energy, side * share * size);
            }
            share *= DISPLACEMENT_GROWTH;
        }
        best
    }
}

fn not_found(last: State, newton: usize, cause: Cause) -> StateError {
    let (residual, last) = (last.report.residual, Box::new(last));
    StateError::NoConvergence { load: 1.0, cuts: 0, newton, residual, reached: 1.0, cause, budget: None, last }
}

/// What a report says of a state: the work is counted once, at the end.
fn without_work(report: &SolveReport) -> SolveReport {
    let SolveReport { solver, residual, min_j, energy, .. } = *report;
    SolveReport { solver, residual, min_j, energy, load_steps: 1, ..SolveReport::default() }
}

/// Whether a displacement is another one than that of a saddle: by more than a hundredth of the amplitude that left it.
fn differs(u: &[f64], saddle: &State, amplitude: f64) -> bool {
    u.iter().zip(saddle.u.iter()).any(|(u, v)| (u - v).abs() > 1e-2 * amplitude.abs())
}

impl Stability<'_> {
    /// A stable equilibrium under the controls of an unstable one, at full loads, by descent from it.
    ///
    /// Along the mode of the most negative eigenvalue (see [`modes`](Self::modes)) the potential falls to both sides.
    /// From where it is least on this line, and beyond, Newton's method lowers it to an equilibrium below the first;
    /// the lower side comes first (the one of the mode's sign, where they are alike). Where that is another saddle, it
    /// goes on from there.
    ///
    /// # Errors
    /// A state at another load than the full one, a model without a potential; [`StateError::NoConvergence`] with the
    /// last saddle and [`Cause::Saddle`] where no lower equilibrium is found, with the last state where ten saddles were left.
    pub fn descend(&self, state: &State, how: &SolveOptions, workspace: &mut Workspace) -> Result<Descent, StateError> {
        self.model.checks().check_held()?;
        self.model.properties().supports(Feature::Descent)?;
        self.model.checks().check_state(state)?;
        self.model.moves().check_start(state, how.parallel)?;
        if state.load != 1.0 {
            let what = "a descent needs a state at full loads".to_owned();
            return Err(FemError::Meaningless { what }.into());
        }
        let mut work = SolveReport::default();
        let mut here = state.clone();
        for saddles in 0..=MAX_SADDLES {
            let modes = self.modes(&here, 1, &self.counting(how))?;
            if modes.negative == 0 {
                here.report.add_work(&work);
                return Ok(Descent { state: here, saddles });
            }
            let Some(next) = self.model.below(&here, &modes.shapes[0], how, workspace, &mut work)? else {
                return Err(not_found(here, work.newton, Cause::Saddle { negative: modes.negative }));
            };
            here = next;
        }
        Err(not_found(here, work.newton, Cause::Unknown))
    }
}
