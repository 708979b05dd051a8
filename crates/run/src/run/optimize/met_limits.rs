//! [`MetLimits`]: trials of one start that led to a limit point.

use nastic_control::{ControlAt, ControlError, ControlLimit};
use nastic_ensemble::EnsembleError;
use nastic_language::number::count;
use nastic_opt::{Reason, Trial};
use nastic_report::record::{LastLimitRecord, LimitPointsRecord, RangeRecord};
use serde::{Deserialize, Serialize};

/// Trials that led to a limit point, and what is known of the last one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MetLimits {
    /// How many there were.
    pub count: usize,
    /// The load case or scenario of the last; empty where there is but one.
    pub member: String,
    /// The control fields that changed on the way to it, with the least and the greatest of their values there, and the unit.
    pub at: Vec<ControlAt>,
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
        self.at.clone_from(&limit.at);
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
        let control = |ControlAt { name, range: [min, max], unit }: &ControlAt| {
            (name.clone(), RangeRecord { min: (*min).into(), max: (*max).into(), unit: Some(unit.clone()) })
        };
        let controls = Some(self.at.iter().map(control).collect());
        let last = LastLimitRecord { member: self.member.clone(), controls };
        (self.count > 0).then_some(LimitPointsRecord { trials: self.count, last })
    }
}

fn shown(trial: usize, who: &str, limit: &ControlLimit) -> String {
    let who = if who.is_empty() { String::new() } else { format!("{who}: ") };
    format!("trial {trial}: {who}{limit}")
}
