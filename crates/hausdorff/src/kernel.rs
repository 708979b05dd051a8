//! phi^alpha as the vector code sees it: lengths in the kernel's own unit, logarithms to base two.

use std::f64::consts::{LN_2, LOG2_E};

use super::lanes::Lanes;
use super::phi::Phi;

/// Added to every squared distance: keeps 1/r finite where points coincide, and is lost in every other.
pub(super) const TINY: f64 = 1e-300;

/// One of the three functions, in units of its length:
/// E(r) = phi(r)^alpha / phi(0)^alpha, and grad_x E = -factor g(r) E (x - y).
pub(super) trait Form: Copy + Send + Sync {
    /// base + log2 E from r^2 + TINY.
    fn log2<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> S::f64s;

    /// base + log2 E, and g, from r^2 + TINY.
    fn log2_and_slope<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> (S::f64s, S::f64s);

    /// log2 E(r).
    fn at(self, r: f64) -> f64;

    /// Added in squares to the distances below: sqrt(r^2 + softening^2) is what the kernel is a function of.
    fn softening(self) -> f64 {
        0.0
    }

    /// A bound of |g(r) (x - y)_d| where Re r >= sqrt(m^2 - c) and |x - y|^2 <= m^2 + eta2, for m^2 >= near2 > c.
    fn pull(self, near2: f64, c: f64, eta2: f64) -> f64;

    /// The largest real |g(r) r| for r >= near.
    fn slope(self, near: f64) -> f64;

    /// d log2 E / dr.
    fn log_slope(self, r: f64) -> f64;

    /// The largest second derivative of log2 E, or zero, at distances from `near` on.
    fn bulge(self, near: f64) -> f64;

    /// The largest downward one.
    fn dip(self, near: f64) -> f64;

    /// How much log2 |E| may rise above log2 E(m) where Re r >= sqrt(m^2 - c), for m >= near.
    fn loss(self, near: f64, c: f64) -> f64;

    /// The factor above.
    fn factor(self) -> f64;
}

/// 2^(-r): lengths are in units of length / (alpha log2 e).
#[derive(Clone, Copy, Debug)]
pub(super) struct Exponential;

/// (1 + r)^(-alpha): lengths are in units of eps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse {
    pub alpha: f64,
}

/// (1 + r^2)^(-alpha / 2): lengths are in units of eps.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmoothInverse {
    pub alpha: f64,
}

impl Form for Exponential {
    #[inline(always)]
    fn log2<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> S::f64s {
        s.negate_mul_add_e_f64s(r2, s.rsqrt(r2), base)
    }

    #[inline(always)]
    fn log2_and_slope<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> (S::f64s, S::f64s) {
        let inverse = s.rsqrt(r2);
        (s.negate_mul_add_e_f64s(r2, inverse, base), inverse)
    }

    fn at(self, r: f64) -> f64 {
        -r
    }

    fn pull(self, near2: f64, c: f64, eta2: f64) -> f64 {
        ((near2 + eta2) / (near2 - c)).sqrt()
    }

    fn slope(self, _near: f64) -> f64 {
        1.0
    }

    fn log_slope(self, _r: f64) -> f64 {
        -1.0
    }

    fn bulge(self, _near: f64) -> f64 {
        0.0
    }

    fn dip(self, near: f64) -> f64 {
        1.0 / near
    }

    fn loss(self, near: f64, c: f64) -> f64 {
        shortening(near, c)
    }

    fn factor(self) -> f64 {
        LN_2
    }
}

impl Form for Inverse {
    #[inline(always)]
    fn log2<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> S::f64s {
        let one_plus_r = s.mul_add_e_f64s(r2, s.rsqrt(r2), s.splat_f64s(1.0));
        s.mul_add_e_f64s(s.splat_f64s(-self.alpha), s.log2(one_plus_r), base)
    }

    #[inline(always)]
    fn log2_and_slope<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> (S::f64s, S::f64s) {
        let inverse = s.rsqrt(r2);
        let one_plus_r = s.mul_add_e_f64s(r2, inverse, s.splat_f64s(1.0));
        let z = s.mul_add_e_f64s(s.splat_f64s(-self.alpha), s.log2(one_plus_r), base);
        (z, s.div_f64s(inverse, one_plus_r))
    }

    fn at(self, r: f64) -> f64 {
        -self.alpha * LOG2_E * r.ln_1p()
    }

    fn pull(self, near2: f64, c: f64, eta2: f64) -> f64 {
        let shortest = (near2 - c).sqrt();
        (near2 + eta2).sqrt() / (shortest * (1.0 + shortest))
    }

    fn slope(self, near: f64) -> f64 {
        1.0 / (1.0 + near)
    }

    fn log_slope(self, r: f64) -> f64 {
        -self.alpha * LOG2_E / (1.0 + r)
    }

    fn bulge(self, near: f64) -> f64 {
        self.alpha * LOG2_E / ((1.0 + near) * (1.0 + near))
    }

    fn dip(self, near: f64) -> f64 {
        self.alpha * LOG2_E / (near * (1.0 + near))
    }

    fn loss(self, near: f64, c: f64) -> f64 {
        let shorter = shortening(near, c);
        self.alpha * LOG2_E * shorter / (1.0 + near - shorter)
    }

    fn factor(self) -> f64 {
        self.alpha
    }
}

impl Form for SmoothInverse {
    #[inline(always)]
    fn log2<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> S::f64s {
        let square = s.add_f64s(s.splat_f64s(1.0), r2);
        s.mul_add_e_f64s(s.splat_f64s(-0.5 * self.alpha), s.log2(square), base)
    }

    #[inline(always)]
    fn log2_and_slope<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> (S::f64s, S::f64s) {
        let square = s.add_f64s(s.splat_f64s(1.0), r2);
        let z = s.mul_add_e_f64s(s.splat_f64s(-0.5 * self.alpha), s.log2(square), base);
        (z, s.div_f64s(s.splat_f64s(1.0), square))
    }

    fn at(self, r: f64) -> f64 {
        -0.5 * self.alpha * LOG2_E * (r * r).ln_1p()
    }

    fn softening(self) -> f64 {
        1.0
    }

    fn pull(self, near2: f64, c: f64, eta2: f64) -> f64 {
        // s / (s^2 - c) falls with s = sqrt(m^2 + 1).
        (near2.sqrt() + eta2.sqrt()) / (near2 - c)
    }

    fn slope(self, near: f64) -> f64 {
        let r = near.max(1.0);
        r / (1.0 + r * r)
    }

    fn log_slope(self, r: f64) -> f64 {
        -self.alpha * LOG2_E * r / (1.0 + r * r)
    }

    fn bulge(self, near: f64) -> f64 {
        let s2 = (near * near).max(4.0);
        self.alpha * LOG2_E * (s2 - 2.0) / (s2 * s2)
    }

    fn dip(self, near: f64) -> f64 {
        self.alpha * LOG2_E / (near * near)
    }

    fn loss(self, near: f64, c: f64) -> f64 {
        0.5 * self.alpha * LOG2_E * c / (near * near - c)
    }

    fn factor(self) -> f64 {
        self.alpha
    }
}

/// m - sqrt(m^2 - c), at its largest for m >= near.
fn shortening(near: f64, c: f64) -> f64 {
    c / (near + (near * near - c).max(0.0).sqrt())
}

/// Any of the three.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Exponential(Exponential),
    Inverse(Inverse),
    SmoothInverse(SmoothInverse),
}

/// Run `$body` with `$form` bound to the kernel's form, compiled once for each.
macro_rules! with_form {
    ($kernel:expr, $form:ident => $body:expr) => {
        match $kernel.kind {
            $crate::kernel::Kind::Exponential($form) => $body,
            $crate::kernel::Kind::Inverse($form) => $body,
            $crate::kernel::Kind::SmoothInverse($form) => $body,
        }
    };
}
pub(super) use with_form;

/// phi^alpha, with what leads back to the user's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    pub kind: Kind,
    /// The unit of length, metres.
    pub unit: f64,
    /// log phi(0)^alpha.
    pub log_at_zero: f64,
}

impl Kernel {
    pub fn new(phi: Phi, alpha: f64) -> Self {
        let (kind, unit) = match phi {
            Phi::Exponential { length } => (Kind::Exponential(Exponential), length / (alpha * LOG2_E)),
            Phi::Inverse { eps } => (Kind::Inverse(Inverse { alpha }), eps),
            Phi::SmoothInverse { eps } => (Kind::SmoothInverse(SmoothInverse { alpha }), eps),
        };
        Self { kind, unit, log_at_zero: alpha * phi.log(0.0) }
    }

    /// log2 E(r), r in units.
    pub fn at(&self, r: f64) -> f64 {
        with_form!(self, form => form.at(r))
    }

    /// See `Form::softening`.
    pub fn softening(&self) -> f64 {
        with_form!(self, form => form.softening())
    }

    /// See `Form::pull`.
    pub fn pull(&self, near2: f64, c: f64, eta2: f64) -> f64 {
        with_form!(self, form => form.pull(near2, c, eta2))
    }

    /// See `Form::slope`.
    pub fn slope(&self, near: f64) -> f64 {
        with_form!(self, form => form.slope(near))
    }

    /// See `Form::log_slope`.
    pub fn log_slope(&self, r: f64) -> f64 {
        with_form!(self, form => form.log_slope(r))
    }

    /// See `Form::bulge`.
    pub fn bulge(&self, near: f64) -> f64 {
        with_form!(self, form => form.bulge(near))
    }

    /// See `Form::dip`.
    pub fn dip(&self, near: f64) -> f64 {
        with_form!(self, form => form.dip(near))
    }

    /// See `Form::loss`.
    pub fn loss(&self, near: f64, c: f64) -> f64 {
        with_form!(self, form => form.loss(near, c))
    }

    /// 2^(-r), which tiles in single precision are written for.
    pub fn is_exponential(&self) -> bool {
        matches!(self.kind, Kind::Exponential(_))
    }

    /// grad_x E in 1/metres is this times g(r) E (x - y), with x - y in units.
    pub fn gradient_factor(&self) -> f64 {
        -with_form!(self, form => form.factor()) / self.unit
    }
}
