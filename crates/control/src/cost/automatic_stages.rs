//! Exponents of the continuation in a smoothed Hausdorff distance, from the size of the target and the spacing of the points.

/// Share of the target's size that the first stage resolves.
const COARSEST: f64 = 0.1;

/// How much shorter, about, the length that a stage resolves is than that of the stage before.
const RATIO: f64 = 4.0;

/// (beta, gamma) of the first stage, and of the last.
const FIRST: (f64, f64) = (4.0, 4.0);
const LAST: (f64, f64) = (16.0, 8.0);

/// The length that the last stage shall resolve where the points are yet to be chosen: that of the second of two stages.
pub(super) fn finest(size: f64) -> f64 {
    COARSEST * size / RATIO
}

/// Stages (alpha, beta, gamma) for a length l of phi, the diagonal d of the target's points and the coarser mean spacing h of the points of
/// body and target. Stage s of S (from 0) resolves `R_s = l/alpha_s`, in geometric progression from `R_0 = d/10` to `R_(S-1) = h`;
/// `S = 1 + round(log_4(R_0/h))`, and beta from 4 to 16, gamma from 4 to 8 are in geometric progression too. Where `R_0 < 2 h` there is one
/// stage, of the last one's exponents. Single points (h = 0) count as `h = R_0/4`.
pub(super) fn exponents(l: f64, d: f64, h: f64) -> Vec<(f64, f64, f64)> {
    let coarsest = COARSEST * d;
    // Slightly above: rounding shall not put the resolved length below the spacing.
    let finest = if h > 0.0 { h * (1.0 + 1e-9) } else { coarsest / RATIO };
    let steps = ((coarsest / finest).ln() / RATIO.ln()).round().max(0.0);
    let stage = |s: usize| {
        let t = if steps > 0.0 { s as f64 / steps } else { 1.0 };
        let between = |first: f64, last: f64| if t == 1.0 { last } else { first * (last / first).powf(t) };
        (l / between(coarsest, finest), between(FIRST.0, LAST.0), between(FIRST.1, LAST.1))
    };
    (0..=steps as usize).map(stage).collect()
}
