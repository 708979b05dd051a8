use nastic_tensor::{Mat3, Vec3};

use super::isochoric::{Function, Invariant, IsochoricLaw, moduli};
use crate::{EnergyError, Existence, Field, Growth, LinearInModuli, MaterialPoint, Moduli, Outside};

/// A family of stiffening fibres with dispersion, to be added to the law of the matrix on the same cells.
///
/// **Energy.** `W = k1/(2 k2) (exp(k2 r(E)^2) - 1)`, `E = J^(-2/3) (d |F|^2 + (1 - 3 d) |F a|^2) - 1` with the dispersion `d` (kappa
/// in the source). The fibres bear tension alone: `r = 0` for `E <= 0`, `r = E - t/2` for `E >= t`, in between
/// `r = t (s^6 - 3 s^5 + 5/2 s^4)`, `s = E/t`, with the toe `t`: `r` is convex with three continuous derivatives, where the switch `r = max(0, E)`
/// of the source, its limit as `t -> 0`, has a tangent that jumps at rest. There is no volumetric part. `P` and `dP/dF` by the chain rule
/// of the invariant and that of [`ConvexDensity`](crate::ConvexDensity).
///
/// **Parameters.** `k1 > 0` in Pa, `k2 > 0`, `0 <= dispersion <= 1/3` (0: all fibres along a; 1/3: isotropic), the unit vector
/// `fiber`, the toe `0 < toe` (default 0.01), pure numbers. Each a [`Field`]. `k2 r^2 > 600` is refused as a deformation beyond the domain
/// ([`Outside`]): the energy would be no number.
///
/// **Convexity.** Polyconvex. By itself it neither grows as `J -> 0` nor is it coercive: the matrix has to. With `dispersion > 0` it bounds
/// `|F|` of any power. It bears no fibre tension: the limit is that of the matrix.
///
/// **At rest.** All moduli are zero: fibres begin to bear with their stretch.
///
/// **Source.** T. C. Gasser, R. W. Ogden & G. A. Holzapfel, J. R. Soc. Interface 3 (2006) 15-35, doi 10.1098/rsif.2005.0073,
/// equations 4.1 to 4.3; the toe is ours.
#[derive(Clone, Debug)]
pub struct FiberFamily {
    k1: Field<f64>,
    k2: Field<f64>,
    dispersion: Field<f64>,
    fiber: Field<Vec3>,
    toe: Field<f64>,
}

/// `k2 r^2` beyond which the exponential is no longer evaluated.
const LARGEST: f64 = 600.0;

impl FiberFamily {
    /// Name in case files and messages.
    pub const NAME: &str = "fiber_family";
    /// The toe where none is given.
    pub const TOE: f64 = 0.01;

    /// From `k1` (Pa), `k2`, the dispersion, the mean direction.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `k1 > 0`, `k2 > 0`, `0 <= dispersion <= 1/3`; [`EnergyError::Direction`] unless `|a| = 1` to 1e-6.
    pub fn new(
        k1: impl Into<Field<f64>>,
        k2: impl Into<Field<f64>>,
        dispersion: impl Into<Field<f64>>,
        fiber: impl Into<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let fiber = fiber.into();
        Self::named(Self::NAME, "fiber", [k1.into(), k2.into(), dispersion.into(), Self::TOE.into()], fiber)
    }

    /// With another toe.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless it is positive.
    pub fn with_toe(self, toe: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let toe = toe.into();
        toe.require_positive(Self::NAME, "toe")?;
        Ok(Self { toe, ..self })
    }

    /// As part of the law `owner`, of `k1`, `k2`, dispersion and toe, the direction under its name there.
    pub(super) fn named(
        owner: &'static str,
        direction: &'static str,
        [k1, k2, dispersion, toe]: [Field<f64>; 4],
        fiber: Field<Vec3>,
    ) -> Result<Self, EnergyError> {
        let fiber = fiber.unit_directions(owner, direction)?;
        k1.require_positive(owner, "k1")?;
        k2.require_positive(owner, "k2")?;
        let requirement = "it must lie in [0, 1/3]: 0 is all fibres along one direction, 1/3 isotropic";
        dispersion.require(owner, "dispersion", |d| (0.0..=1.0 / 3.0).contains(&d), requirement)?;
        toe.require_positive(owner, "toe")?;
        Ok(Self { k1, k2, dispersion, fiber, toe })
    }

    /// `d I + (1 - 3 d) a a`.
    fn metric(&self, at: MaterialPoint) -> Mat3 {
        let (d, a) = (self.dispersion.at(at), self.fiber.at(at));
        // 1/3 is no binary number: what is left of 1 - 3 d there is rounding
        Mat3::from_diagonal_element(d) + a * (a * (1.0 - 3.0 * d).max(0.0)).transpose()
    }

    /// Calls `visit` with the metric and the energy as function of E.
    pub(super) fn visit(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        let (k1, k2, toe) = (self.k1.at(at), self.k2.at(at), self.toe.at(at));
        visit(&self.metric(at), &|e| energy(k1, k2, tensile(e, toe)));
    }

    /// Refuses what is beyond the range of the exponential.
    pub(super) fn bounded(&self, law: &'static str, at: MaterialPoint, f: &Mat3, j: f64) -> Result<(), Outside> {
        let [r, ..] = tensile(Invariant::new(&self.metric(at), f, j).change(), self.toe.at(at));
        let value = self.k2.at(at) * r * r;
        if value <= LARGEST {
            return Ok(());
        }
        let (measure, meaning) = ("k2 E^2 of its fibres", "where exp(k2 E^2) is still a number");
        Err(Outside { law, measure, value, limit: LARGEST, meaning, point: 0 })
    }

    /// Growth of `exp(k2 E^2)`: of any power in `|F|` where the fibres point everywhere.
    pub(super) fn growth(&self, at: MaterialPoint) -> f64 {
        if self.dispersion.at(at) > 0.0 { f64::INFINITY } else { 0.0 }
    }

    /// Checks the fields as those of the law `owner`.
    pub(super) fn check_of(
        &self,
        owner: &'static str,
        direction: &'static str,
        cells: usize,
        points: usize,
    ) -> Result<(), EnergyError> {
        self.k1.check_len(owner, "k1", cells, points)?;
        self.k2.check_len(owner, "k2", cells, points)?;
        self.dispersion.check_len(owner, "dispersion", cells, points)?;
        self.toe.check_len(owner, "toe", cells, points)?;
        self.fiber.check_len(owner, direction, cells, points)
    }

    /// The mean direction.
    pub(super) fn direction(&self, at: MaterialPoint) -> Vec3 {
        self.fiber.at(at)
    }
}

/// `r(E)` and its first three derivatives.
fn tensile(e: f64, toe: f64) -> [f64; 4] {
    if e <= 0.0 {
        return [0.0; 4];
    }
    if e >= toe {
        return [e - 0.5 * toe, 1.0, 0.0, 0.0];
    }
    let s = e / toe;
    let (square, cube) = (s * s, s * s * s);
    [
        toe * square * square * (square - 3.0 * s + 2.5),
        cube * (6.0 * square - 15.0 * s + 10.0),
        30.0 * square * (1.0 - s) * (1.0 - s) / toe,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (toe * toe),
    ]
}

/// `k1/(2 k2) (exp(k2 r^2) - 1)` and its first three derivatives by E.
fn energy(k1: f64, k2: f64, [r, r1, r2, r3]: [f64; 4]) -> [f64; 4] {
    let y = k2 * r * r;
    let grown = y.exp();
    let (first, second) = (k1 * r * grown, k1 * grown * (1.0 + 2.0 * y));
    let third = k1 * k2 * r * grown * (6.0 + 4.0 * y);
    [
        0.5 * k1 / k2 * y.exp_m1(),
        first * r1,
        second * r1 * r1 + first * r2,
        third * r1 * r1 * r1 + 3.0 * second * r1 * r2 + first * r3,
    ]
}

impl IsochoricLaw for FiberFamily {
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        self.visit(at, visit);
    }

    fn bulk(&self, _at: MaterialPoint) -> f64 {
        0.0
    }

    fn within(&self, at: MaterialPoint, f: &Mat3, j: f64) -> Result<(), Outside> {
        self.bounded(Self::NAME, at, f, j)
    }

    /// Without a volumetric part `|F|` is bounded by `J` alone.
    fn existence(&self, _at: MaterialPoint) -> Existence {
        Existence { polyconvex: true, resists_collapse: false, growth: Growth::default() }
    }

    fn rest_moduli(&self, _at: MaterialPoint) -> Moduli {
        moduli(0.0, 0.0)
    }

    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.check_of(Self::NAME, "fiber", cells, points)
    }

    fn along(&self, at: MaterialPoint) -> Option<Vec3> {
        Some(self.direction(at))
    }
}

impl LinearInModuli for FiberFamily {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("k1", self.k1.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        FiberFamily { k1: theta[0].into(), ..self.clone() }
    }
}
