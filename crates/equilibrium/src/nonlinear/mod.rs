//! Newton's method: one `iteration`, whatever finds its steps (`direction`) and whatever measures them (`merit`).

pub(crate) mod anchor;
pub(crate) mod direction;
pub(crate) mod equations;
pub mod iterate;
pub(crate) mod iteration;
mod line_search;
mod merit;
mod newton;
pub(crate) mod predicted_pressures;
