//! [`IdentificationRecord`]: what readings say of parameters.

use crate::record::{ByName, Nullable, Number};
use serde_json::Value;

records! {
    /// What readings say of parameters, or why that is not known; also the content of `identified.json`.
    IdentificationRecord {
        /// Why it is not known.
        failed: Option<String>,
        /// Numbers that were read.
        readings: Option<usize>,
        /// Parameters with a prior, each one more reading.
        priors: Option<usize>,
        /// Weighted sum of the squared residuals of both.
        squares: Number,
        /// The same over the readings less the parameters that they determine: near 1 where the model meets the noise; null without a surplus.
        per_freedom: Number,
        /// By parameter its value; of a field one for each value, NAME/0, NAME/1 ..
        parameters: Option<ByName<ParameterRecord>>,
        /// Correlations of the unknowns, in the order of the parameters; null where one is not determined.
        correlation: Option<Vec<Vec<Number>>>,
        /// Covariance of the unknowns, directions that are not seen left out.
        covariance: Option<Vec<Vec<Number>>>,
        /// Directions of the unknowns, the least determined first.
        directions: Option<Vec<SeenDirectionRecord>>,
        /// By load case its residuals; of a case without load cases one, `all`.
        shots: Option<ByName<ShotRecord>>,
        /// What deserves attention, in sentences.
        remarks: Option<Vec<String>>,
        /// The materials of the case with the identified numbers, to paste.
        materials: Option<Value>,
        /// Materials with mean and covariance of the parameters, to paste.
        scenarios: Option<Value>,
    }

    /// An identified parameter.
    ParameterRecord {
        /// Its value.
        value: Number,
        /// Its unit.
        unit: String,
        /// Its standard deviation, of a control with `log` that of its logarithm times the value; null where it is not determined.
        deviation: Number,
        /// Its interval of 95 %.
        interval: Option<Vec<Number>>,
        /// Whether it lies on a bound, without a deviation then.
        on_bound: Option<bool>,
    }

    /// A direction of the unknowns.
    SeenDirectionRecord {
        /// Standard deviation along it, in shares of the parameters' scales; null where no reading sees it.
        deviation: Number,
        /// Its components in these scales: of a prior its deviation, of `log` the logarithm, else a share of the start or the value, whichever is larger.
        components: ByName<Number>,
    }

    /// The residuals of a shot.
    ShotRecord {
        /// Numbers that were read.
        readings: usize,
        /// Weighted sum of their squared residuals.
        squares: Number,
        /// Root mean square residual of a coordinate of the markers, length.
        rms: Number,
        /// The largest distance of a marker, length.
        largest: Number,
        /// The marker that has it.
        marker: Nullable<String>,
        /// By marker its distance, length.
        distances: Option<ByName<Number>>,
        /// By other cost its root mean square residual, in deviations.
        others: Option<ByName<Number>>,
    }
}
