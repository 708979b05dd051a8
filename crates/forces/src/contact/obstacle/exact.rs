//! A contact whose layer takes up no gap: multipliers around the cubic law.
//!
//! With an offset `o_s` at every sample the pressure is `p(g_s + o_s)`, g the signed distance. At an equilibrium the offsets become
//!
//! ```text
//! o_s <- min(g_s + o_s, delta)
//! ```
//!
//! At the next equilibrium a sample with the same pressure has no gap, and one without pressure is pushed as soon as it enters the obstacle: a
//! fixed point fulfils `g >= 0, p >= 0, g p = 0`, whatever thickness and stiffness are. These decide how fast it is reached: the p are the
//! multipliers of an augmented Lagrangian (Rockafellar, Math. Programming 5 (1973)).

use super::ObstacleContact;
use super::gaps::Gaps;
use crate::contact::ContactLaw;
use nastic_body::contribution::touches::ExactContact;
use nastic_body::instant::Instant;
use std::sync::Arc;

/// Share of the largest pressure below which a pressure counts as zero.
const WEAK_PRESSURE_SHARE: f64 = 1e-3;

/// The contact with offsets by a state, and how far that is from exact; `None` where the law or friction does not go with it.
pub(super) fn step(of: &ObstacleContact, at: &Instant) -> Option<ExactContact> {
    if of.layer.law != ContactLaw::Cubic || of.layer.slip_speed.is_some() {
        return None;
    }
    let gaps = Gaps::at(of, at, true).ok()?;
    let pressures: Vec<f64> = gaps
        .all
        .iter()
        .map(|(_, (_, d))| of.layer.law.at(d.min(of.layer.thickness), of.layer.thickness).value)
        .collect();
    let weak = WEAK_PRESSURE_SHARE * pressures.iter().copied().fold(0.0, f64::max);
    let (mut violation, mut weakly_active) = (0.0_f64, 0);
    for (&(sample, (_, d)), &p) in gaps.all.iter().zip(&pressures) {
        let gap = d - of.with.offset(sample);
        // what is pressed has no gap, what is not pressed is not inside
        violation = violation.max(if p > 0.0 { gap.abs() } else { -gap });
        weakly_active += usize::from(p <= weak && gap.abs() <= WEAK_PRESSURE_SHARE * of.layer.thickness);
    }
    let offsets = gaps.all.iter().map(|(_, (_, d))| d.min(of.layer.thickness) - of.with.inset).collect();
    let mut contribution = of.clone();
    contribution.with.offsets = offsets;
    Some(ExactContact {
        contribution: Arc::new(contribution),
        violation: violation / of.layer.thickness,
        weakly_active,
    })
}
