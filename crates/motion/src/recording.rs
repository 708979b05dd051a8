//! [`Recording`]: a motion with all its states or with checkpoints, for the reverse sweep; for a static problem its state.

use crate::TimeStepping;
use crate::checkpoints::{Checkpoints, split};
use crate::scheme::Scheme;
use crate::trajectory::{StepTo, Trajectory};
use nastic_body::error::StateError;
use nastic_body::state::{SolveReport, State};
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use std::sync::{Arc, LazyLock};

/// A motion by one scheme with all its states, or with checkpoints from which the others are recomputed.
///
/// Every segment begins with an empty [`Workspace`], whether states are stored or not: its results depend on its first states and its
/// controls alone, and have the same bits when it is recomputed. Within a segment a step after
/// [96 Newton iterations or more](Self::begins_anew) begins likewise, which limits the work that is lost when a motion is stopped.
///
/// ```
/// # use nastic_fem::{Checkpoints, Inertia, Recording, ReverseSweep, Scheme, Solid, SolveOptions, StateError, StatePartials};
/// # use nastic_fem::{StepTo, Trajectory, Workspace};
/// # use nastic_energy::NeoHooke;
/// # use nastic_mesh::{CellKind, box_mesh};
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [5, 1, 1], CellKind::Hex8)?)?
///     .material("body", NeoHooke::new(1e5, 4e5)?)?
///     .body_force("body", nastic_tensor::Vec3::new(0.0, 0.0, -1e4))?
///     .clamp("x-")?
///     .inertia(Inertia::new("body", 1000.0))?;
/// let (model, how) = (body.model(), SolveOptions::default());
/// let to = |_: usize| Ok::<_, StateError>(StepTo { dt: 0.01, controls: body.controls() });
///
/// let plan = Checkpoints::at_most(2, 12, 2)?; // 12 steps in segments of two, two checkpoints
/// let mut motion = Recording::new(Trajectory::from_given(body.rest()), Scheme::bdf2(), plan);
/// let mut workspace = Workspace::default();
/// for n in 1..=12 {
///     motion.advance(model, &to(n)?, &how, &mut workspace)?;
/// }
///
/// // the derivative of the mean of u(T), one segment after the other from the end
/// let mut sweep = ReverseSweep::new(model, &how, &mut workspace);
/// motion.backwards(model, &mut |n| to(n), &how, &mut |part, k| {
///     let of_end = vec![1.0 / body.discretization().dofs() as f64; body.discretization().dofs()];
///     let u = if part.first() + k + 1 == 12 { of_end } else { Vec::new() };
///     sweep.step(part, k, StatePartials::by_displacement(u)).map(drop)
/// })?;
/// assert_eq!(motion.counts().recomputed_steps, plan.recomputed_steps());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Recording {
    scheme: Arc<Scheme>,
    plan: Checkpoints,
    /// The segments that begin with a checkpoint.
    places: Vec<usize>,
    /// Increasing; the first is the beginning of the motion. Empty where all states are stored.
    kept: Vec<Checkpoint>,
    /// The states of the last segment that was computed, or all of them.
    part: Trajectory,
    /// The number of that segment; `None` while it is recomputed.
    segment: Option<usize>,
    /// Newton iterations since the workspace was empty.
    iterations: usize,
    counts: RecordingCounts,
}

/// The beginning of a segment.
#[derive(Debug, Clone)]
struct Checkpoint {
    segment: usize,
    states: Trajectory,
}

/// Counts of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RecordingCounts {
    /// Recomputed steps.
    pub recomputed_steps: usize,
    /// Largest number of states in memory.
    pub states: usize,
}

/// Newton iterations after which a step begins with an empty workspace. Most segments take fewer; in the others one more
/// factorisation for this number of iterations costs 1 %.
const MAX_ITERATIONS: usize = 96;

static NO_STEPS: LazyLock<Arc<Scheme>> = LazyLock::new(|| Arc::new(Scheme::quasi_static()));

impl From<State> for Recording {
    /// A static problem: its equilibrium, and no steps.
    fn from(state: State) -> Self {
        let (plan, counts) = (Checkpoints::none(), RecordingCounts { recomputed_steps: 0, states: 1 });
        let (places, kept, part) = (Vec::new(), Vec::new(), Trajectory::from(state));
        Recording { scheme: NO_STEPS.clone(), plan, places, kept, part, segment: None, iterations: 0, counts }
    }
}

impl Recording {
    /// A motion that begins with `begin`.
    pub fn new(begin: Trajectory, scheme: Scheme, plan: Checkpoints) -> Self {
        let counts = RecordingCounts::default();
        let places = plan.first_places();
        let (scheme, kept) = (Arc::new(scheme), Vec::new());
        Recording { scheme, plan, places, kept, part: begin, segment: None, iterations: 0, counts }
    }

    /// The states of the last segment that was computed, with the last step before it for two-step schemes; all states where they
    /// are stored.
    pub fn part(&self) -> &Trajectory {
        &self.part
    }

    /// Whether [`part`](Self::part) is the whole motion.
    pub fn keeps_all(&self) -> bool {
        self.plan.most().is_none()
    }

    /// Whether the next step begins with an empty workspace, so that a motion resumed here has the bits of one without a stop: at the beginning of a
    /// segment, and within it after 96 Newton iterations or more. Only counts decide, which are the same when steps are recomputed.
    pub fn begins_anew(&self) -> bool {
        let done = self.part.first() + self.part.states().len() - 1;
        done.is_multiple_of(self.plan.segment()) || self.iterations >= MAX_ITERATIONS
    }

    /// Recomputed steps and stored states.
    pub fn counts(&self) -> RecordingCounts {
        self.counts
    }

    /// Makes one step.
    ///
    /// # Errors
    /// As [`TimeStepping::advance`].
    pub fn advance(
        &mut self,
        model: &Model,
        to: &StepTo,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<(), StateError> {
        if self.begins_anew() {
            workspace.clear();
            self.iterations = 0;
            let done = self.part.first() + self.part.states().len() - 1;
            if done.is_multiple_of(self.plan.segment()) && !self.keeps_all() {
                self.part = self.part.tail(&self.scheme);
                let segment = done / self.plan.segment();
                let is_kept = self.kept.last().is_some_and(|last| last.segment == segment);
                if !is_kept && self.places.contains(&segment) {
                    self.kept.push(Checkpoint { segment, states: self.part.clone() });
                }
                self.segment = Some(segment);
            }
        }
        model.advance(&mut self.part, &self.scheme, std::slice::from_ref(to), how, workspace)?;
        self.iterations += self.part.end().report.newton;
        self.count_states();
        Ok(())
    }

    /// Calls `each` with every step of the motion, from the last to the first: with a part of the motion and the number k of the step in it, which
    /// leads to the state of number `part.first() + k + 1`. States that are not stored are recomputed, under `to(n)`, the controls of the
    /// step to the n-th state. Returns the work of the recomputation.
    ///
    /// Afterwards only the checkpoint at the beginning is left: another call recomputes the whole motion.
    ///
    /// # Errors
    /// Those of `to` and `each`; a [`StateError`] where `how` or the controls differ from those of the motion.
    pub fn backwards<E: From<StateError>>(
        &mut self,
        model: &Model,
        to: &mut dyn FnMut(usize) -> Result<StepTo, E>,
        how: &SolveOptions,
        each: &mut dyn FnMut(&Trajectory, usize) -> Result<(), E>,
    ) -> Result<SolveReport, E> {
        let mut work = SolveReport::default();
        if self.keeps_all() {
            (0..self.part.steps().len()).rev().try_for_each(|k| each(&self.part, k))?;
            return Ok(work);
        }
        // a separate one, so that the solves of the sweep are the same as with all states in memory
        let mut workspace = Workspace::default();
        for segment in (0..self.plan.segments()).rev() {
            let begin = segment * self.plan.segment();
            let end = (begin + self.plan.segment()).min(self.plan.steps());
            self.kept.truncate(self.kept.partition_point(|kept| kept.segment <= segment));
            if self.segment != Some(segment) {
                self.reach(segment, &mut |run, n| run.again(model, n, to, how, &mut workspace, &mut work))?;
            }
            for n in (begin..end).rev() {
                each(&self.part, n - self.part.first())?;
            }
        }
        Ok(work)
    }

    /// Computes a segment from the checkpoint before it, and stores further checkpoints between them.
    fn reach<E>(&mut self, segment: usize, again: &mut dyn FnMut(&mut Self, usize) -> Result<(), E>) -> Result<(), E> {
        let Some(last) = self.kept.last() else { return Ok(()) };
        self.part = last.states.clone();
        let mut here = last.segment;
        while here < segment {
            let free = self.plan.most().unwrap_or(1) - (self.kept.len() - 1);
            let next = if free > 1 { here + split(segment + 1 - here, free) } else { segment };
            for passed in here..next {
                again(self, passed)?;
            }
            self.part = self.part.tail(&self.scheme);
            if free > 1 {
                self.kept.push(Checkpoint { segment: next, states: self.part.clone() });
            }
            here = next;
        }
        again(self, segment)
    }

    /// Recomputes a segment from its first states, which `part` holds.
    fn again<E: From<StateError>>(
        &mut self,
        model: &Model,
        segment: usize,
        to: &mut dyn FnMut(usize) -> Result<StepTo, E>,
        how: &SolveOptions,
        workspace: &mut Workspace,
        work: &mut SolveReport,
    ) -> Result<(), E> {
        (self.part, self.segment) = (self.part.tail(&self.scheme), None);
        let begin = segment * self.plan.segment();
        let end = (begin + self.plan.segment()).min(self.plan.steps());
        for n in begin + 1..=end {
            if self.begins_anew() {
                workspace.clear();
                self.iterations = 0;
            }
            model.advance(&mut self.part, &self.scheme, &[to(n)?], how, workspace)?;
            self.iterations += self.part.end().report.newton;
            work.add_work(&self.part.end().report);
            self.counts.recomputed_steps += 1;
            self.count_states();
        }
        self.segment = Some(segment);
        Ok(())
    }

    fn count_states(&mut self) {
        let kept: usize = self.kept.iter().map(|kept| kept.states.states().len()).sum();
        self.counts.states = self.counts.states.max(kept + self.part.states().len());
    }
}
