use nastic_energy::EnergyError;

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A measured point that no deformation has.
    #[error("test \"{test}\", point {point}: {what} = {value}, but {requirement}")]
    Point {
        /// Name of the test.
        test: String,
        /// Index of the point, from 0.
        point: usize,
        /// What was measured.
        what: &'static str,
        /// The value found.
        value: f64,
        /// What it has to satisfy.
        requirement: &'static str,
    },
    /// A response that the mode does not have.
    #[error("test \"{test}\": a test of kind {mode} gives {expected}, not {found}")]
    Response {
        /// Name of the test.
        test: String,
        /// The mode.
        mode: &'static str,
        /// What it gives.
        expected: &'static str,
        /// What was said to be measured.
        found: &'static str,
    },
    /// Fewer points than a law has parameters, and one more for the scatter.
    #[error(
        "{law} has {parameters} parameters, and there are {points} points with a stress: measure more, or take a law with fewer parameters"
    )]
    TooFew {
        /// The law.
        law: String,
        /// Its number of parameters.
        parameters: usize,
        /// Number of points.
        points: usize,
    },
    /// All stresses are zero.
    #[error("no test of shape has a stress other than zero: there is nothing to fit")]
    NoStress,
    /// No start led anywhere.
    #[error(
        "{law}: none of {starts} starts converged; the last said: {why}; leave out points that look wrong, or take another law"
    )]
    NotConverged {
        /// The law.
        law: String,
        /// Number of starts.
        starts: usize,
        /// Why the last one ended.
        why: String,
    },
    /// Volumetric data that decide nothing, or against any bulk modulus.
    #[error("volumetric data: {0}")]
    Volume(String),
    /// Parameters that the law refuses.
    #[error(transparent)]
    Energy(#[from] EnergyError),
}
