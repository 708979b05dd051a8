use std::fmt::Debug;

use nastic_tensor::{Mat3, Tangent, Vec3, cross};

use crate::{
    EnergyError, EnergyTerm, Existence, MaterialPoint, Moduli, Outside, PointBatch, Response, Slot, Slots,
    TensionBound, Want,
};

/// Work conjugates of `F`, `H` and `J` (Pa).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conjugates {
    /// `S_F = dW/dF`.
    pub f: Mat3,
    /// `S_H = dW/dH`.
    pub h: Mat3,
    /// `S_J = dW/dJ`.
    pub j: f64,
}

/// Value, first and second partial derivatives, as far as they are wanted.
#[derive(Clone, Debug)]
pub struct Partials {
    /// The value; 0 where it is not wanted.
    pub value: f64,
    /// First partial derivatives.
    pub first: Option<Conjugates>,
    /// Second ones; nothing without the first.
    pub second: Option<Curvature>,
}

/// Changes of `F`, `H` and `J`, each by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Of `F`.
    pub f: Mat3,
    /// Of `H`.
    pub h: Mat3,
    /// Of `J`.
    pub j: f64,
}

/// A block of second derivatives by two matrices, stored in the least expensive form it has.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Absent.
    Zero,
    /// `c delta_ik delta_JL`, from `c |A|^2 / 2`.
    Isotropic(f64),
    /// `delta_ik M_JL` with symmetric `M`, from `A M : A / 2`, such as `M = f f` for a fibre.
    Metric(Mat3),
    /// Anything else: entry `9 (3 i + J) + 3 k + L` is the derivative by `A_iJ` and `B_kL`.
    Full(Box<Tangent>),
}

/// Second partial derivatives of `W(F, H, J)` (Pa).
#[derive(Clone, Debug, PartialEq)]
pub struct Curvature {
    /// `W_FF`.
    pub ff: Block,
    /// `W_HH`.
    pub hh: Block,
    /// `W_JJ`.
    pub jj: f64,
    /// `W_FH`, rows by `F`, columns by `H`.
    pub fh: Block,
    /// `W_FJ`.
    pub fj: Option<Mat3>,
    /// `W_HJ`.
    pub hj: Option<Mat3>,
}

impl Curvature {
    /// Curvature without mixed derivatives, as of a sum of functions of `F`, of `H` and of `J`.
    #[inline]
    pub const fn split(ff: Block, hh: Block, jj: f64) -> Self {
        Curvature { ff, hh, jj, fh: Block::Zero, fj: None, hj: None }
    }
}

impl Change {
    /// That of a change `G` of `F`: `dH = F x G`, `dJ = H : G`.
    #[inline]
    fn along(g: &Mat3, f: &Mat3, h: &Mat3) -> Self {
        Change { f: *g, h: cross(f, g), j: h.dot(g) }
    }
}

impl Conjugates {
    /// Of a law whose only third derivative is the one by `J`: `W_JJJ da_J db_J`.
    #[inline]
    pub fn third_by_j(jjj: f64, [a, b]: [&Change; 2]) -> Self {
        Conjugates { f: Mat3::zeros(), h: Mat3::zeros(), j: jjj * a.j * b.j }
    }
}

impl Block {
    /// The block applied to a direction `B` of its columns.
    #[inline(always)]
    fn apply(&self, b: &Mat3) -> Mat3 {
        match self {
            Block::Zero => Mat3::zeros(),
            Block::Isotropic(c) => b * *c,
            Block::Metric(m) => b * m,
            Block::Full(d) => d.apply(b),
        }
    }

    /// Its transpose applied to a direction of its rows.
    #[inline(always)]
    fn apply_transposed(&self, a: &Mat3) -> Mat3 {
        match self {
            Block::Full(d) => d.transposed().apply(a),
            symmetric => symmetric.apply(a),
        }
    }
}

impl Curvature {
    /// `W_FF`, `W_HH` and `W_JJ` where the first two are multiples of the identity and nothing is mixed.
    #[inline]
    fn isotropic(&self) -> Option<[f64; 3]> {
        let factor = |block: &Block| match block {
            Block::Zero => Some(0.0),
            Block::Isotropic(c) => Some(*c),
            _ => None,
        };
        let split = matches!(self.fh, Block::Zero) && self.fj.is_none() && self.hj.is_none();
        split.then_some([factor(&self.ff)?, factor(&self.hh)?, self.jj])
    }

    /// The change of the conjugates when `F`, `H` and `J` change by these, each by itself.
    #[inline]
    fn along(&self, change: &Change) -> Conjugates {
        let (df, dh, dj) = (&change.f, &change.h, change.j);
        let mut change = Conjugates {
            f: self.ff.apply(df) + self.fh.apply(dh),
            h: self.fh.apply_transposed(df) + self.hh.apply(dh),
            j: self.jj * dj,
        };
        if let Some(fj) = &self.fj {
            change.f += fj * dj;
            change.j += fj.dot(df);
        }
        if let Some(hj) = &self.hj {
            change.h += hj * dj;
            change.j += hj.dot(dh);
        }
        change
    }
}

/// An energy density written as a function of `F`, `H` and `J`, which is polyconvex where it is convex in the three.
///
/// Write the density and its partial derivatives as if the three were independent; `P` and `dP/dF` follow by the one
/// chain rule below. With `X` the map `B -> F x B`, which gives `dH = X dF` and `dJ = H : dF`,
///
/// `P = S_F + S_H x F + S_J H`
///
/// `dP/dF = W_FF + W_FH X + X W_HF + X W_HH X + W_JJ H(.)H + W_FJ(.)H + H(.)W_FJ + (X W_HJ)(.)H + H(.)(X W_HJ)
///          + X(S_H + S_J F)`
///
/// With `a = (A, F x A, H : A)`, `S[a]` the second partial derivatives along `a`, and `S[a, b]` the third along `a` and `b`,
///
/// `d2P/dF2 : (A, B) = T_F + T_H x F + T_J H + S_H[a] x B + S_H[b] x A + S_J[a] F x B + S_J[b] F x A + S_J A x B`,
/// `T = S[a, b] + S[(0, A x B, (F x B) : A)]`
///
/// (Bonet, Gil & Ortigosa 2015, doi 10.1016/j.cma.2014.10.002).
pub trait ConvexDensity: Debug + Send + Sync {
    /// `W(F, H, J)`, J/m^3.
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64;

    /// First partial derivatives.
    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates;

    /// Second partial derivatives.
    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature;

    /// What is wanted of value, first and second partial derivatives: a law that finds something for all of them at once, a spectrum say, overrides it.
    fn partials(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64, want: Want) -> Partials {
        Partials {
            value: if want.energy { self.value(at, f, h, j) } else { 0.0 },
            first: (want.stress || want.tangent).then(|| self.first(at, f, h, j)),
            second: want.tangent.then(|| self.second(at, f, h, j)),
        }
    }

    /// Third partial derivatives along two changes of `F`, `H` and `J`: the second derivative of [`first`](Self::first) along
    /// both, symmetric in them. Second derivatives of a cost ask for it.
    ///
    /// # Errors
    /// [`EnergyError::NoSecondDerivatives`] where the law does not implement it, the same at every point.
    fn third(
        &self,
        _at: MaterialPoint,
        _f: &Mat3,
        _h: &Mat3,
        _j: f64,
        _along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        Err(EnergyError::no_second_derivatives::<Self>("ConvexDensity::third"))
    }

    /// Whether the energy is finite there; see [`EnergyTerm::check_domain`].
    ///
    /// # Errors
    /// [`Outside`], of point 0.
    fn domain(&self, _at: MaterialPoint, _f: &Mat3, _h: &Mat3, _j: f64) -> Result<(), Outside> {
        Ok(())
    }

    /// See [`EnergyTerm::existence`].
    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        None
    }

    /// See [`EnergyTerm::fiber_bound`].
    fn tension_bound(&self, _at: MaterialPoint) -> Option<TensionBound> {
        None
    }

    /// See [`EnergyTerm::check`].
    ///
    /// # Errors
    /// [`EnergyError::Length`] names the field.
    fn check_fields(&self, _cells: usize, _points: usize) -> Result<(), EnergyError> {
        Ok(())
    }

    /// See [`EnergyTerm::direction`].
    fn fiber(&self, _at: MaterialPoint) -> Option<Vec3> {
        None
    }

    /// See [`EnergyTerm::moduli`].
    fn small_strain(&self, _at: MaterialPoint) -> Option<Moduli> {
        None
    }
}

impl<D: ConvexDensity> EnergyTerm for D {
    fn slots(&self) -> &[Slot] {
        &[]
    }

    fn stress_by_control(&self, _at: &PointBatch, _m: Slots, _out: &mut [Mat3]) {}

    fn respond(&self, at: &PointBatch, _m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let (place, f, h, j) = (at.place(q), k.f(), k.h(), k.j());
            let Partials { value, first, second } = self.partials(place, f, h, j, want);
            if want.energy {
                out.energy[q] += value;
            }
            let Some(s) = first else { continue };
            if want.stress {
                out.stress[q] += s.f + cross(&s.h, f) + h * s.j;
            }
            if let Some(second) = second {
                add_tangent(&second, &s, f, h, &mut out.tangent[q]);
            }
        }
    }

    /// The chain rule applied to one direction: a fraction of the work of `dP/dF`.
    fn stress_change(&self, at: &PointBatch, _m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, (k, g)) in at.kinematics.iter().zip(change).enumerate() {
            let (place, f, h, j) = (at.place(q), k.f(), k.h(), k.j());
            let found = self.partials(place, f, h, j, Want::TANGENT);
            let (Some(s), Some(curvature)) = (found.first, found.second) else { continue };
            let a = Change::along(g, f, h);
            let ds = curvature.along(&a);
            out[q] += ds.f + cross(&ds.h, f) + h * ds.j + cross(&s.h, g) + a.h * s.j;
        }
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        _m: Slots,
        changes: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let [first, second] = changes;
        for (q, (k, (ga, gb))) in at.kinematics.iter().zip(first.iter().zip(second)).enumerate() {
            let (place, f, h, j) = (at.place(q), k.f(), k.h(), k.j());
            let (a, b) = (Change::along(ga, f, h), Change::along(gb, f, h));
            let both = Change { f: Mat3::zeros(), h: cross(ga, gb), j: b.h.dot(ga) };
            let found = self.partials(place, f, h, j, Want::TANGENT);
            let (Some(s), Some(curvature)) = (found.first, found.second) else { continue };
            let third = self.third(place, f, h, j, [&a, &b])?;
            let (by_a, by_b, by_both) = (curvature.along(&a), curvature.along(&b), curvature.along(&both));
            out[q] += third.f + by_both.f + cross(&(third.h + by_both.h), f) + h * (third.j + by_both.j);
            out[q] += cross(&by_a.h, gb) + cross(&by_b.h, ga);
            out[q] += b.h * by_a.j + a.h * by_b.j + both.h * s.j;
        }
        Ok(())
    }

    fn check_domain(&self, at: &PointBatch, _m: Slots) -> Result<(), Outside> {
        for (point, k) in at.kinematics.iter().enumerate() {
            let found = self.domain(at.place(point), k.f(), k.h(), k.j());
            found.map_err(|outside| Outside { point, ..outside })?;
        }
        Ok(())
    }

    fn existence(&self, at: MaterialPoint) -> Option<Existence> {
        self.conditions(at)
    }

    fn fiber_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        self.tension_bound(at)
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.check_fields(cells, points)
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        self.fiber(at)
    }

    fn moduli(&self, at: MaterialPoint) -> Option<Moduli> {
        self.small_strain(at)
    }
}

#[inline]
fn add_tangent(w: &Curvature, s: &Conjugates, f: &Mat3, h: &Mat3, out: &mut Tangent) {
    let geometric = s.h + f * s.j;
    if let Some(factors) = w.isotropic() {
        return out.add_isotropic(f, h, &geometric, factors);
    }
    out.add_cross(&geometric, 1.0);
    out.add_outer(h, h, w.jj);
    match &w.ff {
        Block::Zero => {}
        Block::Isotropic(c) => out.add_identity(*c),
        Block::Metric(m) => out.add_metric(m),
        Block::Full(d) => out.add(d),
    }
    match &w.hh {
        Block::Zero => {}
        Block::Isotropic(c) => out.add_cross_squared(f, *c),
        Block::Metric(m) => out.add_cross_metric(f, m),
        Block::Full(d) => out.add_cross_both(f, d),
    }
    match &w.fh {
        Block::Zero => {}
        Block::Isotropic(c) => out.add_cross(f, 2.0 * c),
        Block::Metric(m) => {
            let mut d = Tangent::zero();
            d.add_metric(m);
            out.add_cross_mixed(f, &d);
        }
        Block::Full(d) => out.add_cross_mixed(f, d),
    }
    // H meets the partials mixed with J once: W_FJ + X W_HJ.
    if w.fj.is_some() || w.hj.is_some() {
        let mut with_j = w.fj.unwrap_or_else(Mat3::zeros);
        if let Some(hj) = &w.hj {
            with_j += cross(f, hj);
        }
        out.add_outer_symmetric(&with_j, h, 1.0);
    }
}
