//! What `nastic modes` computes.

/// What `nastic modes` computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModesRequest {
    /// How many modes, the lowest ones.
    pub count: usize,
    /// Whether about the undeformed body without controls and loads instead of the equilibrium at the start controls.
    pub undeformed: bool,
}

impl Default for ModesRequest {
    fn default() -> Self {
        Self { count: 6, undeformed: false }
    }
}
