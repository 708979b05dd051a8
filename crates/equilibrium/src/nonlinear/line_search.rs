//! [`LineSearch`]: how far a step goes.

use crate::nonlinear::direction::{Direction, Step, Take};
use crate::nonlinear::equations::{Equations, Evaluated, moved};
use crate::nonlinear::iterate::{Iterate, Stop};
use crate::nonlinear::merit::Merit;
use crate::nonlinear::merit::augmented::Augmented;
use crate::nonlinear::merit::energy::Energy;
use crate::nonlinear::merit::residual::Residual;
use crate::nonlinear::merit::volume_errors::WithoutVolumeErrors;
use crate::nonlinear::predicted_pressures::PredictedPressures;
use crate::search::gradient_fit::GradientFit;
use crate::search::rotation_corrected_step::StepLimits;
use nastic_body::error::Inadmissible;
use nastic_body::state::SolveReport;
use nastic_body::strategy::Strategy;
use nastic_linear::solver::Curvature;

/// Steps along a curve that leave less than this share of the smallest J are too long.
const COLLAPSE: f64 = 0.09;
/// Sufficient decrease wanted of a step, as a share of what the slope promises; lengths that are tried.
const DESCENT: Rule = Rule { decrease: 1e-4, tries: 30 };
/// The same where the tangent is not positive definite and an equilibrium nearby may be a saddle.
const TO_SADDLE: Rule = Rule { decrease: 0.1, tries: 4 };
/// Under constraints a whole step that leaves this share of the residual is taken whatever the potential.
const FALLS: Rule = Rule { decrease: 0.5, tries: 1 };

/// Least share of a length that the next one has.
const SHORTEST: f64 = 0.1;
/// Longer steps that are tried where parabolas asked for less than that share: a contact that closes is a wall, far from which they see nothing else.
const BEFORE_WALL: usize = 3;

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
    /// Whether it turned with the body.
    pub curved: bool,
}

/// Along what trials lie: `x + s dx`, or the curve that turns with the body, of which every trial has to be reached by a straight move.
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
}

impl<'a> LineSearch<'a> {
    pub fn new(equations: &'a Equations<'a>) -> Self {
        LineSearch { equations, fit: None }
    }

    /// As the step wants to be taken.
    pub fn take(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Taken<'a>, Stop> {
        match step.take {
            Take::Whole => self.within(here, &step.dx, 1.0),
            Take::Longest => self.within(here, &step.dx, 0.0),
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

    /// As far as is admissible, at least this share of the step.
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

    /// Downhill in the potential, or in the augmented Lagrangian; where the tangent has negative eigenvalues an equilibrium nearby may be a
    /// saddle, which is followed as long as the residual falls, and the state's inertia shows what was found. Without a potential the
    /// residual falls, or the potential of those contributions that have one with the work of the others, whose forces stay.
    fn search(
        &mut self,
        here: &Iterate,
        step: &Step,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Taken<'a>, Stop> {
        let model = self.equations.model;
        let constrained = model.unknowns().multipliers() > 0;
        // a proximal step goes downhill
        if constrained
            && self.equations.anchor.is_none()
            && let Some(taken) = self.residual_falls(here, &step.dx, FALLS)?
        {
            return Ok(taken);
        }
        if !self.equations.has_potential() {
            if let Some(taken) = self.residual_falls(here, &step.dx, DESCENT)? {
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
        // errors of the volumes make most of a residual, which shows no saddle then
        if self.equations.anchor.is_none()
            && !uphill
            && direction.pressures().is_none_or(PredictedPressures::are_settled)
            && let Some(taken) = self.residual_falls(here, &step.dx, TO_SADDLE)?
        {
            return Ok(taken);
        }
        let dx = direction.downhill(here, report)?;
        self.descend(here, step, &dx, direction.pressures())
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
        if let Some(taken) = self.residual_falls(here, &step.dx, if negative { TO_SADDLE } else { DESCENT })? {
            return Ok(taken);
        }
        let dx = if negative { direction.downhill(here, report)? } else { return Err(slow()) };
        self.residual_falls(here, &dx, DESCENT)?.ok_or_else(slow)
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
        if self.equations.model.unknowns().multipliers() > 0 {
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
        self.along(here, &merit, (&straight, Along::Straight), longest, rule)
    }

    /// Along the curve that turns with the body where the step turns it, else (or where that leads nowhere) straight on.
    fn downhill(&mut self, here: &Iterate, dx: &[f64], merit: &dyn Merit) -> Result<Taken<'a>, Stop> {
        let Equations { model, options, .. } = *self.equations;
        let (u, du, parallel) = (&*model.displacement(here.x), &*model.displacement(dx), options.parallel);
        let at = here.point.displaced(u);
        let straight = |s: f64| moved(here.x, dx, s);
        let reach = StepLimits::of_model(model, at, du, parallel);
        if self.equations.turns_rigid_bodies() {
            // a rotation is no straight line: that leaves the constraints, which the merit holds against it
            let rigid = |s: f64| model.restored(&straight(s)).unwrap_or_else(|| straight(s));
            let taken = self.along(here, merit, (&rigid, Along::Curve), reach.straight, DESCENT)?;
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
                let taken = self.along(here, merit, (&curve, Along::Curve), longest.min(others), DESCENT)?;
                if let Some(taken) = taken {
                    return Ok(Taken { curved: true, ..taken });
                }
            }
        }
        let longest = reach.straight.min(others);
        let taken = self.along(here, merit, (&straight, Along::Straight), longest, DESCENT)?;
        taken.ok_or(Stop::Slow { residual: here.relative })
    }

    /// The longest of a few lengths along a path that lowers a merit enough and is admissible.
    fn along(
        &self,
        here: &Iterate,
        merit: &dyn Merit,
        (path, along): Path,
        longest: f64,
        rule: Rule,
    ) -> Result<Option<Taken<'a>>, Inadmissible> {
        let line = merit.line();
        let least_j = if merit.is_energy() { COLLAPSE * here.now.min_j } else { f64::NEG_INFINITY };
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
                for _ in 0..wall.map_or(0, |_| BEFORE_WALL) {
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
            wall =
                (shorter && vertex < SHORTEST * length && self.equations.model.touches_something()).then_some(length);
            length = if shorter { vertex.clamp(SHORTEST * length, 0.5 * length) } else { 0.5 * length };
        }
        Ok(None)
    }
}
