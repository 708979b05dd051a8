//! [`Summary`]: named numbers of one trial.

use serde::{Deserialize, Serialize};

/// Named numbers of one trial (cost terms, true Hausdorff distance, counts of work): what a history line holds beside the
/// driver's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary(pub Vec<(String, f64)>);

impl Summary {
    /// The number of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(key, _)| key == name).map(|(_, value)| *value)
    }
}
