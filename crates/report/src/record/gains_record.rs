//! [`GainsRecord`]: sensitivities of outputs by controls, and the law that follows from them.

use crate::record::{ByName, Number};

records! {
    /// Sensitivities S = dy/dm of outputs y by controls m at the start, the law m <- m - L (y - y*) with L = (S^T Q S + R)^-1 S^T Q, and what it does; also the content of `gains.json`.
    GainsRecord {
        /// rho of R.
        damping: Number,
        /// How S was found: `adjoints`, one linear solve for each output, or `tangents`, one for each control.
        by: String,
        /// m, in the order of the columns of S.
        controls: Vec<GainsControlRecord>,
        /// y with targets, in the order of the columns of L.
        outputs: Vec<GainsOutputRecord>,
        /// Outputs without a target, which the law does not see.
        watched: Option<Vec<GainsOutputRecord>>,
        /// L by rows, one for each control.
        gain: Vec<Vec<Number>>,
        /// Singular values of Q^1/2 S D with their directions, D the scales of the controls, the largest first.
        directions: Vec<GainsDirectionRecord>,
        /// Orthonormal combinations of the outputs Q^1/2 y that no control moves.
        unmoved: Option<Vec<Vec<Number>>>,
        /// The law on the case's own body.
        nominal: GainsLoopRecord,
        /// By scenario the law on its body.
        scenarios: Option<ByName<GainsLoopRecord>>,
        /// What deserves attention, in sentences.
        remarks: Option<Vec<String>>,
    }

    /// A control of a law.
    GainsControlRecord {
        /// Its name; of several values of one control NAME.REGION, NAME.x, NAME.0 ..
        name: String,
        /// Its unit.
        unit: String,
        /// Its value at which S is taken, and the law begins.
        value: Number,
        /// Its least value; null without one.
        lower: Number,
        /// Its largest value; null without one.
        upper: Number,
        /// d: the range between its bounds, else the largest size of its control's values, 1 where that is 0.
        scale: Number,
        /// Its entry of R, per square of its unit.
        penalty: Number,
    }

    /// An output.
    GainsOutputRecord {
        /// Its name: that of a cost, with its part; of a probe or contribution NAME.WHAT.
        name: String,
        /// Its unit.
        unit: String,
        /// Its value.
        value: Number,
        /// y*
        target: Number,
        /// Its entry of Q, per square of its unit: the weight of its cost.
        weight: Number,
        /// Its row of S.
        sensitivities: Vec<Number>,
    }

    /// A direction that controls move.
    GainsDirectionRecord {
        /// Singular value: the change of the outputs Q^1/2 y where the controls change by 1 in their scales.
        value: Number,
        /// By how much the error along it shrinks in a step of the law.
        shrinks: Number,
        /// Components of Q^1/2 y.
        outputs: Vec<Number>,
        /// Components of the controls in their scales.
        controls: Vec<Number>,
    }

    /// The law on a body.
    GainsLoopRecord {
        /// By how much the error shrinks per step near the start while no control is on a bound: the spectral radius of 1 - S L with the S of this body, on the outputs that L sees. Below 1: it converges.
        contraction: Number,
        /// The same where the loop ends.
        contraction_at_end: Number,
        /// The error sqrt(sum Q (y - y*)^2) before the first step (open loop) and behind each.
        errors: Vec<Number>,
        /// The same at the outputs of this body that are nearest to their targets by its own S, to first order: what no controls reach.
        unreachable: Number,
        /// y - y* of each output before the first step.
        open: Vec<Number>,
        /// The same behind the last.
        closed: Vec<Number>,
        /// The controls behind the last step.
        controls: Vec<Number>,
        /// How many of them are on a bound.
        on_bounds: usize,
        /// Why the loop ended early.
        failed: Option<String>,
    }
}
