use crate::{Mat3, cofactor};

/// Deformation gradient `F`, cofactor `H = cof F` and Jacobian `J = det F` of one point, with `J > 0` proved.
///
/// The only way in is [`Kinematics::new`], so no law ever meets an inverted or undefined point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    f: Mat3,
    h: Mat3,
    j: f64,
}

/// A deformation gradient whose Jacobian is not a positive finite number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("inverted deformation: J = {jacobian:e}, which must be positive and finite; take a smaller step")]
pub struct Inverted {
    /// The Jacobian found (zero, negative, infinite or NaN).
    pub jacobian: f64,
}

impl Kinematics {
    /// Kinematics of `F = I + grad u`.
    ///
    /// # Errors
    /// [`Inverted`] unless `0 < det F < inf`; an entry that is infinite or NaN is refused the same way.
    #[inline]
    pub fn new(f: Mat3) -> Result<Self, Inverted> {
        let h = cofactor(&f);
        let j = f[(0, 0)] * h[(0, 0)] + f[(0, 1)] * h[(0, 1)] + f[(0, 2)] * h[(0, 2)];
        if j > 0.0 && j < f64::INFINITY { Ok(Self { f, h, j }) } else { Err(Inverted { jacobian: j }) }
    }

    /// The undeformed state, `F = H = I`, `J = 1`.
    pub fn rest() -> Self {
        Self { f: Mat3::identity(), h: Mat3::identity(), j: 1.0 }
    }

    /// Deformation gradient `F`.
    #[inline]
    pub fn f(&self) -> &Mat3 {
        &self.f
    }

    /// Cofactor `H = cof F = J F^-T`.
    #[inline]
    pub fn h(&self) -> &Mat3 {
        &self.h
    }

    /// Jacobian `J = det F`.
    #[inline]
    pub fn j(&self) -> f64 {
        self.j
    }
}
