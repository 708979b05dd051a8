//! [`RigidMotion`]: how a rigid body moved.

use crate::number::short;
use crate::record::{ContributionKind, ContributionRecord, number_of};

/// Radians that count as zero, and the share of a vector below which a component does.
const ROUNDING: f64 = 1e-9;

/// How a rigid body moved, in space or in the plane, where the components outside of it are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Of the centre of its volume.
    pub translation: [f64; 3],
    /// The rotation vector: radians about its direction.
    pub rotation: [f64; 3],
}

impl RigidMotion {
    /// Of a contribution; `None` where it is no rigid body.
    #[must_use]
    pub fn of(record: &ContributionRecord) -> Option<Self> {
        let of = |what: &str, axis: &str| number_of(record, &format!("{what}_{axis}")).unwrap_or_default();
        let vector = |what: &str| ["x", "y", "z"].map(|axis| of(what, axis));
        let motion = || Self { translation: vector("translation"), rotation: vector("rotation") };
        (record.kind == ContributionKind::RigidBody).then(motion)
    }

    /// The length of a vector.
    #[must_use]
    pub fn size(v: &[f64; 3]) -> f64 {
        v.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// In words, translations in a unit of length.
    #[must_use]
    pub fn words(&self, unit: &str) -> String {
        let shown = |v: [f64; 3]| {
            let least = ROUNDING * Self::size(&v);
            format!("({})", v.map(|x| short(if x.abs() < least { 0.0 } else { x })).join(", "))
        };
        let (moves, angle) = (format!("moves by {} {unit}", shown(self.translation)), Self::size(&self.rotation));
        if angle < ROUNDING {
            return moves + ", does not turn";
        }
        let (degrees, axis) = (short(angle.to_degrees()), shown(self.rotation.map(|x| x / angle)));
        format!("{moves}, turns by {} rad = {degrees} degrees about {axis}", short(angle))
    }
}
