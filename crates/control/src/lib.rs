//! Control fields, costs, the adjoint and reduced problems.
//!
//! [`Reduced`] is the cost as a function of the controls alone: it takes a [`Solid`](nastic_fem::Solid), says which
//! actuations are controlled and how ([`Space`]), and adds up [`Cost`]s. It is an
//! [`Objective`](nastic_opt::Objective), so every optimiser of `nastic-opt` drives it.

mod constraint;
mod control_block;
mod control_limit;
mod control_names;
mod control_values;
mod cost;
mod design;
mod error;
mod evaluated;
mod field_chain;
mod field_operator;
mod grid;
mod inner_product;
mod known_limits;
mod layout;
mod map;
mod over_ranks;
mod reduced;
mod snapshot;
mod state_predictor;
mod time;
mod total_variation;
mod workspace;

pub use constraint::{BetweenNodes, Bound, Constraint, ConstraintPoint, CostLimit, IntoConstraint, ObstacleDistance};
pub use control_block::{ControlBlock, ControlTarget, Shown};
pub use control_limit::{ControlAt, ControlLimit};
pub use control_values::{ControlEntity, ControlValues, Pairs};
pub use cost::{
    Aim, BoundHausdorff, BoundTracking, CATALOGUE as COSTS, Compliance, ContactLoad, ContactResultant, ContactSlip,
    ControlNorm, ControlSmoothness, Cost, CostContext, CostExample, CostForm, CostInputs, CostPoint, CostRow,
    CostTaken, CostTarget, CostValue, CostWords, Counts, Curvature, DesignMean, DistanceInTime, Figure, FigureKind,
    IntoCost, Key, KeyKind, LargestStretch, LumenVolume, MakeCost, Marker, Markers, MeanDisplacement, MeanPosition,
    MeanRadius, MotionPartials, Need, ObstaclePenetration, Orientation, Output, OutputTarget, Partials, Prior,
    PumpWork, Reaction, Reading, SmoothedHausdorff, StepBegin, Target, Tracking,
};
pub use design::Consumer;
pub use error::{ControlError, RemoteFailure};
pub use evaluated::{AdjointState, Evaluated, SolvedStates, StepError};
pub use field_operator::FieldOperator;
pub use grid::Grid;
pub use inner_product::{METRICS, Metric, MetricRow, inner_product};
pub use layout::Layout;
pub use map::{
    Basis, Chain, ControlMap, Direction, Expansion, Exponential, Filter, Held, Length, MAPS, MapRow, Mirror, Plane,
    PowerLaw, Projection, SPACES, Space, SpaceRow, Staged, Step,
};
pub use nastic_hausdorff::{CATALOGUE as PHIS, Phi, PhiRow, Smoothing};
pub use nastic_mesh::spatial::Obstacle;
pub use reduced::{AdaptiveSteps, Lagrangian, OutputJacobian, Reduced, SecondDerivative, work_summary};
pub use snapshot::StateFields;
pub use time::{
    ActuationWork, COSTS as MOTION_COSTS, ControlRate, Instants, Interpolation, KineticEnergy, Knots, MotionFootprint,
    MotionMemory, MotionObserver, RateLimit, StepUnderWay, Timeline, TrajectoryContext, TrajectoryCost,
    TrajectoryPartials, When,
};
pub use workspace::ReducedWorkspace;
