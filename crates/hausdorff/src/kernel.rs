//! phi^alpha as the vector code sees it: lengths in the kernel's own unit, logarithms to base two.

use std::f64::consts::{LN_2, LOG2_E};

use super::lanes::Lanes;
use super::phi::Phi;

/// Added to every squared distance: keeps 1/r finite where points coincide, and is lost in every other.
pub(super) const SQUARE_OFFSET: f64 = 1e-300;

/// One of the three functions, in units of its length:
/// E(r) = phi(r)^alpha / phi(0)^alpha, and grad_x E = -factor g(r) E (x - y).
pub(super) trait Form: Copy + Send + Sync {
    /// base + log2 E from r^2 + SQUARE_OFFSET.
    fn log2<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> S::f64s;

    /// base + log2 E, and g, from r^2 + SQUARE_OFFSET.
    fn log2_and_slope<S: Lanes>(self, s: S, r2: S::f64s, base: S::f64s) -> (S::f64s, S::f64s);

    /// log2 E, g, and h = g'/r from r^2 + SQUARE_OFFSET: along a change v of x, `d(g (x - y)) = g v + h ((x - y).v) (x - y)`. Where a kink of phi
    /// lies between two points that meet, g and h are zero.
    fn log2_and_slopes<S: Lanes>(self, s: S, r2: S::f64s) -> [S::f64s; 3];

    /// log2 E(r).
    fn at(self, r: f64) -> f64;

    /// The factor above.
    fn factor(self) -> f64;
}

/// Squared distance below which two points coincide.
const MAX_COINCIDENT_SQUARE: f64 = 1e-200;

/// `value`, zero where points meet.
#[inline(always)]
fn unless_met<S: Lanes>(s: S, r2: S::f64s, value: S::f64s) -> S::f64s {
    s.select_f64s(s.less_than_f64s(r2, s.splat_f64s(MAX_COINCIDENT_SQUARE)), s.splat_f64s(0.0), value)
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

    /// h = -g^3
    #[inline(always)]
    fn log2_and_slopes<S: Lanes>(self, s: S, r2: S::f64s) -> [S::f64s; 3] {
        let (z, g) = self.log2_and_slope(s, r2, s.splat_f64s(0.0));
        let g = unless_met(s, r2, g);
        [z, g, s.mul_f64s(s.mul_f64s(g, g), s.neg_f64s(g))]
    }

    fn at(self, r: f64) -> f64 {
        -r
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

    /// h = -g^2 (1/r + 2)
    #[inline(always)]
    fn log2_and_slopes<S: Lanes>(self, s: S, r2: S::f64s) -> [S::f64s; 3] {
        let (z, g) = self.log2_and_slope(s, r2, s.splat_f64s(0.0));
        let g = unless_met(s, r2, g);
        let factor = unless_met(s, r2, s.add_f64s(s.rsqrt(r2), s.splat_f64s(2.0)));
        [z, g, s.mul_f64s(s.mul_f64s(g, g), s.neg_f64s(factor))]
    }

    fn at(self, r: f64) -> f64 {
        -self.alpha * LOG2_E * r.ln_1p()
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

    /// h = -2 g^2
    #[inline(always)]
    fn log2_and_slopes<S: Lanes>(self, s: S, r2: S::f64s) -> [S::f64s; 3] {
        let (z, g) = self.log2_and_slope(s, r2, s.splat_f64s(0.0));
        [z, g, s.mul_f64s(s.mul_f64s(g, g), s.splat_f64s(-2.0))]
    }

    fn at(self, r: f64) -> f64 {
        -0.5 * self.alpha * LOG2_E * (r * r).ln_1p()
    }

    fn factor(self) -> f64 {
        self.alpha
    }
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

    /// grad_x E in 1/metres is this times g(r) E (x - y), with x - y in units.
    pub fn gradient_factor(&self) -> f64 {
        -with_form!(self, form => form.factor()) / self.unit
    }
}
