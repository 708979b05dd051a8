//! Terms of the cost whose keys are those of their rows: what the keys say, as the library takes it.

use super::array::{self, Entity};
use super::context::Context;
use super::coordinates;
use super::cost::Lowering;
use super::markers::{self, Wanted};
use super::{named_groups, obstacle, time};
use nastic_control::{ControlError, CostInputs, CostValue, Key, KeyKind, Target};
use nastic_language::expression::EvaluationError;
use nastic_language::schema::{CostTerm, KeyValue, MeshSource, Target as TargetBlock, Vector, vector_at};
use nastic_language::syntax::At;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// Methods that take second derivatives.
pub(super) const SECOND_ORDER: [&str; 2] = ["gauss_newton", "newton_cg"];

/// The first fault of the formulas of a target.
type Fault = Arc<OnceLock<EvaluationError>>;

/// The mesh among the values of a term, with its place.
pub(super) fn mesh_of(term: &CostTerm) -> Option<(&MeshSource, At)> {
    term.values.iter().find_map(|(key, value)| match value {
        KeyValue::Mesh(source) => Some((source, term.at.key(key))),
        KeyValue::Target(TargetBlock::Nodes(nodes)) => Some((&nodes.nodes, nodes.at.key("nodes"))),
        _ => None,
    })
}

impl Lowering<'_> {
    /// What a row makes of a term; `None` after complaints.
    pub(super) fn make<C: ?Sized>(
        &self,
        term: &CostTerm,
        make: fn(&CostInputs) -> Result<Box<C>, ControlError>,
        context: &mut Context<'_>,
    ) -> Option<Box<C>> {
        let (mut values, fault) = (BTreeMap::new(), Fault::default());
        let given = term.form.keys.iter().filter_map(|key| Some((key, term.values.get(key.name)?)));
        let given: Vec<(&Key, &KeyValue)> = given.collect();
        for (key, value) in &given {
            let at = term.at.key(key.name);
            if let Some(value) = self.value(key, term, value, &at, &fault, context) {
                values.insert(key.name, value);
            }
        }
        if values.len() < given.len() {
            return None;
        }
        let inputs = CostInputs {
            solid: self.reduced.solid(),
            weight: term.weight,
            in_motion: self.case.time.is_some(),
            second: SECOND_ORDER.contains(&self.case.optimizer.method.name()),
            when: &time::when(self.block),
            values: &values,
        };
        let made = make(&inputs);
        if let Some(error) = fault.get().filter(|_| made.is_err()) {
            let of_target = |key: &&Key| key.kind == KeyKind::Target;
            let key = term.form.keys.iter().find(of_target).map_or("target", |key| key.name);
            context.complain(&term.at.key(key), error);
            return None;
        }
        let at = term.form.reported_at.map_or_else(|| term.at.clone(), |key| term.at.key(key));
        context.take(&at, made)
    }

    /// The value of a key; `None` after a complaint.
    fn value(
        &self,
        key: &Key,
        term: &CostTerm,
        value: &KeyValue,
        at: &At,
        fault: &Fault,
        context: &mut Context<'_>,
    ) -> Option<CostValue> {
        let mesh = self.reduced.solid().mesh().clone();
        Some(match value {
            KeyValue::Names(names) => {
                match key.kind {
                    KeyKind::Surface => drop(named_groups::facets(&mesh, names, at, context)?),
                    KeyKind::Region => drop(named_groups::cells(&mesh, names, at, context)?),
                    _ => drop(named_groups::node_sets(&mesh, names, at, context)?),
                }
                CostValue::Names(names.clone())
            }
            KeyValue::Point(point) => {
                context.take(at, mesh.locate_inside(point.xyz()))?;
                CostValue::Vector(point.xyz())
            }
            KeyValue::Line(line) => {
                let points: Vec<[f64; 3]> = line.iter().map(Vector::xyz).collect();
                let located =
                    points.iter().enumerate().map(|(i, x)| context.take(&at.index(i), mesh.locate_inside(*x)));
                // every point outside is reported
                let inside = located.fold(true, |all, one| all & one.is_some());
                inside.then_some(CostValue::Line(points))?
            }
            KeyValue::Points(points) => CostValue::Points(points.clone()),
            KeyValue::Components(fix) => CostValue::Components(fix.components()),
            KeyValue::Flag(flag) => CostValue::Flag(*flag),
            KeyValue::Direction(direction) => CostValue::Vector(direction.xyz()),
            KeyValue::Number(number) => CostValue::Number(*number),
            KeyValue::Count(count) => CostValue::Count(u32::try_from(*count).unwrap_or(u32::MAX)),
            KeyValue::Word(word) => CostValue::Word(word),
            KeyValue::Markers(table) => {
                let deviation = match term.values.get("deviation") {
                    Some(KeyValue::Number(deviation)) => Some(*deviation),
                    _ => None,
                };
                CostValue::Markers(markers::read(table, &Wanted { mesh: &mesh, deviation, at }, context)?)
            }
            KeyValue::Position(position) => CostValue::Position(coordinates::given(position, context)?),
            // a table that could not be read was complained about
            KeyValue::Path(_) => return None,
            KeyValue::Target(block) => CostValue::Target(self.positions(block, at, fault, context)?),
            KeyValue::Mesh(_) => CostValue::Mesh(self.target?.mesh.clone()),
            KeyValue::Obstacle(shape) => CostValue::Obstacle(obstacle::of(self.case, shape, clearance(term), context)?),
            KeyValue::Contact(name) => CostValue::Name(name.clone()),
            // the library's name of a control is that of its actuation
            KeyValue::Control(name) => {
                let control = self.case.controls.iter().find(|control| control.name() == name)?;
                CostValue::Name(control.of.clone())
            }
        })
    }

    /// Positions of all points.
    fn positions(&self, block: &TargetBlock, at: &At, fault: &Fault, context: &mut Context<'_>) -> Option<Target> {
        let mesh = self.reduced.solid().mesh();
        let dim = mesh.dim();
        match block {
            TargetBlock::Formulas(entries) if entries.len() < dim => {
                context.complain(at, format!("{} entries, but the body has {dim} dimensions", entries.len()));
                None
            }
            TargetBlock::Formulas(entries) => {
                let (entries, fault) = (entries.clone(), fault.clone());
                // The target of a plane body lies in its plane, whatever the third entry left out.
                Some(Target::position(move |x| {
                    vector_at(&entries, x).unwrap_or_else(|error| {
                        let _ = fault.set(error);
                        [f64::NAN; 3]
                    })
                }))
            }
            TargetBlock::Array(file) => {
                let array = array::read(file, at, &[2, 3], Entity::Node, self.case, mesh, context)?;
                if array.entity == Entity::Cell {
                    context.complain(&at.key("array"), "a displacement by cell is no target: one by node is wanted");
                    return None;
                }
                let entries = array.values.chunks_exact(array.components);
                Some(Target::Displacement(entries.flat_map(|u| u[..dim.min(u.len())].to_vec()).collect()))
            }
            TargetBlock::Nodes(nodes) => {
                let shape = self.target?;
                let (found, wanted) = (shape.mesh.points().len(), mesh.points().len());
                if found != wanted {
                    let name = shape.mesh.name();
                    let message = format!("{name} has {found} nodes, the body's mesh {wanted}: no numbering in common");
                    context.complain(&nodes.at.key("nodes"), message);
                    return None;
                }
                let pairs = shape.mesh.points().iter().zip(mesh.points());
                Some(Target::Displacement(pairs.flat_map(|(y, x)| (0..dim).map(move |k| y[k] - x[k])).collect()))
            }
        }
    }
}

/// The distance to keep from an obstacle.
fn clearance(term: &CostTerm) -> f64 {
    match term.values.get("clearance") {
        Some(KeyValue::Number(clearance)) => *clearance,
        _ => 0.0,
    }
}
