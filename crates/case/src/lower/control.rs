//! Control fields: starts, bounds, and the set they stay in.

use super::actuation::beyond_limit;
use super::array::{self, Entity, MeshArray};
use super::context::Context;
use crate::quantity::Dimension;
use crate::result::snapshot::RESERVED;
use crate::schema::{Case, Control, Parameter, Space as SpaceBlock, Start, vector_at};
use crate::syntax::At;
use nastic_control::{ControlBlock, Reduced, Space};
use nastic_opt::{Admissible, Ball, Bounds, Limit, Outside, Product, Random, Sphere};

/// A control field as the case describes it; its place in the control vector is that of the same number in the layout.
#[derive(Clone, PartialEq, Debug)]
pub struct ControlField {
    /// Path of its block in the case.
    pub at: At,
    /// Its name in results.
    pub name: String,
    /// Unit of its values, in the case's system.
    pub unit: String,
    /// What its values may be.
    pub admitted: Admitted,
    /// The bounds of every component, where the values are scalars.
    pub bounds: Option<Bounds>,
    /// The convexity bound of the passive law, for a tension where the law has one.
    pub limit: Option<f64>,
}

/// What values are admitted.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Admitted {
    /// Between bounds; the least and the greatest over the body.
    Between {
        /// Least lower bound.
        lower: f64,
        /// Greatest upper bound.
        upper: f64,
    },
    /// Vectors of this length.
    Norm(f64),
    /// Vectors no longer than this.
    MaxNorm(f64),
    /// All vectors.
    Any,
}

/// What becomes of the block `controls`.
pub(super) struct Lowered {
    pub controls: Vec<ControlField>,
    pub start: Vec<f64>,
    pub set: Product,
}

/// A start is this near to a bound by rounding alone, as a share of the values' size.
const ROUNDING: f64 = 1e-9;

/// Adds the fields to the problem; `None` after a complaint that leaves no problem to go on with.
pub(super) fn add(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for control in &case.controls {
        let space = match control.space {
            SpaceBlock::Uniform => Space::Uniform,
            SpaceBlock::Region => Space::Region,
            SpaceBlock::Cell => Space::Cell,
            SpaceBlock::Node => Space::Node,
        };
        reduced = context.take(&control.at, reduced.control(&control.of, space))?;
    }
    Some(reduced)
}

/// Starts and bounds of all fields.
pub(super) fn lower(case: &Case, reduced: &Reduced, context: &mut Context<'_>) -> Option<Lowered> {
    let mut out = Lowered { controls: vec![], start: vec![], set: Product::new() };
    let mut whole = true;
    for (control, block) in case.controls.iter().zip(reduced.layout().blocks()) {
        let lowering = Lowering { case, reduced, control, block };
        match lowering.lower(context) {
            Some((field, start, set)) => {
                out.controls.push(field);
                out.start.extend(start);
                out.set.push(block.len(), set);
            }
            None => whole = false,
        }
    }
    whole.then_some(out)
}

struct Lowering<'a> {
    case: &'a Case,
    reduced: &'a Reduced,
    control: &'a Control,
    block: &'a ControlBlock,
}

/// What is admitted, in words and as a set.
struct Allowed {
    admitted: Admitted,
    bounds: Option<Bounds>,
    set: Box<dyn Admissible>,
}

impl Lowering<'_> {
    fn lower(&self, context: &mut Context<'_>) -> Option<(ControlField, Vec<f64>, Box<dyn Admissible>)> {
        let limit = self.limit();
        let allowed = self.allowed(limit, context);
        let start = self.start(context);
        let (Allowed { admitted, bounds, set }, start) = (allowed?, start?);
        let start = self.settle(start, set.as_ref(), context)?;
        let unit = crate::expression::dimension_of(self.block.unit).unwrap_or(Dimension::NONE);
        let unit = context.units.label(unit);
        let (at, name) = (self.control.at.clone(), self.control.name().to_owned());
        if RESERVED.contains(&name.as_str()) || name.starts_with("gradient_") || name.starts_with("direction_") {
            context
                .complain(&at, format!("results have an array \"{name}\" already: give the control another \"name\""));
        }
        Some((ControlField { at, name, unit, admitted, bounds, limit }, start, set))
    }

    /// The law's bound on a tension.
    fn limit(&self) -> Option<f64> {
        let body = self.reduced.solid().body();
        (self.block.components == 1).then(|| body.fiber_limit(self.block.actuation)).flatten()
    }

    fn allowed(&self, limit: Option<f64>, context: &mut Context<'_>) -> Option<Allowed> {
        if self.block.components == 1 { self.bounds(limit, context) } else { self.vectors(context) }
    }

    fn vectors(&self, context: &mut Context<'_>) -> Option<Allowed> {
        let dim = self.block.components;
        match (self.control.norm, self.control.max_norm) {
            (Some(norm), _) => {
                let set = context.take(&self.control.at.key("norm"), Sphere::new(dim, norm))?;
                Some(Allowed { admitted: Admitted::Norm(norm), bounds: None, set: Box::new(set) })
            }
            (None, Some(most)) => {
                let set = context.take(&self.control.at.key("max_norm"), Ball::new(dim, most))?;
                Some(Allowed { admitted: Admitted::MaxNorm(most), bounds: None, set: Box::new(set) })
            }
            (None, None) => {
                context.warn(
                    &self.control.at,
                    "neither \"norm\" nor \"max_norm\" is given: the vectors may grow without bound",
                );
                Some(Allowed { admitted: Admitted::Any, bounds: None, set: Box::new(Bounds::none()) })
            }
        }
    }

    fn bounds(&self, limit: Option<f64>, context: &mut Context<'_>) -> Option<Allowed> {
        let lower = self.bound("lower", &self.control.lower, context);
        let upper = self.bound("upper", &self.control.upper, context);
        let (lower, upper) = (lower?, upper?);
        if lower.is_none() {
            let message = "no \"lower\" bound is given: the theory needs none, but a strong contraction may crush cells; \
                           give one if solves fail";
            context.warn(&self.control.at, message);
        }
        let lower = lower.unwrap_or(Limit::Uniform(f64::NEG_INFINITY));
        let upper = match (upper, limit) {
            (Some(upper), limit) => {
                let most = greatest(&upper);
                if let Some(limit) = limit.filter(|limit| most > *limit) {
                    context.warn(&self.control.at.key("upper"), beyond_limit(most, limit, context.units));
                }
                upper
            }
            (None, Some(limit)) => Limit::Uniform(limit),
            (None, None) => {
                context.warn(&self.control.at, "no \"upper\" bound is given, and the law reports none");
                Limit::Uniform(f64::INFINITY)
            }
        };
        let admitted = Admitted::Between { lower: least(&lower), upper: greatest(&upper) };
        match Bounds::new(lower, upper) {
            Ok(bounds) => Some(Allowed { admitted, bounds: Some(bounds.clone()), set: Box::new(bounds) }),
            Err(nastic_opt::SetError::Crossed { index, lower, upper }) => {
                let place = self.block.map.describe(index);
                let from_law = if self.control.upper.is_none() { " (the law's convexity bound)" } else { "" };
                let message =
                    format!("crossed bounds at {place}: \"lower\" is {lower}, above \"upper\" {upper}{from_law}");
                context.complain(&self.control.at.key("lower"), message);
                None
            }
            Err(error) => {
                context.complain(&self.control.at.key("lower"), error);
                None
            }
        }
    }

    /// A bound by unknown. The outer option is a complaint, the inner one a bound left out.
    fn bound(&self, key: &str, bound: &Option<Parameter>, context: &mut Context<'_>) -> Option<Option<Limit>> {
        let Some(bound) = bound else { return Some(None) };
        if let Some(constant) = bound.constant() {
            return Some(Some(Limit::Uniform(constant)));
        }
        let at = self.control.at.key(key);
        let values = match bound {
            Parameter::Formula(formula) => {
                let values: Result<_, _> = self.block.map.positions().iter().map(|x| formula.at(*x)).collect();
                context.take(&at, values)?
            }
            Parameter::Array(file) => self.values_of_file(file, &at, context)?,
        };
        Some(Some(Limit::Each(values)))
    }

    fn start(&self, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let at = self.control.at.key("start");
        let positions = self.block.map.positions();
        match &self.control.start {
            None => Some(vec![0.0; self.block.len()]),
            Some(Start::Scalar(formula)) => {
                let values: Result<_, _> = positions.iter().map(|x| formula.at(*x)).collect();
                context.take(&at, values)
            }
            Some(Start::Vector(entries)) => {
                let values: Result<Vec<_>, _> = positions.iter().map(|x| vector_at(entries, *x)).collect();
                context.take(&at, values).map(|values| values.concat())
            }
            Some(Start::Array(file)) => self.values_of_file(file, &at, context),
            Some(Start::Random(seed)) => {
                let Some(norm) = self.control.norm.or(self.control.max_norm) else {
                    context.complain(&at, "random directions need a length: give \"norm\" or \"max_norm\"");
                    return None;
                };
                Some(random(*seed, norm, positions.len(), self.reduced.solid().mesh().dim()))
            }
        }
    }

    /// Entries of an array that belong to the unknowns, or its mean over each unknown's part of the body.
    fn values_of_file(&self, file: &crate::schema::ArrayFile, at: &At, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let map = &self.block.map;
        let mesh = self.reduced.solid().mesh();
        let prefer = if map.space() == Space::Node { Entity::Node } else { Entity::Cell };
        let array = array::read(file, at, &[self.block.components], prefer, self.case, mesh, context)?;
        let n = array.components;
        let direct = matches!((map.space(), array.entity), (Space::Node, Entity::Node) | (Space::Cell, Entity::Cell));
        if direct {
            let of = |&entity: &u32| array.values[entity as usize * n..][..n].to_vec();
            return Some(map.entities().iter().flat_map(of).collect());
        }
        Some(self.means(&array))
    }

    fn means(&self, array: &MeshArray) -> Vec<f64> {
        let (disc, n) = (self.reduced.solid().discretization(), array.components);
        let at_points = match array.entity {
            Entity::Node => disc.body().interpolate(&array.values, n),
            Entity::Cell => {
                let of = |cell: u32| array.values[cell as usize * n..][..n].to_vec();
                disc.body().cells().into_iter().flat_map(of).collect()
            }
        };
        let map = &self.block.map;
        let mut sums = vec![0.0; map.len() * n];
        let mut weights = vec![0.0; map.len()];
        let mut range = vec![(f64::INFINITY, f64::NEG_INFINITY); map.len() * n];
        for (q, w) in disc.body().weights().iter().enumerate() {
            for (i, shape) in map.at_point(q) {
                weights[i] += w * shape;
                for c in 0..n {
                    let (value, range) = (at_points[q * n + c], &mut range[i * n + c]);
                    sums[i * n + c] += w * shape * value;
                    *range = (range.0.min(value), range.1.max(value));
                }
            }
        }
        // The mean of equal values is that value, without rounding.
        let mean = |(k, sum): (usize, &f64)| (sum / weights[k / n]).clamp(range[k].0, range[k].1);
        sums.iter().enumerate().map(mean).collect()
    }

    /// The start, moved onto the set if only rounding keeps it outside.
    fn settle(&self, mut start: Vec<f64>, set: &dyn Admissible, context: &mut Context<'_>) -> Option<Vec<f64>> {
        let at = self.control.at.key("start");
        if let Some(norm) = self.control.norm {
            if let Some(k) = start.chunks(self.block.components).position(|v| v.iter().all(|x| *x == 0.0)) {
                let place = self.block.map.describe(k);
                context.complain(&at, format!("the start is zero at {place}: it cannot be given the \"norm\" {norm}"));
                return None;
            }
            set.project(&mut start);
            return Some(start);
        }
        let Err(outside) = set.check(&start) else { return Some(start) };
        let mut moved = start.clone();
        set.project(&mut moved);
        let size = start.iter().chain(&moved).fold(0.0f64, |most, x| most.max(x.abs()));
        let far = start.iter().zip(&moved).any(|(a, b)| (a - b).abs() > ROUNDING * size);
        if far {
            context.complain(&at, self.outside(&outside));
            return None;
        }
        Some(moved)
    }

    fn outside(&self, outside: &Outside) -> String {
        let place = self.block.map.describe(outside.index / self.block.components);
        let allowed = &outside.allowed;
        format!("the start {} at {place} lies outside what is allowed: {allowed}", outside.value)
    }
}

fn least(limit: &Limit) -> f64 {
    match limit {
        Limit::Uniform(value) => *value,
        Limit::Each(values) => values.iter().copied().fold(f64::INFINITY, f64::min),
    }
}

fn greatest(limit: &Limit) -> f64 {
    match limit {
        Limit::Uniform(value) => *value,
        Limit::Each(values) => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    }
}

/// Vectors of one length and random directions, uniform on the sphere (in the plane: on the circle).
fn random(seed: u64, norm: f64, count: usize, dim: usize) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut out = Vec::with_capacity(3 * count);
    while out.len() < 3 * count {
        let mut v = [0.0; 3];
        v.iter_mut().take(dim).for_each(|x| *x = random.symmetric());
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (0.1..=1.0).contains(&length) {
            out.extend(v.map(|x| x * norm / length));
        }
    }
    out
}
