//! Finite elements at finite strain: assembly, linear solvers, Newton's method, continuation, states.
//!
//! A [`Solid`] is a body on a [`Discretization`] with energy terms, supports and loads; [`Solid::solve`] finds its
//! equilibrium and [`Solid::adjoint`] solves with the tangent there. What is known here about laws is what
//! [`EnergyTerm`](nastic_energy::EnergyTerm) says, and about costs nothing.

mod adjoint;
pub mod contributions;
mod discretization;
mod error;
mod kernels;
mod model;
mod nonlinear;
mod solid;
mod solution;
mod structure;
pub mod time;

pub use adjoint::Adjoint;
pub use adjoint::second_order::{AdjointChange, SecondOrder};
pub use contributions::body_energy::excess_tension::ExcessTension;
pub use contributions::body_energy::formulation::Formulation;
pub use contributions::body_energy::point_peaks::PointPeak;
pub use contributions::body_energy::{AttachedActuation, BodyEnergy};
pub use contributions::{
    BeforeStep, BodyPoint, Cavity, Constrains, Contact, ContactLaw, Contribution, ContributionPoint, ControlPoint,
    Controls, Demand, EnergyRole, ExactContact, Foundation, History, Increment, Inertia, Instant, Lumen, MovingSupport,
    Need, Onsets, Prescribes, Remembers, RigidBody, RigidPose, SampleState, SecondSensitivities, Sensitivities,
    Sliding, Spring, Sums, SurfaceContact, Tendon, Tied, TimeStep, Touch, TouchParameters, Touches, VaryingLoad,
    check_contribution,
};
pub use discretization::Discretization;
pub use discretization::parted::all_accept;
pub use discretization::quadrature_points::QuadraturePoints;
pub use discretization::rigid_motions::FreeMotion;
pub use discretization::supports::{AXES, Supports};
pub use error::{Cause, FemError, Inadmissible, InvertedAt, MeetingGuides, SecondDerivativeError, StateError};
pub use model::{ContactSum, Controllable, DISPLACEMENT, Feature, Model, ModelPoint, Pressing, StoredEnergy};
pub use nastic_linear::memory::{
    LimitError as MemoryLimitError, available as available_memory, limit as memory_limit, peak as peak_memory,
};
pub use nastic_linear::solver::Inertia as TangentInertia;
pub use nastic_linear::{ByProducts, Field, On, Role, Share, Solver, SolverFactory, Space};
pub use solid::Solid;
pub use solid::cell_fields::CellFields;
pub use solution::ahead::{Ahead, LimitAhead};
pub use solution::connection::Connection;
pub use solution::deflation::{Equilibria, Equilibrium};
pub use solution::descent::Descent;
pub use solution::exact_contact::ExactEquilibrium;
pub use solution::modes::Modes;
pub use solution::options::{Progress, SolveOptions};
pub use solution::path::{EquilibriumPath, EventKind, PathEnd, PathEvent, PathOptions, PathPoint};
pub use solution::ramp::{CriticalPoint, Ramp, RampPoint};
pub use solution::state::{SolveReport, State};
pub use solution::vibration_modes::{ModeKind, VibrationMode};
pub use solution::workspace::Workspace;
pub use structure::{StructureCounts, TangentStructure};
pub use time::adaptive::{AdaptiveReport, Tolerance};
pub use time::checkpoints::Checkpoints;
pub use time::energy_balance::{EnergyBalance, EnergyLedger};
pub use time::instant_adjoint::StatePartials;
pub use time::numerical_damping::{AmplificationFactor, ModalDamping};
pub use time::recording::{Recording, RecordingCounts};
pub use time::reverse_sweep::{ReverseSweep, Swept, SweptInstant};
pub use time::scheme::Scheme;
pub use time::trajectory::{Begin, StepRecord, StepTo, Trajectory};
