//! Errors of the input.

/// Why a smoothed Hausdorff distance cannot be formed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HausdorffError {
    /// A parameter of the smoothing is not a positive, finite number.
    #[error("smoothed Hausdorff: {name} = {value} must be positive and finite")]
    Parameter {
        /// Which one: `length`, `eps`, `alpha`, `beta`, `gamma`, `tolerance`.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// A cloud without points.
    #[error("smoothed Hausdorff: the cloud has no points; is the body or target region empty?")]
    Empty,
    /// Points and weights, or a seed and its cloud, differ in number.
    #[error("smoothed Hausdorff: {found} {what} for {points} points; give one for each")]
    Length {
        /// What was counted.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many points there are.
        points: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("smoothed Hausdorff: point {index} = {point:?} is not finite; did the state solve fail?")]
    Point {
        /// Its number in the cloud.
        index: usize,
        /// Its coordinates.
        point: [f64; 3],
    },
    /// A weight is zero, negative or not finite.
    #[error(
        "smoothed Hausdorff: weight {index} = {weight} must be positive and finite; inverted cell (J <= 0), or a rule \
         with negative weights?"
    )]
    Weight {
        /// Its number in the cloud.
        index: usize,
        /// Its value.
        weight: f64,
    },
    /// A result left the range of numbers.
    #[error(
        "smoothed Hausdorff: {what} = {value} is not finite; alpha, beta or gamma are too extreme for these lengths"
    )]
    Overflow {
        /// Which quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// `value` if it is positive and finite.
pub(super) fn positive(name: &'static str, value: f64) -> Result<f64, HausdorffError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(HausdorffError::Parameter { name, value }) }
}
