//! [`Absent`]: what a result leaves out.

use indexmap::IndexMap;
use serde_json::Value;

/// Whether a key says nothing, and is left out.
pub trait Absent {
    /// `None`, an empty map, a group without an entry.
    fn is_absent(&self) -> bool;
}

impl<T> Absent for Option<T> {
    fn is_absent(&self) -> bool {
        self.is_none()
    }
}

impl<K, V> Absent for IndexMap<K, V> {
    fn is_absent(&self) -> bool {
        self.is_empty()
    }
}

impl<T> Absent for Vec<T> {
    fn is_absent(&self) -> bool {
        false
    }
}

/// Keys that always stand there.
macro_rules! present {
    ($($type:ty),*) => { $( impl Absent for $type {
        fn is_absent(&self) -> bool {
            false
        }
    } )* };
}

present!(bool, u8, u64, usize, String, Value);
