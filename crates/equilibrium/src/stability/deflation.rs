//! [`Equilibria`]: several equilibria under the same controls and loads, by deflation.

use crate::linear_systems::workspace::Workspace;
use crate::model::views::Stability;
use crate::model::{Feature, Model};
use crate::nonlinear::direction::deflated::{Deflated, Known};
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Iteration, Limits};
use crate::search::options::SolveOptions;
use nastic_body::contribution::Demand;
use nastic_body::error::{FemError, StateError};
use nastic_body::instant::Instant;
use nastic_body::state::{SolveReport, State};
use nastic_numeric::vector::axpy;

/// Equilibria under the same controls and loads, all different.
#[derive(Debug, Clone)]
pub struct Equilibria {
    /// The one that was known, then the others in the order they were found.
    pub found: Vec<Equilibrium>,
    /// Starts of the deflated iteration that were tried.
    pub starts: usize,
    /// Newton iterations of all of them.
    pub newton: usize,
}

/// One of several equilibria.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    /// The equilibrium; its report has the potential.
    pub state: State,
    /// Negative pivots of its tangent; `None` where the tangent is singular or not symmetric.
    pub negative: Option<usize>,
}

/// Modes of a known equilibrium along which starts are displaced, to both sides.
const MODES_PER_STATE: usize = 3;
/// Largest displacement along a mode at which the potential is evaluated, as a share of the body's diagonal.
const MAX_AMPLITUDE: f64 = 0.5;
/// Ratio of one displacement to the one before.
const AMPLITUDE_GROWTH: f64 = 1.25;
/// Number of displacements along a mode.
const AMPLITUDE_SAMPLES: usize = 48;
/// Further amplitudes along a mode, as shares of the body's diagonal.
const FURTHER_AMPLITUDES: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
/// Newton iterations from one start. (Twice as many found more states of nearly inverted cells, not the others sooner.)
const MAX_ITERATIONS: usize = 40;
/// The same for nearly incompressible bodies, which move slowly along the states of constant volume.
const MAX_ITERATIONS_STIFF: usize = 80;
/// Ratio of bulk to shear modulus above which a body is nearly incompressible here.
const MIN_STIFF_RATIO: f64 = 200.0;

impl Model {
    fn with_inertia(&self, state: State, how: &SolveOptions) -> Equilibrium {
        let negative = self.stability().negative_pivots_by(&state, how).ok();
        Equilibrium { state, negative }
    }

    /// Displacements `u + a phi` along the soft modes phi of an equilibrium to start from: first those where the
    /// potential is stationary along the mode, then some of fixed amplitudes, of either those of lower potential first.
    fn starts(&self, state: &State, how: &SolveOptions) -> Result<Vec<Vec<f64>>, StateError> {
        let free = self.supports.fixed().iter().filter(|&&fixed| !fixed).count();
        let modes = self.stability().modes(state, MODES_PER_STATE.min(free), &self.stability().counting(how))?;
        let size = self.discretization().mesh().diagonal();
        let (mut stationary, mut further) = (Vec::new(), Vec::new());
        for shape in &modes.shapes {
            for side in [1.0, -1.0] {
                let displaced = |share: f64| {
                    let mut u = state.u.to_vec();
                    axpy(side * share * size, shape, &mut u);
                    let energy = self.energy_beside(&u, state, how);
                    (energy, u)
                };
                let sample = |k: usize| {
                    displaced(MAX_AMPLITUDE * AMPLITUDE_GROWTH.powi(k as i32 + 1 - AMPLITUDE_SAMPLES as i32))
                };
                let energies: Vec<f64> = (0..AMPLITUDE_SAMPLES).map(|k| sample(k).0).collect();
                let turns = |k: &usize| (energies[*k] - energies[k - 1]) * (energies[k + 1] - energies[*k]) < 0.0;
                stationary.extend((1..AMPLITUDE_SAMPLES - 1).filter(turns).map(sample));
                further.extend(FURTHER_AMPLITUDES.map(displaced));
            }
        }
        let ordered = |mut starts: Vec<(f64, Vec<f64>)>| {
            starts.retain(|(energy, _)| energy.is_finite());
            starts.sort_by(|a, b| a.0.total_cmp(&b.0));
            starts.into_iter().map(|(_, u)| u)
        };
        Ok(ordered(stationary).chain(ordered(further)).collect())
    }

    /// The potential under the controls, the load and the multipliers of a state; infinite where a cell inverts, and
    /// where another contribution refuses the straight move from it.
    pub(crate) fn energy_beside(&self, u: &[f64], state: &State, how: &SolveOptions) -> f64 {
        let at = |u| Instant { parallel: how.parallel, ..Instant::new(u, &state.controls, state.load) };
        if !self.moves().admissible_move_of_others(&at(&state.u), u).is_ok_and(|share| share >= 1.0) {
            return f64::INFINITY;
        }
        let sums = self.evaluate(&at(u), Demand { energy: true, force: false });
        sums.map_or(f64::INFINITY, |sums| sums.energy)
    }

    /// From u to an equilibrium; `None` where it is one that is known.
    fn deflated(
        &self,
        known: &[Equilibrium],
        mut u: Vec<f64>,
        how: &SolveOptions,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<State>, Stop> {
        let first = &known[0].state;
        let equations = self.equations(&first.controls, first.load, None, 1.0, how);
        let known = Known::new(&equations, known.iter().map(|known| &known.state).collect());
        let solver = self.linear_solver(how, workspace);
        let mut direction = Deflated::new(&equations, &mut u, &known, solver);
        let most = if self.properties().bulk_over_shear(&first.controls) > MIN_STIFF_RATIO {
            MAX_ITERATIONS_STIFF
        } else {
            MAX_ITERATIONS
        };
        Iteration::new(&equations, Limits::new(most, how.accuracy)).run(&mut u, &mut direction, report)?;
        let report = SolveReport { load_steps: 1, ..*report };
        let new = !known.contains(&u);
        Ok(new.then(|| State::equilibrium(u, (*first.controls).clone(), first.load, report)))
    }
}

impl Stability<'_> {
    /// Up to `count` equilibria under the controls and the load of one that is known, itself included.
    ///
    /// Newton's method for the deflated residual, which has no zero at the equilibria u_i that are known,
    ///
    /// ```text
    /// m(u) r(u) = 0,    m(u) = prod_i (1 / |u - u_i|^2 + 1),    |v|^2 = sum_a V_a v_a . v_a / (V l^2)
    /// ```
    ///
    /// (V_a the volumes of the nodes, l a tenth of the body's diagonal). Its step is Newton's, `K d = -r`, times `1 /
    /// (1 - (grad log m) . d)`. Farrell, Birkisson, Funke, "Deflation techniques for finding distinct solutions of
    /// nonlinear partial differential equations", SIAM J. Sci. Comput. 37 (2015). It starts on the straight lines from
    /// the known equilibria along their three softest modes: where the potential is stationary on them, then 1, 3, 10
    /// and 30 hundredths of the diagonal away. Every equilibrium found adds its own starts. What is not found may exist
    /// all the same; what is found is an equilibrium of the discrete body, and a coarse mesh has some of its own.
    ///
    /// `watch` is called with every equilibrium, the known one first.
    ///
    /// # Errors
    /// A count of zero; a state of another body; [`StateError::Cancelled`] (`watch` has seen what was found before);
    /// modes that cannot be had, see [`modes`](Self::modes).
    pub fn equilibria(
        &self,
        known: &State,
        count: usize,
        how: &SolveOptions,
        workspace: &mut Workspace,
        watch: &mut dyn FnMut(&Equilibrium),
    ) -> Result<Equilibria, StateError> {
        self.model.checks().check_held()?;
        self.model.properties().supports(Feature::Deflation)?;
        self.model.checks().check_state(known)?;
        self.model.moves().check_start(known, how.parallel)?;
        if count == 0 {
            return Err(
                FemError::Meaningless { what: "no equilibria are asked for; ask for 1 or more".to_owned() }.into()
            );
        }
        let first = self.model.with_inertia(known.clone(), how);
        watch(&first);
        let mut all = Equilibria { found: vec![first], starts: 0, newton: 0 };
        let mut from = 0;
        while from < all.found.len() && all.found.len() < count {
            for start in self.model.starts(&all.found[from].state, how)? {
                all.starts += 1;
                let mut report = SolveReport::default();
                let found = self.model.deflated(&all.found, start, how, workspace, &mut report);
                all.newton += report.newton;
                match found {
                    Ok(Some(state)) => {
                        let next = self.model.with_inertia(state, how);
                        watch(&next);
                        all.found.push(next);
                    }
                    Ok(None) => workspace.forget(),
                    // Another start may lead somewhere.
                    Err(stop) => match stop.final_error() {
                        Some(error) => return Err(error),
                        None => workspace.forget(),
                    },
                }
                if all.found.len() == count {
                    break;
                }
            }
            from += 1;
        }
        Ok(all)
    }
}
