//! [`Scale`]: functions of a number by which laws are scaled.

use crate::{EnergyError, Entry, Slot};
use nastic_tensor::{HyperDual, Scalar};

/// How a law is scaled by s: densities of topology optimisation, and fillers of an elastomer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// `chi(s) = e + (1 - e) s^p`, 0 <= s <= 1. Source: M. P. Bendsoe, Struct. Optim. 1 (1989) 193-202, doi 10.1007/BF01650949.
    Simp {
        /// e, the share of the stiffness that a void keeps, > 0.
        floor: f64,
        /// p, 1 or at least 2.
        exponent: f64,
    },
    /// `chi(s) = e + (1 - e) s/(1 + p (1 - s))`, whose slope at 0 is not zero. Source: M. Stolpe & K. Svanberg, Struct. Multidiscip. Optim. 22 (2001) 116-124, doi
    /// 10.1007/s001580100129.
    Ramp {
        /// e, the share of the stiffness that a void keeps, > 0.
        floor: f64,
        /// p >= 0.
        penalty: f64,
    },
    /// `exp(2.5 phi/(1 - 1.35 phi))` of a volume share phi of rigid particles. Source: M. Mooney, J. Colloid Sci. 6 (1951) 162-170, doi 10.1016/0095-8522(51)90036-0.
    Mooney,
    /// `1 + 2.5 phi + 14.1 phi^2`. Source: E. Guth, J. Appl. Phys. 16 (1945) 20-25, doi 10.1063/1.1707495.
    Guth,
    /// `1/(1 - 2.5 phi)`, phi < 0.4, of rigid spheres in what keeps its volume. Source: R. Hill, J. Mech. Phys. Solids 13 (1965) 213-222, doi
    /// 10.1016/0022-5096(65)90010-4.
    Hill,
    /// `s`, 0 <= s <= 1: of an actuation, which acts where s is 1 alone. A law that holds the body has no stiffness at 0.
    Factor,
    /// `s^2`, 0 <= s <= 1: of a [dielectric](crate::Dielectric), whose field is then `s E`, where electrodes cover the share s of a film. Fringes, about as wide as
    /// the film is thick, are left out.
    Electrode,
}

/// Shares of a filler below which chi is finite.
const MAX_MOONEY: f64 = 1.0 / 1.35;
const MAX_HILL: f64 = 0.4;

impl Scale {
    /// Name in messages.
    pub const fn name(&self) -> &'static str {
        match self {
            Scale::Simp { .. } => "simp",
            Scale::Ramp { .. } => "ramp",
            Scale::Mooney => "mooney",
            Scale::Guth => "guth",
            Scale::Hill => "hill",
            Scale::Factor => "factor",
            Scale::Electrode => "electrode",
        }
    }

    /// chi, in numbers that carry their derivatives.
    fn value(&self, s: HyperDual) -> HyperDual {
        let number = HyperDual::constant;
        let one = number(1.0);
        let above = |floor: f64, share: HyperDual| number(floor) + share * number(1.0 - floor);
        match *self {
            Scale::Simp { floor, exponent } => above(floor, power(s, exponent)),
            Scale::Ramp { floor, penalty } => above(floor, s / (one + (one - s) * number(penalty))),
            Scale::Mooney => (s * number(2.5) / (one - s * number(1.35))).exp(),
            Scale::Guth => one + s * number(2.5) + s * s * number(14.1),
            Scale::Hill => one / (one - s * number(2.5)),
            Scale::Factor => s,
            Scale::Electrode => s * s,
        }
    }

    /// `chi, chi', chi''` at s.
    pub fn derivatives(&self, s: f64) -> [f64; 3] {
        let HyperDual([value, first, _, second]) = self.value(HyperDual([s, 1.0, 1.0, 0.0]));
        [value, first, second]
    }

    /// The closed range of s; that of Mooney's and of Hill's filler ends where chi is infinite.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Scale::Simp { .. } | Scale::Ramp { .. } => [0.0, 1.0],
            Scale::Guth | Scale::Factor | Scale::Electrode => [0.0, 1.0],
            Scale::Mooney => [0.0, MAX_MOONEY],
            Scale::Hill => [0.0, MAX_HILL],
        }
    }

    /// Whether chi and its derivatives are defined at s, and chi is positive.
    pub fn is_defined(&self, s: f64) -> bool {
        let [least, most] = self.range();
        (least..=most).contains(&s) && self.derivatives(s).iter().all(|chi| chi.is_finite())
    }

    pub(super) fn check(&self) -> Result<(), EnergyError> {
        let owner = self.name();
        let refuse = |name, value: f64, requirement| {
            Err(EnergyError::Parameter { owner, name, value, entry: Entry::Uniform, requirement })
        };
        let positive = |floor: f64| floor > 0.0 && floor < 1.0;
        match *self {
            Scale::Simp { floor, .. } | Scale::Ramp { floor, .. } if !positive(floor) => {
                refuse("floor", floor, "it must lie between 0 and 1: a void of no stiffness has no equilibrium")
            }
            Scale::Simp { exponent, .. } if !(exponent.is_finite() && (exponent == 1.0 || exponent >= 2.0)) => {
                refuse("exponent", exponent, "it must be 1 or at least 2: others have no second derivative at 0")
            }
            Scale::Ramp { penalty, .. } if !(penalty.is_finite() && penalty >= 0.0) => {
                refuse("penalty", penalty, "it must be at least 0")
            }
            _ => Ok(()),
        }
    }

    /// Whether a law behind it vanishes at 0.
    pub(super) fn vanishes(&self) -> bool {
        matches!(self, Scale::Factor | Scale::Electrode)
    }

    /// The slot of s; a density, a factor and an electrode are 1 at rest, a filler absent.
    pub(super) fn slot(&self) -> Slot {
        match self {
            Scale::Simp { .. } | Scale::Ramp { .. } => Slot::design("density", "1", 1.0),
            Scale::Mooney | Scale::Guth | Scale::Hill => Slot::design("filler", "1", 0.0),
            Scale::Factor => Slot::design("factor", "1", 1.0),
            Scale::Electrode => Slot::design("electrode", "1", 1.0),
        }
    }
}

/// `s^p` with its derivatives at s = 0 too.
fn power(s: HyperDual, p: f64) -> HyperDual {
    let x = s.real();
    let derivative = |factor: f64, p: f64| if factor == 0.0 { 0.0 } else { factor * x.powf(p) };
    s.chain([x.powf(p), derivative(p, p - 1.0), derivative(p * (p - 1.0), p - 2.0)])
}
