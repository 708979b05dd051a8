//! Constraints.

use super::context::Context;
use super::cost::Lowering;
use super::named_groups::{Kind, NamedGroups};
use super::obstacle;
use crate::lower::target_shape::TargetShape;
use crate::warning::INSIDE_OBSTACLE;
use nastic_control::{
    BetweenNodes, Bound, Constraint, ConstraintPoint, ControlError, CostContext, CostLimit, Instants, IntoConstraint,
    ObstacleDistance, Reduced, Timeline,
};
use nastic_fem::Solid;
use nastic_language::number::{count, short};
use nastic_language::schema::{Case, Constraint as Block, Cost, HoldsWhen, KeepOut};
use nastic_opt::ConstraintGroup;
use std::sync::Arc;

/// Depths below this share of the body's diagonal are rounding.
const ROUNDING: f64 = 1e-9;

/// Target meshes of bounded functionals, by constraint.
pub(super) fn load_targets(case: &Case, context: &mut Context<'_>) -> Vec<Option<TargetShape>> {
    let target = |block: &Block, context: &mut Context<'_>| super::cost::load_target(block.cost.as_ref()?, context);
    case.constraints.iter().map(|block| target(block, context)).collect()
}

/// Refuses what a constraint, which holds at instants of a motion, cannot take.
fn check_at_instants(cost: &Cost, context: &mut Context<'_>) -> Option<()> {
    let message = if cost.when().is_some() {
        "a constraint holds at instants: \"when\" belongs beside \"cost\", as \"always\", \"end\" or { \"at\": .. }"
    } else if cost.uses_time() {
        "a bounded functional does not change in time: leave t out, or take a term of the cost"
    } else if cost.is_of_motion() {
        "a constraint holds at instants, and this functional is one of the whole motion: take it as a term of the cost"
    } else {
        return Some(());
    };
    context.complain(cost.at(), message);
    None
}

/// At which instants of a motion it holds.
fn instants(block: &Block) -> Instants {
    match &block.when {
        Some(HoldsWhen::Always) => Instants::All,
        Some(HoldsWhen::At(times)) => Instants::At(times.clone()),
        None if block.obstacle.is_some() => Instants::All,
        None | Some(HoldsWhen::End) => Instants::End,
    }
}

/// Adds all constraints to the problem; `None` if that cannot be.
pub(super) fn add(
    case: &Case,
    targets: Vec<Option<TargetShape>>,
    mut reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let mut all = Vec::new();
    for (block, target) in case.constraints.iter().zip(targets) {
        let bound = match (&block.obstacle, &block.cost) {
            (Some(keep_out), _) => {
                let bound = distance(case, keep_out, &reduced, context);
                bound.inspect(|bound| look_at_rest(case, block, keep_out, bound.as_ref(), &reduced, context))
            }
            (None, Some(cost)) => {
                check_at_instants(cost, context)?;
                let lowering = Lowering { case, reduced: &reduced, block: cost, target: target.as_ref() };
                let cost = lowering.lower(context)?;
                let limit = match (block.at_most, block.at_least, block.equal) {
                    (Some(bound), ..) => CostLimit::at_most(cost, bound),
                    (None, Some(bound), _) => CostLimit::at_least(cost, bound),
                    (None, None, bound) => CostLimit::equal(cost, bound.unwrap_or_default()),
                };
                let limit = block.scale.into_iter().fold(limit, CostLimit::scale);
                context.take(&block.at, limit.bind(reduced.solid()))
            }
            (None, None) => None,
        };
        let constraint = bound?;
        all.push((block, Named { name: block.name().to_owned(), constraint }));
    }
    for (block, named) in all {
        let named: Box<dyn Constraint> = Box::new(named);
        reduced = match case.time {
            Some(_) => context.take(&block.at.key("when"), reduced.constrain_when(instants(block), named))?,
            None => context.take(&block.at, reduced.constrain(named))?,
        };
    }
    Some(reduced)
}

fn distance(case: &Case, block: &KeepOut, reduced: &Reduced, context: &mut Context<'_>) -> Option<Box<dyn Constraint>> {
    let solid = reduced.solid();
    let place = NamedGroups::of(&block.surface, &block.region, &block.nodes)?;
    place.nodes(solid.mesh(), &block.at, context)?;
    let shape = obstacle::of(case, &block.shape, block.clearance, context)?;
    let distance = match place.kind {
        Kind::Surface => ObstacleDistance::surface(place.names, shape),
        Kind::Region => ObstacleDistance::region(place.names, shape),
        Kind::Nodes => ObstacleDistance::nodes(place.names, shape),
    };
    context.take(&block.at, distance.clearance(block.clearance).bind(solid))
}

/// Warns where the body at rest, or a support of it, is inside of an obstacle.
fn look_at_rest(
    case: &Case,
    block: &Block,
    keep_out: &KeepOut,
    bound: &dyn Constraint,
    reduced: &Reduced,
    context: &mut Context<'_>,
) {
    let solid = reduced.solid();
    let (mesh, dim, supports) = (solid.mesh(), solid.discretization().dim(), solid.supports());
    let Some(shape) = obstacle::of(case, &keep_out.shape, keep_out.clearance, context) else { return };
    let unit = context.units.length().symbol;
    let tolerance = ROUNDING * mesh.diagonal();
    let (mut held, mut free) = (Vec::new(), Vec::new());
    for &node in bound.nodes().unwrap_or_default() {
        let (mut x, first) = (mesh.points()[node as usize], node as usize * dim);
        let is_held = supports.fixed()[first..first + dim].iter().all(|fixed| *fixed);
        if is_held {
            x.iter_mut().zip(&supports.values()[first..first + dim]).for_each(|(x, u)| *x += u);
        }
        let depth = keep_out.clearance - shape.distance(&x);
        if depth > tolerance {
            if is_held { &mut held } else { &mut free }.push((depth, node, x));
        }
    }
    let (clearance, name) = (keep_out.clearance, block.name());
    let place = if clearance > 0.0 {
        format!("closer to the obstacle than {} {unit}", short(clearance))
    } else {
        "inside of the obstacle".to_owned()
    };
    let deepest = |found: &[(f64, u32, [f64; 3])]| {
        let deepest = found.iter().max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        deepest
            .map(|(depth, node, x)| format!("node {node} at ({}) by {} {unit}", x.map(short).join(", "), short(*depth)))
    };
    if held.is_empty() && free.is_empty() {
        let u = vec![0.0; solid.model().unknowns().len()];
        let (layout, m) = (reduced.layout_of_instant(), vec![]);
        let between =
            bound.between_nodes(&CostContext { solid, layout, u: &u, state: None, m: &m, stage: 0, step: None });
        if let Some(BetweenNodes { distance, position }) = between.filter(|between| between.distance < -tolerance) {
            let message = format!(
                "{name}: the body at rest is inside of the obstacle between its nodes, at ({}) by {} {unit}: they do not see it, unless the mesh is finer there",
                position.map(short).join(", "),
                short(-distance)
            );
            context.warn(&INSIDE_OBSTACLE, &block.at, message);
        }
        return;
    }
    let mut warn = |found: &[(f64, u32, [f64; 3])], what: &str, so: &str| {
        let Some(deepest) = deepest(found) else { return };
        let message = format!("{name}: {} {what} {place}, {deepest}: {so}", count(found.len(), "node"));
        context.warn(&INSIDE_OBSTACLE, &block.at, message);
    };
    warn(&held, "that a support holds lie", "no control can meet the constraint");
    warn(&free, "of the body at rest lie", "the optimisation may begin outside of the constraint");
}

/// Constraints under the name the case gives them.
#[derive(Debug)]
struct Named {
    name: String,
    constraint: Box<dyn Constraint>,
}

impl Constraint for Named {
    fn group(&self) -> ConstraintGroup {
        ConstraintGroup { name: self.name.clone(), ..self.constraint.group() }
    }

    fn unit(&self) -> &'static str {
        self.constraint.unit()
    }

    fn bound(&self) -> Option<Bound> {
        self.constraint.bound()
    }

    fn nodes(&self) -> Option<&[u32]> {
        self.constraint.nodes()
    }

    fn between_nodes(&self, at: &CostContext) -> Option<BetweenNodes> {
        self.constraint.between_nodes(at)
    }

    fn check_in_motion(&self, solid: &Solid, timeline: &Timeline, at_start: bool) -> Result<(), ControlError> {
        self.constraint.check_in_motion(solid, timeline, at_start)
    }

    fn needs_step(&self) -> bool {
        self.constraint.needs_step()
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn ConstraintPoint>, ControlError> {
        self.constraint.at(at)
    }
}
