use std::fmt::Debug;
use std::sync::Arc;

use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

use crate::{
    EnergyError, Evolution, Existence, MaterialPoint, Moduli, Outside, PointQuantity, Slot, StrainMap, TensionBound,
};

/// The quadrature points of one cell: their kinematics, and who they are.
#[derive(Clone, Copy, Debug)]
pub struct PointBatch<'a> {
    /// `F`, `H`, `J` per point.
    pub kinematics: &'a [Kinematics],
    /// The mesh cell.
    pub cell: usize,
    /// Global number of the cell's first quadrature point; the others follow it.
    pub first: usize,
}

impl PointBatch<'_> {
    /// Number of points.
    #[inline]
    pub fn len(&self) -> usize {
        self.kinematics.len()
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.kinematics.is_empty()
    }

    /// The `q`-th point by itself.
    #[inline]
    pub fn only(&self, q: usize) -> PointBatch<'_> {
        PointBatch { kinematics: &self.kinematics[q..=q], cell: self.cell, first: self.first + q }
    }

    /// The place of the `q`-th point, for fields.
    #[inline]
    pub fn place(&self, q: usize) -> MaterialPoint {
        MaterialPoint { cell: self.cell, point: self.first + q }
    }
}

/// What the slots of a law hold at the points of one cell.
#[derive(Clone, Copy, Debug)]
pub struct Slots<'a> {
    /// Slot `k` at point `q` is `values[q * width + k]`, of [global scope](crate::Scope) `values[k]` at every point; in the slot's unit.
    pub values: &'a [f64],
    /// Number of slots.
    pub width: usize,
    /// Whether all points have the same.
    pub shared: bool,
}

impl<'a> Slots<'a> {
    /// What a law without slots gets.
    pub const fn none() -> Self {
        Slots { values: &[], width: 0, shared: false }
    }

    /// So many values for each point.
    pub const fn by_point(values: &'a [f64], width: usize) -> Self {
        Slots { values, width, shared: false }
    }

    /// The same values for all points.
    pub const fn shared(values: &'a [f64]) -> Self {
        Slots { values, width: values.len(), shared: true }
    }

    /// How many values there are for so many points.
    #[inline]
    pub fn count(&self, points: usize) -> usize {
        if self.shared { self.width } else { self.width * points }
    }

    /// The slots of the `q`-th point alone.
    #[inline]
    pub fn only(&self, q: usize) -> Slots<'a> {
        if self.shared { *self } else { Slots { values: &self.values[q * self.width..(q + 1) * self.width], ..*self } }
    }

    /// Slot `k` at the `q`-th point; zero where nothing gives a value.
    #[inline]
    pub fn get(&self, q: usize, k: usize) -> f64 {
        match (self.width, self.shared) {
            (0, _) => 0.0,
            (_, true) => self.values[k],
            (width, false) => self.values[q * width + k],
        }
    }
}

/// What a caller wants of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Want {
    /// Energy density, J/m^3.
    pub energy: bool,
    /// First Piola-Kirchhoff stress `P`, Pa.
    pub stress: bool,
    /// Elasticity tensor `dP/dF`, Pa.
    pub tangent: bool,
}

impl Want {
    /// The energy alone, for line searches.
    pub const ENERGY: Want = Want { energy: true, stress: false, tangent: false };
    /// The stress alone.
    pub const STRESS: Want = Want { energy: false, stress: true, tangent: false };
    /// Stress and tangent, for Newton steps.
    pub const TANGENT: Want = Want { energy: false, stress: true, tangent: true };
    /// Everything.
    pub const ALL: Want = Want { energy: true, stress: true, tangent: true };
}

/// Where terms **add** what is wanted: one entry per point. A slice that is not wanted may be empty.
#[derive(Debug)]
pub struct Response<'a> {
    /// Energy density, J/m^3.
    pub energy: &'a mut [f64],
    /// First Piola-Kirchhoff stress `P`, Pa.
    pub stress: &'a mut [Mat3],
    /// Elasticity tensor `dP/dF`, Pa.
    pub tangent: &'a mut [Tangent],
}

/// A contribution `W(F; m)` to the energy density of a body: a material, an actuation, a viscous law. What m is to the body, its [`Slot`]s say.
///
/// Everything anyone may ask of a law is asked here, and nothing else in the workspace differentiates one. Laws that
/// are a function of `(F, H, J)` implement [`ConvexDensity`](crate::ConvexDensity) instead and get this for free.
pub trait EnergyTerm: Debug + Send + Sync {
    /// Adds energy, `P` and `dP/dF`, as wanted, at all points of one cell.
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response);

    /// Adds the change of stress `dP/dF : G` (Pa) for a change `G` of `F` at every point of one cell: all that a product with
    /// the tangent matrix asks of a law. Derived from [`respond`](Self::respond); a law with a less expensive way implements it here.
    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        let want = Want { energy: false, stress: false, tangent: true };
        for (q, (change, out)) in change.iter().zip(out).enumerate() {
            let mut tangent = [Tangent::zero()];
            let mut response = Response { energy: &mut [], stress: &mut [], tangent: &mut tangent };
            self.respond(&at.only(q), m.only(q), want, &mut response);
            *out += tangent[0].apply(change);
        }
    }

    /// Adds the second derivative of the stress along two changes `A`, `B` of `F` at every point of one cell, `d2P/dF2 : (A, B)`
    /// (Pa): the third derivative of the energy, symmetric in `A` and `B`. Second derivatives of a cost ask for it.
    ///
    /// # Errors
    /// [`EnergyError::NoSecondDerivatives`] where the law does not implement it, the same at every point.
    fn second_stress_change(
        &self,
        _at: &PointBatch,
        _m: Slots,
        _changes: [&[Mat3]; 2],
        _out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        Err(EnergyError::no_second_derivatives::<Self>("EnergyTerm::second_stress_change"))
    }

    /// Whether the energy is finite at all points of one cell. A law with a limit of its own, such as the limiting stretch of
    /// [`Gent`](crate::Gent), refuses what lies beyond it, as [`Kinematics`] refuses `J <= 0`; nothing else may be asked of it there.
    ///
    /// # Errors
    /// [`Outside`] with the first point.
    fn check_domain(&self, _at: &PointBatch, _m: Slots) -> Result<(), Outside> {
        Ok(())
    }

    /// What the law states of the conditions for the existence of minimisers; `None` where it makes no statement.
    fn existence(&self, _at: MaterialPoint) -> Option<Existence> {
        None
    }

    /// The fibre tensions with which this law stays polyconvex. `None` where the law makes no statement.
    fn fiber_bound(&self, _at: MaterialPoint) -> Option<TensionBound> {
        None
    }

    /// Largest fibre tension `m` (Pa) along the unit vector `a` alone for which this law with `-(m/2) |F a|^2` added stays
    /// polyconvex: that of its [`fiber_bound`](Self::fiber_bound).
    fn fiber_limit(&self, at: MaterialPoint, a: &Vec3) -> Option<f64> {
        self.fiber_bound(at).map(|bound| bound.along(a))
    }

    /// Checks that the parameter fields fit a mesh of so many cells and quadrature points.
    ///
    /// # Errors
    /// [`EnergyError::Length`] names the field.
    fn check(&self, _cells: usize, _points: usize) -> Result<(), EnergyError> {
        Ok(())
    }

    /// The fibre, to be written back out.
    fn direction(&self, _at: MaterialPoint) -> Option<Vec3> {
        None
    }

    /// Small-strain moduli at the rest state, where they are known in closed form.
    fn moduli(&self, _at: MaterialPoint) -> Option<Moduli> {
        None
    }

    /// Its numbers beside F, in the order of [`Slots::values`]: controls, numbers of the law, internal variables, as their [roles](crate::Role) say.
    fn slots(&self) -> &[Slot];

    /// The derivative of the stress by the slots at every point: sets `out[q * width + k] = dP/dm_k` (Pa per unit of slot `k`).
    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]);

    /// Adds the derivative of `sum_q P_q : with_q` by the slots, `out[q * width + k] += dP/dm_k : with_q`, of global scope the sum over the points into
    /// `out[k]`: what an adjoint asks for. Derived from [`stress_by_control`](Self::stress_by_control); a law with many slots has a less expensive way.
    fn slots_vjp(&self, at: &PointBatch, m: Slots, with: &[Mat3], out: &mut [f64]) {
        let mut by_control = vec![Mat3::zeros(); at.len() * m.width];
        self.stress_by_control(at, m, &mut by_control);
        for (q, (by_control, with)) in by_control.chunks_exact(m.width).zip(with).enumerate() {
            let first = if m.shared { 0 } else { q * m.width };
            out[first..].iter_mut().zip(by_control).for_each(|(out, stress)| *out += stress.dot(with));
        }
    }

    /// The change of the control derivative along a change `A` of `F` and `v` of the controls at every point: sets
    /// `out[q * width + k] = d2P/dm_k dF : A + sum_l d2P/dm_k dm_l v_l` (Pa per unit of slot `k`). Second derivatives of a cost
    /// ask for it.
    ///
    /// # Errors
    /// [`EnergyError::NoSecondDerivatives`] where the law does not implement it, the same at every point.
    fn control_stress_change(
        &self,
        _at: &PointBatch,
        _m: Slots,
        _change: &[Mat3],
        _v: Slots,
        _out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        Err(EnergyError::no_second_derivatives::<Self>("EnergyTerm::control_stress_change"))
    }

    /// The value of a slot at rest.
    fn rest(&self, _at: MaterialPoint, slot: usize) -> f64 {
        self.slots()[slot].rest()
    }

    /// Whether it is a body's material: one without slots, or with numbers of its own as slots.
    fn is_material(&self) -> bool {
        self.slots().iter().all(Slot::is_design)
    }

    /// The number at every point that the law has to be judged by, if there is one.
    fn point_quantity(&self) -> Option<PointQuantity> {
        None
    }

    /// Sets the value of its [`point_quantity`](Self::point_quantity) at every point of one cell; nothing without one.
    fn point_values(&self, _at: &PointBatch, _m: Slots, _out: &mut [f64]) {}

    /// The largest value of its [`point_quantity`](Self::point_quantity) that the material bears at a point, if that is known.
    fn point_limit(&self, _at: MaterialPoint) -> Option<f64> {
        None
    }

    /// How its slots follow the deformation, of a law whose slots are internal variables: nobody controls it.
    fn evolution(&self) -> Option<&dyn Evolution> {
        None
    }

    /// The same with its direction as further slots, a vector `direction` at rest where it is written; `None` without one.
    fn with_direction_slots(&self) -> Option<Arc<dyn EnergyTerm>> {
        None
    }

    /// How all laws of its cells see the deformation, of a law that has no energy of its own: a growth.
    fn strain_map(&self) -> Option<&dyn StrainMap> {
        None
    }

    /// The control values seen by an observer who turned space by `q`: components of spatial vectors turn with it,
    /// scalars and vectors of the reference body stay. The contract tests use it to state objectivity.
    fn turn(&self, _q: &Mat3, _m: &mut [f64]) {}
}

/// What a law around another one says as that does: where it may be, what is stated of it, what its slots are to a body.
macro_rules! forward_statements {
    ($self:ident, $law:expr) => {
        fn existence(&$self, at: $crate::MaterialPoint) -> Option<$crate::Existence> {
            $law.existence(at)
        }

        fn fiber_bound(&$self, at: $crate::MaterialPoint) -> Option<$crate::TensionBound> {
            $law.fiber_bound(at)
        }

        fn check(&$self, cells: usize, points: usize) -> Result<(), $crate::EnergyError> {
            $law.check(cells, points)
        }

        fn direction(&$self, at: $crate::MaterialPoint) -> Option<nastic_tensor::Vec3> {
            $law.direction(at)
        }

        fn moduli(&$self, at: $crate::MaterialPoint) -> Option<$crate::Moduli> {
            $law.moduli(at)
        }
    };
}

/// What a law around another one, with the same slots, does as that does.
macro_rules! forward_law {
    ($self:ident, $law:expr) => {
        fn respond(&$self, at: &$crate::PointBatch, m: $crate::Slots, want: $crate::Want, out: &mut $crate::Response) {
            $law.respond(at, m, want, out);
        }

        fn stress_change(
            &$self,
            at: &$crate::PointBatch,
            m: $crate::Slots,
            change: &[nastic_tensor::Mat3],
            out: &mut [nastic_tensor::Mat3],
        ) {
            $law.stress_change(at, m, change, out);
        }

        fn second_stress_change(
            &$self,
            at: &$crate::PointBatch,
            m: $crate::Slots,
            changes: [&[nastic_tensor::Mat3]; 2],
            out: &mut [nastic_tensor::Mat3],
        ) -> Result<(), $crate::EnergyError> {
            $law.second_stress_change(at, m, changes, out)
        }

        fn stress_by_control(&$self, at: &$crate::PointBatch, m: $crate::Slots, out: &mut [nastic_tensor::Mat3]) {
            $law.stress_by_control(at, m, out);
        }

        fn slots_vjp(&$self, at: &$crate::PointBatch, m: $crate::Slots, with: &[nastic_tensor::Mat3], out: &mut [f64]) {
            $law.slots_vjp(at, m, with, out);
        }

        fn control_stress_change(
            &$self,
            at: &$crate::PointBatch,
            m: $crate::Slots,
            change: &[nastic_tensor::Mat3],
            v: $crate::Slots,
            out: &mut [nastic_tensor::Mat3],
        ) -> Result<(), $crate::EnergyError> {
            $law.control_stress_change(at, m, change, v, out)
        }

        fn rest(&$self, at: $crate::MaterialPoint, slot: usize) -> f64 {
            $law.rest(at, slot)
        }

        fn point_quantity(&$self) -> Option<$crate::PointQuantity> {
            $law.point_quantity()
        }

        fn point_values(&$self, at: &$crate::PointBatch, m: $crate::Slots, out: &mut [f64]) {
            $law.point_values(at, m, out);
        }

        fn point_limit(&$self, at: $crate::MaterialPoint) -> Option<f64> {
            $law.point_limit(at)
        }

        fn turn(&$self, q: &nastic_tensor::Mat3, m: &mut [f64]) {
            $law.turn(q, m);
        }

        fn check_domain(&$self, at: &$crate::PointBatch, m: $crate::Slots) -> Result<(), $crate::Outside> {
            $law.check_domain(at, m)
        }

        forward_statements!($self, $law);
    };
}
pub(crate) use {forward_law, forward_statements};

impl<T: EnergyTerm + ?Sized> EnergyTerm for Arc<T> {
    fn slots(&self) -> &[Slot] {
        (**self).slots()
    }

    fn evolution(&self) -> Option<&dyn Evolution> {
        (**self).evolution()
    }

    fn strain_map(&self) -> Option<&dyn StrainMap> {
        (**self).strain_map()
    }

    fn with_direction_slots(&self) -> Option<Arc<dyn EnergyTerm>> {
        (**self).with_direction_slots()
    }

    fn is_material(&self) -> bool {
        (**self).is_material()
    }

    forward_law!(self, (**self));
}
