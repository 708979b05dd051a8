//! Finite elements at finite strain: one crate for bodies, forces, equilibria and motions, and the builder of a body, [`Solid`].
//!
//! A [`Solid`] is a body on a [`Discretization`] with energy terms, supports and loads; [`Solid::solve`] finds its
//! equilibrium and [`Solid::adjoint`] solves with the tangent there. What is known here about laws is what
//! [`EnergyTerm`](nastic_energy::EnergyTerm) says, and about costs nothing.

mod body;
pub mod catalogue;
mod solid;

pub use body::Body;
pub use nastic_body::body_energy::excess_tension::ExcessTension;
pub use nastic_body::body_energy::formulation::Formulation;
pub use nastic_body::body_energy::free_shape::FreeShape;
pub use nastic_body::body_energy::point_peaks::PointPeak;
pub use nastic_body::body_energy::shape::{NodalMode, ShapeQuality};
pub use nastic_body::body_energy::{AttachedLaw, BodyEnergy};
pub use nastic_body::contribution::body_point::BodyPoint;
pub use nastic_body::contribution::constrains::Constrains;
pub use nastic_body::contribution::energy_role::EnergyRole;
pub use nastic_body::contribution::point::{ContributionPoint, Need};
pub use nastic_body::contribution::prescribes::Prescribes;
pub use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
pub use nastic_body::contribution::tied::Tied;
pub use nastic_body::contribution::touches::{
    ExactContact, Onsets, RigidPose, SampleState, Sliding, Touch, TouchParameters, Touches,
};
pub use nastic_body::contribution::{Contribution, Demand, OverCells, Sums};
pub use nastic_body::controls::{ControlPoint, Controls};
pub use nastic_body::discretization::Discretization;
pub use nastic_body::discretization::parted::all_accept;
pub use nastic_body::discretization::quadrature_points::QuadraturePoints;
pub use nastic_body::discretization::rigid_motions::FreeMotion;
pub use nastic_body::discretization::supports::{AXES, Supports};
pub use nastic_body::error::{
    Cause, FemError, Inadmissible, InvertedAt, MeetingGuides, SecondDerivativeError, StateError,
};
pub use nastic_body::history::{BeforeStep, History, Remembers};
pub use nastic_body::instant::{Instant, TimeStep};
pub use nastic_body::state::{SolveReport, State};
pub use nastic_body::strategy::{Strategies, Strategy, StrategyCounts};
pub use nastic_body::structure::{StructureCounts, TangentStructure};
pub use nastic_equilibrium::adjoint::Adjoint;
pub use nastic_equilibrium::adjoint::second_order::{AdjointChange, SecondOrder};
pub use nastic_equilibrium::contribution_check::check_contribution;
pub use nastic_equilibrium::linear_systems::workspace::Workspace;
pub use nastic_equilibrium::model::views;
pub use nastic_equilibrium::model::{
    ContactSum, Contacts, Controllable, DISPLACEMENT, Feature, Model, ModelPoint, Pressing, StoredEnergy,
};
pub use nastic_equilibrium::search::ahead::{Ahead, LimitAhead};
pub use nastic_equilibrium::search::connection::Connection;
pub use nastic_equilibrium::search::descent::Descent;
pub use nastic_equilibrium::search::exact_contact::ExactEquilibrium;
pub use nastic_equilibrium::search::options::{Progress, SolveOptions};
pub use nastic_equilibrium::stability::deflation::{Equilibria, Equilibrium};
pub use nastic_equilibrium::stability::modes::Modes;
pub use nastic_equilibrium::stability::path::{EquilibriumPath, EventKind, PathEnd, PathEvent, PathOptions, PathPoint};
pub use nastic_equilibrium::stability::ramp::{CriticalPoint, Ramp, RampPoint};
pub use nastic_forces::cavity::{Cavity, Lumen};
pub use nastic_forces::contact::{Contact, ContactLaw};
pub use nastic_forces::dielectric_body::DielectricBody;
pub use nastic_forces::electrode::{Electrode, ElectrodeDrive, ElectrodePlace};
pub use nastic_forces::foundation::Foundation;
pub use nastic_forces::free_shape::{DrawnKeeper, SkinMap};
pub use nastic_forces::inertia::{BodyInertia, Inertia};
pub use nastic_forces::medium::Medium;
pub use nastic_forces::moving_support::MovingSupport;
pub use nastic_forces::nodal_value::NodalValue;
pub use nastic_forces::rigid_body::RigidBody;
pub use nastic_forces::spring::Spring;
pub use nastic_forces::tendon::Tendon;
pub use nastic_forces::varying_load::VaryingLoad;
pub use nastic_forces::weak_form::{CellSum, FormDual, FormPoint, WeakForm};
pub use nastic_linear::memory::{
    LimitError as MemoryLimitError, available as available_memory, limit as memory_limit, peak as peak_memory,
};
pub use nastic_linear::solver::Inertia as TangentInertia;
pub use nastic_linear::{ByProducts, Field, On, Role, Share, Solver, SolverFactory, Space};
pub use nastic_motion::TimeStepping;
pub use nastic_motion::adaptive::{AdaptiveReport, Tolerance};
pub use nastic_motion::catalogue as schemes;
pub use nastic_motion::checkpoints::Checkpoints;
pub use nastic_motion::energy_balance::{EnergyBalance, EnergyLedger};
pub use nastic_motion::instant_adjoint::StatePartials;
pub use nastic_motion::numerical_damping::{AmplificationFactor, ModalDamping};
pub use nastic_motion::recording::{Recording, RecordingCounts};
pub use nastic_motion::reverse_sweep::{ReverseSweep, Swept, SweptInstant};
pub use nastic_motion::scheme::Scheme;
pub use nastic_motion::trajectory::{Begin, StepRecord, StepTo, Trajectory};
pub use nastic_motion::vibration_modes::{ModeKind, VibrationMode};
pub use solid::Solid;
pub use solid::cell_fields::CellFields;
