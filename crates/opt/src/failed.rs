//! [`Failed`]: a trial that could not be evaluated.

use crate::summary::Summary;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// A trial without a cost, or a point without a derivative (a state solve that failed, say): an ordinary answer, which
/// shortens the step, unless it is [fatal](Failed::fatal). The error's type is kept: [`Failed::downcast_ref`] asks for it. Displayed as its source.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "SavedFailure", into = "SavedFailure")]
pub struct Failed {
    source: Arc<dyn Error + Send + Sync>,
    work: Summary,
    fatal: bool,
    limit: Option<f64>,
}

impl Failed {
    /// A failure with its cause.
    pub fn new(source: impl Error + Send + Sync + 'static) -> Self {
        Self { source: Arc::new(source), work: Summary::default(), fatal: false, limit: None }
    }

    /// A failure that has no type of its own.
    pub fn because(why: impl Into<String>) -> Self {
        Self::new(Words(why.into()))
    }

    /// The same failure with what the attempt took, under the names of [`Objective::summary`](crate::Objective::summary).
    #[must_use]
    pub fn after(self, work: Summary) -> Self {
        Self { work, ..self }
    }

    /// The same failure, told by an error that has its cause: that of a member of an ensemble, with the member's name.
    #[must_use]
    pub fn told_by(self, source: impl Error + Send + Sync + 'static) -> Self {
        Self { source: Arc::new(source), ..self }
    }

    /// The same failure as one that says nothing about the control (too little memory, say): no trial is rejected for it, since
    /// results would depend on the machine. It ends the run.
    #[must_use]
    pub fn fatal(self) -> Self {
        Self { fatal: true, ..self }
    }

    /// The same failure with what is known of the way from the point it began near: beyond this share there is no value.
    #[must_use]
    pub fn beyond(self, share: f64) -> Self {
        Self { limit: Some(share), ..self }
    }

    /// The share of the way from the point it began near beyond which there is no value, where that is known.
    pub fn limit(&self) -> Option<f64> {
        self.limit
    }

    /// Whether it ends the run.
    pub fn is_fatal(&self) -> bool {
        self.fatal
    }

    /// The cause, if it is of this type.
    pub fn downcast_ref<E: Error + 'static>(&self) -> Option<&E> {
        self.source.downcast_ref()
    }

    /// What the attempt took, where that is known.
    pub fn work(&self) -> &Summary {
        &self.work
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.source.fmt(f)
    }
}

impl Error for Failed {
    /// What caused the source: `Failed` displays as its source and stands in its place.
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.source.source()
    }
}

/// Failures are equal that say the same.
impl PartialEq for Failed {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

/// A cause in words.
#[derive(Debug)]
struct Words(String);

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for Words {}

/// What is saved of a failure: its words, not its type.
#[derive(Serialize, Deserialize)]
struct SavedFailure {
    why: String,
    fatal: bool,
}

impl From<Failed> for SavedFailure {
    fn from(failed: Failed) -> Self {
        Self { why: failed.to_string(), fatal: failed.fatal }
    }
}

impl From<SavedFailure> for Failed {
    fn from(SavedFailure { why, fatal }: SavedFailure) -> Self {
        Self { fatal, ..Failed::because(why) }
    }
}
