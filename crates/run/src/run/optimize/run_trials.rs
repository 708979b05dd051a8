//! [`RunTrials`]: what is kept of the trials of one start.

use crate::run::optimize::branch_changes::BranchChanges;
use crate::run::optimize::finished_run::{read_work, write_work};
use crate::run::optimize::met_limits::MetLimits;
use nastic_fem::SolveReport;
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_report::Iterates;

/// What is kept of the trials of one start.
pub(super) struct RunTrials {
    /// Their work, by member.
    pub work: Vec<SolveReport>,
    /// Those that led to another branch of equilibria.
    pub changes: BranchChanges,
    /// Those that met a limit point.
    pub limits: MetLimits,
    /// Iterations of which snapshots were written.
    pub snapshots: Vec<usize>,
    /// Shapes and controls of accepted iterations, load case by load case.
    pub iterates: Vec<Iterates>,
    /// Lines of `history.jsonl` since the round of starts began.
    pub lines: Vec<u8>,
}

impl RunTrials {
    /// None yet.
    pub fn new(members: usize, load_cases: usize) -> Self {
        Self {
            work: vec![SolveReport::default(); members],
            changes: BranchChanges::default(),
            limits: MetLimits::default(),
            snapshots: vec![],
            iterates: vec![Iterates::default(); load_cases],
            lines: vec![],
        }
    }

    pub fn write(&self, out: &mut Writer) {
        write_work(&self.work, out);
        self.changes.write(out);
        self.limits.write(out);
        out.count(self.snapshots.len());
        self.snapshots.iter().for_each(|iteration| out.count(*iteration));
        out.count(self.iterates.len());
        self.iterates.iter().for_each(|kept| out.bytes(&kept.to_bytes()));
        out.bytes(&self.lines);
    }

    pub fn read(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let (work, changes, limits) = (read_work(input)?, BranchChanges::read(input)?, MetLimits::read(input)?);
        let snapshots = (0..input.count(8)?).map(|_| input.number()).collect::<Result<_, _>>()?;
        let iterates = (0..input.count(8)?).map(|_| read_iterates(input)).collect::<Result<_, _>>()?;
        Ok(Self { work, changes, limits, snapshots, iterates, lines: input.list()? })
    }
}

fn read_iterates(input: &mut Reader<'_>) -> Result<Iterates, SavedRunError> {
    Iterates::from_bytes(&input.list()?).map_err(|_| input.damaged("iterates of another form"))
}
