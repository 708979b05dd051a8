//! [`Trajectory`]: states one after the other.
