//! What the page and the terminal read of `result.json`, as values.

use indexmap::IndexMap;

/// Types whose fields are keys of `result.json`; those that it lacks have their defaults.
macro_rules! records {
    ($(
        $(#[$about:meta])*
        $name:ident { $( $(#[$attribute:meta])* $field:ident: $type:ty ),* $(,)? }
    )*) => { $(
        $(#[$about])*
        #[derive(Clone, Debug, Default, serde::Deserialize)]
        #[serde(default)]
        #[allow(missing_docs)] // fields are keys
        pub struct $name { $( $(#[$attribute])* pub $field: $type ),* }
    )* };
}

mod run_record;
mod state_record;

pub use run_record::{
    ControlRecord, MemberRecord, RangeRecord, RunRecord, SpectrumRecord, StartRecord, UnitsRecord, WarningRecord,
};
pub use state_record::{HausdorffRecord, MeasureRecord, ProbeRecord, ProbesRecord, SeriesRecord, StateRecord};

/// A number of a result; `None` where there is none, or none that is finite.
pub type Number = Option<f64>;
/// Numbers by name, in the order of the file.
pub type Numbers = IndexMap<String, Number>;

/// The number of a name.
#[must_use]
pub fn number_of(numbers: &Numbers, name: &str) -> Number {
    numbers.get(name).copied().flatten()
}
