//! Cost terms and the shapes they aim at.

use crate::lower::context::Context;
use crate::lower::named_cost::{Named, NamedMotionTerm};
use crate::lower::target_shape::TargetShape;
use crate::lower::{cost_term, far_target, named_groups, time};
use crate::warning::{HAUSDORFF_LENGTH, INPUT};
use nastic_control::{
    ControlError, Cost, IntoCost, MakeCost, Phi, Reduced, SmoothedHausdorff, Timeline, TrajectoryCost, When,
};
use nastic_language::schema;
use nastic_language::schema::{Case, Cost as Block, Phi as PhiBlock, Stages};
use std::sync::Arc;

/// The target meshes, by cost; read before the body is built, so that all missing files are reported at once.
pub(super) fn load_targets(case: &Case, context: &mut Context<'_>) -> Vec<Option<TargetShape>> {
    case.costs.iter().map(|cost| load_target(cost, context)).collect()
}

pub(super) fn load_target(cost: &Block, context: &mut Context<'_>) -> Option<TargetShape> {
    let (source, at) = match cost {
        Block::SmoothedHausdorff(block) => (&block.target, block.at.key("target")),
        _ => cost_term::mesh_of(cost.term()?)?,
    };
    let mesh = super::mesh::load(source, &at, context)?;
    Some(TargetShape {
        at: cost.at().clone(),
        cost: cost.name().to_owned(),
        mesh,
        regions: None,
        displacement: Arc::default(),
    })
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
            of_motion.push((
                block,
                Lowering { case, reduced: &reduced, block, target: target.as_ref() }.lower_motion(context)?,
            ));
            continue;
        }
        // shown is where a target that moves is at the end
        let end = reduced.timeline().map_or(0.0, Timeline::end);
        let at_end = block.at_time(end);
        let lowering = Lowering { case, reduced: &reduced, block: &at_end, target: target.as_ref() };
        let Some(cost) = lowering.lower(context) else { continue };
        let shape = cost.target(reduced.solid());
        let shape = shape
            .map(|shape| TargetShape::of(block.at().clone(), block.name(), shape, reduced.solid().discretization()));
        far_target::check(block, cost.as_ref(), shape.as_ref(), &reduced, context);
        shapes.extend(shape);
        terms.push((block, target, Named::new(block.name(), cost)));
    }
    for (block, target, term) in terms {
        reduced = add_term(case, block, target.as_ref(), term, reduced, context)?;
    }
    for (block, cost) in of_motion {
        let term = NamedMotionTerm { name: block.name().to_owned(), cost };
        reduced = context.take(block.at(), reduced.trajectory_cost(term))?;
    }
    Some((reduced, shapes))
}

/// A term, in a motion with the part of it over which it counts.
fn add_term(
    case: &Case,
    block: &Block,
    target: Option<&TargetShape>,
    term: Named,
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
    along_path(case, block, target, when, reduced, context)
}

/// A term whose target moves: one for every instant at which it counts.
fn along_path(
    case: &Case,
    block: &Block,
    target: Option<&TargetShape>,
    when: When,
    reduced: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    let instants = reduced.timeline()?.instants().to_vec();
    let mut made = Vec::new();
    for t in instants {
        let at_time = block.at_time(t);
        let cost = Lowering { case, reduced: &reduced, block: &at_time, target }.lower(context)?;
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
    /// The mesh it aims at, if any.
    pub target: Option<&'a TargetShape>,
}

impl Lowering<'_> {
    /// A term of states.
    pub fn lower(&self, context: &mut Context<'_>) -> Option<Box<dyn Cost>> {
        if let Block::SmoothedHausdorff(block) = self.block {
            return self.hausdorff(block, self.target?, context);
        }
        self.check_unit(context)?;
        let term = self.block.term()?;
        if let MakeCost::OfStates(make) = term.form.make { self.make(term, make, context) } else { None }
    }

    /// Refuses the greyness of what is no number between 0 and 1.
    fn check_unit(&self, context: &mut Context<'_>) -> Option<()> {
        let term = self.block.term().filter(|_| self.block.kind() == "greyness");
        let name = term.and_then(|term| term.control());
        let control = self.case.controls.iter().find(|control| Some(control.name()) == name);
        let block = control.and_then(|control| self.reduced.layout().block(&control.of).ok());
        let Some(block) = block.filter(|block| block.unit != "1") else { return Some(()) };
        let message = format!("no greyness: that is of a number between 0 and 1, and this one is in {}", block.unit);
        context.complain(&self.block.at().key("of"), message);
        None
    }

    /// A term of a motion.
    fn lower_motion(&self, context: &mut Context<'_>) -> Option<Box<dyn TrajectoryCost>> {
        let term = self.block.term()?;
        if let MakeCost::OfMotion(make) = term.form.make { self.make(term, make, context) } else { None }
    }

    fn hausdorff(
        &self,
        block: &schema::SmoothedHausdorff,
        target: &TargetShape,
        context: &mut Context<'_>,
    ) -> Option<Box<dyn Cost>> {
        let solid = self.reduced.solid();
        let mut sound = true;
        if let Some(region) = &block.region {
            sound &= named_groups::cells(solid.mesh(), region, &block.at.key("region"), context).is_some();
        }
        if let Some(region) = &block.target_region {
            sound &= named_groups::cells(&target.mesh, region, &block.at.key("target_region"), context).is_some();
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
