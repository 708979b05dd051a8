//! [`RunRecord`]: the whole of `result.json`.

use crate::error::ReportError;
use crate::record::{
    ByName, CaseDescription, ControlRecord, DerivativeNorm, FailureRecord, GainsRecord, GradcheckRecord,
    GradientCheckRecord, Nullable, Number, OptimumRecord, ResumedRecord, StateRecord,
};
use serde::Deserialize;
use serde_json::Value;
use std::ops::{Deref, DerefMut};

records! {
    /// The result of a command.
    RunRecord {
        /// By smoothed distance (of a load case `CASE/TERM`) the exponents of its stages, automatic ones too.
        smoothing: ByName<Vec<SmoothingRecord>>,
        /// What was run.
        command: String,
        /// The case file.
        case: Option<String>,
        /// Its title.
        title: Nullable<String>,
        /// Hash of the case and of all files that it names.
        case_hash: String,
        /// The files that the case names, in the order in which the hash has them; relative names count from the case file.
        inputs: Option<Vec<String>>,
        /// Versions of the program and of the case's syntax.
        versions: VersionsRecord,
        /// Units of all numbers but those of modes, which are in SI.
        units: UnitsRecord,
        /// The size of the problem.
        discretization: Option<DiscretizationRecord>,
        /// Number of threads, on which nothing else depends but `seconds` and `peak_memory`.
        threads: Option<usize>,
        /// What was mended in meshes; cells and size of obstacles from meshes.
        notes: Option<Vec<String>>,
        /// Where a run went on: of several starts the first that had not ended.
        resumed: ResumedRecord,
        /// The short check of the derivative at the start.
        gradient_check: GradientCheckRecord,
        /// What `gradcheck` found.
        gradcheck: Option<GradcheckRecord>,
        /// The case as it was understood, of `check`.
        #[serde(flatten)]
        description: CaseDescription,
        /// What was found.
        #[serde(flatten)]
        state: StateRecord,
        /// Costs at the start of an optimisation, valued by the last stage.
        start: StateRecord,
        /// By name what became of each control.
        controls: Option<ByName<ControlRecord>>,
        /// Norms of the derivative.
        derivative_norm: DerivativeNorm,
        /// Sensitivities and law, of `gains`; `gains.json` holds the same.
        gains: Option<GainsRecord>,
        /// Of an optimisation: how it went.
        #[serde(flatten)]
        optimum: OptimumRecord,
        /// How far a motion came that has no end: of several members the one that came least far.
        reached: ReachedRecord,
        /// Why it failed or stopped on the way.
        error: Option<String>,
        /// Why a state solve failed.
        failure: FailureRecord,
        /// Wall time by phase: `read`, `ordering` (pattern and elimination order of the tangent), `solve` or `optimize`, `inspect` (stability, self-intersection), `write`, and so on.
        seconds: ByName<Number>,
        /// Largest memory of the process so far, in bytes (Linux; null elsewhere).
        peak_memory: Nullable<usize>,
        /// Values that the case expects.
        expect: Option<ExpectRecord>,
        /// What deserves attention.
        warnings: Vec<WarningRecord>,
        /// The exit code.
        exit: Option<u8>,
        /// True of a command that ended by a signal or for a lack of memory: the same command may find more. Else left out.
        interrupted: Option<bool>,
        /// Every state, and what the names of its files begin with.
        members: Option<Vec<MemberRecord>>,
        /// Names of the files that the run wrote.
        files: Option<Vec<String>>,
    }

    /// The program that ran.
    VersionsRecord {
        /// The program.
        nastic: String,
        /// The syntax of the case.
        case: Option<u64>,
    }

    /// The units of all numbers.
    UnitsRecord {
        /// Of lengths.
        length: String,
        /// Of forces.
        force: String,
        /// Of times.
        time: String,
        /// Of magnetic flux densities.
        field: String,
        /// Of stresses.
        pressure: String,
    }

    /// The size of a problem.
    DiscretizationRecord {
        /// 2 or 3.
        dimensions: usize,
        /// Cells.
        cells: usize,
        /// Nodes.
        nodes: usize,
        /// Displacement components.
        unknowns: usize,
    }

    /// The exponents of a stage.
    SmoothingRecord {
        /// alpha.
        alpha: Number,
        /// beta.
        beta: Number,
        /// gamma.
        gamma: Number,
        /// The length that they resolve.
        length: Number,
    }

    /// What deserves attention.
    WarningRecord {
        /// Its kind.
        code: String,
        /// A place of the case, a scenario, a state; empty for the case as a whole.
        place: String,
        /// What was found.
        message: String,
        /// What to try.
        #[serde(rename = "try")]
        advice: String,
    }

    /// Values that the case expects.
    ExpectRecord {
        /// How many were looked at.
        checked: usize,
        /// Those that were not met.
        missed: Vec<MissRecord>,
    }

    /// One that was not met.
    MissRecord {
        /// Where in the result.
        path: String,
        /// What is there.
        found: Value,
        /// What the case expects.
        expected: Value,
    }

    /// A member, and what the names of its files begin with.
    MemberRecord {
        /// Its name: of the scenario, the load case or both.
        name: String,
        /// Its scenario.
        scenario: Nullable<String>,
        /// Its load case.
        load_case: Nullable<String>,
        /// What the names of its files begin with.
        stem: String,
        /// The same without the scenario.
        case_stem: String,
        /// Its target shapes.
        targets: Vec<String>,
        /// Its obstacles.
        obstacles: Vec<String>,
        /// The names of all its obstacles in the case, of those that move too.
        obstacle_names: Vec<String>,
    }

    /// How far a motion came.
    ReachedRecord {
        /// The last instant.
        t: Number,
        /// Steps until then.
        steps: usize,
    }
}

impl Deref for RunRecord {
    type Target = StateRecord;

    fn deref(&self) -> &StateRecord {
        &self.state
    }
}

impl DerefMut for RunRecord {
    fn deref_mut(&mut self) -> &mut StateRecord {
        &mut self.state
    }
}

impl RunRecord {
    /// The result that a program has as JSON.
    ///
    /// # Errors
    /// A value of another kind than its key has.
    pub fn of(result: &Value) -> Result<Self, ReportError> {
        Self::deserialize(result).map_err(ReportError::of_result)
    }

    /// The result as JSON.
    ///
    /// # Errors
    /// A value that JSON cannot hold; none of ours is.
    pub fn to_json(&self) -> Result<Value, ReportError> {
        serde_json::to_value(self).map_err(ReportError::of_result)
    }
}
