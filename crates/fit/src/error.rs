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
    /// A number of a test that it cannot be used with.
    #[error("test \"{test}\": {what} = {value}, but {requirement}")]
    Setting {
        /// Name of the test.
        test: String,
        /// What it is.
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
    /// A test that no specimen with fibres is used for.
    #[error("test \"{test}\": a test of kind {mode} takes no \"fibers\": {why}")]
    Fibers {
        /// Name of the test.
        test: String,
        /// The mode.
        mode: &'static str,
        /// Why not.
        why: &'static str,
    },
    /// A law with fibres, and a test that does not say how they lay.
    #[error(
        "{law} has fibres, and test \"{test}\" does not say how its specimen lay to them: \"along\" or \"across\" (\"fibers\"; a balloon has neither)"
    )]
    NoFibers {
        /// The law.
        law: String,
        /// Name of the test.
        test: String,
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
    /// A test all of whose responses oppose the deformation.
    #[error(
        "test \"{test}\": all of its {points} stresses have the wrong sign: they are positive in tension and negative in compression \
         (stretches below 1), pressures of a balloon and shear stresses as the deformation"
    )]
    WrongSign {
        /// Name of the test.
        test: String,
        /// Number of its points with a stress.
        points: usize,
    },
    /// Some responses oppose the deformation, and they outweigh the others.
    #[error(
        "the shear modulus of least squares over all tests is {shear:.4e} Pa, which must be positive: many stresses have the wrong sign (they are \
         positive in tension, negative in compression); correct them or leave them out"
    )]
    NegativeShear {
        /// Of the neo-Hookean law, Pa.
        shear: f64,
    },
    /// A test without responses, and residuals that are shares of them.
    #[error(
        "test \"{test}\": all stresses are zero, and errors relative to zero have no meaning: leave the test out, or take absolute errors"
    )]
    ZeroTest {
        /// Name of the test.
        test: String,
    },
    /// A name that no law that can be fitted has.
    #[error("no law {found} can be fitted (one of: {known})")]
    Unknown {
        /// The name.
        found: String,
        /// Those that can.
        known: String,
    },
    /// Another number of parameters than the law has.
    #[error("{law} has {expected} parameters, but {found} were given")]
    Parameters {
        /// The law.
        law: String,
        /// How many it has.
        expected: usize,
        /// How many were given.
        found: usize,
    },
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
    /// Every start that led anywhere ran out of evaluations before it converged.
    #[error(
        "{law}: {exhausted} of {starts} starts ran out of evaluations, and none converged: the data may not determine its parameters; take a law with \
         fewer, or measure more"
    )]
    Exhausted {
        /// The law.
        law: String,
        /// Number of starts.
        starts: usize,
        /// How many ran out of evaluations.
        exhausted: usize,
    },
    /// A bulk modulus that leaves nothing for the volumetric part of a law.
    #[error(
        "{law}: the bulk modulus {bulk:.4e} Pa is below what its other parameters give already, {least:.4e} Pa: give a larger one, or take another law"
    )]
    SmallBulk {
        /// The law.
        law: String,
        /// The bulk modulus, Pa.
        bulk: f64,
        /// The least one, Pa.
        least: f64,
    },
    /// Volumetric data that decide nothing, or against any bulk modulus.
    #[error("volumetric data: {0}")]
    Volume(String),
    /// Parameters that the law refuses.
    #[error(transparent)]
    Energy(#[from] EnergyError),
}
