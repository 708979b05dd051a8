//! [`KeptFactor`]: the one factor an evaluated point holds.

use nastic_fem::linear::Factor;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The factor a point keeps for the next solve near it. The adjoint's replaces the evaluation's, so that there is never
/// more than one; it serves as a preconditioner and decides no result.
#[derive(Default)]
pub(crate) struct KeptFactor(Mutex<Option<Arc<Factor>>>);

impl KeptFactor {
    pub fn new(factor: Option<Arc<Factor>>) -> Self {
        KeptFactor(Mutex::new(factor))
    }

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

impl Clone for KeptFactor {
    fn clone(&self) -> Self {
        KeptFactor::new(self.get())
    }
}

impl fmt::Debug for KeptFactor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "KeptFactor({} bytes)", self.bytes())
    }
}
