//! `result.json` as values: what commands fill, the page and the terminal read, and the JSON Schema of results describes.

use indexmap::IndexMap;

/// Types whose fields are keys of results. A key that says nothing (`None`, an empty map, a group without an entry) is left out; one that a
/// file lacks has its default.
macro_rules! records {
    ($(
        $(#[$about:meta])*
        $name:ident { $( $(#[$attribute:meta])* $field:ident: $type:ty ),* $(,)? }
    )*) => { $(
        $(#[$about])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(default)]
        pub struct $name { $(
            $(#[$attribute])*
            #[serde(skip_serializing_if = "crate::record::Absent::is_absent")]
            pub $field: $type
        ),* }

        impl crate::record::Absent for $name {
            fn is_absent(&self) -> bool {
                *self == Self::default()
            }
        }
    )* };
}

mod absent;
mod case_record;
mod comparison_record;
mod contact_record;
mod contribution_record;
mod control_record;
mod error_record;
mod failure_record;
mod first_order_record;
mod fit_record;
mod gains_record;
mod gradcheck_record;
mod identification_record;
mod nullable;
mod number;
mod optimum_record;
mod rigid_motion;
mod run_record;
mod schema;
mod series_record;
mod spectrum_record;
mod state_record;
mod sweep_record;
mod time_record;
mod trial_record;

pub use absent::Absent;
pub use case_record::{
    BodyPointRecord, CaseDescription, CellGroupRecord, ConstantRecord, ExistenceRecord, GrowthRecord, LawRecord,
    MemoryRecord, MeshRecord, NamesRecord, QualityRecord, SetRecord,
};
pub use comparison_record::{ComparedRecord, ComparisonRecord, DistancesRecord, NodeByNodeRecord};
pub use contact_record::{ContactRecord, ExactContactRecord, HalfThicknessRecord};
pub use contribution_record::*;
pub use control_record::{ControlRecord, ControlValues, RangeRecord, WidthRecord};
pub use error_record::{ErrorRecord, ProblemRecord};
pub use failure_record::{
    CellRecord, DomainRecord, ExcessTensionRecord, FailureRecord, FreeMotionRecord, MeetingGuidesRecord,
    PenetrationRecord, TensionRecord,
};
pub use first_order_record::{FirstOrderRecord, SourceRecord};
pub use fit_record::{
    BulkRecord, EstimateRecord, FailedLawRecord, FitRecord, FitStartsRecord, FittedLawRecord, SeenRecord,
    StableRangeRecord, TestRecord,
};
pub use gains_record::{GainsControlRecord, GainsDirectionRecord, GainsLoopRecord, GainsOutputRecord, GainsRecord};
pub use gradcheck_record::{
    DirectionRecord, GradcheckRecord, RemainderRecord, SecondDirectionRecord, SecondGradcheckRecord, TermCheckRecord,
};
pub use identification_record::{IdentificationRecord, ParameterRecord, SeenDirectionRecord, ShotRecord};
pub use nullable::Nullable;
pub use number::{Number, Numbers, number_of, numbers};
pub use optimum_record::{
    BetweenNodesRecord, ConstraintGroupRecord, ConstraintValueRecord, ConstraintsRecord, DerivativeNorm,
    GradientCheckRecord, LastLimitRecord, LimitPointsRecord, OptimumRecord, ResumedRecord, StageRecord, StartRecord,
};
pub use rigid_motion::RigidMotion;
pub use run_record::{
    DiscretizationRecord, ExpectRecord, MemberRecord, MissRecord, ReachedRecord, RunRecord, SmoothingRecord,
    UnitsRecord, VersionsRecord, WarningRecord,
};
pub use series_record::{
    EquilibriaRecord, JumpRecord, ModesRecord, ModesUnits, PointRecord, SeriesRecord, VibrationInSteps,
};
pub use spectrum_record::{EigenvectorsRecord, SpectrumRecord};
pub use state_record::{
    CostRecord, HausdorffRecord, IntersectionRecord, MeasureRecord, ProbeRecord, ProbesRecord, RiskRecord, StateRecord,
    StoredEnergyRecord, UncountedRecord,
};
pub use sweep_record::{ConvergenceRecord, SweepRecord, SweepRunRecord, SweptRecord};
pub use time_record::{EnergiesRecord, EnergyBalanceRecord, EnergyRecord, StepErrorRecord, TimeRecord};
pub use trial_record::TrialRecord;

/// Entries by name, in the order of the file.
pub type ByName<T> = IndexMap<String, T>;
