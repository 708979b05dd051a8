//! The blocks of `costs` about contacts.

use crate::schema::timing::When;

object! {
    /// weight times the force that a contact presses with: the sum of its pressures times areas.
    pub struct ContactForce {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// One of the case's contacts.
        pub contact: String,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}

object! {
    /// weight times a smoothed largest pressure of a contact: the power mean over its surface, never above it.
    pub struct ContactPressure {
        /// Name in results; the kind if left out.
        pub name: Option<String>,
        /// One of the case's contacts.
        pub contact: String,
        /// q of the exponent 2q: the larger, the nearer to the largest pressure.
        pub exponent: usize as POSITIVE = 8,
        /// Factor.
        pub weight: f64 as ANY_NOT_NEGATIVE = 1.0,
        /// When it counts in a motion; at the end if left out.
        pub when: Option<When>,
    }
}
