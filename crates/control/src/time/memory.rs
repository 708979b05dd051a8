//! [`MotionMemory`]: how much memory the states of a motion may take.

/// What is kept of a motion for its derivative. The rest is computed again, and comes out the same, to the bit: neither costs nor
/// derivatives depend on it, but the time a derivative takes does (see [`MotionFootprint`]). Of each point: an optimiser holds up to
/// three, of which those whose derivative was taken keep their beginning alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotionMemory {
    /// All states.
    #[default]
    All,
    /// As many states as fit into this number of bytes.
    AtMost {
        /// Memory of the states of one motion.
        bytes: usize,
    },
    /// So many checkpoints, the beginning of the motion among them, and the states of one segment.
    Checkpoints(usize),
}

/// What one motion takes, known before it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MotionFootprint {
    /// States in memory at once, at most.
    pub states: usize,
    /// Their memory.
    pub bytes: usize,
    /// Checkpoints; nothing where all states are kept.
    pub checkpoints: Option<usize>,
    /// Steps of the motion.
    pub steps: usize,
    /// Steps that a derivative computes again.
    pub recomputed_steps: usize,
}
