//! Names of the arrays of result files.

/// Distance of nodes from the first target.
pub const TARGET_DISTANCE: &str = "target_distance";

/// Names of result arrays that no control may take.
const RESERVED: [&str; 22] = [
    "mises",
    "displacement",
    "velocity",
    "adjoint",
    "J",
    "P",
    "cauchy_stress",
    "energy",
    "fiber",
    "B_r",
    "B_a",
    "region",
    "intersecting",
    "failed",
    "min_J",
    "failure_rank",
    "green_strain",
    "principal_stretches",
    "nodal_cauchy_stress",
    "nodal_mises",
    "reaction",
    TARGET_DISTANCE,
];

/// Whether results have arrays of this name already.
pub(super) fn is_reserved(array: &str) -> bool {
    let prefixes = ["gradient_", "direction_", "mode_"];
    RESERVED.contains(&array) || prefixes.iter().any(|prefix| array.starts_with(prefix))
}
