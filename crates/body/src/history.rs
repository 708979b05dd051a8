//! [`History`]: the internal variables of everything that remembers where it has been.

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Internal variables, in blocks: of each actuation of the body in the order of [`Controls`](crate::controls::Controls) those of its
/// [`Evolution`](nastic_energy::Evolution), shape `[points][slots]`; then of each other contribution those that it
/// [remembers](crate::contribution::Contribution::remembers). A block is empty where there are none, and all are where nothing was remembered yet: a static
/// state is one after a long time, in which they are relaxed.
///
/// A state has those that the step which led to it began with; from them and from the state those of the next step follow.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct History {
    /// Length of the step that they belong to, s.
    pub dt: f64,
    blocks: Vec<Block>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Block {
    /// Values per point.
    width: usize,
    values: Vec<f64>,
}

static RELAXED: LazyLock<History> = LazyLock::new(History::default);

impl History {
    /// That of a static state.
    pub fn relaxed() -> &'static Self {
        &RELAXED
    }

    /// All zero: for each block the values per point, and all values.
    pub fn zeros(blocks: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let block = |(width, len)| Block { width, values: vec![0.0; len] };
        History { dt: 0.0, blocks: blocks.into_iter().map(block).collect() }
    }

    /// Of this shape, all zero.
    #[must_use]
    pub(crate) fn zeroed(&self) -> Self {
        History::zeros(self.blocks.iter().map(|block| (block.width, block.values.len())))
    }

    /// Length of the step that they belong to, s; 0 where there is none.
    pub fn step(&self) -> f64 {
        self.dt
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.blocks.iter().all(|block| block.values.is_empty())
    }

    /// Whether all of them are zero.
    pub fn is_zero(&self) -> bool {
        self.blocks.iter().all(|block| block.values.iter().all(|&value| value == 0.0))
    }

    /// Number of blocks.
    #[inline]
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Values per point of the k-th block; 0 where nothing was remembered yet.
    pub(crate) fn width(&self, k: usize) -> usize {
        self.blocks.get(k).map_or(0, |block| block.width)
    }

    /// Values of the k-th block.
    #[inline]
    pub fn values(&self, k: usize) -> &[f64] {
        self.blocks.get(k).map_or(&[], |block| &block.values)
    }

    /// The same, to be written to.
    #[inline]
    pub fn values_mut(&mut self, k: usize) -> &mut [f64] {
        self.blocks.get_mut(k).map_or(&mut [], |block| &mut block.values)
    }

    /// Adds those of the same shape; takes them where it has none.
    pub fn add(&mut self, other: &History) {
        if self.blocks.is_empty() {
            self.blocks.clone_from(&other.blocks);
            return;
        }
        for (own, other) in self.blocks.iter_mut().zip(&other.blocks) {
            own.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += b);
        }
    }
}

/// Internal variables of a contribution beside the body, and how they go on: `z' = f(u, z, m)` at the end of a time step, with the
/// displacement and controls there and the z that the step began with.
pub trait Remembers {
    /// How many.
    fn len(&self) -> usize;

    /// Whether there are none.
    #[inline]
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The internal variables behind the step that ended at an instant (of length [`History::step`]), into `next`; those it began with are
    /// [`Instant::internal`](crate::instant::Instant::internal).
    fn advance(&self, at: &crate::instant::Instant, next: &mut [f64]);

    /// Adds `by_next . dz'/d(u, z, m)`.
    fn advance_vjp(&self, at: &crate::instant::Instant, by_next: &[f64], into: &mut BeforeStep);
}

/// Derivatives of a functional by the state that a time step begins at.
#[derive(Debug, Clone, PartialEq)]
pub struct BeforeStep {
    /// By its displacement, flat; empty in a static problem.
    pub u: Vec<f64>,
    /// By its controls.
    pub controls: crate::controls::Controls,
    /// By the internal variables that the step begins with.
    pub history: History,
}

impl BeforeStep {
    /// Adds to the derivative by the internal variables of the contribution that is asked.
    pub fn add_internal(&mut self, at: &crate::instant::Instant, variable: usize, value: f64) {
        if let Some(sum) = self.history.values_mut(at.memory).get_mut(variable) {
            *sum += value;
        }
    }

    /// Adds to the derivative by a slot of the controls of the contribution that is asked.
    pub fn add_control(&mut self, at: &crate::instant::Instant, slot: usize, value: f64) {
        self.controls.values_mut(at.block)[slot] += value;
    }
}
