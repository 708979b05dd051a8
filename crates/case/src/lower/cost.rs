//! Cost terms and the shapes they aim at.

use crate::lower::array::Entity;
use crate::lower::context::Context;
use crate::lower::named::key_of;
use crate::lower::named_cost::{Named, NamedMotionTerm};
use crate::lower::place::{Kind, Place};
use crate::lower::target_shape::TargetShape;
use crate::lower::{array, place, time};
use crate::warning::{HAUSDORFF_LENGTH, INPUT};
use nastic_control::{
    ActuationWork, ContactLoad, ControlError, ControlNorm, ControlRate, ControlSmoothness, Cost, IntoCost,
    KineticEnergy, ObstaclePenetration, Phi, Reduced, SmoothedHausdorff, Target, Timeline, Tracking, TrajectoryCost,
    When,
};
use nastic_energy::catalogue::{Inputs, choose_form};
use nastic_language::expression::EvaluationError;
use nastic_language::schema;
use nastic_language::schema::{
    AddedCost, Case, Cost as Block, Input, Phi as PhiBlock, Stages, Target as TargetBlock, vector_at,
};
use nastic_mesh::Mesh;
use nastic_tensor::Vec3;
use std::sync::{Arc, OnceLock};

/// The target meshes, by cost; read before the body is built, so that all missing files are told at once.
pub(super) fn load_targets(case: &Case, context: &mut Context<'_>) -> Vec<Option<TargetShape>> {
    case.costs.iter().map(|cost| load_target(cost, context)).collect()
}

pub(super) fn load_target(cost: &Block, context: &mut Context<'_>) -> Option<TargetShape> {
    let (source, at) = match cost {
        Block::SmoothedHausdorff(block) => (&block.target, block.at.key("target")),
        Block::Tracking(block) => match &block.target {
            TargetBlock::Nodes(nodes) => (&nodes.nodes, nodes.at.key("nodes")),
            _ => return None,
        },
        _ => return None,
    };
    let mesh = super::mesh::load(source, &at, context)?;
    Some(TargetShape { at: cost.at().clone(), cost: cost.name().to_owned(), mesh, regions: None, displacement: vec![] })
}

/// Adds all terms to the problem, with the targets to show; `None` if that cannot be.
pub(super) fn add(
    case: &Case,
    targets: Vec<Option<TargetShape>>,
    mut reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<(Reduced, Vec<TargetShape>)> {
    let (mut terms, mut shapes, mut of_motion) = (Vec::new(), Vec::new(), Vec::new());
    for (block, target) in case.costs.iter().zip(targets) {
        if block.weight() == 0.0 {
            context.warn(&INPUT, &block.at().key("weight"), "the weight is zero: the term is left out");
            continue;
        }
        if block.is_of_motion() {
            of_motion.push((block, of_a_motion(case, block, context)?));
            continue;
        }
        // shown is where a target that moves is at the end
        let end = reduced.timeline().map_or(0.0, Timeline::end);
        let at_end = block.at_time(end);
        let lowering = Lowering { case, reduced: &reduced, block: &at_end };
        let Some(cost) = lowering.lower(target, context) else { continue };
        let shape = cost.target(reduced.solid());
        shapes.extend(shape.map(|shape| TargetShape::of(block.at().clone(), block.name(), shape)));
        terms.push((block, Named::new(block.name(), cost)));
    }
    for (block, term) in terms {
        reduced = add_term(case, (block, term), reduced, context)?;
    }
    for (block, cost) in of_motion {
        let term = NamedMotionTerm { name: block.name().to_owned(), cost };
        reduced = context.take(block.at(), reduced.trajectory_cost(term))?;
    }
    Some((reduced, shapes))
}

/// A term of a motion.
fn of_a_motion(case: &Case, block: &Block, context: &mut Context<'_>) -> Option<Box<dyn TrajectoryCost>> {
    let at = block.at();
    Some(match block {
        Block::ControlRate(block) => {
            let of = case.controls.iter().find(|control| control.name() == block.of)?;
            Box::new(context.take(at, ControlRate::of(&of.of, block.weight))?)
        }
        Block::KineticEnergy(own) => Box::new(context.take(at, KineticEnergy::new(time::when(block), own.weight))?),
        _ => Box::new(context.take(at, ActuationWork::new(block.weight()))?),
    })
}

/// A term, in a motion with the part of it over which it counts.
fn add_term(
    case: &Case,
    (block, term): (&Block, Named),
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    if case.time.is_none() {
        return context.take(block.at(), reduced.cost(term));
    }
    let (when, at) = (time::when(block), block.at().key("when"));
    if !block.uses_time() {
        return context.take(&at, reduced.cost_when(when, term));
    }
    along_path(case, (block, when), reduced, context)
}

/// A term whose target moves: one for every instant at which it counts.
fn along_path(
    case: &Case,
    (block, when): (&Block, When),
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let instants = reduced.timeline()?.instants().to_vec();
    let mut made = Vec::new();
    for t in instants {
        let at_time = block.at_time(t);
        let lowering = Lowering { case, reduced: &reduced, block: &at_time };
        let cost = lowering.lower(None, context)?;
        made.push((t, Named::new(block.name(), cost)));
    }
    let place = |t: f64| made.binary_search_by(|(instant, _): &(f64, Named)| instant.total_cmp(&t)).ok();
    let at = |t: f64| place(t).map(|k| made[k].1.clone());
    let missing = || ControlError::Cost { what: "a target at no instant of the motion".to_owned() };
    let added = reduced.cost_along(when, |t| at(t).ok_or_else(missing));
    context.take(&block.at().key("when"), added)
}

/// What the terms themselves have to say.
pub(super) fn warn(case: &Case, reduced: &Reduced, context: &mut Context<'_>) {
    let of_states = |block: &&Block| block.weight() != 0.0 && !block.is_of_motion();
    let terms = case.costs.iter().filter(of_states);
    for (block, cost) in terms.zip(reduced.costs()) {
        for warning in cost.warnings(reduced.solid()) {
            context.warn(&HAUSDORFF_LENGTH, block.at(), warning);
        }
    }
}

/// A block of the case with what it refers to.
pub(super) struct Lowering<'a> {
    pub case: &'a Case,
    pub reduced: &'a Reduced,
    pub block: &'a Block,
}

impl Lowering<'_> {
    pub fn lower(&self, target: Option<TargetShape>, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        match self.block {
            Block::SmoothedHausdorff(block) => self.hausdorff(block, target?, context),
            Block::Tracking(block) => self.tracking(block, target, context),
            Block::Position(block) => self.position(block, context),
            Block::Orientation(block) => self.orientation(block, context),
            Block::Curvature(block) => self.curvature(block, context),
            Block::LargestStretch(block) => self.largest_stretch(block, context),
            Block::Compliance(block) => self.compliance(block, context),
            Block::ContactForce(block) => {
                let cost = ContactLoad::force(&block.contact).weight(block.weight);
                context.take(&block.at.key("contact"), cost.bind(self.reduced.solid()))
            }
            Block::ContactPressure(block) => {
                let cost = ContactLoad::pressure(&block.contact, block.exponent as u32).weight(block.weight);
                context.take(&block.at.key("contact"), cost.bind(self.reduced.solid()))
            }
            Block::Obstacle(block) => self.obstacle(block, context),
            Block::ControlNorm(block) => {
                let cost = ControlNorm::of(self.control(&block.of)?, block.weight);
                Some(Box::new(context.take(&block.at, cost)?))
            }
            Block::ControlSmoothness(block) => {
                let cost = ControlSmoothness::of(self.control(&block.of)?, block.weight);
                Some(Box::new(context.take(&block.at, cost)?))
            }
            // Of a motion, not of a state.
            Block::ControlRate(_) | Block::KineticEnergy(_) | Block::ActuationWork(_) => None,
            Block::Added(block) => {
                let inputs = uniform(block, context)?;
                let given = choose_form(block.row.name, block.row.forms, &inputs);
                let given = given.map_err(|error| context.complain(&key_of(&block.at, &error), error)).ok()?;
                let cost = (block.row.make)(self.reduced.solid(), &given, block.weight);
                context.take(&block.at, cost)
            }
        }
    }

    /// The library's name of a control, which is that of its actuation.
    fn control(&self, name: &str) -> Option<&str> {
        self.case.controls.iter().find(|control| control.name() == name).map(|control| control.of.as_str())
    }

    fn hausdorff(
        &self,
        block: &schema::SmoothedHausdorff,
        target: TargetShape,
        context: &mut Context<'_>,
    ) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let mut sound = true;
        if let Some(region) = &block.region {
            sound &= place::cells(solid.mesh(), region, &block.at.key("region"), context).is_some();
        }
        if let Some(region) = &block.target_region {
            sound &= place::cells(&target.mesh, region, &block.at.key("target_region"), context).is_some();
        }
        if !sound {
            return None;
        }
        let diagonal = target.mesh.diagonal_of(block.target_region.as_ref());
        let diagonal = context.take(&block.at.key("target_region"), diagonal)?;
        let mut cost = SmoothedHausdorff::to(target.mesh.clone()).phi(phi(&block.phi, diagonal)).weight(block.weight);
        cost = match &block.stages {
            Stages::Auto => cost.automatic_stages(),
            Stages::List(stages) => cost.stages(stages.iter().map(|stage| (stage.alpha, stage.beta, stage.gamma))),
        };
        if let Some(points) = block.quadrature {
            cost = cost.quadrature(points);
        }
        if let Some(region) = &block.region {
            cost = cost.region(region);
        }
        if let Some(region) = &block.target_region {
            cost = cost.target_region(region);
        }
        context.take(&block.at, cost.bind(solid))
    }

    fn tracking(
        &self,
        block: &schema::Tracking,
        target: Option<TargetShape>,
        context: &mut Context<'_>,
    ) -> Option<Box<dyn Cost>> {
        let mesh = self.reduced.solid().mesh().clone();
        let place = Place::of(&block.surface, &block.region, &block.nodes)?;
        place.nodes(&mesh, &block.at, context)?;
        let goal = self.goal(block, target, &mesh, context)?;
        let tracking = match place.kind {
            Kind::Surface => Tracking::surface(place.names, goal.target.clone()),
            Kind::Region => Tracking::region(place.names, goal.target.clone()),
            Kind::Nodes => Tracking::nodes(place.names, goal.target.clone()),
        };
        match tracking.weight(block.weight).bind(self.reduced.solid()) {
            Ok(cost) => Some(cost),
            Err(error) => {
                let why = goal.fault.get().map_or_else(|| error.to_string(), ToString::to_string);
                context.complain(&block.at.key("target"), why);
                None
            }
        }
    }

    fn obstacle(&self, block: &schema::Penetration, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let place = Place::of(&block.surface, &block.region, &block.nodes)?;
        place.nodes(solid.mesh(), &block.at, context)?;
        let shape = super::obstacle::of(self.case, &block.shape, context)?;
        let penetration = match place.kind {
            Kind::Surface => ObstaclePenetration::surface(place.names, shape),
            Kind::Region => ObstaclePenetration::region(place.names, shape),
            Kind::Nodes => ObstaclePenetration::nodes(place.names, shape),
        };
        context.take(&block.at, penetration.clearance(block.clearance).weight(block.weight).bind(solid))
    }

    fn goal(
        &self,
        block: &schema::Tracking,
        target: Option<TargetShape>,
        mesh: &Mesh,
        context: &mut Context<'_>,
    ) -> Option<Goal> {
        let (at, dim) = (block.at.key("target"), mesh.dim());
        let fault: Arc<OnceLock<EvaluationError>> = Arc::default();
        let target = match &block.target {
            TargetBlock::Formulas(entries) if entries.len() < dim => {
                context.complain(&at, format!("{} entries, but the body has {dim} dimensions", entries.len()));
                return None;
            }
            TargetBlock::Formulas(entries) => {
                let (entries, fault) = (entries.clone(), fault.clone());
                // The target of a plane body lies in its plane, whatever the third entry left out.
                Target::position(move |x| match vector_at(&entries, x) {
                    Ok(y) => y,
                    Err(error) => {
                        let _ = fault.set(error);
                        [f64::NAN; 3]
                    }
                })
            }
            TargetBlock::Array(file) => {
                let array = array::read(file, &at, &[2, 3], Entity::Node, self.case, mesh, context)?;
                if array.entity == Entity::Cell {
                    context.complain(&at.key("array"), "a displacement by cell is no target: one by node is wanted");
                    return None;
                }
                let entries = array.values.chunks_exact(array.components);
                Target::Displacement(entries.flat_map(|u| u[..dim.min(u.len())].to_vec()).collect())
            }
            TargetBlock::Nodes(nodes) => {
                let target = target?;
                let (found, wanted) = (target.mesh.points().len(), mesh.points().len());
                if found != wanted {
                    let name = target.mesh.name();
                    let message = format!("{name} has {found} nodes, the body's mesh {wanted}: no numbering in common");
                    context.complain(&nodes.at.key("nodes"), message);
                    return None;
                }
                let pairs = target.mesh.points().iter().zip(mesh.points());
                Target::Displacement(pairs.flat_map(|(y, x)| (0..dim).map(move |k| y[k] - x[k])).collect())
            }
        };
        Some(Goal { target, fault })
    }
}

/// What tracked points should reach, and the first fault of its formulas.
struct Goal {
    target: Target,
    fault: Arc<OnceLock<EvaluationError>>,
}

/// The parameters of an added cost, which are the same everywhere.
fn uniform(block: &AddedCost, context: &mut Context<'_>) -> Option<Inputs> {
    let mut out = Inputs::new();
    for (name, input) in &block.parameters {
        let constant = match input {
            Input::Number(value) => value.constant().map(|value| out.clone().number(name, value)),
            Input::Direction(value) => value.constant().map(|v| out.clone().direction(name, Vec3::from(v))),
            Input::Word(word) => Some(out.clone().choice(name, word)),
            Input::Name(place) => Some(out.clone().choice(name, place)),
        };
        let Some(with) = constant else {
            context.complain(&block.at.key(name), "a cost takes one value, not one that varies over the body");
            return None;
        };
        out = with;
    }
    Some(out)
}

fn phi(block: &PhiBlock, diagonal: f64) -> Phi {
    match block {
        PhiBlock::Exponential(phi) => {
            let length = phi.length.or(phi.fraction.map(|fraction| fraction * diagonal));
            Phi::Exponential { length: length.unwrap_or(diagonal) }
        }
        PhiBlock::Inverse(phi) => Phi::Inverse { eps: phi.eps },
        PhiBlock::SmoothInverse(phi) => Phi::SmoothInverse { eps: phi.eps },
    }
}
