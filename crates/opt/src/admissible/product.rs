//! Products of admissible sets: control blocks one after the other.

use super::{Admissible, Face, Intervals, NotBounds, Outside};
use std::ops::Range;
use std::sync::Arc;

/// Blocks of a control vector, each in its own set: a magnetisation on a sphere, then a field in a ball.
#[derive(Clone, Debug, Default)]
pub struct Product {
    blocks: Vec<(Range<usize>, Arc<dyn Admissible>)>,
}

impl Product {
    /// No block yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a block of `len` components.
    #[must_use]
    pub fn block(mut self, len: usize, set: impl Admissible + 'static) -> Self {
        self.push(len, Arc::new(set));
        self
    }

    /// Appends a block of `len` components.
    pub fn push(&mut self, len: usize, set: Arc<dyn Admissible>) {
        let start = self.len();
        self.blocks.push((start..start + len, set));
    }

    /// Total number of components.
    pub fn len(&self) -> usize {
        self.blocks.last().map_or(0, |(range, _)| range.end)
    }

    /// Whether there is no component.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The blocks in order: where each lies, and its set.
    pub fn blocks(&self) -> impl Iterator<Item = (Range<usize>, &dyn Admissible)> {
        self.blocks.iter().map(|(range, set)| (range.clone(), set.as_ref()))
    }
}

impl Admissible for Product {
    fn check(&self, m: &[f64]) -> Result<(), Outside> {
        if m.len() != self.len() {
            let allowed = format!("the blocks hold {} components, the control has {}", self.len(), m.len());
            return Err(Outside { index: self.len().min(m.len()), value: f64::NAN, allowed });
        }
        for (range, set) in self.blocks() {
            let start = range.start;
            set.check(&m[range]).map_err(|outside| Outside { index: outside.index + start, ..outside })?;
        }
        Ok(())
    }

    fn project(&self, m: &mut [f64]) {
        self.blocks().for_each(|(range, set)| set.project(&mut m[range]));
    }

    fn restrict(&self, m: &[f64], d: &mut [f64]) {
        self.blocks().for_each(|(range, set)| set.restrict(&m[range.clone()], &mut d[range]));
    }

    fn reach(&self, m: &[f64], d: &[f64], s: &[f64]) -> f64 {
        let of =
            |(range, set): (Range<usize>, &dyn Admissible)| set.reach(&m[range.clone()], &d[range.clone()], &s[range]);
        self.blocks().map(of).fold(1.0, f64::min)
    }

    fn tangent(&self, m: &[f64], v: &mut [f64]) {
        self.blocks().for_each(|(range, set)| set.tangent(&m[range.clone()], &mut v[range]));
    }

    fn retract(&self, m: &[f64], d: &[f64], t: f64, out: &mut [f64]) {
        for (range, set) in self.blocks() {
            set.retract(&m[range.clone()], &d[range.clone()], t, &mut out[range]);
        }
    }

    fn add_curvature(&self, m: &[f64], derivative: &[f64], v: &[f64], out: &mut [f64]) {
        for (range, set) in self.blocks() {
            set.add_curvature(&m[range.clone()], &derivative[range.clone()], &v[range.clone()], &mut out[range]);
        }
    }

    fn transport(&self, from: &[f64], to: &[f64], v: &mut [f64]) {
        for (range, set) in self.blocks() {
            set.transport(&from[range.clone()], &to[range.clone()], &mut v[range]);
        }
    }

    fn face(&self, m: &[f64], d: &[f64], derivative: &[f64]) -> Face {
        let mut face = Face::free(m.len());
        for (range, set) in self.blocks() {
            face.insert(range.start, &set.face(&m[range.clone()], &d[range.clone()], &derivative[range.clone()]));
        }
        face
    }

    fn inward(&self, m: &[f64], d: &mut [f64]) {
        self.blocks().for_each(|(range, set)| set.inward(&m[range.clone()], &mut d[range]));
    }

    fn intervals(&self, _len: usize) -> Result<Intervals, NotBounds> {
        let mut all = Intervals::default();
        for (range, set) in self.blocks() {
            let start = range.start;
            let own = set.intervals(range.len()).map_err(|not| NotBounds { index: not.index + start, ..not })?;
            all.lower.extend(own.lower);
            all.upper.extend(own.upper);
        }
        Ok(all)
    }

    fn extent(&self, m: &[f64]) -> Vec<f64> {
        self.blocks().flat_map(|(range, set)| set.extent(&m[range])).collect()
    }
}
