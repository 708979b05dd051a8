//! [`check_contribution`]: what every contribution must fulfil.

use crate::linear_systems::saddle_point::BorderedTangent;
use crate::model::Model;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::history::{BeforeStep, History};
use nastic_body::instant::Instant;
use nastic_body::instant::{FrictionLag, TimeStep};
use nastic_body::state::State;
use nastic_energy::Slot;
use nastic_linear::{Space, Symmetry};
use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, sub};

/// One process checks.
const SPACE: &Space = Space::LOCAL;
/// Size of the displacements at which a contribution is evaluated, as a share of the body's diagonal.
const DISPLACEMENT_RATIO: f64 = 0.02;
/// Size of its controls and multipliers.
const CONTROL_SIZE: f64 = 1e3;
/// Variation of its angles.
const ANGLE_VARIATION: f64 = 0.3;
/// Variation of its designs, as a share of their values.
const DESIGN_VARIATION: f64 = 0.1;
/// Relative error of the sixth-order differences that counts as agreement.
const TOLERANCE: f64 = 1e-7;

/// Holds a contribution of a model to its contract at displacements, controls and directions drawn at random from a seed:
/// the residual is the derivative of the potential (where there is one), the tangent that of the residual, static and in a
/// time step; the tangent is symmetric if said so; products with it are its products; `vjp` is the derivative of
/// `lambda . r` by controls, velocity and acceleration, the latter with the mass that is given; where it depends on the path, with normal forces
/// taken at another displacement there is a potential; second derivatives, where there are some, are those of the first ones and
/// symmetric; the same question has the same answer to the bit.
///
/// A potential with kinks in its second or third derivative needs an example in which no sample is within 5 % of a cell of one: differences of
/// sixth order are compared, which cannot distinguish a kink from a mistake.
///
/// # Errors
/// What is violated, where, by how much; an unknown name.
pub fn check_contribution(model: &Model, name: &str, seed: u64) -> Result<(), String> {
    let (contribution, block, scalar, memory) =
        model.contribution(name).ok_or_else(|| format!("there is no contribution \"{name}\""))?;
    let mut random = Random::new(seed);
    let n = model.unknowns().len();
    let size = DISPLACEMENT_RATIO * model.discretization().mesh().diagonal() / (model.unknowns().nodes() as f64).cbrt();
    let dofs = model.unknowns().nodal();
    let mut draw = |scale: f64, of_multipliers: f64| -> Vec<f64> {
        let scale = |i: usize| if i < dofs { scale } else { of_multipliers };
        (0..n).map(|i| scale(i) * random.symmetric()).collect()
    };
    let (u, direction, lambda) = (draw(size, CONTROL_SIZE), draw(size, CONTROL_SIZE), draw(1.0, 1.0));
    let mut before = model.rest();
    before.u = draw(size, CONTROL_SIZE).into();
    before.velocity = Some(draw(size, CONTROL_SIZE).into());
    let mut controls = model.controls();
    for k in 0..controls.len() {
        let scales = scales(contribution.slots(), k == block, size);
        let own = f64::from(u8::from(k == block));
        let values = controls.values_mut(k).iter_mut().zip(scales);
        values.for_each(|(m, (rest, scale))| *m = rest + own * scale * random.symmetric());
    }
    let mut history = model.zero_history();
    history.dt = 0.3;
    let own = history.values_mut(memory);
    own.iter_mut().for_each(|z| *z = size * random.symmetric());
    let step = TimeStep { history: history.into(), ..TimeStep::backward_euler(&before, 0.3) };
    // in motion a model with further fields is refused
    let motion = model.unknowns().has_one_nodal_field().then_some(&step);
    for step in [None].into_iter().chain(motion.map(Some)) {
        let at = Instant { block, scalar, memory, ..Instant::new(&u, &controls, 0.7) };
        let at = step.map_or(at, |step| at.in_step(step));
        Subject { contribution, model, at, size }.check(&direction, &lambda).map_err(|why| {
            let when = if step.is_some() { "in a time step" } else { "static" };
            format!("contribution \"{name}\", {when}: {why}")
        })?;
    }
    if let (Some(step), Some(_)) = (motion, contribution.path_dependence()) {
        let lag = FrictionLag { u: step.before.u.clone(), controls: controls.clone().into(), smoothing: 2.0 };
        let lagged = TimeStep { lag: Some(lag), ..step.clone() };
        let at = Instant { block, scalar, memory, ..Instant::new(&u, &controls, 0.7) }.in_step(&lagged);
        let found = Subject { contribution, model, at, size }.check_residual(&direction, &lambda, [true, true]);
        found.map_err(|why| format!("contribution \"{name}\", with its normal forces of elsewhere: {why}"))?;
    }
    Ok(())
}

struct Subject<'a> {
    contribution: &'a dyn Contribution,
    model: &'a Model,
    at: Instant<'a>,
    /// Of displacements.
    size: f64,
}

/// Value at rest of each slot of a block, again and again, and what it varies by: a translation as much as the body moves, a rotation by some
/// degrees, a design by a share of its value, other loads by [`CONTROL_SIZE`].
fn scales(slots: &[Slot], own: bool, size: f64) -> Box<dyn Iterator<Item = (f64, f64)> + '_> {
    let of_slot = move |slot: &Slot| match (slot.is_design(), slot.component.map_or("", |_| slot.unit)) {
        (true, _) => (slot.rest(), DESIGN_VARIATION * slot.rest()),
        (false, "m") => (0.0, size),
        (false, "1") => (0.0, ANGLE_VARIATION),
        _ => (0.0, CONTROL_SIZE),
    };
    match own && !slots.is_empty() {
        true => Box::new(slots.iter().map(of_slot).cycle()),
        false => Box::new(std::iter::repeat((0.0, CONTROL_SIZE))),
    }
}

impl Subject<'_> {
    fn check(&self, direction: &[f64], lambda: &[f64]) -> Result<(), String> {
        if self.contribution.has_potential() && self.contribution.symmetry() == Symmetry::General {
            return Err("it has a potential, so its tangent must be symmetric".into());
        }
        let potential = [self.contribution.has_potential(), self.contribution.symmetry() == Symmetry::Symmetric];
        self.check_residual(direction, lambda, potential)?;
        self.check_sensitivities(lambda)?;
        self.check_prescribed(lambda)?;
        self.check_second(direction, lambda)
    }

    /// The residual as the derivative of the potential, if it `has` one; the tangent and products with it, symmetric or not.
    fn check_residual(&self, direction: &[f64], lambda: &[f64], [has, symmetric]: [bool; 2]) -> Result<(), String> {
        let shown = |at: Inadmissible| at.to_string();
        let sums = self.sums(self.at).map_err(shown)?;
        if sums.force != self.sums(self.at).map_err(shown)?.force {
            return Err("the residual has other bits when asked again".into());
        }
        if has {
            let slope = difference(|s| Ok(vec![self.sums(self.moved(&self.along(direction, s)))?.energy]))?[0];
            let found = SPACE.dot(&sums.force, direction);
            agree(
                "the residual along a direction",
                &[found],
                "the slope of the potential",
                &[slope],
                sums.energy_scale,
            )?;
        }
        self.check_adds(&sums, lambda).map_err(shown)??;
        let tangent = self.tangent(self.at).map_err(shown)?;
        let product = tangent.multiply(direction, false);
        let expected = difference(|s| Ok(self.sums(self.moved(&self.along(direction, s)))?.force))?;
        agree(
            "tangent times a direction",
            &product,
            "differences of the residual",
            &expected,
            SPACE.norm(&sums.force_scale),
        )?;
        if symmetric {
            let (left, right) = (SPACE.dot(lambda, &product), SPACE.dot(direction, &tangent.multiply(lambda, false)));
            agree("a . K b", &[left], "b . K a", &[right], SPACE.norm(lambda) * SPACE.norm(&product))?;
        }
        let mut out = lambda.to_vec();
        if self
            .point(&self.at)
            .and_then(|point| point.add_tangent_product(&self.at, direction, &mut out))
            .map_err(shown)?
        {
            let out = sub(&out, lambda);
            agree("the product without a matrix", &out, "the tangent times the vector", &product, SPACE.norm(lambda))?;
        }
        Ok(())
    }

    /// What it prescribes: the change along a change of the controls, and the derivative of its work with a force.
    fn check_prescribed(&self, force: &[f64]) -> Result<(), String> {
        let Some(prescribed) = self.contribution.prescribes() else { return Ok(()) };
        let unknowns = prescribed.unknowns();
        let mut random = Random::new(13);
        let mut draw = || {
            let mut controls = self.model.controls();
            controls.values_mut(self.at.block).iter_mut().for_each(|m| *m = 0.7 * random.symmetric());
            controls
        };
        let (m, v) = (draw(), draw());
        let at = Instant { controls: &m, ..self.at };
        let moved = |s: f64| {
            let mut controls = m.clone();
            axpy(s, v.values(self.at.block), controls.values_mut(self.at.block));
            let mut u = vec![0.0; force.len()];
            prescribed.prescribe(&Instant { controls: &controls, ..self.at }, &mut u);
            Ok(u)
        };
        let mut found = vec![0.0; force.len()];
        prescribed.add_change(&at, &v, &mut found);
        if let Some(dof) = (0..found.len()).find(|dof| found[*dof] != 0.0 && !unknowns.contains(&(*dof as u32))) {
            return Err(format!("it moves unknown {dof}, which it does not hold"));
        }
        agree("the change of what it holds", &found, "differences", &difference(moved)?, 0.0)?;
        let mut by_controls = Sensitivities::zero(self.model.controls(), &at);
        prescribed.vjp(&at, force, &mut by_controls);
        let (left, right) =
            (SPACE.dot(by_controls.controls.values(self.at.block), v.values(self.at.block)), SPACE.dot(force, &found));
        agree("the derivative of a force's work", &[left], "the work along the change", &[right], 0.0)
    }

    /// Second derivatives of `lambda . r`, where there are some, are differences of the first ones along an increment, and
    /// symmetric.
    fn check_second(&self, direction: &[f64], lambda: &[f64]) -> Result<(), String> {
        let mut controls = self.model.controls();
        let mut random = Random::new(12);
        self.draw(&mut controls, &mut random);
        let along = Increment { u: direction, controls: &controls };
        let Some(found) = self.second(lambda, &along)? else { return Ok(()) };
        let first = |s: f64| -> Result<(Vec<f64>, Controls), Inadmissible> {
            let (u, m) = (self.along(direction, s), self.controls_along(&controls, s));
            let at = Instant { controls: &m, ..self.moved(&u) };
            let by_u = self.tangent(at)?.multiply_transposed(lambda, false);
            let mut by_m = Sensitivities::zero(self.model.controls(), &at);
            self.point(&at)?.vjp(&at, lambda, &mut by_m)?;
            Ok((by_u, by_m.controls))
        };
        let (by_u, by_m) = first(0.0).map_err(|at| at.to_string())?;
        let expected = difference(|s| Ok(first(s)?.0))?;
        agree("the change of K^T lambda", &found.u, "differences", &expected, SPACE.norm(&by_u))?;
        for k in 0..controls.len() {
            let expected = difference(|s| Ok(first(s)?.1.values(k).to_vec()))?;
            let what = "the change of the derivative by the controls";
            agree(what, found.controls.values(k), "differences", &expected, SPACE.norm(by_m.values(k)))?;
        }
        let mut product = vec![0.0; direction.len()];
        let error = |error: SecondDerivativeError| error.to_string();
        let point = self.point(&self.at).map_err(|at| at.to_string())?;
        let added = point.add_control_product(&self.at, &controls, &mut product);
        let (name, controlled) = (self.contribution.name(), !self.contribution.slots().is_empty());
        added.or_else(|error| error.of(name, controlled)).map_err(error)?;
        let expected = difference(|s| {
            let m = self.controls_along(&controls, s);
            Ok(self.sums(Instant { controls: &m, ..self.at })?.force)
        })?;
        agree("dr/dm v", &product, "differences of the residual", &expected, SPACE.norm(&product))?;
        let (other_u, mut other_controls) = (sub(lambda, direction), controls.clone());
        self.draw(&mut other_controls, &mut random);
        let other = Increment { u: &other_u, controls: &other_controls };
        let Some(of_other) = self.second(lambda, &other)? else { return Ok(()) };
        let pair = |second: &SecondSensitivities, along: &Increment| -> f64 {
            let by_m = |k: usize| SPACE.dot(second.controls.values(k), along.controls.values(k));
            SPACE.dot(&second.u, along.u) + (0..controls.len()).map(by_m).sum::<f64>()
        };
        let (left, right) = (pair(&found, &other), pair(&of_other, &along));
        agree("second derivatives along a, then b", &[left], "those along b, then a", &[right], 0.0)
    }

    /// Other values of its own controls.
    fn draw(&self, controls: &mut Controls, random: &mut Random) {
        if self.at.block < controls.len() {
            let scales = scales(self.contribution.slots(), true, self.size);
            controls.values_mut(self.at.block).iter_mut().zip(scales).for_each(|(m, (_, scale))| {
                *m = scale * random.symmetric();
            });
        }
    }

    /// `None` where the contribution, or a law in it, gives none.
    fn second(&self, lambda: &[f64], along: &Increment) -> Result<Option<SecondSensitivities>, String> {
        let mut sums = SecondSensitivities::zero(self.model.controls(), lambda.len());
        let point = self.point(&self.at).map_err(|at| at.to_string())?;
        match point.second_vjp(&self.at, lambda, along, &mut sums) {
            Ok(()) => Ok(Some(sums)),
            Err(SecondDerivativeError::Inadmissible(at)) => Err(at.to_string()),
            Err(_) => Ok(None),
        }
    }

    fn controls_along(&self, v: &Controls, s: f64) -> Controls {
        let mut controls = self.at.controls.clone();
        (0..controls.len()).for_each(|k| axpy(s, v.values(k), controls.values_mut(k)));
        controls
    }

    /// Sums are added to, not overwritten; forces are no larger than what their rounding is measured against.
    fn check_adds(&self, alone: &Sums, others: &[f64]) -> Result<Result<(), String>, Inadmissible> {
        let scale = SPACE.max_abs(&alone.force_scale);
        let before: Vec<f64> = others.iter().map(|o| scale * o).collect();
        let mut sums = Sums { force: before.clone(), energy: scale, ..Sums::zero(before.len()) };
        self.point(&self.at)?.add_residual(&self.at, Demand { energy: true, force: true }, &mut sums)?;
        let added = sub(&sums.force, &before);
        if let Err(why) = agree("what is added to forces of others", &added, "the residual", &alone.force, scale) {
            return Ok(Err(why));
        }
        let allowed = 1e-9 * (scale + alone.energy.abs());
        if (sums.energy - scale - alone.energy).abs() > allowed {
            return Ok(Err("the potential of others is overwritten instead of added to".into()));
        }
        let beyond = alone.force.iter().zip(&alone.force_scale).position(|(f, s)| f.abs() > (1.0 + 1e-9) * s);
        Ok(match beyond {
            None => Ok(()),
            Some(dof) => Err(format!(
                "the force {:.3e} of unknown {dof} is larger than its `force_scale` {:.3e}: add absolute forces there",
                alone.force[dof], alone.force_scale[dof]
            )),
        })
    }

    fn check_sensitivities(&self, lambda: &[f64]) -> Result<(), String> {
        let mut found = Sensitivities::zero(self.model.controls(), &self.at);
        self.point(&self.at).and_then(|point| point.vjp(&self.at, lambda, &mut found)).map_err(|at| at.to_string())?;
        let work = |at: Instant| Ok(vec![SPACE.dot(lambda, &self.sums(at)?.force)]);
        let mut random = Random::new(11);
        for k in 0..found.controls.len() {
            let scales = scales(self.contribution.slots(), k == self.at.block, self.size);
            let along: Vec<f64> =
                found.controls.values(k).iter().zip(scales).map(|(_, (_, scale))| scale * random.symmetric()).collect();
            let moved = |s: f64| -> Controls {
                let mut controls = self.at.controls.clone();
                controls.values_mut(k).iter_mut().zip(&along).for_each(|(m, d)| *m += s * d);
                controls
            };
            let expected = difference(|s| work(Instant { controls: &moved(s), ..self.at }))?;
            let slope = SPACE.dot(found.controls.values(k), &along);
            let scale: f64 = found.controls.values(k).iter().zip(&along).map(|(g, d)| (g * d).abs()).sum();
            agree("the derivative by the controls", &[slope], "differences", &expected, scale)?;
        }
        let Some(step) = self.at.step else { return Ok(()) };
        self.check_before(&found.before, step, lambda)?;
        let offset = |b: &[f64], s: f64| -> Vec<f64> { b.iter().zip(lambda).map(|(b, d)| b + s * d).collect() };
        let with = |velocity: f64, acceleration: f64| TimeStep {
            velocity: (step.velocity.0, offset(&step.velocity.1, velocity)),
            acceleration: (step.acceleration.0, offset(&step.acceleration.1, acceleration)),
            ..step.clone()
        };
        let by_velocity = difference(|s| work(Instant { step: Some(&with(s, 0.0)), ..self.at }))?;
        let slope = [SPACE.dot(&found.velocity, lambda)];
        agree("the derivative by the velocity", &slope, "differences", &by_velocity, SPACE.norm(&found.velocity))?;
        let by_acceleration = difference(|s| work(Instant { step: Some(&with(0.0, s)), ..self.at }))?;
        let slope = [SPACE.dot(&found.acceleration, lambda)];
        let size = SPACE.norm(&found.acceleration);
        agree("the derivative by the acceleration", &slope, "differences", &by_acceleration, size)?;
        let mut mass = self.model.tangents().matrix();
        self.contribution.add_mass(&self.at, &mut mass).map_err(|lacking| lacking.to_string())?;
        let mut product = vec![0.0; lambda.len()];
        let dofs = self.model.unknowns().nodal();
        mass.multiply(&lambda[..dofs], &mut product[..dofs]);
        agree("the mass times a vector", &product, "the derivative by the acceleration", &found.acceleration, size)
    }

    /// By the state that the step begins at, whose velocity and acceleration go into those of the end, not into this.
    fn check_before(&self, found: &BeforeStep, step: &TimeStep, lambda: &[f64]) -> Result<(), String> {
        let work =
            |step: &TimeStep| Ok(vec![SPACE.dot(lambda, &self.sums(Instant { step: Some(step), ..self.at })?.force)]);
        let with = |s: f64| {
            let u = step.before.u.iter().zip(lambda).map(|(u, d)| u + s * d).collect::<Vec<f64>>();
            let mut controls = Controls::clone(&step.before.controls);
            for k in 0..controls.len() {
                let scales = scales(self.contribution.slots(), k == self.at.block, self.size);
                controls.values_mut(k).iter_mut().zip(scales).for_each(|(m, (_, scale))| *m += s * scale);
            }
            let mut history = History::clone(&step.history);
            (0..history.len()).for_each(|k| history.values_mut(k).iter_mut().for_each(|z| *z += s));
            let before = State { u: u.into(), controls: controls.into(), ..step.before.clone() };
            TimeStep { before, history: history.into(), ..step.clone() }
        };
        let expected = difference(|s| work(&with(s)))?;
        let by_u: f64 = SPACE.dot(&found.u, lambda);
        let of_block = |k: usize| -> f64 {
            let scales = scales(self.contribution.slots(), k == self.at.block, self.size);
            found.controls.values(k).iter().zip(scales).map(|(d, (_, scale))| d * scale).sum()
        };
        let by_controls = (0..found.controls.len()).map(of_block).sum::<f64>();
        let by_history: f64 = (0..found.history.len()).flat_map(|k| found.history.values(k)).sum();
        let slope = by_u + by_controls + by_history;
        let scale = by_u.abs() + by_controls.abs() + by_history.abs();
        agree("the derivative by the state before", &[slope], "differences", &expected, scale)
    }

    fn point(&self, at: &Instant) -> Result<Box<dyn ContributionPoint + '_>, Inadmissible> {
        self.model.point_of(self.contribution, at, Need::Derivatives)
    }

    /// Of a point whose residual was found before, as where solvers ask for it.
    fn tangent(&self, at: Instant) -> Result<BorderedTangent, Inadmissible> {
        let mut tangent = BorderedTangent::zero(self.model);
        let point = self.point(&at)?;
        point.add_residual(&at, Demand { energy: true, force: true }, &mut Sums::zero(self.model.unknowns().len()))?;
        tangent.add(self.contribution, point.as_ref(), &at)?;
        Ok(tangent)
    }

    fn sums(&self, at: Instant) -> Result<Sums, Inadmissible> {
        let mut sums = Sums::zero(self.model.unknowns().len());
        self.point(&at)?.add_residual(&at, Demand { energy: true, force: true }, &mut sums)?;
        Ok(sums)
    }

    fn along(&self, direction: &[f64], s: f64) -> Vec<f64> {
        self.at.u.iter().zip(direction).map(|(u, d)| u + s * d).collect()
    }

    fn moved<'u>(&'u self, u: &'u [f64]) -> Instant<'u> {
        Instant { u, ..self.at }
    }
}

/// The derivative at 0 by central differences of sixth order.
fn difference(f: impl Fn(f64) -> Result<Vec<f64>, Inadmissible>) -> Result<Vec<f64>, String> {
    const H: f64 = 0.02;
    let mut sum: Vec<f64> = Vec::new();
    for (offset, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        for sign in [1.0, -1.0] {
            let value = f(sign * offset * H).map_err(|at| at.to_string())?;
            sum.resize(value.len(), 0.0);
            sum.iter_mut().zip(&value).for_each(|(s, v)| *s += sign * weight * v / (60.0 * H));
        }
    }
    Ok(sum)
}

/// Whether two vectors agree beside their size and what they are the difference of.
fn agree(what: &str, found: &[f64], other: &str, expected: &[f64], scale: f64) -> Result<(), String> {
    let error = SPACE.max_abs(&sub(found, expected));
    let allowed = TOLERANCE * SPACE.max_abs(expected).max(SPACE.max_abs(found)) + 1e-9 * scale;
    if error <= allowed {
        return Ok(());
    }
    Err(format!("{what} differs from {other} by {error:.3e} of {:.3e}", SPACE.max_abs(expected)))
}
