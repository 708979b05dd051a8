//! [`Equations`]: the evaluation of a model by solvers.

use crate::linear_systems::saddle_point::BorderedTangent;
use crate::linear_systems::tangent::{Tangent, TangentRef};
use crate::model::{Model, ModelPoint};
use crate::nonlinear::anchor::Anchor;
use crate::nonlinear::iterate::Iterate;
use crate::search::options::SolveOptions;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::{Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::Inadmissible;
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;
use nastic_body::strategy::Strategy;
use nastic_linear::SparseMatrix;

/// Relative residual of a step in time above which its tangents leave out the curvature of contacts: the forces of gaps that an iterate has closed too far make
/// it large, and it is of no use there.
const MIN_FLAT_RESIDUAL: f64 = 1e-2;
/// Relative residual of a step in time below which it may end at a saddle, which Newton's method finds: above it goes downhill.
const MAX_SADDLE_RESIDUAL: f64 = 1e-4;
/// Distance of prescribed components from their places in a step in time that is rounding, as a share of the body's size: a guess that carries them along.
const PLACE_ROUNDING: f64 = 1e-12;

/// `r(x) = 0`: the residual of a model by the unknowns `x = (u, p)`, p the multipliers of constraints, or `x = (u, p, s)` along a path.
pub(crate) struct Equations<'a> {
    pub model: &'a Model,
    pub drive: Drive<'a>,
    pub options: &'a SolveOptions<'a>,
    /// A proximal term beside the model.
    pub anchor: Option<&'a Anchor>,
    /// [`Instant::flat_contacts`]
    pub flat_contacts: bool,
}

/// How controls and loads are given.
#[derive(Clone, Copy)]
pub(crate) enum Drive<'a> {
    /// Controls and loads are given.
    Held {
        controls: &'a Controls,
        load: f64,
        /// The time step to this equilibrium, if any.
        time_step: Option<&'a TimeStep>,
        /// Share of the way to the controls asked for.
        share: f64,
    },
    /// Controls `(1 - s) c_0 + s c_1` and loads `(1 - s) l_0 + s l_1`, s the last unknown.
    Path { from: &'a State, to: (&'a Controls, f64) },
}

/// The remaining displacement of the prescribed components.
pub(super) type Jump = Option<Vec<f64>>;

/// A model evaluated at a vector of unknowns.
pub(crate) struct Evaluated<'m> {
    /// Energy and residual, without inactive inequalities.
    pub sums: Sums,
    pub point: ModelPoint<'m>,
}

impl<'a> Equations<'a> {
    /// Calls a function with the instant of a vector of unknowns.
    fn with<T>(&self, x: &[f64], call: impl FnOnce(&Instant) -> T) -> T {
        let parallel = self.options.parallel;
        match self.drive {
            Drive::Held { controls, load, time_step, .. } => {
                let flat_contacts = self.flat_contacts;
                call(&Instant { step: time_step, parallel, flat_contacts, ..Instant::new(x, controls, load) })
            }
            Drive::Path { .. } => {
                let (u, s) = self.split(x);
                let (controls, load) = self.prescribed_at(s);
                call(&Instant { parallel, ..Instant::new(u, &controls, load) })
            }
        }
    }

    /// The controls that are given; along a path those at its end.
    pub fn controls(&self) -> &'a Controls {
        match self.drive {
            Drive::Held { controls, .. } => controls,
            Drive::Path { to, .. } => to.0,
        }
    }

    /// Whether the residual is the derivative of a potential: of the model, or with lagged normal forces of friction.
    pub fn has_potential(&self) -> bool {
        match self.drive {
            Drive::Held { time_step: Some(step), .. } if step.lag.is_some() => {
                self.model.has_potential_without_friction()
            }
            _ => self.model.properties().has_potential(),
        }
    }

    /// Whether it is an equilibrium at given controls, not a step in time.
    pub fn is_static(&self) -> bool {
        matches!(self.drive, Drive::Held { time_step: None, .. })
    }

    /// Whether it is a step in time.
    pub fn is_step(&self) -> bool {
        matches!(self.drive, Drive::Held { time_step: Some(_), .. })
    }

    /// Whether tangents may leave out the curvature of contacts: in steps in time, where inertia or a short way makes an equilibrium a minimum.
    pub fn may_flatten(&self) -> bool {
        self.is_step() && self.model.touches_something() && self.options.strategies.has(Strategy::FlatContacts)
    }

    /// Whether tangents at an iterate leave it out: far from the end of a step.
    pub fn flattens(&self, here: &Iterate) -> bool {
        here.relative > MIN_FLAT_RESIDUAL && self.may_flatten()
    }

    /// Whether steps from an iterate go downhill alone, where the tangent is not positive definite.
    pub fn descends(&self, here: &Iterate) -> bool {
        here.relative > MAX_SADDLE_RESIDUAL && self.may_flatten()
    }

    /// Whether trials of equilibria project rigid bodies onto their constraints; for steps in time see [`stays_rigid`](Self::stays_rigid).
    pub fn turns_rigid_bodies(&self) -> bool {
        self.is_static() && !self.model.supports.ties().is_empty() && self.model.unknowns().has_one_nodal_field()
    }

    /// Whether iterates stay on the constraints, along which the potential decreases: in a step in time in which rigid bodies alone are constrained.
    pub fn stays_rigid(&self) -> bool {
        self.is_step() && self.anchor.is_none() && self.model.restores_all()
    }

    /// Unknowns with rigid bodies put onto their constraints.
    pub fn restored(&self, x: Vec<f64>) -> Vec<f64> {
        self.model.restored(&x).unwrap_or(x)
    }

    /// Displacement with multipliers, and their place s on the way.
    pub fn split<'x>(&self, x: &'x [f64]) -> (&'x [f64], f64) {
        match self.drive {
            Drive::Held { share, .. } => (x, share),
            Drive::Path { .. } => (&x[..x.len() - 1], x[x.len() - 1]),
        }
    }

    /// Controls and load at a place on the way.
    pub fn prescribed_at(&self, s: f64) -> (Controls, f64) {
        match self.drive {
            Drive::Held { controls, load, .. } => (controls.clone(), load),
            Drive::Path { from, to } => {
                let load = if s == 1.0 { to.1 } else { from.load + s * (to.1 - from.load) };
                (from.controls.blend(to.0, s), load)
            }
        }
    }

    /// Number of unknowns on nodes.
    pub fn dofs(&self) -> usize {
        self.model.unknowns().nodal()
    }

    /// The model at x, for derivatives.
    pub fn point(&self, x: &[f64]) -> Result<ModelPoint<'a>, Inadmissible> {
        self.with(x, |at| self.model.at(at, Need::Derivatives))
    }

    /// Energy and residual at x.
    pub fn evaluate(&self, x: &[f64]) -> Result<Evaluated<'a>, Inadmissible> {
        let point = self.point(x)?;
        Ok(Evaluated { sums: self.sums(&point, x)?, point })
    }

    /// The same at the displacement of a point.
    pub fn sums(&self, point: &ModelPoint, x: &[f64]) -> Result<Sums, Inadmissible> {
        let mut sums = self.with(x, |at| point.evaluate(at, Demand { energy: true, force: true }))?;
        self.model.leave_out_slack(self.split(x).0, &mut sums);
        if let Some(anchor) = self.anchor {
            anchor.add(x, &mut sums);
        }
        Ok(sums)
    }

    /// The residual alone, at another place on the way.
    pub fn force_at(&self, point: &ModelPoint, u: &[f64], s: f64) -> Result<Vec<f64>, Inadmissible> {
        let (controls, load) = self.prescribed_at(s);
        let at = Instant { parallel: self.options.parallel, ..Instant::new(u, &controls, load) };
        Ok(point.evaluate(&at, Demand { energy: false, force: true })?.force)
    }

    /// The sums of the contributions that have no potential.
    pub fn without_potential(&self, point: &ModelPoint, x: &[f64]) -> Result<Sums, Inadmissible> {
        self.with(x, |at| point.evaluate_without_potential(at))
    }

    /// What friction with lagged normal forces adds to the potential in a step, `D(u)`; motions have neither ranks nor further fields.
    pub fn dissipation(&self, lagged: &TimeStep, point: &ModelPoint, x: &[f64]) -> Result<f64, Inadmissible> {
        self.with(x, |at| {
            let energy = |at: &Instant| point.evaluate_friction(at).map(|sums| sums.energy);
            Ok(energy(&Instant { step: Some(lagged), ..*at })? - energy(at)?)
        })
    }

    /// The tangent by the displacement, in the memory of the previous one.
    pub fn tangent<'m>(
        &self,
        here: &Iterate,
        memory: &'m mut Option<SparseMatrix>,
    ) -> Result<&'m mut SparseMatrix, Inadmissible> {
        let matrix = memory.get_or_insert_with(|| self.model.tangents().matrix());
        matrix.clear();
        self.with(here.x, |at| here.point.add_tangent(at, matrix))?;
        if let Some(anchor) = self.anchor {
            matrix.add_diagonal(anchor.diagonal());
        }
        Ok(matrix)
    }

    /// The same by products of cells, if `products` is set and the model has them.
    pub fn tangent_or_products<'m>(
        &self,
        here: &Iterate,
        products: bool,
        memory: &'m mut Option<Tangent>,
    ) -> Result<&'m mut Tangent, Inadmissible> {
        // the old tangent is dropped before the new one is made
        let mut entries = memory.take().and_then(Tangent::into_entries);
        if products
            && self.anchor.is_none()
            && let Some(products) = self.with(here.x, |at| here.point.cell_products(at))?
        {
            return Ok(memory.insert(Tangent::of_products(self.model, products)));
        }
        self.tangent(here, &mut entries)?;
        let entries = entries.unwrap_or_else(|| self.model.tangents().matrix());
        Ok(memory.insert(Tangent::of_entries(entries)))
    }

    /// The tangent with the border of the constraints.
    pub fn bordered_tangent(&self, point: &ModelPoint, x: &[f64]) -> Result<BorderedTangent, Inadmissible> {
        let mut tangent = self.with(x, |at| point.bordered_tangent(at))?;
        if let Some(anchor) = self.anchor {
            tangent.matrix.add_diagonal(anchor.diagonal());
        }
        Ok(tangent)
    }

    /// Adds the residuals `-g` of all inequalities, of inactive ones too, and returns the scales of their rounding.
    pub fn put_slack(
        &self,
        point: &ModelPoint,
        x: &[f64],
        inequalities: &[bool],
        residual: &mut [f64],
    ) -> Result<Vec<f64>, Inadmissible> {
        if !inequalities.contains(&true) {
            return Ok(Vec::new());
        }
        let of_them = self.with(x, |at| point.inequality_residuals(at))?;
        let dofs = self.dofs();
        for k in (0..inequalities.len()).filter(|&k| inequalities[k]) {
            residual[dofs + k] = of_them.force[dofs + k];
        }
        Ok(of_them.force_scale[dofs..].to_vec())
    }

    /// Calls a function with the instant of x.
    pub fn at<T>(&self, x: &[f64], call: impl FnOnce(&Instant) -> T) -> T {
        self.with(x, call)
    }

    /// The longest share of the straight move from an iterate to another displacement that every contribution admits.
    pub fn admissible_move(&self, from: &Iterate, to: &[f64]) -> Result<f64, Inadmissible> {
        self.with(from.x, |at| from.point.admissible_move(at, self.split(to).0))
    }

    /// The same for the contributions beside the body, for moves with rotations: a straight line inverts parts that rotate by more
    /// than 110 degrees.
    pub fn admissible_chord(&self, from: &[f64], to: &[f64]) -> Result<f64, Inadmissible> {
        self.chord(&self.point(from)?, from, to)
    }

    /// The same from a point.
    pub fn chord(&self, point: &ModelPoint, from: &[f64], to: &[f64]) -> Result<f64, Inadmissible> {
        self.with(from, |at| point.admissible_move_of_others(at, self.split(to).0))
    }

    /// Along a path, sets prescribed components to their values at s, and in a step in time where rounding alone keeps them away; elsewhere they
    /// [jump](Self::jump) in a step.
    pub fn place(&self, x: &mut [f64]) {
        let values = match self.drive {
            Drive::Path { .. } => {
                let (controls, load) = self.prescribed_at(self.split(x).1);
                self.model.prescribed(&controls, load)
            }
            Drive::Held { controls, load, time_step: Some(step), share } => {
                let values = self.prescribed(controls, load, Some(step), share);
                if self.jump_to(&values, x).is_some() {
                    return;
                }
                values
            }
            Drive::Held { .. } => return,
        };
        for ((u, &fixed), value) in x.iter_mut().zip(self.model.supports.fixed()).zip(values) {
            if fixed {
                *u = value;
            }
        }
    }

    /// The remaining displacement of the prescribed components; `None` when it is zero, in a step in time rounding.
    pub fn jump(&self, x: &[f64]) -> Jump {
        let Drive::Held { controls, load, time_step, share } = self.drive else { return None };
        self.jump_to(&self.prescribed(controls, load, time_step, share), x)
    }

    fn jump_to(&self, prescribed: &[f64], x: &[f64]) -> Jump {
        let wanted = self.model.supports.fixed().iter().zip(prescribed).zip(x);
        let jump: Vec<f64> = wanted.map(|((&f, &v), &u)| if f { v - u } else { 0.0 }).collect();
        let rounding = if self.is_step() { PLACE_ROUNDING * self.diagonal() } else { 0.0 };
        self.model.unknowns().any(jump.iter().any(|d| d.abs() > rounding)).then_some(jump)
    }

    /// The values of the prescribed components; those of an extrapolated end are interpolated between the state before and that end.
    fn prescribed(&self, controls: &Controls, load: f64, time_step: Option<&TimeStep>, share: f64) -> Vec<f64> {
        let Some((step, end)) = time_step.and_then(|step| Some((step, step.end.as_ref()?))) else {
            return self.model.prescribed(controls, load);
        };
        let controls = step.before.controls.blend(&end.controls, share);
        let mut w = self.model.prescribed(&controls, load);
        w.iter_mut().zip(&end.rest).for_each(|(w, b)| *w = (*w - b) / end.alpha);
        w
    }

    /// Free residual, and its norm relative to the norm of the sums of absolute forces, for each field separately; for constraints each relative
    /// to its own scale.
    pub fn residual(&self, now: &Sums) -> (Vec<f64>, f64) {
        let mut residual = now.force.clone();
        self.model.supports.restrict(&mut residual);
        let space = self.model.unknowns();
        let share = |r: &[f64], scale: &[f64]| {
            let size = space.norm(r);
            if size == 0.0 { 0.0 } else { size / space.norm(scale) }
        };
        let (by_field, scales) = (space.by_nodal_field(&residual), space.by_nodal_field(&now.force_scale));
        let of_fields = by_field.iter().zip(&scales).map(|(r, scale)| share(r, scale)).fold(0.0, f64::max);
        let relative = of_fields.max(self.constraint_residual(&residual, now));
        (residual, relative)
    }

    /// The norm of the forces of the moduli of the body under a strain of 1, the scale of forces where there are none. Zero for a body over ranks, without
    /// messages.
    pub fn force_of_moduli(&self) -> f64 {
        let Equations { model, .. } = self;
        match model.ranks().is_over_ranks() {
            true => 0.0,
            false => model.body.squared_force_of_moduli(&model.rigid_cells(), self.controls()).sqrt(),
        }
    }

    /// The largest residual of a constraint relative to its own scale; zero without constraints.
    pub fn constraint_residual(&self, residual: &[f64], now: &Sums) -> f64 {
        let share = |(r, scale): (&f64, &f64)| if *r == 0.0 { 0.0 } else { r.abs() / scale };
        residual.iter().zip(&now.force_scale).skip(self.dofs()).map(share).fold(0.0, f64::max)
    }

    /// The size of the terms whose difference is the energy: W vanishes at rest, while its terms have the size of
    /// `F : dP/dF : F`, or `x . K x` with the current positions x.
    pub fn energy_scale<'m>(&self, tangent: impl Into<TangentRef<'m>>, u: &[f64], now: &Sums) -> f64 {
        let disc = self.model.discretization();
        let dim = disc.dim();
        let block = self.model.unknowns().block();
        let mut x = self.model.nodal(u).to_vec();
        for (x, reference) in x.chunks_exact_mut(block).zip(disc.mesh().points()) {
            x.iter_mut().zip(&reference[..dim]).for_each(|(x, reference)| *x += reference);
        }
        let mut stretched = vec![0.0; x.len()];
        tangent.into().multiply(&x, &mut stretched, self.options.parallel);
        let terms: f64 = x.iter().zip(&stretched).map(|(x, f)| x * f).sum();
        now.energy_scale + self.model.unknowns().total(terms).abs()
    }

    /// The size of the body.
    pub fn diagonal(&self) -> f64 {
        self.model.discretization().diagonal()
    }
}

/// `u + length step`.
pub(crate) fn moved(u: &[f64], step: &[f64], length: f64) -> Vec<f64> {
    u.iter().zip(step).map(|(u, s)| u + length * s).collect()
}
