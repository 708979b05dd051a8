//! [`Equilibria`]: several equilibria under the same controls and loads, by deflation.

use crate::contributions::Demand;
use crate::contributions::instant::Instant;
use crate::error::{FemError, Inadmissible, StateError};
use crate::model::Model;
use crate::solution::options::{Progress, SolveOptions};
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::{TangentSystems, eliminate};
use crate::solution::workspace::Workspace;
use nastic_linear::{LinearError, SparseMatrix};
use nastic_numeric::vector::{axpy, dot, max_abs, norm};

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
const MODES: usize = 3;
/// Displacements along a mode at which the potential is looked at: the largest as a share of the body's diagonal, from
/// one to the next, and how many.
const LARGEST: f64 = 0.5;
const GROWTH: f64 = 1.25;
const SAMPLES: usize = 48;
/// Further amplitudes along a mode, as shares of the body's diagonal.
const AMPLITUDES: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
/// Newton iterations from one start.
const ITERATIONS: usize = 40;
/// Largest component of one step, as a share of the body's diagonal.
const LONGEST: f64 = 0.1;
/// The distance at which deflation is as strong as the shift, as a share of the body's diagonal.
const RANGE: f64 = 0.1;
/// Equilibria nearer than this share of the body's diagonal (root mean square) are the same.
const SAME: f64 = 1e-6;
/// A step shorter than this share of the body's size is below what double precision resolves.
const RESOLUTION: f64 = 1e-12;
/// Below this relative residual an iteration that does not halve it has met the limit of double precision.
const ROUNDING: f64 = 1e-10;

impl Model {
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
        self.check()?;
        let instead = "hold the multipliers found (pressures, tensions) as controls and look for equilibria there";
        self.refuse_constraints("other equilibria by deflation", instead)?;
        self.check_state(known)?;
        if count == 0 {
            return Err(
                FemError::Meaningless { what: "no equilibria are asked for; ask for 1 or more".to_owned() }.into()
            );
        }
        let first = self.with_inertia(known.clone(), how);
        watch(&first);
        let mut all = Equilibria { found: vec![first], starts: 0, newton: 0 };
        let mut from = 0;
        while from < all.found.len() && all.found.len() < count {
            for start in self.starts(&all.found[from].state, how)? {
                all.starts += 1;
                let (found, newton) = Deflation::new(self, &all.found, how).solve(start, workspace);
                all.newton += newton;
                match found {
                    Ok(state) => {
                        let next = self.with_inertia(state, how);
                        watch(&next);
                        all.found.push(next);
                    }
                    Err(Stop::Cancelled) => return Err(StateError::Cancelled),
                    Err(Stop::Problem(error)) => return Err(error.into()),
                    // Another start may lead somewhere.
                    Err(Stop::Failed) => workspace.forget(),
                }
                if all.found.len() == count {
                    break;
                }
            }
            from += 1;
        }
        Ok(all)
    }

    fn with_inertia(&self, state: State, how: &SolveOptions) -> Equilibrium {
        let negative = self.negative_pivots_by(&state, how).ok();
        Equilibrium { state, negative }
    }

    /// Displacements `u + a phi` along the soft modes phi of an equilibrium to start from: first those where the
    /// potential is stationary along the mode, then some of fixed amplitudes, of either those of lower potential first.
    fn starts(&self, state: &State, how: &SolveOptions) -> Result<Vec<Vec<f64>>, StateError> {
        let free = self.supports.fixed().iter().filter(|&&fixed| !fixed).count();
        let modes = self.modes(state, MODES.min(free), how)?;
        let size = self.discretization().mesh().diagonal();
        let (mut stationary, mut further) = (Vec::new(), Vec::new());
        for shape in &modes.shapes {
            for side in [1.0, -1.0] {
                let displaced = |share: f64| {
                    let mut u = state.u.to_vec();
                    axpy(side * share * size, shape, &mut u);
                    let energy = self.energy(&u, state, how);
                    (energy, u)
                };
                let sample = |k: usize| displaced(LARGEST * GROWTH.powi(k as i32 + 1 - SAMPLES as i32));
                let energies: Vec<f64> = (0..SAMPLES).map(|k| sample(k).0).collect();
                let turns = |k: &usize| (energies[*k] - energies[k - 1]) * (energies[k + 1] - energies[*k]) < 0.0;
                stationary.extend((1..SAMPLES - 1).filter(turns).map(sample));
                further.extend(AMPLITUDES.map(displaced));
            }
        }
        let ordered = |mut starts: Vec<(f64, Vec<f64>)>| {
            starts.retain(|(energy, _)| energy.is_finite());
            starts.sort_by(|a, b| a.0.total_cmp(&b.0));
            starts.into_iter().map(|(_, u)| u)
        };
        Ok(ordered(stationary).chain(ordered(further)).collect())
    }

    /// The potential under the controls and the load of a state; infinite where a cell inverts.
    fn energy(&self, u: &[f64], state: &State, how: &SolveOptions) -> f64 {
        let at = Instant { parallel: how.parallel, ..Instant::new(u, &state.controls, state.load) };
        let sums = self.evaluate(&at, Demand { energy: true, force: false });
        sums.map_or(f64::INFINITY, |sums| sums.energy)
    }
}

/// Why a start leads nowhere.
enum Stop {
    Failed,
    Problem(FemError),
    Cancelled,
}

impl From<Inadmissible> for Stop {
    fn from(at: Inadmissible) -> Self {
        at.problem().map_or(Stop::Failed, Stop::Problem)
    }
}

impl From<LinearError> for Stop {
    fn from(_: LinearError) -> Self {
        Stop::Failed
    }
}

/// Newton's method for the deflated residual.
struct Deflation<'a> {
    model: &'a Model,
    known: &'a [Equilibrium],
    how: &'a SolveOptions<'a>,
    /// `V_a / (V l^2)` by unknown.
    weights: Vec<f64>,
    size: f64,
}

impl<'a> Deflation<'a> {
    fn new(model: &'a Model, known: &'a [Equilibrium], how: &'a SolveOptions<'a>) -> Self {
        let disc = model.discretization();
        let size = disc.mesh().diagonal();
        let mut weights = disc.volumes_by_unknown();
        let scale = weights.iter().sum::<f64>() / disc.dim() as f64 * (RANGE * size).powi(2);
        weights.iter_mut().for_each(|w| *w /= scale);
        Deflation { model, known, how, weights, size }
    }

    /// From u to an equilibrium that is not known, and the iterations it took.
    fn solve(&self, u: Vec<f64>, workspace: &mut Workspace) -> (Result<State, Stop>, usize) {
        let mut report = SolveReport::default();
        let found = self.iterate(u, workspace, &mut report);
        (found, report.newton)
    }

    fn iterate(&self, mut u: Vec<f64>, workspace: &mut Workspace, report: &mut SolveReport) -> Result<State, Stop> {
        let (mut before, mut tiny) = (f64::INFINITY, false);
        for _ in 0..=ITERATIONS {
            if self.how.cancelled() {
                return Err(Stop::Cancelled);
            }
            let now = self.model.evaluate(&self.at(&u), Demand { energy: true, force: true })?;
            let mut residual = now.force;
            self.model.supports.clear(&mut residual);
            let size = norm(&residual);
            let relative = if size == 0.0 { 0.0 } else { size / norm(&now.force_scale) };
            (report.residual, report.min_j, report.energy) = (relative, now.min_j, now.energy);
            self.tell(report);
            if tiny || relative <= self.how.accuracy || (relative <= ROUNDING && relative > 0.5 * before) {
                return self.distinct(u, report);
            }
            before = relative;
            let mut matrix: SparseMatrix = self.model.matrix();
            self.model.add_tangent(&self.at(&u), &mut matrix)?;
            eliminate(self.model, &mut matrix);
            let rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
            let solver = self.model.linear_solver(self.how, workspace);
            let newton = TangentSystems::new(self.model, self.how.parallel, solver).solve(&matrix, &u, &rhs, report)?;
            report.newton += 1;
            let factor = self.factor(&u, &newton);
            let longest = LONGEST * self.size / max_abs(&newton).max(f64::MIN_POSITIVE);
            let mut step: Vec<f64> = newton.iter().map(|d| factor.clamp(-longest, longest) * d).collect();
            let admissible = self.model.max_step(&self.at(&u), &step)?;
            step.iter_mut().for_each(|d| *d *= admissible);
            tiny = max_abs(&newton) <= RESOLUTION * self.size;
            axpy(1.0, &step, &mut u);
        }
        Err(Stop::Failed)
    }

    fn at<'u>(&'u self, u: &'u [f64]) -> Instant<'u> {
        let first = &self.known[0].state;
        Instant { parallel: self.how.parallel, ..Instant::new(u, &first.controls, first.load) }
    }

    /// `1 / (1 - (grad log m) . d)` for Newton's step d.
    fn factor(&self, u: &[f64], step: &[f64]) -> f64 {
        let slope = |known: &Equilibrium| {
            let away: Vec<f64> = u.iter().zip(known.state.u.iter()).map(|(u, v)| u - v).collect();
            let weighted: Vec<f64> = away.iter().zip(&self.weights).map(|(v, w)| v * w).collect();
            let square = dot(&away, &weighted);
            -2.0 * dot(&weighted, step) / (square * (1.0 + square))
        };
        let factor = 1.0 / (1.0 - self.known.iter().map(slope).sum::<f64>());
        if factor.is_finite() { factor } else { f64::MAX }
    }

    /// The equilibrium, unless it is one that is known.
    fn distinct(&self, u: Vec<f64>, report: &SolveReport) -> Result<State, Stop> {
        let least = (SAME / RANGE).powi(2);
        let near = |known: &Equilibrium| {
            let squares = u.iter().zip(known.state.u.iter()).zip(&self.weights).map(|((u, v), w)| (u - v).powi(2) * w);
            squares.sum::<f64>() < least
        };
        if self.known.iter().any(near) {
            return Err(Stop::Failed);
        }
        let first = &self.known[0].state;
        let mut state = State::equilibrium(u, (*first.controls).clone(), first.load, *report);
        state.report.load_steps = 1;
        Ok(state)
    }

    fn tell(&self, report: &SolveReport) {
        if let Some(watch) = self.how.watch {
            let SolveReport { newton, residual, energy, .. } = *report;
            watch(&Progress { load: 1.0, newton, residual, step: 1.0, energy });
        }
    }
}
