//! [`Fixed`]: the value of a slot that is no control.

use crate::schema::field::{Parameter, VectorField};
use crate::schema::time_table::TimeTable;

/// The value of a slot that is no control.
#[derive(Clone, PartialEq, Debug)]
pub enum Fixed {
    /// Of a tension, a pressure.
    Scalar(Parameter),
    /// Of a remanence, a field.
    Vector(VectorField),
    /// Of either, over the time.
    Table(TimeTable),
}
