//! [`MetLimits`]: trials of one start that led to a limit point.

use nastic_control::{ControlError, ControlLimit, EnsembleError};
use nastic_language::number::count;
use nastic_opt::bytes::{Reader, Writer};
use nastic_opt::{Reason, SavedRunError, Trial};
use nastic_report::record::{LastLimitRecord, LimitPointsRecord, RangeRecord};

/// Trials that led to a limit point, and what is known of the last one.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MetLimits {
    /// How many there were.
    pub count: usize,
    /// The load case or scenario of the last; empty where there is but one.
    pub member: String,
    /// The control fields that changed on the way to it, with the least and the greatest of their values there, and the unit.
    pub at: Vec<(String, [f64; 2], String)>,
    /// How a message shows it.
    pub shown: String,
}

impl MetLimits {
    /// Looks at a trial.
    pub fn add<P>(&mut self, trial: &Trial<'_, P>) {
        let (Reason::Failed(why) | Reason::OtherBranch(why)) = &trial.reason else { return };
        let Some(EnsembleError::Member { who, source }) = why.downcast_ref::<EnsembleError>() else { return };
        let ControlError::LimitPoint { limit, .. } = source.as_ref() else { return };
        self.count += 1;
        self.member.clone_from(who);
        self.at = limit.at.iter().map(|at| (at.name.clone(), at.range, at.unit.clone())).collect();
        self.shown = shown(trial.trial, who, limit);
    }

    /// `limits      3 trials met a limit point, the last: trial 7: limit point at ..`.
    pub fn say(&self) -> Option<String> {
        let trials = count(self.count, "trial");
        let last = if self.count > 1 { ", the last" } else { "" };
        (self.count > 0).then(|| format!("limits      {trials} met a limit point{last}: {}", self.shown))
    }

    /// The entry `limit_points` of the result.
    pub fn record(&self) -> Option<LimitPointsRecord> {
        let control = |(name, [min, max], unit): &(String, [f64; 2], String)| {
            (name.clone(), RangeRecord { min: (*min).into(), max: (*max).into(), unit: Some(unit.clone()) })
        };
        let controls = Some(self.at.iter().map(control).collect());
        let last = LastLimitRecord { member: self.member.clone(), controls };
        (self.count > 0).then_some(LimitPointsRecord { trials: self.count, last })
    }

    pub fn write(&self, out: &mut Writer) {
        out.count(self.count);
        out.bytes(self.member.as_bytes());
        out.count(self.at.len());
        for (name, range, unit) in &self.at {
            out.bytes(name.as_bytes());
            out.floats(range);
            out.bytes(unit.as_bytes());
        }
        out.bytes(self.shown.as_bytes());
    }

    pub fn read(input: &mut Reader<'_>) -> Result<Self, SavedRunError> {
        let (count, member) = (input.number()?, input.text()?);
        let at = (0..input.count(8)?).map(|_| read_control(input)).collect::<Result<_, _>>()?;
        Ok(Self { count, member, at, shown: input.text()? })
    }
}

fn read_control(input: &mut Reader<'_>) -> Result<(String, [f64; 2], String), SavedRunError> {
    let (name, range, unit) = (input.text()?, input.floats()?, input.text()?);
    let [low, high] = range[..] else { return Err(input.damaged("a limit point of another form")) };
    Ok((name, [low, high], unit))
}

fn shown(trial: usize, who: &str, limit: &ControlLimit) -> String {
    let who = if who.is_empty() { String::new() } else { format!("{who}: ") };
    format!("trial {trial}: {who}{limit}")
}
