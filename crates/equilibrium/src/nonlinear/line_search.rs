//! [`LineSearch`]: the length of a step.

use crate::nonlinear::direction::{Direction, Step, Take};
use crate::nonlinear::equations::{Equations, Evaluated, moved};
use crate::nonlinear::iterate::{Iterate, Stop};
use crate::nonlinear::merit::Merit;
use crate::nonlinear::merit::augmented::Augmented;
use crate::nonlinear::merit::energy::Energy;
use crate::nonlinear::merit::residual::Residual;
use crate::nonlinear::merit::sliding::Sliding;
use crate::nonlinear::merit::volume_errors::WithoutVolumeErrors;
use crate::nonlinear::predicted_pressures::PredictedPressures;
use crate::search::gradient_fit::GradientFit;
use crate::search::rotation_corrected_step::StepLimits;
use nastic_body::error::Inadmissible;
use nastic_body::state::SolveReport;
use nastic_body::strategy::Strategy;
use nastic_linear::solver::Curvature;

/// Steps that reduce the smallest J below this share of itself are too long.
const MIN_J_RATIO: f64 = 0.09;
/// Sufficient decrease of a step, as a share of what the slope predicts, and the number of lengths that are tried.
const DESCENT_RULE: Rule = Rule { decrease: 1e-4, tries: 30 };
/// The same where the tangent is not positive definite and an equilibrium nearby may be a saddle.
const SADDLE_RULE: Rule = Rule { decrease: 0.1, tries: 4 };
/// Under constraints and with friction a whole step that reduces the residual by this share is taken whatever the potential.
const HALVING_RULE: Rule = Rule { decrease: 0.5, tries: 1 };

/// Smallest ratio of a length to the one before.
const MIN_LENGTH_RATIO: f64 = 0.1;
/// Longer steps that are tried where the parabola asked for a smaller ratio: where a contact closes, the potential at the trial is dominated by the barrier.
const MAX_EXTENSIONS: usize = 3;

/// Relative violation of the constraints of rigid bodies up to which an iterate is on them.
const MAX_FULFILLED_VIOLATION: f64 = 1e-12;

#[derive(Clone, Copy)]
struct Rule {
    decrease: f64,
    tries: usize,
}

/// An accepted step.
pub(super) struct Taken<'m> {
    pub x: Vec<f64>,
    pub now: Evaluated<'m>,
    pub length: f64,
    /// Whether it was taken along a rotation-corrected curve.
    pub curved: bool,
}

/// The path of trials: `x + s dx`, or a rotation-corrected curve, each trial of which must be reached by an admissible straight move.
type Path<'p> = (&'p dyn Fn(f64) -> Vec<f64>, Along);

#[derive(Clone, Copy, PartialEq, Eq)]
enum Along {
    Straight,
    Curve,
}

/// Takes steps within the admissible set.
pub(super) struct LineSearch<'a> {
    equations: &'a Equations<'a>,
    fit: Option<GradientFit>,
    /// [`Equations::stays_rigid`]
    rigid: bool,
}

impl<'a> LineSearch<'a> {
    pub fn new(equations: &'a Equations<'a>) -> Self {
        LineSearch { equations, fit: None, rigid: equations.stays_rigid() }
    }

    /// Takes a step in the way that it prescribes.
    pub fn take(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Taken<'a>, Stop> {
        match step.take {
            Take::Longest { least } => self.within(here, &step.dx, least),
            Take::Once => {
                let x = moved(here.x, &step.dx, 1.0);
                if self.equations.chord(here.point, here.x, &x)? < 1.0 {
                    return Err(Stop::Slow { residual: here.relative });
                }
                let now = self.equations.evaluate(&x)?;
                Ok(Taken { x, now, length: 1.0, curved: false })
            }
            Take::Checked { length } => {
                let x = moved(here.x, &step.dx, 1.0);
                let now = self.equations.evaluate(&x)?;
                Ok(Taken { x, now, length, curved: false })
            }
            Take::Search => self.search(here, step, direction, report),
        }
    }

    /// Takes the longest admissible share of a step, if it is at least `least`.
    fn within(&self, here: &Iterate, dx: &[f64], least: f64) -> Result<Taken<'a>, Stop> {
        let mut x = moved(here.x, dx, 1.0);
        self.equations.place(&mut x);
        let length = self.equations.admissible_move(here, &x)?;
        if length < least {
            return Err(Stop::Slow { residual: here.relative });
        }
        if length < 1.0 {
            x = moved(here.x, dx, length);
        }
        let now = self.equations.evaluate(&x)?;
        Ok(Taken { x, now, length, curved: false })
    }

    /// Descent in the potential, or in the augmented Lagrangian. Where the tangent has negative eigenvalues an equilibrium nearby may be a
    /// saddle, which is followed as long as the residual decreases; the state's inertia shows which. Without a potential the residual
    /// decreases, or the potential of the contributions that have one with the work of the constant forces of the others; with friction the potential with
    /// lagged friction comes first.
    fn search(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Taken<'a>, Stop> {
        let model = self.equations.model;
        let constrained = model.unknowns().multipliers() > 0 && !self.rigid;
        // a proximal step is a descent step
        if constrained
            && self.equations.anchor.is_none()
            && let Some(taken) = self.residual_falls(here, &step.dx, HALVING_RULE)?
        {
            return Ok(taken);
        }
        if !self.equations.has_potential() {
            if !constrained && let Some(taken) = self.slides(here, step, direction, report)? {
                return Ok(taken);
            }
            if let Some(taken) = self.residual_falls(here, &step.dx, DESCENT_RULE)? {
                return Ok(taken);
            }
            if constrained {
                return Err(Stop::Slow { residual: here.relative });
            }
            let merit = Energy::lagged(self.equations, here, step)?;
            return self.downhill(here, &step.dx, &merit);
        }
        if model.unknowns().has_saddle_field() {
            return self.search_saddle(here, step, direction, report);
        }
        let uphill = direction.pressures().is_some_and(|pressures| self.is_uphill(here, step, pressures));
        if step.curvature != Curvature::Negative && !uphill {
            return self.descend(here, step, &step.dx, direction.pressures());
        }
        // a residual that is mostly errors of the volumes does not indicate a saddle
        if self.equations.anchor.is_none()
            && !self.equations.descends(here)
            && !uphill
            && direction.pressures().is_none_or(PredictedPressures::are_settled)
            && let Some(taken) = self.residual_falls(here, &step.dx, SADDLE_RULE)?
        {
            return Ok(taken);
        }
        let dx = direction.downhill(here, report)?;
        self.descend(here, step, &dx, direction.pressures())
    }

    /// With friction: a whole step that halves the residual, else one that decreases the potential with [lagged friction](Sliding); where Newton's step leads uphill,
    /// one with a shifted tangent. `None` where neither is found.
    fn slides(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Option<Taken<'a>>, Stop> {
        let equations = self.equations;
        let Some(in_time) = Sliding::step(equations) else { return Ok(None) };
        if let Some(taken) = self.residual_falls(here, &step.dx, HALVING_RULE)? {
            return Ok(Some(taken));
        }
        let mut along =
            |dx: &[f64], energy: Energy| self.downhill(here, dx, &Sliding::new(equations, in_time, here, energy)?);
        let energy = |dx: &[f64]| Energy::new(equations, here, dx, step.scale);
        let own = energy(&step.dx);
        let definite = step.curvature != Curvature::Negative || !equations.descends(here);
        let taken = match definite && own.line().slope < 0.0 {
            true => along(&step.dx, own),
            false => direction.downhill(here, report).and_then(|dx| along(&dx, energy(&dx))),
        };
        match taken {
            Ok(taken) => Ok(Some(taken)),
            Err(stop) if stop.is_final() => Err(stop),
            // the residual may still fall
            Err(_) => Ok(None),
        }
    }

    /// Towards an equilibrium in which the potential has a maximum by a field: it rises there, and the residual alone shows what is nearer. Where the tangent has more
    /// negative eigenvalues than that has unknowns, as far as the residual falls along Newton's step, or else along one with a shifted tangent.
    fn search_saddle(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Taken<'a>, Stop> {
        let negative = step.curvature == Curvature::Negative;
        let slow = || Stop::Slow { residual: here.relative };
        if let Some(taken) = self.residual_falls(here, &step.dx, if negative { SADDLE_RULE } else { DESCENT_RULE })? {
            return Ok(taken);
        }
        let dx = if negative { direction.downhill(here, report)? } else { return Err(slow()) };
        self.residual_falls(here, &dx, DESCENT_RULE)?.ok_or_else(slow)
    }

    /// Whether a step whose pressures are not those of its changes of volume leads uphill.
    fn is_uphill(&self, here: &Iterate, step: &Step, pressures: &PredictedPressures) -> bool {
        let energy = Energy::new(self.equations, here, &step.dx, step.scale);
        let line = WithoutVolumeErrors { energy, pressures }.line();
        pressures.is_apart() && line.slope > line.noise
    }

    fn descend(
        &mut self,
        here: &Iterate,
        step: &Step,
        dx: &[f64],
        pressures: Option<&PredictedPressures>,
    ) -> Result<Taken<'a>, Stop> {
        if self.equations.model.unknowns().multipliers() > 0 && !self.rigid {
            let merit = Augmented::new(self.equations, here, dx, step.scale)?;
            return self.downhill(here, dx, &merit);
        }
        let energy = Energy::new(self.equations, here, dx, step.scale);
        match pressures {
            Some(pressures) => self.downhill(here, dx, &WithoutVolumeErrors { energy, pressures }),
            None => self.downhill(here, dx, &energy),
        }
    }

    fn residual_falls(&self, here: &Iterate, dx: &[f64], rule: Rule) -> Result<Option<Taken<'a>>, Inadmissible> {
        let merit = Residual::new(self.equations, here);
        let straight = |s: f64| moved(here.x, dx, s);
        let longest = self.equations.admissible_move(here, &straight(1.0))?;
        if rule.tries == 1 && longest < 1.0 {
            return Ok(None);
        }
        if self.rigid && rule.tries == 1 {
            let onto = |s: f64| self.equations.restored(straight(s));
            if let Some(taken) = self.along(here, &merit, (&onto, Along::Curve), longest, rule)? {
                return Ok(Some(taken));
            }
        }
        self.along(here, &merit, (&straight, Along::Straight), longest, rule)
    }

    /// Along a rotation-corrected curve where the step rotates the body, else (or where that fails) along a straight line.
    fn downhill(&mut self, here: &Iterate, dx: &[f64], merit: &dyn Merit) -> Result<Taken<'a>, Stop> {
        let Equations { model, options, .. } = *self.equations;
        let (u, du, parallel) = (&*model.displacement(here.x), &*model.displacement(dx), options.parallel);
        let at = here.point.displaced(u);
        let straight = |s: f64| moved(here.x, dx, s);
        let reach = StepLimits::of_model(model, at, du, parallel);
        if self.rigid {
            let path = |s: f64| self.equations.restored(straight(s));
            // whole steps may leave the constraints, to second order, but the potential is compared on them
            if self.equations.constraint_residual(here.residual, here.now) > MAX_FULFILLED_VIOLATION {
                let x = path(0.0);
                return Ok(Taken { now: self.equations.evaluate(&x)?, x, length: 1.0, curved: false });
            }
            let taken = self.along(here, merit, (&path, Along::Curve), reach.straight, DESCENT_RULE)?;
            return taken.ok_or(Stop::Slow { residual: here.relative });
        }
        if self.equations.turns_rigid_bodies() {
            // a rotation along a straight line violates the constraints, which increases the merit
            let rigid = |s: f64| self.equations.restored(straight(s));
            let taken = self.along(here, merit, (&rigid, Along::Curve), reach.straight, DESCENT_RULE)?;
            if let Some(taken) = taken {
                return Ok(taken);
            }
        }
        let others = self.equations.chord(here.point, here.x, &straight(1.0))?;
        let curves = |_: &f64| model.unknowns().has_one_nodal_field() && options.strategies.has(Strategy::CurvedStep);
        if let Some(longest) = reach.curved.filter(curves) {
            if self.fit.is_none() {
                self.fit = GradientFit::new(model, parallel);
            }
            if let Some(fit) = &self.fit {
                let curve = |s: f64| {
                    let bent = fit.correction(model, at, du, s, parallel);
                    let mut to = straight(s);
                    to.iter_mut().zip(&bent).for_each(|(u, bent)| *u += bent);
                    to
                };
                let taken = self.along(here, merit, (&curve, Along::Curve), longest.min(others), DESCENT_RULE)?;
                if let Some(taken) = taken {
                    return Ok(Taken { curved: true, ..taken });
                }
            }
        }
        let longest = reach.straight.min(others);
        let taken = self.along(here, merit, (&straight, Along::Straight), longest, DESCENT_RULE)?;
        taken.ok_or(Stop::Slow { residual: here.relative })
    }

    /// The longest of a few lengths along a path that decreases a merit sufficiently and is admissible.
    fn along(
        &self,
        here: &Iterate,
        merit: &dyn Merit,
        (path, along): Path,
        longest: f64,
        rule: Rule,
    ) -> Result<Option<Taken<'a>>, Inadmissible> {
        let line = merit.line();
        // what rounding accepts along a direction that leads uphill never ends
        if merit.is_energy() && line.slope > line.noise && self.equations.is_step() {
            return Ok(None);
        }
        let least_j = if merit.is_energy() { MIN_J_RATIO * here.now.min_j } else { f64::NEG_INFINITY };
        let (mut length, mut wall) = (longest, None);
        let at = |length: f64| -> Result<_, Inadmissible> {
            let trial = path(length);
            // the straight move to the longest one was checked
            let reached = along == Along::Straight || self.equations.chord(here.point, here.x, &trial)? >= 1.0;
            let found = if reached { merit.value(self.equations, &trial, length).ok() } else { None };
            Ok(found.filter(|(_, now)| now.sums.min_j >= least_j).map(|(value, now)| (trial, value, now)))
        };
        for _ in 0..rule.tries {
            let Some((trial, value, now)) = at(length)? else {
                length *= 0.5;
                continue;
            };
            let change = value - line.start;
            if change <= rule.decrease * length * line.slope + line.noise {
                let mut best = (trial, value, now);
                for _ in 0..wall.map_or(0, |_| MAX_EXTENSIONS) {
                    let longer = wall.map_or(length, |wall: f64| (length * wall).sqrt());
                    match at(longer)?.filter(|(_, value, _)| *value < best.1) {
                        Some(found) => (best, length) = (found, longer),
                        None => break,
                    }
                }
                let now = merit.accepted(self.equations, &best.0, length, best.2)?;
                return Ok(Some(Taken { x: best.0, now, length, curved: false }));
            }
            // the vertex of the parabola through the start, its slope and this value
            let vertex = -line.slope * length * length / (2.0 * (change - line.slope * length));
            let shorter = merit.is_energy() && vertex.is_finite();
            wall = (shorter && vertex < MIN_LENGTH_RATIO * length && self.equations.model.touches_something())
                .then_some(length);
            length = if shorter { vertex.clamp(MIN_LENGTH_RATIO * length, 0.5 * length) } else { 0.5 * length };
        }
        Ok(None)
    }
}
