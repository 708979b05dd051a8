//! From a [`Case`](nastic_language::schema::Case) to a [`CaseProblem`]: meshes read, formulas evaluated where they are needed, names looked up.
//!
//! Every problem names its path and line; as many as possible are found before giving up. A case becomes an
//! [`Ensemble`](nastic_control::Ensemble) of members, one for every load case of every scenario; a plain case is an ensemble of one.

mod actuation;
mod adaptive_steps;
mod array;
mod assembled;
mod bending;
mod body;
mod coarse_steps;
mod constraint;
mod contact;
mod context;
mod control;
mod control_field;
mod control_grid;
mod control_start;
mod cost;
mod cost_term;
mod elements;
mod field;
mod inertia;
mod load;
mod lowering;
mod material;
mod member;
mod mesh;
mod named;
mod named_cost;
mod named_groups;
mod obstacle;
mod optimizer;
mod probe;
mod problem;
mod random;
pub mod result_array;
mod scenario;
mod sizes;
mod spring;
mod start;
mod support;
mod survey;
mod swept;
mod target_shape;
mod tension;
mod test_table;
mod time;
mod time_table;
mod variant;

pub use actuation::CONTRACTION;
pub use adaptive_steps::StepsError;
pub use assembled::AssemblyError;
pub use assembled::{Admission, Assembled, ControlProblem};
pub use control_field::{Admitted, ControlField};
pub use control_grid::grid_cells;
pub use member::CaseMember;
pub use mesh::again as mesh_again;
pub use obstacle::obstacle_of;
pub use probe::LocatedProbe;
pub use problem::CaseProblem;
pub use swept::{Combination, Swept, combinations};
pub use target_shape::TargetShape;
pub use test_table::read_tests;
pub use variant::file_name;
