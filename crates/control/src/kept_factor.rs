//! [`SharedWorkspace`]: the one workspace that neighbouring points hold together.

use nastic_fem::Workspace;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// What is kept for the next solve nearby. A point and whatever was evaluated from it share one, so that a trial holds no
/// second factor beside the point it starts from.
#[derive(Clone, Default)]
pub(crate) struct SharedWorkspace(Arc<Mutex<Workspace>>);

impl SharedWorkspace {
    /// Takes what is there; put it back with [`put`](Self::put).
    pub fn take(&self) -> Workspace {
        // A thread that died while it held the lock left a whole value behind.
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn put(&self, workspace: Workspace) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = workspace;
    }

    pub fn bytes(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).factor_bytes()
    }
}

impl fmt::Debug for SharedWorkspace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "SharedWorkspace({} bytes)", self.bytes())
    }
}
