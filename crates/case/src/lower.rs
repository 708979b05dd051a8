//! From a [`Case`] to a [`Problem`]: meshes read, formulas evaluated where they are needed, names looked up.
//!
//! Every problem names its path and line; as many as possible are found before giving up.

mod actuation;
mod array;
mod context;
mod control;
mod cost;
mod field;
mod load;
mod material;
mod mesh;
mod named;
mod optimizer;
mod probe;
mod sizes;
mod support;
mod unsupported;

pub use control::{Admitted, ControlField};
pub use cost::TargetShape;
pub use probe::LocatedProbe;

use crate::quantity::Units;
use crate::schema::Case;
use crate::syntax::{At, Diagnostic, Diagnostics, Document};
use context::Context;
use nastic_control::{ControlError, Layout, Metric, Reduced, Sight};
use nastic_fem::{Discretization, FemError, Solid, State};
use nastic_mesh::Mesh;
use nastic_opt::{Optimizer, Product};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A case made ready to compute: what every command works on.
#[derive(Debug)]
pub struct Problem {
    /// The file, with its overrides.
    pub document: Document,
    /// Its blocks.
    pub case: Case,
    /// Body, controls and costs.
    pub reduced: Reduced,
    /// The control fields, in file order.
    pub controls: Vec<ControlField>,
    /// Control vector to start from.
    pub start: Vec<f64>,
    /// Where the control vector must stay.
    pub set: Product,
    /// Points to report.
    pub probes: Vec<LocatedProbe>,
    /// Shapes the costs aim at.
    pub targets: Vec<TargetShape>,
    /// What deserves attention, with its place in the case.
    pub warnings: Vec<Diagnostic>,
    /// What was mended when meshes were read.
    pub notes: Vec<String>,
    /// All files that were read, the case itself left out.
    pub files: Vec<PathBuf>,
}

impl Problem {
    /// Reads all that a case names and builds the problem. A raised flag ends state solves.
    ///
    /// # Errors
    /// All problems found, each with its path and line.
    pub fn lower(document: Document, cancel: Arc<AtomicBool>) -> Result<Self, Diagnostics> {
        let case = Case::read(&document)?;
        let mut context = Context::new(&document, case.units);
        unsupported::check(&case, &mut context);
        let body = mesh::body(&case, &mut context);
        let targets = cost::load_targets(&case, &mut context);
        let Some(mesh) = body else { return Err(context.into_problems()) };
        let mesh = Arc::new(mesh);
        let disc = match Discretization::new(mesh.clone()) {
            Ok(disc) => disc,
            Err(error) => {
                context.complain(&mesh::at(&case), error);
                return Err(context.into_problems());
            }
        };
        let mut solid = Solid::on(disc);
        material::add(&case, &mut solid, &mut context);
        actuation::add(&case, &mut solid, &mut context);
        support::add(&case, &mut solid, &mut context);
        load::add(&case, &mut solid, &mut context);
        if context.is_sound() {
            check_complete(&solid, &mut context);
        }
        let probes = probe::locate(&case, &mesh, &mut context);
        sizes::check(&case, &mesh, &targets, &mut context);
        let metric = optimizer::metric(&case);
        let reduced = Reduced::new(solid).metric(metric).no_other_controls().cancelled_by(cancel);
        let reduced = actuation::fix(&case, reduced, &mut context);
        let reduced = reduced.and_then(|reduced| control::add(&case, reduced, &mut context));
        // Bounds and costs look at the body: with one that is not as written they would complain of their own.
        let (Some(reduced), true) = (reduced, context.is_sound()) else { return Err(context.into_problems()) };
        let lowered = control::lower(&case, &reduced, &mut context);
        let with_costs = cost::add(&case, targets, reduced, &mut context);
        let Some((reduced, targets)) = with_costs else { return Err(context.into_problems()) };
        if context.is_sound() && !reduced.layout().is_empty() {
            context.take(&At::root().key("controls"), reduced.check());
        }
        cost::warn(&case, &reduced, &mut context);
        let (Some(lowered), true) = (lowered, context.is_sound()) else { return Err(context.into_problems()) };
        let Context { warnings, notes, files, .. } = context;
        let control::Lowered { controls, start, set } = lowered;
        Ok(Self { case, reduced, controls, start, set, probes, targets, warnings, notes, files, document })
    }

    /// The body.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        self.reduced.solid()
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        self.solid().mesh()
    }

    /// The units of all numbers.
    #[must_use]
    pub fn units(&self) -> &Units {
        &self.case.units
    }

    /// The control fields' places in the control vector.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        self.reduced.layout()
    }

    /// What costs may look at in a state.
    #[must_use]
    pub fn sight<'a>(&'a self, state: &'a State, m: &'a [f64], stage: usize) -> Sight<'a> {
        Sight { solid: self.solid(), layout: self.layout(), u: &state.u, m, stage }
    }

    /// The values of all cost terms, weights included.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn terms(&self, state: &State, m: &[f64], stage: usize) -> Result<Vec<f64>, ControlError> {
        let sight = self.sight(state, m, stage);
        self.reduced.costs().iter().map(|cost| cost.value(&sight)).collect()
    }

    /// Number of continuation stages.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.reduced.costs().iter().map(|cost| cost.stages()).max().unwrap_or(1)
    }

    /// The optimiser of the case.
    ///
    /// # Errors
    /// A method that is not supported; [`Self::lower`] has refused it already.
    pub fn optimizer(&self) -> Result<Box<dyn Optimizer>, Diagnostics> {
        optimizer::build(&self.case)
            .ok_or_else(|| self.document.complain(&self.case.optimizer.at.key("method"), "not supported yet").into())
    }

    /// The inner product of controls.
    #[must_use]
    pub fn metric(&self) -> Metric {
        optimizer::metric(&self.case)
    }

    /// The problem `message` at a path of the case.
    #[must_use]
    pub fn complain(&self, key: &str, message: impl Into<String>) -> Diagnostics {
        self.document.complain(&At::root().key(key), message).into()
    }
}

/// Every cell has a material, no rigid motion is left free.
fn check_complete(solid: &Solid, context: &mut Context<'_>) {
    if let Err(error) = solid.check() {
        let block = match &error {
            FemError::RigidMotion { .. } => "supports",
            FemError::NoMaterial { .. } => "materials",
            _ => "mesh",
        };
        context.complain(&At::root().key(block), error);
    }
}
