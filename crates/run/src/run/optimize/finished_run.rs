//! [`FinishedRun`]: a run from one start, as a value and as bytes.

use crate::run::error::RunError;
use crate::run::optimize::met_limits::MetLimits;
use crate::run::session::Session;
use nastic_control::{Ensemble, EnsemblePoint, read_report, write_report};
use nastic_fem::SolveReport;
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{AugmentedLagrangian, Best, ConstraintsReport, Failed, Objective, Request, SavedRunError};

const MAGIC: &str = "nastic-finished-run-3";

/// A run from one start.
#[derive(Clone)]
pub(super) struct FinishedRun {
    /// Where it began.
    pub start: EnsemblePoint,
    pub best: Best<EnsemblePoint>,
    /// Values and multipliers of the constraints there.
    pub constraints: ConstraintsReport,
    /// Work of all trials, by member.
    pub work: Vec<SolveReport>,
    /// Its trials that met a limit point.
    pub limits: MetLimits,
}

impl FinishedRun {
    /// Whether it came down deeper; of runs that do not both meet the constraints, whether it comes closer to that.
    pub fn is_better_than(&self, other: &Self) -> bool {
        // What feasible runs violate is rounding.
        let violation = |run: &Self| match run.constraints.violation {
            violation if violation <= AugmentedLagrangian::default().feasibility => 0.0,
            violation => violation,
        };
        let (own, others) = (violation(self), violation(other));
        own < others || own == others && self.best.cost < other.best.cost
    }

    pub fn to_bytes(&self, ensemble: &Ensemble) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        write_start(&self.start, ensemble, &mut out);
        out.bytes(&self.best.save(ensemble));
        self.constraints.write(&mut out);
        write_work(&self.work, &mut out);
        self.limits.write(&mut out);
        out.finish()
    }

    pub fn from_bytes(bytes: &[u8], ensemble: &Ensemble) -> Result<Self, Failed> {
        let mut input = Reader::new(bytes, MAGIC).map_err(Failed::new)?;
        let start = read_start(&mut input, ensemble)?;
        let best = Best::load(ensemble, &input.list().map_err(Failed::new)?)?;
        let constraints = ConstraintsReport::read(&mut input).map_err(Failed::new)?;
        let work = read_work(&mut input).map_err(Failed::new)?;
        let limits = MetLimits::read(&mut input).map_err(Failed::new)?;
        input.finish().map_err(Failed::new)?;
        Ok(Self { start, best, constraints, work, limits })
    }
}

impl Session<'_> {
    /// A run with all members, at the first rank.
    pub(super) fn whole_run(&self, run: &FinishedRun) -> Result<Option<FinishedRun>, RunError> {
        let (start, point) = (self.whole(&run.start)?, self.whole(&run.best.point)?);
        let whole = |(start, point)| {
            let FinishedRun { best, constraints, work, limits, .. } = run.clone();
            FinishedRun { start, best: Best { point, ..best }, constraints, work, limits }
        };
        Ok(start.zip(point).map(whole))
    }
}

/// A start: evaluated, in the first stage.
pub(super) fn write_start(start: &EnsemblePoint, ensemble: &Ensemble, out: &mut Writer) {
    out.floats(&start.m);
    out.bytes(&ensemble.save(start));
}

pub(super) fn read_start(input: &mut Reader<'_>, ensemble: &Ensemble) -> Result<EnsemblePoint, Failed> {
    let m = input.floats().map_err(Failed::new)?;
    let point = input.list().map_err(Failed::new)?;
    ensemble.load(&m, &point, &Request::default())
}

pub(super) fn write_work(work: &[SolveReport], out: &mut Writer) {
    out.count(work.len());
    work.iter().for_each(|work| write_report(work, out));
}

pub(super) fn read_work(input: &mut Reader<'_>) -> Result<Vec<SolveReport>, SavedRunError> {
    (0..input.count(8)?).map(|_| read_report(input)).collect()
}
