//! The members of a problem: every load case of every scenario.

use crate::lower::control_field::ControlField;
use crate::lower::problem::CaseProblem;
use crate::lower::target_shape::TargetShape;
use nastic_control::{ControlBlock, Layout, Reduced};
use nastic_ensemble::Member;
use nastic_fem::Solid;
use nastic_language::schema::Case;
use nastic_mesh::Mesh;
use std::sync::Arc;

/// What the library does not know of a member.
#[derive(Debug)]
pub(super) struct Label {
    /// Name of its scenario; `None` in a case without scenarios.
    pub scenario: Option<String>,
    /// Name of its load case; `None` in a case without load cases.
    pub load_case: Option<String>,
    /// What the names of its files begin with.
    pub stem: String,
    /// The same without its scenario.
    pub case_stem: String,
    /// The case as this member sees it.
    pub case: Case,
    /// Shapes its costs aim at.
    pub targets: Vec<TargetShape>,
}

/// One member: a body with its costs. A plain case has one, without a name.
#[derive(Clone, Copy, Debug)]
pub struct CaseMember<'p> {
    problem: &'p CaseProblem,
    index: usize,
}

impl CaseProblem {
    /// All members, scenario by scenario, load case by load case.
    pub fn members(&self) -> impl Iterator<Item = CaseMember<'_>> {
        (0..self.labels.len()).map(|index| CaseMember { problem: self, index })
    }

    /// The members of the first scenario: one for every load case.
    pub fn leads(&self) -> impl Iterator<Item = CaseMember<'_>> {
        self.members().take_while(|member| member.part().scenario() == 0)
    }

    /// The member of this number.
    #[must_use]
    pub fn member(&self, index: usize) -> CaseMember<'_> {
        CaseMember { problem: self, index: index.min(self.labels.len() - 1) }
    }

    /// Whether there are no scenarios and no load cases.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.labels.iter().all(|label| label.scenario.is_none() && label.load_case.is_none())
    }

    /// Whether the scenarios are uncertain.
    #[must_use]
    pub fn has_scenarios(&self) -> bool {
        self.labels.iter().any(|label| label.scenario.is_some())
    }
}

impl<'p> CaseMember<'p> {
    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &'p CaseProblem {
        self.problem
    }

    /// Its number.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }

    fn label(&self) -> &'p Label {
        &self.problem.labels[self.index]
    }

    /// The library's view of it.
    #[must_use]
    pub fn part(&self) -> &'p Member {
        &self.problem.ensemble.members()[self.index]
    }

    /// Body, control fields and costs.
    #[must_use]
    pub fn reduced(&self) -> &'p Reduced {
        self.part().problem()
    }

    /// The case with the values and blocks of this member.
    #[must_use]
    pub fn case(&self) -> &'p Case {
        &self.label().case
    }

    /// Name of its scenario; `None` in a case without scenarios.
    #[must_use]
    pub fn scenario(&self) -> Option<&'p str> {
        self.label().scenario.as_deref()
    }

    /// Name of its load case; `None` in a case without load cases.
    #[must_use]
    pub fn load_case(&self) -> Option<&'p str> {
        self.label().load_case.as_deref()
    }

    /// `SCENARIO`, `LOAD_CASE`, `SCENARIO/LOAD_CASE`, or nothing in a plain case.
    #[must_use]
    pub fn name(&self) -> String {
        [self.scenario(), self.load_case()].into_iter().flatten().collect::<Vec<_>>().join("/")
    }

    /// `member 4 (scenario NAME, load case NAME)`, counted from 0, or nothing in a plain case.
    #[must_use]
    pub fn words(&self) -> String {
        let scenario = self.scenario().map(|name| format!("scenario {name}"));
        let load_case = self.load_case().map(|name| format!("load case {name}"));
        let names = [scenario, load_case].into_iter().flatten().collect::<Vec<_>>().join(", ");
        if names.is_empty() { names } else { format!("member {} ({names})", self.index) }
    }

    /// ` in NAME`, or nothing in a plain case: what is said of it ends with that.
    #[must_use]
    pub fn inside(&self) -> String {
        let name = self.name();
        if name.is_empty() { name } else { format!(" in {name}") }
    }

    /// The name of one of its files.
    #[must_use]
    pub fn file(&self, name: &str) -> String {
        format!("{}{name}", self.label().stem)
    }

    /// The name of a file that the load cases of different scenarios have in common.
    #[must_use]
    pub fn case_file(&self, name: &str) -> String {
        format!("{}{name}", self.label().case_stem)
    }

    /// The body.
    #[must_use]
    pub fn solid(&self) -> &'p Solid {
        self.reduced().solid()
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &'p Arc<Mesh> {
        self.solid().mesh()
    }

    /// Its control fields' places in its control vector.
    #[must_use]
    pub fn layout(&self) -> &'p Layout {
        self.reduced().layout()
    }

    /// Its control fields, as the library and as the case describe them.
    pub fn fields(&self) -> impl Iterator<Item = (&'p ControlBlock, &'p ControlField)> {
        let controls = &self.problem.controls;
        self.layout().blocks().iter().zip(self.part().blocks()).map(|(block, k)| (block, &controls[*k]))
    }

    /// Shapes its costs aim at.
    #[must_use]
    pub fn targets(&self) -> &'p [TargetShape] {
        &self.label().targets
    }

    /// Its part of the problem's control vector, or of a derivative.
    #[must_use]
    pub fn local(&self, m: &[f64]) -> Vec<f64> {
        self.problem.ensemble.local(self.part(), m).unwrap_or_default()
    }
}
