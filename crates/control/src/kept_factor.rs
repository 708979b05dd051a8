//! [`KeptFactor`]: the one factor that neighbouring points hold together.

use nastic_linear::Factor;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The factor kept for the next solve nearby. A point and whatever was evaluated from it share one: the newest takes the
/// place of the one before, so that a trial holds no second factor beside the point it starts from, and a rejected trial
/// leaves behind the factor that the next one wants. It serves as a preconditioner and decides no result beyond the
/// accuracy asked for.
#[derive(Clone, Default)]
pub(crate) struct KeptFactor(Arc<Mutex<Option<Arc<Factor>>>>);

impl KeptFactor {
    pub fn get(&self) -> Option<Arc<Factor>> {
        // A thread that died while it held the lock left a whole value behind.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub fn replace(&self, newer: Arc<Factor>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(newer);
    }

    pub fn bytes(&self) -> usize {
        self.get().map_or(0, |factor| factor.bytes())
    }
}

impl fmt::Debug for KeptFactor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "KeptFactor({} bytes)", self.bytes())
    }
}
