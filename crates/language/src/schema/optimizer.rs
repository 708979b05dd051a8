//! The block `optimizer`.

use crate::schema::named::Method;
use crate::schema::read::Reader;

object! {
    /// How the cost is made small.
    pub struct Optimizer checked by check {
        /// The method.
        pub method: Method = Method::default(),
        /// Iterations after which it stops unconverged.
        pub max_iterations: usize = 100,
        /// It stops when the projected gradient's norm has fallen to this part of its first value.
        pub tolerance: f64 as POSITIVE = 1e-4,
        /// The same of the stages before the last, where `tolerance` is smaller.
        pub stage_tolerance: f64 as POSITIVE = 1e-2,
        /// It stops as well when that norm is no larger than this (`gradient_norm` of `result.json` is the norm at which a run ended).
        pub absolute_tolerance: f64 as NOT_NEGATIVE = 0.0,
        /// Of "mma": the largest change of a control in an iteration, as a share of the range between its bounds; 0.2 if left out.
        pub move_limit: Option<f64> as POSITIVE,
        /// Of "mma": the distance of the asymptotes in the first two iterations of a stage, as a share of the range; 0.5 if left out.
        pub asymptote_distance: Option<f64> as POSITIVE,
        /// The inner product of controls.
        pub metric: Metric = Metric::L2,
        /// What becomes of trials whose equilibrium is unstable.
        pub unstable: Unstable = Unstable::Accept,
        /// Whether the optimum is solved again from rest: a warning says whether that ends in another state.
        pub verify: bool = false,
        /// Number of starts; those after the first are random.
        pub starts: usize as POSITIVE = 1,
        /// Whether starts that cannot reach the best one any more are stopped.
        pub early_stopping: bool = true,
        /// Seed of whatever is random.
        pub seed: u64 = 0,
    }
}

/// The method of moving asymptotes.
pub(crate) const MMA: &str = "mma";
/// A record of each start is kept in memory.
pub(crate) const MOST_STARTS: usize = 10_000;

fn check(block: &Optimizer, reader: &mut Reader<'_>) {
    let of_asymptotes = [("move_limit", block.move_limit), ("asymptote_distance", block.asymptote_distance)];
    for (key, _) in of_asymptotes.iter().filter(|(_, value)| value.is_some() && block.method.name() != MMA) {
        let message = format!("\"{}\" has no asymptotes: leave this out, or take \"{MMA}\"", block.method.name());
        reader.complain_at(&block.at.key(key), message);
    }
    if block.starts > MOST_STARTS {
        let message = format!("{} starts; at most {MOST_STARTS}", block.starts);
        reader.complain_at(&block.at.key("starts"), message);
    }
}

choice! {
    /// What becomes of unstable trials.
    pub enum Unstable {
        /// They are taken like others; a warning says whether the optimum is one.
        "accept" => Accept,
        /// They fail, so that the optimiser shortens its step; one factorisation more per trial.
        "refuse" => Refuse,
    }
}

choice! {
    /// Inner products of controls.
    pub enum Metric {
        /// int m n
        "l2" => L2,
        /// int m n + length^2 int grad m . grad n
        "h1" => H1(f64) as POSITIVE_LENGTH,
    }
}
