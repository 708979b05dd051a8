use nastic_tensor::Kinematics;

use super::{Finding, Violation, Worst, evaluate, norm};
use crate::{EnergyTerm, MaterialPoint};

/// The rest state has neither energy nor stress: `W(I) = 0`, `P(I) = 0`.
///
/// # Errors
/// A [`Violation`] otherwise.
pub fn rest(law: &dyn EnergyTerm, at: MaterialPoint) -> Result<Finding, Violation> {
    let mut worst = Worst::new("the rest state has no energy and no stress", 1e-14);
    let k = Kinematics::rest();
    let here = evaluate(law, at, &k, &[]);
    worst.see(here.energy.abs(), norm(&here.tangent), k.f())?;
    worst.see(here.stress.norm(), norm(&here.tangent), k.f())?;
    Ok(worst.finding())
}

/// `dP/dF` at rest is the elasticity tensor of the moduli the law states; `None` where it states none.
///
/// # Errors
/// A [`Violation`] when it is not.
pub fn moduli(law: &dyn EnergyTerm, at: MaterialPoint) -> Result<Option<Finding>, Violation> {
    let Some(moduli) = law.moduli(at) else { return Ok(None) };
    let mut worst = Worst::new("dP/dF at rest has the stated moduli", 1e-13);
    let k = Kinematics::rest();
    let tangent = evaluate(law, at, &k, &[]).tangent;
    let stated = moduli.elasticity();
    let error = tangent.0.iter().zip(&stated.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    worst.see(error, norm(&stated), k.f())?;
    Ok(Some(worst.finding()))
}
