//! [`FirstOrderRecord`]: mean and deviation of a cost to first order.

use crate::record::Number;

records! {
    /// Mean and standard deviation of the cost to first order in its random parameters.
    FirstOrderRecord {
        /// The cost at the medians of the random parameters, to first order its mean.
        mean: Number,
        /// Its standard deviation to first order.
        deviation: Number,
        /// The deviation as it is optimised, rounded where it is zero.
        rounded: Number,
        /// Where the expansion is, in words.
        about: String,
        /// The random parameters, and parts of fields, by their shares of the variance, the largest first.
        sources: Vec<SourceRecord>,
    }

    /// What a random parameter makes of the variance of the cost.
    SourceRecord {
        /// The path of the parameter.
        parameter: String,
        /// Of a field over several regions: the region.
        region: Option<String>,
        /// Its share of the variance.
        share: Number,
    }
}

/// Sources that are told.
const SAID: usize = 4;

impl FirstOrderRecord {
    /// The largest sources in words.
    #[must_use]
    pub fn sources_in_words(&self) -> String {
        let of = |own: &SourceRecord| {
            let region = own.region.as_ref().map_or_else(String::new, |region| format!(" in {region}"));
            let share = own.share.map_or(f64::NAN, |share| 100.0 * share);
            format!("{}{region} {share:.1} %", own.parameter)
        };
        let more = self.sources.len().saturating_sub(SAID);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        self.sources.iter().take(SAID).map(of).collect::<Vec<_>>().join(", ") + &more
    }
}
