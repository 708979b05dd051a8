//! [`OnTrial`]: what is called for the trials of an optimisation.

use crate::record::TrialRecord;
use std::fmt;
use std::sync::Arc;

type Listener = dyn Fn(&TrialRecord) + Send + Sync;

/// A function that is called after every trial with its line of `history.jsonl`; nobody by default. The run waits for it.
#[derive(Clone, Default)]
pub struct OnTrial(Option<Arc<Listener>>);

impl OnTrial {
    /// Calls `shown`.
    pub fn call(shown: impl Fn(&TrialRecord) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(shown)))
    }

    /// A trial has ended.
    pub fn call_with(&self, line: &TrialRecord) {
        if let Some(shown) = &self.0 {
            shown(line);
        }
    }
}

impl fmt::Debug for OnTrial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "OnTrial(..)" } else { "OnTrial(nobody)" })
    }
}
