//! Exponents of the continuation in a smoothed Hausdorff distance, from the size of the target and the spacing of the points.

/// Length that the first stage resolves, as a share of the target's size.
const FIRST_LENGTH_RATIO: f64 = 0.1;

/// Approximate ratio of the length that a stage resolves to the length of the next one.
const STAGE_RATIO: f64 = 4.0;

/// beta of the first stage.
const FIRST_BETA: f64 = 4.0;
/// gamma of the first stage.
const FIRST_GAMMA: f64 = 4.0;
/// beta of the last stage.
const LAST_BETA: f64 = 16.0;
/// gamma of the last stage.
const LAST_GAMMA: f64 = 8.0;

/// The length that the last stage shall resolve where the points are yet to be chosen: that of the second of two stages.
pub(super) fn finest(size: f64) -> f64 {
    FIRST_LENGTH_RATIO * size / STAGE_RATIO
}

/// Stages (alpha, beta, gamma) for a length l of phi, the diagonal d of the target's points and the coarser mean spacing h of the points of
/// body and target. Stage s of S (from 0) resolves `R_s = l/alpha_s`, in geometric progression from `R_0 = d/10` to `R_(S-1) = h`;
/// `S = 1 + round(log_4(R_0/h))`, and beta from 4 to 16, gamma from 4 to 8 are in geometric progression too. Where `R_0 < 2 h` there is one
/// stage, of the last one's exponents. Single points (h = 0) count as `h = R_0/4`.
pub(super) fn exponents(l: f64, d: f64, h: f64) -> Vec<(f64, f64, f64)> {
    let coarsest = FIRST_LENGTH_RATIO * d;
    // Slightly above: rounding shall not put the resolved length below the spacing.
    let finest = if h > 0.0 { h * (1.0 + 1e-9) } else { coarsest / STAGE_RATIO };
    let steps = ((coarsest / finest).ln() / STAGE_RATIO.ln()).round().max(0.0);
    let stage = |s: usize| {
        let t = if steps > 0.0 { s as f64 / steps } else { 1.0 };
        let between = |first: f64, last: f64| if t == 1.0 { last } else { first * (last / first).powf(t) };
        (l / between(coarsest, finest), between(FIRST_BETA, LAST_BETA), between(FIRST_GAMMA, LAST_GAMMA))
    };
    (0..=steps as usize).map(stage).collect()
}
