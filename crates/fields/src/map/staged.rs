//! [`Staged`]: a map that changes from stage to stage of an optimisation.

use super::ControlMap;
use std::sync::Arc;

/// One map for each stage, of one size; the last one where no stage is asked for, and in later stages: a projection that becomes sharper.
#[derive(Debug, Clone)]
pub struct Staged {
    first: Vec<Arc<dyn ControlMap>>,
    last: Arc<dyn ControlMap>,
}

impl Staged {
    /// `first` before `last`.
    pub fn new(first: Vec<Arc<dyn ControlMap>>, last: impl ControlMap + 'static) -> Self {
        Staged { first, last: Arc::new(last) }
    }
}

impl ControlMap for Staged {
    fn describe(&self) -> String {
        let all = self.first.iter().chain([&self.last]);
        all.map(|map| map.describe()).collect::<Vec<_>>().join(", then ")
    }

    fn shared(&self) -> String {
        let all = self.first.iter().chain([&self.last]);
        all.map(|map| map.shared()).collect::<Vec<_>>().join(", then ")
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.last.values(x)
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        self.last.change(x, v)
    }

    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.last.vjp(x, g)
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        self.last.second_vjp(x, v, g)
    }

    fn is_affine(&self) -> bool {
        self.last.is_affine()
    }

    fn stages(&self) -> usize {
        self.first.len() + 1
    }

    fn at_stage(&self, stage: usize) -> Option<Arc<dyn ControlMap>> {
        Some(self.first.get(stage).unwrap_or(&self.last).clone())
    }
}
