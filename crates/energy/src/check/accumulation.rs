use nastic_tensor::Tangent;

use super::{Finding, Violation, Worst, evaluate, norm, states};
use crate::{EnergyTerm, MaterialPoint, PointBatch, Response, Slots, Want};

/// The term adds to what is there, gives each wanted quantity alone the same as all together, and does not touch (or
/// need) the others.
///
/// # Errors
/// A [`Violation`] at the first state where it does not.
pub fn accumulation(term: &dyn EnergyTerm, at: MaterialPoint, m: &[f64]) -> Result<Finding, Violation> {
    let mut worst = Worst::new("adds what is wanted and nothing else", 1e-14);
    for k in states() {
        let whole = evaluate(term, at, &k, m);
        let points = PointBatch { kinematics: &[k], cell: at.cell, first: at.point };
        let slots = Slots::by_point(m, m.len());
        // Start values of the size of the answer, so that an overwritten start shows and no digits are lost.
        let scale = norm(&whole.tangent) + whole.stress.norm() + whole.energy.abs();
        let (mut energy, mut stress, mut tangent) = ([scale], [k.f() * scale], [Tangent([scale; 81])]);
        let mut only = Response { energy: &mut energy, stress: &mut [], tangent: &mut [] };
        term.respond(&points, slots, Want::ENERGY, &mut only);
        let mut only = Response { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        term.respond(&points, slots, Want::STRESS, &mut only);
        let mut only = Response { energy: &mut [], stress: &mut [], tangent: &mut tangent };
        term.respond(&points, slots, Want { stress: false, ..Want::TANGENT }, &mut only);
        let bound = 1.0 + k.f().norm();
        worst.see((energy[0] - scale - whole.energy).abs(), scale * bound, k.f())?;
        worst.see((stress[0] - k.f() * scale - whole.stress).norm(), scale * bound, k.f())?;
        let error = tangent[0].0.iter().zip(&whole.tangent.0).map(|(a, b)| (a - scale - b).abs()).fold(0.0, f64::max);
        worst.see(error, scale * bound, k.f())?;
    }
    Ok(worst.finding())
}
