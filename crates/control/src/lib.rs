//! Control fields, costs, the adjoint and reduced problems.
//!
//! [`Reduced`] is the cost as a function of the controls alone: it takes a [`Solid`](nastic_fem::Solid), says which
//! actuations are controlled and how ([`Space`]), and adds up [`Cost`]s. It is an
//! [`Objective`](nastic_opt::Objective), so every optimiser of `nastic-opt` drives it.

mod constraint;
mod cost;
mod evaluated;
mod known_limits;
mod reduced;
mod snapshot;
mod state_predictor;
mod time;
mod workspace;

pub use constraint::{BetweenNodes, Bound, Constraint, ConstraintPoint, CostLimit, IntoConstraint, ObstacleDistance};
pub use cost::{
    Aim, BoundHausdorff, BoundTracking, CATALOGUE as COSTS, Compliance, ContactLoad, ContactResultant, ContactSlip,
    ControlNorm, ControlSmoothness, Cost, CostContext, CostExample, CostForm, CostInputs, CostPoint, CostRow,
    CostTaken, CostTarget, CostValue, CostWords, Counts, Curvature, DesignMean, DistanceInTime, Figure, FigureKind,
    IntoCost, Key, KeyKind, LargestStretch, LumenVolume, MakeCost, Marker, Markers, MeanDisplacement, MeanPosition,
    MeanRadius, MotionPartials, Need, ObstaclePenetration, Orientation, Output, OutputTarget, Partials, Prior,
    PumpWork, Reaction, Reading, ShapeShrinkage, SmoothedHausdorff, StepBegin, Target, Tracking,
};
pub use evaluated::{AdjointState, Evaluated, SolvedStates, StepError};
pub use nastic_fields::{
    Basis, Chain, Consumer, ControlAt, ControlBlock, ControlEntity, ControlError, ControlLimit, ControlMap,
    ControlTarget, ControlValues, Direction, Expansion, Exponential, FieldOperator, Filter, Grid, Held, Interpolation,
    Knots, Layout, Length, MAPS, METRICS, MapRow, Metric, MetricRow, Mirror, Pairs, Plane, PowerLaw, Projection,
    RemoteFailure, SPACES, Shown, Space, SpaceRow, Staged, Step, inner_product,
};
pub use nastic_hausdorff::{CATALOGUE as PHIS, Phi, PhiRow, Smoothing};
pub use nastic_mesh::spatial::Obstacle;
pub use reduced::{AdaptiveSteps, Lagrangian, OutputJacobian, Reduced, SecondDerivative, work_summary};
pub use snapshot::StateFields;
pub use time::{
    ActuationWork, COSTS as MOTION_COSTS, ControlRate, Instants, KineticEnergy, MotionFootprint, MotionMemory,
    MotionObserver, RateLimit, StepUnderWay, Timeline, TrajectoryContext, TrajectoryCost, TrajectoryPartials, When,
};
pub use workspace::ReducedWorkspace;
