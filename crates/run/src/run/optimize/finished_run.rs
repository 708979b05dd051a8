//! [`FinishedRun`]: a run from one start, as a value and as bytes.

use crate::run::error::RunError;
use crate::run::optimize::met_limits::MetLimits;
use crate::run::optimize::parted::{Parted, next};
use crate::run::session::Session;
use nastic_control::{Ensemble, EnsemblePoint, read_report, write_report};
use nastic_fem::SolveReport;
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{AugmentedLagrangian, Best, ConstraintsReport, Failed, Objective, Request, SavedRunError};

const MAGIC: &str = "nastic-finished-run-4";

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

    pub fn to_parted(&self, index: usize, ensemble: &Ensemble) -> Parted {
        let mut out = Writer::new(MAGIC);
        out.count(index);
        out.floats(&self.start.m);
        out.bytes(&self.best.save_with(&[]));
        self.constraints.write(&mut out);
        write_work(&self.work, &mut out);
        self.limits.write(&mut out);
        Parted { body: out.finish(), points: vec![ensemble.save(&self.start), ensemble.save(&self.best.point)] }
    }

    /// The run with its number.
    pub fn from_parted(Parted { body, points }: &Parted, ensemble: &Ensemble) -> Result<(usize, Self), Failed> {
        let (mut input, mut points) = (Reader::new(body, MAGIC).map_err(Failed::new)?, points.iter().cloned());
        let index = input.number().map_err(Failed::new)?;
        let (m, start) = (input.floats().map_err(Failed::new)?, next(&mut points).map_err(Failed::new)?);
        let start = ensemble.load(&m, &start, &Request::default())?;
        let best = input.list().map_err(Failed::new)?;
        let best = Best::load_with(ensemble, &best, Some(next(&mut points).map_err(Failed::new)?))?;
        let constraints = ConstraintsReport::read(&mut input).map_err(Failed::new)?;
        let work = read_work(&mut input).map_err(Failed::new)?;
        let limits = MetLimits::read(&mut input).map_err(Failed::new)?;
        input.finish().map_err(Failed::new)?;
        Ok((index, Self { start, best, constraints, work, limits }))
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

pub(super) fn write_work(work: &[SolveReport], out: &mut Writer) {
    out.count(work.len());
    work.iter().for_each(|work| write_report(work, out));
}

pub(super) fn read_work(input: &mut Reader<'_>) -> Result<Vec<SolveReport>, SavedRunError> {
    (0..input.count(8)?).map(|_| read_report(input)).collect()
}
