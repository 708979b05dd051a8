//! [`FitRecord`]: the content of `fit.json`.

use crate::record::{ByName, ExistenceRecord, Nullable, Number};
use serde_json::Value;

records! {
    /// What a fit found.
    FitRecord {
        /// `fit`.
        command: String,
        /// Version of the program.
        version: String,
        /// Title of the data file.
        title: Nullable<String>,
        /// `absolute` or `relative`: which errors are made small.
        errors: String,
        /// The tests as they were understood.
        tests: Vec<TestRecord>,
        /// Which shapes the tests that were fitted have seen.
        seen: SeenRecord,
        /// The best law.
        best: String,
        /// Every law, the best first.
        laws: Vec<FittedLawRecord>,
        /// Laws that could not be fitted.
        failed: Vec<FailedLawRecord>,
        /// Names of the files.
        files: Vec<String>,
        /// The exit code.
        exit: u8,
    }

    /// A test.
    TestRecord {
        /// Its name.
        name: String,
        /// Its kind.
        kind: String,
        /// What was measured.
        response: String,
        /// How the specimen lies to fibres.
        fibers: Nullable<String>,
        /// Number of points.
        points: usize,
        /// Points at rest, which are left out.
        at_rest: usize,
        /// Its weight.
        weight: Number,
        /// Whether it took no part in the fit.
        held_out: bool,
    }

    /// Which shapes tests have seen.
    SeenRecord {
        /// Kinds of tests that are missing, of `uniaxial`, `equibiaxial` and `planar`.
        missing: Vec<String>,
        /// Range of I1 = |F|^2 at constant volume.
        first_invariant: Vec<f64>,
        /// Range of I2 = |H|^2.
        second_invariant: Vec<f64>,
    }

    /// A law that could not be fitted.
    FailedLawRecord {
        /// The law.
        law: String,
        /// Why.
        why: String,
    }

    /// A fitted law.
    FittedLawRecord {
        /// The law.
        law: String,
        /// Its parameters.
        parameters: Option<ByName<EstimateRecord>>,
        /// Correlations of the parameters; null where one is not determined.
        correlation: Vec<Vec<Number>>,
        /// Its bulk modulus.
        bulk: BulkRecord,
        /// Sum of squared residuals.
        squares: Number,
        /// Number of points.
        points: usize,
        /// Standard deviation of the residuals.
        scatter: Number,
        /// Its unit.
        scatter_unit: String,
        /// R^2 by test, also of those held out; null where the law has no response.
        r_squared: Option<ByName<Number>>,
        /// Akaike's criterion, corrected for few points.
        aicc: Number,
        /// Bayes' criterion.
        bic: Number,
        /// `aicc` above that of the best law.
        aicc_above_best: Number,
        /// Starts of least squares.
        starts: FitStartsRecord,
        /// Poisson's ratio at rest.
        poissons_ratio: Nullable<f64>,
        /// By kind of test where the law is stable (Drucker).
        stable: Option<ByName<StableRangeRecord>>,
        /// Conditions of the existence theorem.
        existence: Nullable<ExistenceRecord>,
        /// The block of materials to paste.
        materials: Value,
        /// The block of scenarios to paste.
        scenarios: Value,
    }

    /// A parameter.
    EstimateRecord {
        /// Its value.
        value: Number,
        /// Its unit.
        unit: String,
        /// Its standard deviation.
        deviation: Number,
        /// Its interval of 95 %.
        interval: Nullable<[f64; 2]>,
    }

    /// A bulk modulus.
    BulkRecord {
        /// Its value.
        value: Number,
        /// Pa.
        unit: String,
        /// Its standard deviation; null where it was given.
        deviation: Number,
        /// Half of its interval.
        half_width: Number,
    }

    /// Starts of least squares.
    FitStartsRecord {
        /// How many were tried.
        tried: usize,
        /// How many converged.
        converged: usize,
        /// How many ran out of evaluations.
        exhausted: usize,
        /// How many led to the best one.
        alike: usize,
        /// Whether the best one ran out of evaluations.
        best_exhausted: bool,
    }

    /// Stretches between which a law is stable.
    StableRangeRecord {
        /// The least.
        from: Number,
        /// The largest.
        to: Number,
        /// Whether it ends below.
        ends_below: bool,
        /// Whether it ends above.
        ends_above: bool,
        /// Whether the law has no values below.
        limit_below: bool,
        /// Whether the law has no values above.
        limit_above: bool,
        /// Whether an end lies within the data.
        within_data: bool,
    }
}
