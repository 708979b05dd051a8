//! [`Assembled`]: what a program that has no case file makes a [`CaseProblem`] of.

mod check;
mod error;

pub use error::AssemblyError;

use super::control_grid::unresolved;
use super::member::Label;
use super::probe::LocatedProbe;
use super::result_array::is_reserved;
use super::sizes;
use super::tension::{beyond_limit, beyond_together, joint_excess, limit};
use super::variant::stems;
use crate::lower::control_field::{Admitted, ControlField};
use crate::lower::problem::CaseProblem;
use crate::lower::target_shape::TargetShape;
use crate::warning::{CONVEXITY, GRID_RESOLUTION, HAUSDORFF_LENGTH, UNBOUNDED, UNITS, Warning};
use nastic_control::Reduced;
use nastic_ensemble::{Ensemble, EnsembleBlock, Member};
use nastic_language::expression::dimension_of;
use nastic_language::quantity::Dimension;
use nastic_language::schema::Case;
use nastic_language::syntax::{At, Document};
use nastic_opt::{Admissible, Bounds, Product};
use serde_json::Map;
use std::sync::Arc;

/// Bodies, sets and starts of a program, and what else results need to know.
#[derive(Debug)]
pub struct Assembled {
    /// The bodies with their costs.
    pub ensemble: Ensemble,
    /// Set and start of every control field, in the order of the ensemble's blocks.
    pub controls: Vec<ControlProblem>,
    /// Names and reference positions of points to report.
    pub probes: Vec<(String, [f64; 3])>,
    /// Title, units, optimiser, output; all else of it is empty.
    pub case: Case,
    /// What the problem is, under its name: equal documents are equal problems as far as a program can be written down.
    pub document: Document,
}

/// Where a control field may be, and where it begins.
#[derive(Debug)]
pub struct ControlProblem {
    /// What its values may be.
    pub admitted: Admission,
    /// The set they stay in.
    pub set: Arc<dyn Admissible>,
    /// The values to begin with.
    pub start: Vec<f64>,
}

/// What a control field may be, before the number of its values is known.
#[derive(Debug, Clone)]
pub enum Admission {
    /// Scalars within bounds.
    Bounds(Bounds),
    /// Vectors of so many components.
    Vectors {
        /// What each vector may be.
        admitted: Admitted,
        /// Components of a vector.
        dim: usize,
    },
}

impl CaseProblem {
    /// The problem of a program.
    ///
    /// # Errors
    /// The first member, start, control or probe that does not fit.
    pub fn assemble(assembled: Assembled) -> Result<Self, AssemblyError> {
        let Assembled { ensemble, controls, probes, case, document } = assembled;
        check::members(&ensemble)?;
        let labels: Vec<Label> = ensemble.members().iter().map(|member| label(&ensemble, member, &case)).collect();
        let (mut fields, mut start, mut set, mut warnings) = (vec![], vec![], Product::new(), vec![]);
        for (block, control) in ensemble.blocks().iter().zip(controls) {
            let field = field(&ensemble, block, &control, &case, &mut warnings)?;
            check::random_starts(&field, &case)?;
            fields.push(field);
            start.extend(control.start);
            set.push(block.len, control.set);
        }
        let mesh = ensemble.members()[0].problem().solid().mesh().clone();
        let locate = |(name, point): (String, [f64; 3])| match mesh.locate_inside(point) {
            Ok(located) => Ok(LocatedProbe { name, point, located }),
            Err(outside) => Err(AssemblyError::Probe { what: outside.to_string(), name }),
        };
        let probes = probes.into_iter().map(locate).collect::<Result<_, _>>()?;
        if let Some(large) = sizes::large(&mesh, case.units) {
            let message = format!("{large}: if the program computes in millimetres, say so with Study::units");
            warnings.push(Warning::new(&UNITS, message));
        }
        for member in ensemble.members() {
            let body = member.problem();
            let bounds = member.blocks().iter().map(|k| fields[*k].bounds.as_ref());
            if let Some(excess) = joint_excess(body, bounds) {
                warnings.push(Warning::new(&CONVEXITY, beyond_together(&excess, case.units)).of(member.name()));
            }
            let shown = body.costs().iter().flat_map(|cost| cost.warnings(body.solid()));
            warnings.extend(shown.map(|shown| Warning::new(&HAUSDORFF_LENGTH, shown).of(member.name())));
        }
        let differences = ensemble.scenarios().iter().map(|_| Map::new()).collect();
        Ok(Self {
            document,
            case,
            ensemble,
            controls: fields,
            start,
            set,
            probes,
            warnings,
            notes: vec![],
            files: vec![],
            ordering: std::time::Duration::ZERO,
            labels,
            differences,
            of_program: true,
            has_steps: true,
        })
    }
}

fn label(ensemble: &Ensemble, member: &Member, case: &Case) -> Label {
    let named = |name: &str| (!name.is_empty()).then(|| name.to_owned());
    let scenario = named(&ensemble.scenarios()[member.scenario()]);
    let load_case = named(member.load_case());
    let (stem, case_stem) = stems(scenario.as_ref().map(|_| member.scenario()), load_case.as_deref());
    Label { scenario, load_case, stem, case_stem, case: case.clone(), targets: targets(member.problem()) }
}

/// The shapes that the costs of a body aim at.
fn targets(body: &Reduced) -> Vec<TargetShape> {
    let terms = body.costs().iter().zip(body.term_names());
    terms
        .filter_map(|(cost, name)| {
            Some(TargetShape::of(At::root(), &name, cost.target(body.solid())?, body.solid().discretization()))
        })
        .collect()
}

fn field(
    ensemble: &Ensemble,
    block: &EnsembleBlock,
    control: &ControlProblem,
    case: &Case,
    warnings: &mut Vec<Warning>,
) -> Result<ControlField, AssemblyError> {
    let owner = &ensemble.members()[block.owner];
    let own = &owner.problem().layout().blocks()[block.field];
    let array = own.name.clone();
    if is_reserved(&array) {
        return Err(AssemblyError::Reserved { control: array });
    }
    check::set(own, control)?;
    check::start(own, control)?;
    let name = block.name.replace('/', ".");
    let unit = case.units.label(dimension_of(own.unit).unwrap_or(Dimension::NONE));
    let bodies = ensemble.members().iter().map(Member::problem);
    let shown =
        unresolved(own, owner.problem()).map(|message| Warning::new(&GRID_RESOLUTION, format!("{name}: {message}")));
    warnings.extend(shown);
    let users = bodies.filter(|body| body.layout().blocks().iter().any(|other| other.name == own.name));
    let limit = users
        .filter_map(|body| {
            let field = body.layout().blocks().iter().position(|other| other.name == own.name)?;
            limit(std::iter::once(body), field)
        })
        .reduce(f64::min);
    let (admitted, bounds) = match &control.admitted {
        Admission::Vectors { admitted, .. } => (*admitted, None),
        Admission::Bounds(bounds) => {
            let all = (0..own.len()).map(|i| bounds.at(i));
            let (lower, upper) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), (a, b)| (l.min(a), u.max(b)));
            let value = |x: f64| if own.log { x.exp() } else { x };
            (Admitted::Between { lower: value(lower), upper: value(upper) }, Some(bounds.clone()))
        }
    };
    if let Admitted::Between { lower, upper } = admitted {
        for (bound, side) in [(lower, "lower"), (upper, "upper")] {
            if bound.is_infinite() {
                warnings.push(Warning::new(&UNBOUNDED, format!("{name} has no {side} bound")));
            }
        }
        if let Some(limit) = limit.filter(|limit| upper > *limit) {
            warnings.push(Warning::new(&CONVEXITY, beyond_limit(upper, limit, case.units)));
        }
    }
    let load_case = block.name.contains('/').then_some(block.owner);
    let log = own.log;
    Ok(ControlField { at: At::root(), name, array, load_case, unit, admitted, log, bounds, limit })
}
