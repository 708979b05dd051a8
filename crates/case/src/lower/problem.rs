//! A case made ready to compute.

use crate::lower::control_field::ControlField;
use crate::lower::member::Label;
use crate::lower::optimizer;
use crate::lower::probe::LocatedProbe;
use crate::warning::Warning;
use nastic_control::{ControlBlock, Metric};
use nastic_ensemble::{Ensemble, EnsembleBlock};
use nastic_fem::{Solid, TimeStepping};
use nastic_language::quantity::Units;
use nastic_language::schema::{Case, Unstable};
use nastic_language::syntax::{At, Diagnostics, Document};
use nastic_mesh::Mesh;
use nastic_opt::Objective as _;
use nastic_opt::{InnerProduct, Optimizer, Problem as _, Product};
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A case made ready to compute: what every command works on.
#[derive(Debug)]
pub struct CaseProblem {
    /// The file, with its overrides.
    pub document: Document,
    /// Its blocks.
    pub case: Case,
    /// Bodies, controls and costs of all members.
    pub ensemble: Ensemble,
    /// The control fields, in the order of the ensemble's blocks: those all share in file order, then those of load cases.
    pub controls: Vec<ControlField>,
    /// Control vector to start from.
    pub start: Vec<f64>,
    /// Where the control vector must stay.
    pub set: Product,
    /// Points to report.
    pub probes: Vec<LocatedProbe>,
    /// What deserves attention in the case, before anything is solved.
    pub warnings: Vec<Warning>,
    /// What was mended when meshes were read, and the sizes of obstacles that are meshes.
    pub notes: Vec<String>,
    /// All files that were read, the case itself left out.
    pub files: Vec<PathBuf>,
    /// Wall time of the tangent's pattern and elimination order, which belong to solving rather than to reading.
    pub ordering: Duration,
    pub(super) labels: Vec<Label>,
    /// What differs in every scenario.
    pub(super) differences: Vec<Map<String, Value>>,
    /// Whether a program made the problem, and `document` says only what it is.
    pub(super) of_program: bool,
    /// Whether the time steps are those that were found.
    pub(super) has_steps: bool,
}

impl CaseProblem {
    /// The case file as it was named; `None` where a program made the problem.
    #[must_use]
    pub fn case_file(&self) -> Option<&str> {
        (!self.of_program).then(|| self.document.name())
    }

    /// The body of the first member.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        self.member(0).solid()
    }

    /// The mesh, which all members share.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        self.solid().mesh()
    }

    /// A control field as the first member that uses it has it.
    #[must_use]
    pub fn control_block(&self, block: &EnsembleBlock) -> &ControlBlock {
        &self.member(block.owner).layout().blocks()[block.field]
    }

    /// The units of all numbers.
    #[must_use]
    pub fn units(&self) -> &Units {
        &self.case.units
    }

    /// What differs in a scenario: paths and values.
    #[must_use]
    pub fn differences(&self, scenario: usize) -> &Map<String, Value> {
        &self.differences[scenario]
    }

    /// Whether anything is to be made small.
    #[must_use]
    pub fn has_costs(&self) -> bool {
        self.members().any(|member| member.reduced().has_costs())
    }

    /// Whether it is one in time.
    #[must_use]
    pub fn is_motion(&self) -> bool {
        self.case.time.is_some()
    }

    /// Refuses what has no derivative where derivatives are wanted: schemes without an adjoint, fields that are cut.
    ///
    /// # Errors
    /// There is one.
    pub fn check_adjoint(&self) -> Result<(), Diagnostics> {
        let mut controls = self.leads().flat_map(|member| &member.case().controls);
        if let Some(control) = controls.find(|control| control.cut.is_some()) {
            let at = control.at.key("cut");
            let message = "a field that is cut has no derivative: \"solve\" it, or leave \"cut\" out";
            return Err(self.document.complain(&at, message).into());
        }
        let refused = self.members().find_map(|member| {
            let (model, scheme) = (member.solid().model(), member.reduced().timeline()?.scheme());
            model.supports_motion_adjoint(scheme).err()
        });
        refused.map_or(Ok(()), |error| Err(self.complain("time/scheme", error.to_string())))
    }

    /// Number of continuation stages.
    #[must_use]
    pub fn stages(&self) -> usize {
        self.ensemble.stages()
    }

    /// The optimiser of the case.
    ///
    /// # Errors
    /// A method that is not supported; [`Self::lower`] has refused it already.
    pub fn optimizer(&self) -> Result<Box<dyn Optimizer>, Diagnostics> {
        optimizer::build(&self.case)
            .ok_or_else(|| self.document.complain(&self.case.optimizer.at.key("method"), "not supported yet").into())
    }

    /// Lets unstable equilibria fail where the case says so (`"unstable": "refuse"`), for optimisations.
    pub fn refuse_unstable_if_asked(&mut self) {
        if self.case.optimizer.unstable == Unstable::Refuse {
            self.ensemble.refuse_unstable(true);
        }
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

    /// The inner product of the controls; nothing where there are none.
    #[must_use]
    pub fn inner_product(&self) -> Option<Arc<dyn InnerProduct>> {
        self.ensemble.inner_product().ok()
    }
}
