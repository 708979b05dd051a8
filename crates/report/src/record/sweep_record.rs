//! [`SweepRecord`]: the content of `sweep.json`.

use crate::record::{ByName, Nullable, Number};
use serde_json::Value;

records! {
    /// A sweep.
    SweepRecord {
        /// The command of its runs.
        command: String,
        /// The case.
        case: String,
        /// What is swept.
        swept: Vec<SweptRecord>,
        /// Options with one value.
        fixed: Vec<String>,
        /// Whether runs start from the controls of the one before.
        warm: bool,
        /// How many runs were planned.
        planned: usize,
        /// The quantity of the chart, as a path in results, where it was asked for.
        quantity: Option<String>,
        /// Those that were made.
        runs: Vec<SweepRunRecord>,
        /// Of a sweep over meshes: how a quantity converges, from the coarsest to the finest.
        convergence: Option<Vec<ConvergenceRecord>>,
        /// Directories of those that are missing: not made, or not finished.
        missing: Vec<String>,
        /// The exit code of the worst; at least 4 where some are missing.
        exit: u8,
    }

    /// A swept option.
    SweptRecord {
        /// Where in the case.
        path: String,
        /// Its values as they were typed.
        values: Vec<String>,
    }

    /// A run on a mesh beside those on others.
    ConvergenceRecord {
        /// Its directory.
        run: String,
        /// The quantity, as a path in results.
        quantity: String,
        /// Cells.
        cells: usize,
        /// Displacement components.
        unknowns: usize,
        /// Its value.
        value: Number,
        /// Less that of the finest mesh, the one with most unknowns.
        difference: Number,
        /// The same as a share of that value.
        relative_difference: Number,
        /// The order of convergence that this mesh and the two before it show.
        order: Number,
    }

    /// A run of a sweep.
    SweepRunRecord {
        /// Its directory.
        run: String,
        /// Its swept values, by path.
        values: Option<ByName<Value>>,
        /// The run whose controls it started from.
        warm_from: Nullable<String>,
        /// Its exit code.
        exit: u8,
        /// Codes of its warnings.
        warnings: Vec<String>,
        /// Why it failed.
        error: Nullable<String>,
        /// Numbers of its result, by their paths there.
        figures: Option<ByName<Value>>,
    }
}
