//! The typed case: every block and key of a case file.
//!
//! One description serves three readers: the structs below are written once, with their keys, documentation, units and
//! defaults, and two macros turn that into the Rust type, the reader that reports every problem, and the
//! JSON Schema ([`json_schema`]). They cannot diverge. Laws and actuations take their names and keys from the catalogue
//! of `nastic-energy`.

#[macro_use]
mod macros;

mod actuation;
mod actuation_words;
mod block;
mod body_point;
mod case;
mod case_schema;
mod catalogue;
mod check;
mod constraint;
mod contact;
mod control;
mod cost;
mod cost_term;
mod design;
mod direction;
mod electrode;
mod expectation;
mod field;
mod field_chain;
mod fit;
mod fixed;
mod gains;
mod group_names;
mod hints;
mod json;
mod key_value;
mod load;
mod load_case;
mod markers;
mod material;
mod mesh;
mod named;
mod named_part;
mod network;
mod network_file;
mod obstacle;
mod optimizer;
mod read;
mod scenario;
mod settings;
mod smoothed_hausdorff;
mod support;
mod target;
mod time;
mod time_table;
mod timing;
mod units;
mod value;

pub use actuation::{Actuation, Means};
pub use actuation_words::{CONVENTIONS, pulling};
pub use block::{Block, at_rest};
pub use body_point::point_in_words;
pub use case::*;
pub use case_schema::json_schema;
pub use catalogue::{Input, SlotName};
pub use constraint::{Constraint, KeepOut};
pub use contact::{Contact, PressureLaw};
pub use control::{Bound, Cells, Control, ControlPrior, ControlsFile, Space, Start};
pub use cost::Cost;
pub use cost_term::CostTerm;
pub use design::{Design, DesignKind, Interpolation, MixedLaw, OwnLaw};
pub use direction::Direction;
pub use electrode::Electrode;
pub use expectation::{Command, Expectation};
pub use field::{ArrayFile, Parameter, VectorField, vector_at};
pub use field_chain::{GivenPlane, Projection, Sharpness, SymmetryPlane};
pub use fit::{FitData, FitErrors, FitKind, FitLaw, FitTest};
pub use fixed::Fixed;
pub use gains::Gains;
pub use group_names::group_names;
pub use key_value::KeyValue;
pub use load::Load;
pub use load_case::LoadCase;
pub use markers::{MarkerRow, MarkerTable};
pub use material::Material;
pub use mesh::{BodyBox, BoxMesh, BoxesMesh, MeshFile, MeshSource};
pub use named::{Element, Method, SchemeName};
pub use named_part::{NamedRegion, NamedSurface};
pub use network::{InputName, LayerBlock, NetworkBlock, NetworkSource, network_json};
pub use network_file::NetworkFile;
pub use obstacle::{AlignedBox, Capsule, HalfSpace, Obstacle, Outline, Shape, ShapeOrName, Sphere, VectorInTime};
pub use optimizer::{Metric, Optimizer, Unstable};
pub use scenario::{
    BetaLaw, ConditionalValueAtRisk, FirstOrder, GammaLaw, GaussianLaw, Inadmissible, Kernel, LognormalLaw,
    MeanDeviation, RandomParameter, RandomScenarios, Risk, Rule, Scenario, Scenarios, UniformLaw, WorstCase,
};
pub use smoothed_hausdorff::{Exponential, Inverse, Phi, SmoothedHausdorff, Stage, Stages};
pub use support::{Along, Axis, Displacement, Fix, Support};
pub use target::{Coordinates, Target};
pub use time::{Beginning, KelvinVoigt, MassKind, Maxwell, Rayleigh, SpringMeasure, Time};
pub use time_table::TimeTable;
pub use timing::{HoldsWhen, InTime, KnotInterpolation, When};
pub use value::Vector;
