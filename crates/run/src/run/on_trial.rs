//! [`OnTrial`]: who is told of the trials of an optimisation.

use serde_json::Value;
use std::fmt;
use std::sync::Arc;

type Listener = dyn Fn(&Value) + Send + Sync;

/// A function that is called after every trial with its line of `history.jsonl`; nobody by default. The run waits for it.
#[derive(Clone, Default)]
pub struct OnTrial(Option<Arc<Listener>>);

impl OnTrial {
    /// Calls `told`.
    pub fn call(told: impl Fn(&Value) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(told)))
    }

    pub(super) fn tell(&self, line: &Value) {
        if let Some(told) = &self.0 {
            told(line);
        }
    }
}

impl fmt::Debug for OnTrial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "OnTrial(..)" } else { "OnTrial(nobody)" })
    }
}
