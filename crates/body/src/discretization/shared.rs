//! [`Shared`]: values that the problems on one discretisation have in common.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// How many different values of a type are compared with: those of a scenario that has some of its own are no better known.
const COMPARED: usize = 8;

type Value = Weak<dyn Any + Send + Sync>;

/// The latest values of every type, as long as somebody has them.
#[derive(Debug, Default)]
pub(super) struct Shared(Mutex<HashMap<TypeId, Vec<Value>>>);

impl Shared {
    pub fn share<T: PartialEq + Send + Sync + 'static>(&self, value: Arc<T>) -> Arc<T> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = all.entry(TypeId::of::<T>()).or_default();
        known.retain(|known| known.strong_count() > 0);
        let latest = known.iter().filter_map(|known| known.upgrade()?.downcast::<T>().ok());
        if let Some(same) = latest.into_iter().find(|known| Arc::ptr_eq(known, &value) || **known == *value) {
            return same;
        }
        if known.len() == COMPARED {
            known.remove(0);
        }
        let kept: Arc<dyn Any + Send + Sync> = value.clone();
        known.push(Arc::downgrade(&kept));
        value
    }
}
