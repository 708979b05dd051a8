//! Control fields: starts, bounds, and the set they stay in.

use crate::lower::actuation::is_built;
use crate::lower::context::Context;
use crate::lower::control_field::{Admitted, ControlField};
use crate::lower::control_grid::unresolved;
use crate::lower::result_array::is_reserved;
use crate::lower::tension::{beyond_limit, default_upper, limit};
use crate::lower::variant::Variant;
use crate::lower::{design, field_chain, material, optimizer, shape, time};
use crate::warning::{CONVEXITY, GRID_RESOLUTION, UNBOUNDED};
use nastic_control::{Consumer, ControlBlock, RateLimit, Reduced, Shown, Space};
use nastic_energy::Slot;
use nastic_language::expression::Formula;
use nastic_language::quantity::Dimension;
use nastic_language::schema::{
    Beginning, Bound, Case, Cells, Contact, Control, Parameter, Space as SpaceBlock, Start, pulling,
};
use nastic_opt::{Admissible, Ball, Bounds, Limit, Product};

/// A number of a law so many times its own is as good as infinite.
const LARGE: f64 = 1e9;

/// What becomes of the block `controls`.
pub(super) struct Lowered {
    pub controls: Vec<ControlField>,
    pub start: Vec<f64>,
    pub set: Product,
}

/// Adds the fields to the problem; `None` after a complaint that leaves no problem to go on with.
pub(super) fn add(case: &Case, mut reduced: Reduced, context: &mut Context<'_>) -> Option<Reduced> {
    for control in &case.controls {
        let mut owners = case.actuation.iter().filter(|a| owned(&control.of, &a.name));
        let is_missing = |contact: &Contact| {
            std::iter::once(contact.name()).chain(contact.obstacle.clone()).any(|name| owned(&control.of, &name))
                && !is_built(&contact.name(), &reduced)
        };
        let mut materials = case.materials.iter().filter(|material| material.number_of(&control.of).is_some());
        if materials.any(|own| own.name.as_deref().is_some_and(|name| !is_built(name, &reduced))) {
            continue;
        }
        if owners.any(|actuation| !is_built(&actuation.name, &reduced)) || case.contact.iter().any(is_missing) {
            continue;
        }
        let unbuilt = |of: &Consumer| !is_built(of.owner(), &reduced);
        let consumers = design::consumers(case, &control.of);
        if consumers.iter().any(unbuilt) {
            continue;
        }
        let space = match control.space {
            SpaceBlock::Uniform => Space::Uniform,
            SpaceBlock::Region => Space::Region,
            SpaceBlock::Cell => Space::Cell,
            SpaceBlock::Node => Space::Node,
            SpaceBlock::Grid(Cells(cells)) => Space::Grid(cells),
        };
        let knots = match (&control.in_time, &case.time) {
            (Some(in_time), Some(time)) => Some(time::knots(in_time, time.end, context)?),
            _ => None,
        };
        let added = match (&control.direction, knots) {
            (None, None) if !consumers.is_empty() => reduced.design(&control.of, space, &consumers),
            (None, None) => reduced.control(&control.of, space),
            (Some(direction), None) => reduced.control_along(&control.of, space, direction.xyz()),
            (None, Some(knots)) => reduced.control_in_time(&control.of, space, knots),
            (Some(direction), Some(knots)) => reduced.control_along_in_time(&control.of, space, direction.xyz(), knots),
        };
        reduced = context.take(&control.at, added)?;
        if control.log {
            reduced = context.take(&control.at.key("log"), reduced.by_logarithm(&control.of))?;
        }
        reduced = field_chain::add(case, control, reduced, context)?;
        // Between nodes the vectors must be as long as at them, and everywhere where a method moves their components.
        let apart = space.interpolates() || control.filter.is_some() || !optimizer::takes_spheres(case);
        if let (true, Some(norm), None) = (apart, control.length(), &control.direction) {
            reduced = context.take(&control.at.key("norm"), reduced.of_length(&control.of, norm))?;
        }
        if let (Some(rate), true) = (control.rate.as_ref().and_then(Formula::constant), control.in_time.is_some()) {
            let at = control.at.key("rate");
            let limit = context.take(&at, RateLimit::of(&control.of, rate))?;
            reduced = context.take(&at, reduced.limit_rate(limit))?;
        }
    }
    Some(reduced)
}

/// Whether a control is of that actuation: "magnet" or "magnet.remanence" of "magnet".
fn owned(of: &str, actuation: &str) -> bool {
    of.strip_prefix(actuation).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Starts and bounds of all fields, each once: those that all members share, of which there are `shared`, then those of
/// load cases.
pub(super) fn lower(
    shared: usize,
    variants: &[Variant],
    bodies: &[Reduced],
    contexts: &mut [Context<'_>],
) -> Option<Lowered> {
    let mut out = Lowered { controls: vec![], start: vec![], set: Product::new() };
    let mut known: Vec<(Option<usize>, usize)> = vec![];
    let (mut whole, mut starts) = (true, Vec::new());
    for ((variant, body), context) in variants.iter().zip(bodies).zip(&mut *contexts) {
        let fields = variant.case.controls.iter().zip(body.layout().blocks()).enumerate();
        for (k, (control, block)) in fields {
            let load_case = variant.load_case.filter(|_| k >= shared);
            if known.contains(&(load_case, k)) {
                continue;
            }
            known.push((load_case, k));
            let users = variants.iter().zip(bodies).filter(|(user, _)| k < shared || user.load_case == load_case);
            let limit = limit(users.clone().map(|(_, body)| body), k);
            let default_upper = default_upper(users.map(|(_, body)| body), k);
            let case_name = load_case.map(|_| variant.case_name.as_str());
            let lowering =
                Lowering { case: &variant.case, reduced: body, control, block, limit, default_upper, case_name };
            match lowering.lower(context) {
                Some((field, start, set)) => {
                    out.controls.push(ControlField { load_case, ..field });
                    starts.push(start.clone());
                    out.start.extend(start);
                    out.set.push(block.len(), set.into());
                }
                None => whole = false,
            }
        }
    }
    let start_of = |variant: &Variant, k: usize| {
        let field = (variant.load_case.filter(|_| k >= shared), k);
        starts.get(known.iter().position(|own| *own == field)?)
    };
    let whole = whole && shape::check_starts(variants, bodies, contexts, start_of);
    if let (true, [variant, ..], [body, ..], [context, ..]) = (whole, variants, bodies, contexts) {
        material::warn_of_corners(&variant.case, &out.controls, body.solid(), context);
    }
    whole.then_some(out)
}

/// Says how messages call the fields of a body, and weighs them in the inner product, so that a change through its whole range counts the same in each; a
/// field without a range counts as the first one that has one.
pub(super) fn weigh(
    variant: &Variant,
    shared: usize,
    mut body: Reduced,
    fields: &[ControlField],
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let reference = fields.iter().find_map(|field| field.range());
    let names: Vec<String> = body.layout().blocks().iter().map(|block| block.name.clone()).collect();
    for (k, (control, name)) in variant.case.controls.iter().zip(&names).enumerate() {
        let load_case = variant.load_case.filter(|_| k >= shared);
        let own = fields.iter().find(|field| field.load_case == load_case && field.at == control.at);
        if let Some(field) = own {
            let shown = Shown { name: field.name.clone(), unit: field.unit.clone() };
            body = context.take(&control.at, body.show(name, shown))?;
        }
        if let Some((reference, range)) = reference.zip(own.and_then(|field| field.range())) {
            body = context.take(&control.at, body.weigh(name, (reference / range).powi(2)))?;
        }
    }
    Some(body)
}

pub(super) struct Lowering<'a> {
    pub case: &'a Case,
    pub reduced: &'a Reduced,
    pub control: &'a Control,
    pub block: &'a ControlBlock,
    /// The laws' bound on a tension of this family alone.
    limit: Option<f64>,
    /// The upper bound where none is given.
    default_upper: Option<f64>,
    /// Name of the load case that has it alone.
    pub case_name: Option<&'a str>,
}

/// What is admitted, in words and as a set.
struct Allowed {
    admitted: Admitted,
    bounds: Option<Bounds>,
    set: Box<dyn Admissible>,
}

impl Lowering<'_> {
    fn lower(&self, context: &mut Context<'_>) -> Option<(ControlField, Vec<f64>, Box<dyn Admissible>)> {
        let limit = self.limit;
        let allowed = self.allowed(context);
        let start = self.start(context);
        if let Some(allowed) = &allowed {
            field_chain::check_fixed(self.case, self.control, allowed.admitted, self.reduced.solid(), context)?;
        }
        let (Allowed { admitted, bounds, set }, start) = (allowed?, start?);
        let start = self.unknowns(self.settle(start, set.as_ref(), context)?, context)?;
        let (bounds, set) = self.of_unknowns(bounds, set);
        optimizer::check_set(self.case, self.control, set.as_ref(), start.len(), context)?;
        self.check_at_rest(bounds.as_ref(), context)?;
        let unit = nastic_language::expression::dimension_of(self.block.unit).unwrap_or(Dimension::NONE);
        let unit = if self.slot().is_some_and(|slot| slot.group == "rotation") {
            "rad".to_owned()
        } else {
            context.units.label(unit)
        };
        if let Some(message) = unresolved(self.block, self.reduced) {
            context.warn(&GRID_RESOLUTION, &self.control.at.key("space"), message);
        }
        let (at, array) = (self.control.at.clone(), self.control.name().to_owned());
        if is_reserved(&array) {
            context
                .complain(&at, format!("results have an array \"{array}\" already: give the control another \"name\""));
        }
        let name = self.case_name.map_or_else(|| array.clone(), |case| format!("{case}.{array}"));
        let log = self.block.log;
        Some((ControlField { at, name, array, load_case: None, unit, admitted, log, bounds, limit }, start, set))
    }

    /// Refuses controls that may move a held surface at t = 0, where the body is at rest.
    fn check_at_rest(&self, bounds: Option<&Bounds>, context: &mut Context<'_>) -> Option<()> {
        let begins = self.case.time.as_ref().filter(|time| time.start == Beginning::Rest);
        let still = |bounds: &Bounds| (0..self.block.size()).all(|entry| bounds.at(entry) == (0.0, 0.0));
        if begins.is_none() || !self.block.holds || bounds.is_some_and(still) {
            return Some(());
        }
        let message = "may move its surface away at t = 0, where a body that begins at rest is undeformed: give \"in_time\", a \"direction\" and \
                       bounds that are 0 there, as \"upper\": \"20 mm * min(t / 50 ms, 1)\", or begin at the equilibrium, \"start\" in \"time\"";
        context.complain(&self.control.at, message);
        None
    }

    /// The first slot that it drives.
    pub(super) fn slot(&self) -> Option<Slot> {
        let target = &self.block.targets[0];
        self.reduced.solid().model().controllable()[target.actuation].slots.get(target.slot).copied()
    }

    /// The slot, where it only pulls.
    fn pulling(&self) -> Option<&'static str> {
        self.slot().filter(|slot| slot.not_negative).map(|slot| slot.group)
    }

    /// The default bounds of a growth, if it drives one.
    fn bounds_of_growth(&self) -> Option<[f64; 2]> {
        let target = &self.block.targets[0];
        let attached = self.reduced.solid().body().actuations().get(target.actuation)?;
        attached.law.strain_map().map(|map| map.default_bounds(target.slot))
    }

    /// Why the growth that it drives refuses a value, its other slots at rest.
    fn refused_growth(&self, value: f64) -> Option<&'static str> {
        let target = &self.block.targets[0];
        let body = self.reduced.solid().body();
        body.refused_growth(target.actuation, |_, slot, rest| if slot == target.slot { value } else { rest })
    }

    fn allowed(&self, context: &mut Context<'_>) -> Option<Allowed> {
        if self.block.components == 1 { self.bounds(context) } else { self.vectors(context) }
    }

    fn vectors(&self, context: &mut Context<'_>) -> Option<Allowed> {
        let dim = self.block.components;
        if self.control.lower.is_some() || self.control.upper.is_some() {
            return self.box_of_vectors(context);
        }
        match (self.control.length(), self.control.longest()) {
            (Some(norm), _) => {
                let set = context.take(&self.control.at.key("norm"), optimizer::of_length(self.case, dim, norm))?;
                Some(Allowed { admitted: Admitted::Norm(norm), bounds: None, set })
            }
            (None, Some(most)) => {
                let set = context.take(&self.control.at.key("max_norm"), Ball::new(dim, most))?;
                Some(Allowed { admitted: Admitted::MaxNorm(most), bounds: None, set: Box::new(set) })
            }
            (None, None) => {
                let message = "neither \"norm\" nor \"max_norm\" is given: the vectors may grow without bound";
                context.warn(&UNBOUNDED, &self.control.at, message);
                Some(Allowed { admitted: Admitted::Any, bounds: None, set: Box::new(Bounds::none()) })
            }
        }
    }

    /// Vectors whose components have bounds.
    fn box_of_vectors(&self, context: &mut Context<'_>) -> Option<Allowed> {
        let mut limit = |key: &str, bound: &Option<Bound>, none: f64| match bound {
            Some(Bound::Vector(entries)) => context.take(&self.control.at.key(key), self.vectors_in_time(entries)),
            _ => Some(vec![none; self.block.len()]),
        };
        let lower = limit("lower", &self.control.lower, f64::NEG_INFINITY);
        let upper = limit("upper", &self.control.upper, f64::INFINITY);
        let (lower, upper) = (Limit::Each(lower?), Limit::Each(upper?));
        if least(&lower) == f64::NEG_INFINITY || greatest(&upper) == f64::INFINITY {
            context.warn(&UNBOUNDED, &self.control.at, "the components have no bound on one side");
        }
        let admitted = Admitted::Between { lower: least(&lower), upper: greatest(&upper) };
        let bounds = context.take(&self.control.at.key("lower"), Bounds::new(lower, upper))?;
        Some(Allowed { admitted, bounds: Some(bounds.clone()), set: Box::new(bounds) })
    }

    /// Whether start and bounds are of the dimension of what they control, where the mesh decides it (a volume is an area in
    /// the plane).
    fn check_dimension(&self, context: &mut Context<'_>) -> Option<()> {
        // of a formula's parameter, whose unit is the user's
        let Some(dimension) = nastic_language::expression::dimension_of(self.block.unit) else { return Some(()) };
        let start = if let Some(Start::Scalar(formula)) = &self.control.start { Some(formula) } else { None };
        let bounds = [("lower", &self.control.lower), ("upper", &self.control.upper)].map(|(key, bound)| {
            (key, if let Some(Bound::Scalar(Parameter::Formula(formula))) = bound { Some(formula) } else { None })
        });
        for (key, formula) in bounds.into_iter().chain([("start", start)]) {
            if let Some(Err(why)) = formula.map(|formula| formula.check(dimension)) {
                context.complain(&self.control.at.key(key), why);
                return None;
            }
        }
        Some(())
    }

    fn bounds(&self, context: &mut Context<'_>) -> Option<Allowed> {
        self.check_dimension(context)?;
        let lower = self.bound("lower", &self.control.lower, context);
        let upper = self.bound("upper", &self.control.upper, context);
        let (mut lower, mut upper) = (lower?, upper?);
        if let Some(slot) = self.pulling() {
            if lower.as_ref().is_some_and(|lower| least(lower) < 0.0) {
                context.complain(&self.control.at.key("lower"), pulling(slot).why);
                return None;
            }
            lower = lower.or(Some(Limit::Uniform(0.0)));
        }
        if let Some(range) = design::range(self.case, &self.control.of) {
            let own = [lower.as_ref().map(least), upper.as_ref().map(greatest)];
            design::check_bounds(self.case, self.control, own, range, context)?;
            lower = lower.or(Some(Limit::Uniform(range[0])));
            upper = upper.or(Some(Limit::Uniform(range[1])));
        } else if let Some(defaults) = self.bounds_of_growth() {
            for (key, value) in [("lower", lower.as_ref().map(least)), ("upper", upper.as_ref().map(greatest))] {
                if let Some(why) = value.filter(|value| value.is_finite()).and_then(|value| self.refused_growth(value))
                {
                    context.complain(&self.control.at.key(key), why);
                    return None;
                }
            }
            let [least, most] = defaults.map(|own| own.is_finite().then_some(Limit::Uniform(own)));
            lower = lower.or(least.filter(|_| !self.block.log));
            upper = upper.or(most);
        }
        if let (Some(most), Some(_)) = (self.control.longest(), &self.control.direction) {
            let beyond = lower.as_ref().is_some_and(|lower| least(lower) < -most)
                || upper.as_ref().is_some_and(|upper| greatest(upper) > most);
            if beyond {
                let message = format!("the bounds let the amplitude exceed the \"max_norm\" {most}");
                context.complain(&self.control.at.key("max_norm"), message);
                return None;
            }
            lower = lower.or(Some(Limit::Uniform(-most)));
            upper = upper.or(Some(Limit::Uniform(most)));
        }
        if lower.is_none() && self.is_number() && !self.block.log {
            let message = "a number of a material needs a \"lower\" bound, above which its law holds; or \"log\": true, which keeps it positive";
            context.complain(&self.control.at, message);
            return None;
        }
        if lower.is_none() && !self.block.log {
            let message = match self.control.direction {
                None if self.bounds_of_growth().is_some() => "values may leave nothing of a length, where solves fail",
                None => "the theory needs none, but a strong contraction may crush cells; give one if solves fail",
                Some(_) => "the amplitude may grow without bound",
            };
            context.warn(&UNBOUNDED, &self.control.at, format!("no \"lower\" bound is given: {message}"));
        }
        let lower = lower.unwrap_or(Limit::Uniform(f64::NEG_INFINITY));
        let upper = match (upper, self.default_upper) {
            (Some(upper), _) => {
                let most = greatest(&upper);
                if let Some(limit) = self.limit.filter(|limit| most > *limit) {
                    context.warn(&CONVEXITY, &self.control.at.key("upper"), beyond_limit(most, limit, context.units));
                }
                upper
            }
            (None, Some(default)) => Limit::Uniform(default),
            (None, None) if self.refuses_large(context) => return None,
            (None, None) if self.block.log => Limit::Uniform(f64::INFINITY),
            (None, None) => {
                context.warn(&UNBOUNDED, &self.control.at, "no \"upper\" bound is given, and the law reports none");
                Limit::Uniform(f64::INFINITY)
            }
        };
        // what is positive has no lower bound below zero, and none that says so
        let lower = match lower {
            Limit::Uniform(f64::NEG_INFINITY) if self.block.log => Limit::Uniform(0.0),
            lower => lower,
        };
        let bounded = [("lower", self.control.lower.is_some(), least(&lower)), ("upper", true, least(&upper))];
        if let Some((key, _, value)) =
            bounded.into_iter().find(|(_, given, value)| *given && *value <= 0.0 && self.block.log)
        {
            context.complain(&self.control.at.key(key), no_logarithm(value));
            return None;
        }
        let lowest = least(&lower);
        let admitted = Admitted::Between { lower: lowest, upper: greatest(&upper) };
        let ends = [if self.block.log && lowest <= 0.0 { f64::NEG_INFINITY } else { lowest }, greatest(&upper)];
        let refused = material::refused(self.case, &self.control.of, ends, self.reduced.solid(), context);
        if let Some(refused) = refused.filter(|_| self.control.lower.is_some() || self.control.upper.is_some()) {
            context.complain(&self.control.at, format!("the bounds leave what its law admits: {refused}"));
            return None;
        }
        match Bounds::new(lower, upper) {
            Ok(bounds) => Some(Allowed { admitted, bounds: Some(bounds.clone()), set: Box::new(bounds) }),
            Err(nastic_opt::SetError::Crossed { index, lower, upper }) => {
                let place = self.place(index);
                let from_law = if self.control.upper.is_none() { " (within the law's convexity bound)" } else { "" };
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

    /// Complains where the law of a number bounds it above, as Poisson's ratio, and nothing else does.
    fn refuses_large(&self, context: &mut Context<'_>) -> bool {
        let large = [LARGE * self.slot().map_or(1.0, |slot| slot.rest().abs().max(1.0)), f64::INFINITY];
        let refused = material::refused(self.case, &self.control.of, large, self.reduced.solid(), context);
        if let Some(refused) = &refused {
            let message = format!("give an \"upper\" bound, up to which its law holds: {refused}");
            context.complain(&self.control.at, message);
        }
        refused.is_some()
    }

    /// Whether it is a number of a material.
    fn is_number(&self) -> bool {
        self.slot().is_some_and(|slot| slot.is_design())
            && self.case.materials.iter().any(|own| own.number_of(&self.control.of).is_some())
    }

    /// The bounds, and the set of bounds, of unknowns from those of values.
    fn of_unknowns(&self, bounds: Option<Bounds>, set: Box<dyn Admissible>) -> (Option<Bounds>, Box<dyn Admissible>) {
        let Some(values) = bounds.as_ref().filter(|_| self.block.log) else { return (bounds, set) };
        let (lower, upper) = (0..self.block.len()).map(|i| values.at(i)).map(|(l, u)| (l.ln(), u.ln())).unzip();
        match Bounds::new(Limit::Each(lower), Limit::Each(upper)) {
            Ok(own) => (Some(own.clone()), Box::new(own)),
            Err(_) => (bounds, set),
        }
    }

    /// Unknowns with these values.
    fn unknowns(&self, values: Vec<f64>, context: &mut Context<'_>) -> Option<Vec<f64>> {
        match values.iter().find(|value| self.block.log && **value <= 0.0) {
            Some(value) => {
                context.complain(&self.control.at.key("start"), no_logarithm(*value));
                None
            }
            None if self.block.log => Some(values.into_iter().map(f64::ln).collect()),
            None => Some(values),
        }
    }

    /// A bound by unknown. The outer option is a complaint, the inner one a bound left out.
    fn bound(&self, key: &str, bound: &Option<Bound>, context: &mut Context<'_>) -> Option<Option<Limit>> {
        let Some(bound) = bound.as_ref().and_then(Bound::scalar) else { return Some(None) };
        if let Some(constant) = bound.constant() {
            return Some(Some(Limit::Uniform(constant)));
        }
        let at = self.control.at.key(key);
        let values = match bound {
            Parameter::Formula(formula) => {
                let values = context.take(&at, self.in_time(formula))?;
                return Some(Some(Limit::Each(values)));
            }
            Parameter::Array(file) => self.values_of_file(file, &at, context)?,
            Parameter::Cells(_) => {
                context.complain(&at, "a bound cannot be random");
                return None;
            }
        };
        Some(Some(Limit::Each(values.repeat(self.block.values_in_time()))))
    }
}

fn no_logarithm(value: f64) -> String {
    format!("{value} has no logarithm: with \"log\" all values are positive")
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
