//! The blocks of `load_cases`.

use crate::schema::control::Control;
use crate::schema::cost::Cost;
use crate::schema::load::Load;
use crate::schema::settings::Settings;
use crate::schema::support::Support;

object! {
    /// One of several states that share the design; the blocks named here belong to it alone.
    pub struct LoadCase {
        /// Name in results and file names.
        pub name: String,
        /// Factor of its cost in the sum.
        pub weight: f64 as NOT_NEGATIVE = 1.0,
        /// What differs: path and value.
        pub set: Settings,
        /// Supports of this load case alone.
        pub supports: Vec<Support> = Vec::new(),
        /// Loads of this load case alone.
        pub loads: Vec<Load> = Vec::new(),
        /// Controls of this load case alone.
        pub controls: Vec<Control> = Vec::new(),
        /// Costs of this load case alone.
        pub costs: Vec<Cost> = Vec::new(),
    }
}
