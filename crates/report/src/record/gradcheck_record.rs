//! [`GradcheckRecord`]: Taylor tests of the derivative and the second derivative.

use crate::record::{Nullable, Number};

records! {
    /// What `gradcheck` found.
    GradcheckRecord {
        /// Whether no derivative is wrong.
        passed: bool,
        /// In words.
        verdict: String,
        /// The lowest order of a remainder that could be judged; 2 is right.
        lowest_order: Number,
        /// The same of the second derivative, whose order is 3.
        second: SecondGradcheckRecord,
        /// Samples of contacts within 1 % of where they begin to touch or to slip at the start, over all instants: second derivatives jump there.
        near_onset: usize,
        /// By control and term.
        tests: Vec<TermCheckRecord>,
    }

    /// What was found of the second derivative.
    SecondGradcheckRecord {
        /// Whether none is wrong.
        passed: bool,
        /// In words.
        verdict: String,
        /// The lowest order.
        lowest_order: Number,
    }

    /// The Taylor test of one control and one part of the cost.
    TermCheckRecord {
        /// The control.
        control: String,
        /// `total`, a term, each with its stage where there are several, or `constraint NAME`.
        term: String,
        /// `right`, `WRONG`, `linear`, `quadratic`, `kink` or `undecided`.
        verdict: String,
        /// The same of the second derivative.
        second: Nullable<String>,
        /// Whether remainders that it is judged by lead over such an onset, and are not those of a smooth function: it is not decided then.
        kink: bool,
        /// Every direction.
        directions: Vec<DirectionRecord>,
    }

    /// One direction d.
    DirectionRecord {
        /// dj.d.
        slope: Number,
        /// The same by differences.
        observed: Number,
        /// Noise of the cost.
        noise: Number,
        /// Order of |j(m + t d) - j(m)|.
        order0: Number,
        /// Order of |j(m + t d) - j(m) - t dj.d|.
        order1: Number,
        /// What follows.
        verdict: String,
        /// Step by step.
        rows: Vec<RemainderRecord>,
        /// The second derivative along it.
        second: Nullable<SecondDirectionRecord>,
    }

    /// Remainders of one step.
    RemainderRecord {
        /// The step.
        t: Number,
        /// |j(m + t d) - j(m)|.
        r0: Number,
        /// |j(m + t d) - j(m) - t dj.d|.
        r1: Number,
        /// Whether the order is fitted to it.
        used: bool,
        /// Samples of contacts that touch, part, stick or slip other than at the start, over all instants.
        changed: usize,
    }

    /// The second derivative along a direction.
    SecondDirectionRecord {
        /// d.Hd.
        curvature: Number,
        /// Remainders of third order, step by step.
        r2: Vec<Number>,
        /// Which of them the order is fitted to.
        used: Vec<usize>,
        /// Their order.
        order: Number,
        /// What follows.
        verdict: String,
    }
}
