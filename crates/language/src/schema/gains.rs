//! The block `gains`.

object! {
    /// The law of `nastic gains`, by which measured outputs change the controls.
    pub struct Gains {
        /// rho of the weight R = rho sigma_1^2 / d^2 of the change of a control in a step, d its scale, sigma_1 the largest singular value: 0 for steps to the targets, larger for smaller steps.
        pub damping: f64 as NOT_NEGATIVE = 1e-3,
        /// Steps of the loops that are tried on the case and its scenarios.
        pub steps: usize as POSITIVE = 10,
    }
}
