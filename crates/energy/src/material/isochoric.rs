//! Laws of the invariants `J^(-2/3) F M : F` and of `J`: the chain rule of them all.

use nastic_tensor::{Mat3, Tangent, Vec3};

use super::volumetric::volumetric;
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, MaterialPoint, Moduli, Outside,
    TensionBound,
};

/// A function of one invariant and its first three derivatives, from the change `x` of the invariant since rest.
pub(super) type Function<'a> = &'a dyn Fn(f64) -> [f64; 4];

/// A law `W = sum_k phi_k(x_k) + U(J)`, `x_k = J^(-2/3) F M_k : F - tr M_k`, with symmetric positive semidefinite `M_k`: the identity
/// for `x = I1' - 3`, `a a` for `x = I4' - 1`. `U` is the [`volumetric`] part.
///
/// Polyconvex where every `phi_k` is convex and nondecreasing, for `|F A|^2 / J^(2/3)` is convex in `F` and `J` (S. Hartmann & P. Neff,
/// Int. J. Solids Struct. 40, 2003, 2767-2791, doi 10.1016/S0020-7683(03)00086-6).
pub(super) trait IsochoricLaw: std::fmt::Debug + Send + Sync {
    /// Calls `visit` for every `M_k` with its `phi_k`.
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>));

    /// Bulk modulus of the volumetric part; 0 where there is none.
    fn bulk(&self, at: MaterialPoint) -> f64;

    /// See [`ConvexDensity::conditions`].
    fn existence(&self, at: MaterialPoint) -> Existence;

    /// See [`ConvexDensity::small_strain`].
    fn rest_moduli(&self, at: MaterialPoint) -> Moduli;

    /// See [`ConvexDensity::check_fields`].
    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError>;

    /// Whether the functions are finite there: see [`ConvexDensity::domain`].
    fn within(&self, _at: MaterialPoint, _f: &Mat3, _j: f64) -> Result<(), Outside> {
        Ok(())
    }

    /// See [`ConvexDensity::fiber`].
    fn along(&self, _at: MaterialPoint) -> Option<Vec3> {
        None
    }
}

/// `J^(-2/3) F M : F` and its derivatives by `F` and by `J`, taken as independent.
pub(super) struct Invariant<'a> {
    metric: &'a Mat3,
    fm: Mat3,
    j: f64,
    /// `J^(-2/3)`.
    scale: f64,
    value: f64,
}

/// A derivative by `F` and one by `J`.
#[derive(Clone, Copy)]
struct Slope {
    f: Mat3,
    j: f64,
}

impl Slope {
    fn dot(&self, change: &Change) -> f64 {
        self.f.dot(&change.f) + self.j * change.j
    }
}

impl<'a> Invariant<'a> {
    pub fn new(metric: &'a Mat3, f: &Mat3, j: f64) -> Self {
        let root = j.cbrt();
        let (fm, scale) = (f * metric, 1.0 / (root * root));
        let value = scale * fm.dot(f);
        Invariant { metric, fm, j, scale, value }
    }

    /// Change since rest.
    pub fn change(&self) -> f64 {
        self.value - self.metric.trace()
    }

    /// `2 g F M`, `-2 x / (3 J)`.
    fn slope(&self) -> Slope {
        Slope { f: self.fm * (2.0 * self.scale), j: -2.0 / 3.0 * self.value / self.j }
    }

    /// The change of the slope: `2 g A M - 4/3 g F M a / J`, `-4/3 g F M : A / J + 10/9 x a / J^2`.
    fn slope_change(&self, a: &Change) -> Slope {
        let mixed = -4.0 / 3.0 * self.scale / self.j;
        Slope {
            f: a.f * self.metric * (2.0 * self.scale) + self.fm * (mixed * a.j),
            j: mixed * self.fm.dot(&a.f) + 10.0 / 9.0 * self.value / (self.j * self.j) * a.j,
        }
    }

    /// The second change of the slope.
    fn slope_second_change(&self, a: &Change, b: &Change) -> Slope {
        let (once, twice) = (-4.0 / 3.0 * self.scale / self.j, 20.0 / 9.0 * self.scale / (self.j * self.j));
        let (am, bm) = (a.f * self.metric, b.f * self.metric);
        let cubic = -80.0 / 27.0 * self.value / self.j.powi(3);
        Slope {
            f: (am * b.j + bm * a.j) * once + self.fm * (twice * a.j * b.j),
            j: once * am.dot(&b.f) + twice * (self.fm.dot(&a.f) * b.j + self.fm.dot(&b.f) * a.j) + cubic * a.j * b.j,
        }
    }
}

impl<L: IsochoricLaw> ConvexDensity for L {
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> f64 {
        let mut sum = volumetric(self.bulk(at), j)[0];
        self.each(at, &mut |metric, phi| sum += phi(Invariant::new(metric, f, j).change())[0]);
        sum
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Conjugates {
        let mut sum = Conjugates { f: Mat3::zeros(), h: Mat3::zeros(), j: volumetric(self.bulk(at), j)[1] };
        self.each(at, &mut |metric, phi| {
            let x = Invariant::new(metric, f, j);
            let ([_, first, ..], slope) = (phi(x.change()), x.slope());
            sum.f += slope.f * first;
            sum.j += slope.j * first;
        });
        sum
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let mut ff = Tangent::zero();
        let mut fj = Mat3::zeros();
        let mut jj = volumetric(self.bulk(at), j)[2];
        self.each(at, &mut |metric, phi| {
            let x = Invariant::new(metric, f, j);
            let ([_, first, second, _], slope) = (phi(x.change()), x.slope());
            ff.add_metric(&(metric * (2.0 * first * x.scale)));
            ff.add_outer(&slope.f, &slope.f, second);
            fj += slope.f * (second * slope.j - 2.0 / 3.0 * first / j);
            jj += second * slope.j * slope.j + first * 10.0 / 9.0 * x.value / (j * j);
        });
        Curvature { fj: Some(fj), ..Curvature::split(Block::Full(Box::new(ff)), Block::Zero, jj) }
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        _h: &Mat3,
        j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let mut sum = Conjugates::third_by_j(volumetric(self.bulk(at), j)[3], [a, b]);
        self.each(at, &mut |metric, phi| {
            let x = Invariant::new(metric, f, j);
            let ([_, first, second, third], slope) = (phi(x.change()), x.slope());
            let (by_a, by_b, by_both) = (x.slope_change(a), x.slope_change(b), x.slope_second_change(a, b));
            let (along_a, along_b, along_both) = (slope.dot(a), slope.dot(b), by_a.dot(b));
            let own = third * along_a * along_b + second * along_both;
            sum.f += slope.f * own + (by_b.f * along_a + by_a.f * along_b) * second + by_both.f * first;
            sum.j += slope.j * own + (by_b.j * along_a + by_a.j * along_b) * second + by_both.j * first;
        });
        Ok(sum)
    }

    fn domain(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Result<(), Outside> {
        self.within(at, f, j)
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        Some(self.existence(at))
    }

    /// The curvature by `F` fades as `J` grows: no positive tension leaves the sum convex. `None` where the law alone is not polyconvex.
    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        let polyconvex = self.conditions(at).is_some_and(|conditions| conditions.polyconvex);
        polyconvex.then(|| TensionBound::isotropic(0.0))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.check_lengths(cells, points)
    }

    fn fiber(&self, at: MaterialPoint) -> Option<Vec3> {
        self.along(at)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        Some(self.rest_moduli(at))
    }
}

/// Moduli of shear modulus `mu` and bulk modulus `kappa`.
pub(super) fn moduli(mu: f64, kappa: f64) -> Moduli {
    Moduli::isotropic(kappa - 2.0 * mu / 3.0, mu)
}
