use nastic_tensor::{Mat3, Tangent};

use super::engineering::bulk_of_d1;
use super::isochoric::moduli;
use super::power_trace::{PowerTrace, Spectrum};
use super::volumetric::volumetric;
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, Partials, TensionBound, Want, combine,
};

/// Ogden's law of N terms in powers of the isochoric principal stretches.
///
/// **Energy.** `W = sum_p mu_p/alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3) + kappa/4 (J^2 - 1 - 2 log J)`, `l_i` the singular values of
/// `J^(-1/3) F`. Terms of positive `alpha` are written as `J^(-alpha/3) tr (F^T F)^(alpha/2)`, those of negative as
/// `J^(2 alpha/3) tr (H^T H)^(-alpha/2)`: partial derivatives by those of such traces, which are exact where stretches
/// coincide, and the chain rule of [`ConvexDensity`].
///
/// **Parameters.** `mu_p` in Pa and `alpha_p`, pure numbers, with `mu_p alpha_p > 0` for every term; the bulk modulus `bulk > 0` in Pa, or
/// `d1 = 2 / bulk` in 1/Pa. Each a [`Field`]. Abaqus' mu_p are `mu_p alpha_p / 2` of these.
///
/// **Convexity.** Polyconvex if every `alpha_p >= 3/2` or `<= -3`; a term between has no such statement. `W -> inf` as `J -> 0`. Coercive
/// if a positive `alpha` is at least 6 (`p = 3`), or together with a negative one: `p = 6 alpha/(alpha + 6)`, `q = 3 |alpha|/(|alpha| + 3)`, `r = 2`. No
/// positive fibre tension keeps it polyconvex.
///
/// **At rest.** Shear modulus `1/2 sum mu_p alpha_p`, bulk modulus `kappa`.
///
/// **Source.** R. W. Ogden, Proc. R. Soc. Lond. A 326 (1972) 565-584, doi 10.1098/rspa.1972.0026; polyconvexity by S. Hartmann &
/// P. Neff, Int. J. Solids Struct. 40 (2003) 2767-2791, doi 10.1016/S0020-7683(03)00086-6; volumetric part by J. C. Simo & T. J. R.
/// Hughes, *Computational Inelasticity* (1998), section 9.2.
#[derive(Clone, Debug)]
pub struct Ogden {
    terms: Vec<[Field<f64>; 2]>,
    bulk: Field<f64>,
}

const MU: [&str; Ogden::TERMS] = ["mu1", "mu2", "mu3", "mu4"];
const ALPHA: [&str; Ogden::TERMS] = ["alpha1", "alpha2", "alpha3", "alpha4"];

impl Ogden {
    /// Name in case files and messages.
    pub const NAME: &str = "ogden";
    /// Terms beyond which none has a name.
    pub const TERMS: usize = 4;

    /// From one to [`TERMS`](Self::TERMS) pairs of `mu_p` (Pa) and `alpha_p`, and the bulk modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu_p alpha_p > 0` and `bulk > 0`, all finite; [`EnergyError::Missing`] without a term or with too many.
    pub fn new(terms: Vec<[Field<f64>; 2]>, bulk: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let bulk = bulk.into();
        if terms.is_empty() || terms.len() > Self::TERMS {
            let (given, forms) = (vec![format!("{} terms", terms.len())], format!("1 to {} terms", Self::TERMS));
            return Err(EnergyError::Missing { owner: Self::NAME, name: "mu1", given, forms });
        }
        bulk.require_positive(Self::NAME, "bulk")?;
        for ([mu, alpha], (mu_name, alpha_name)) in terms.iter().zip(MU.into_iter().zip(ALPHA)) {
            mu.require(Self::NAME, mu_name, |_| true, "it must be finite")?;
            alpha.require(Self::NAME, alpha_name, |alpha| alpha != 0.0, "it must not be zero")?;
            combine(Self::NAME, [(mu_name, mu), (alpha_name, alpha)], |entry, [mu, alpha]| {
                if mu * alpha > 0.0 {
                    return Ok([]);
                }
                let requirement = "it must have the sign of its alpha: mu alpha > 0 for every term";
                Err(EnergyError::Parameter { owner: Self::NAME, name: mu_name, value: mu, entry, requirement })
            })?;
        }
        Ok(Self { terms, bulk })
    }

    /// The same with D1 (1/Pa): bulk modulus `2 / D1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `D1 > 0`.
    pub fn from_d1(terms: Vec<[Field<f64>; 2]>, d1: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        Self::new(terms, bulk_of_d1(Self::NAME, &d1.into())?)
    }

    fn at(&self, at: MaterialPoint) -> impl Iterator<Item = Term> {
        self.terms.iter().map(move |[mu, alpha]| Term::new(mu.at(at), alpha.at(at)))
    }

    /// Calls `visit` with every term, whether it is one of F, and its trace.
    fn each(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, mut visit: impl FnMut(&Term, bool, &PowerTrace<'_>)) {
        let spectrum =
            |of_f: bool| self.at(at).any(|t| t.of_f == of_f).then(|| Spectrum::new(if of_f { f } else { h }));
        let spectra = [spectrum(false), spectrum(true)];
        for term in self.at(at) {
            if let Some(spectrum) = &spectra[usize::from(term.of_f)] {
                visit(&term, term.of_f, &spectrum.power(term.s));
            }
        }
    }
}

/// `factor (J^(-q) tr (A^T A)^s - 3)`, A one of F and H.
struct Term {
    of_f: bool,
    factor: f64,
    s: f64,
    q: f64,
}

impl Term {
    fn new(mu: f64, alpha: f64) -> Self {
        let (of_f, size) = (alpha > 0.0, alpha.abs());
        let q = if of_f { size / 3.0 } else { 2.0 * size / 3.0 };
        Term { of_f, factor: mu / alpha, s: 0.5 * size, q }
    }

    /// `factor J^(-q)` and its first three derivatives.
    fn scale(&self, j: f64) -> [f64; 4] {
        let q = self.q;
        let zeroth = self.factor * j.powf(-q);
        let first = -q * zeroth / j;
        let second = -(q + 1.0) * first / j;
        [zeroth, first, second, -(q + 2.0) * second / j]
    }
}

impl ConvexDensity for Ogden {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        self.partials(at, f, h, j, Want::ENERGY).value
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let found = self.partials(at, f, h, j, Want::STRESS);
        found.first.unwrap_or(Conjugates { f: Mat3::zeros(), h: Mat3::zeros(), j: 0.0 })
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Curvature {
        let zero = || Curvature::split(Block::Zero, Block::Zero, 0.0);
        self.partials(at, f, h, j, Want::TANGENT).second.unwrap_or_else(zero)
    }

    /// With one spectrum of F and one of H.
    fn partials(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64, want: Want) -> Partials {
        let [mut value, mut by_j, mut jj, _] = volumetric(self.bulk.at(at), j);
        let mut by = [Mat3::zeros(), Mat3::zeros()];
        let mut own: [Option<Box<Tangent>>; 2] = [None, None];
        let mut mixed = [None, None];
        self.each(at, f, h, |term, of_f, trace| {
            let (scale, k) = (term.scale(j), usize::from(of_f));
            let of_trace = trace.value();
            value += scale[0] * of_trace - 3.0 * term.factor;
            if !(want.stress || want.tangent) {
                return;
            }
            let first = trace.first();
            by[k] += first * scale[0];
            by_j += scale[1] * of_trace;
            if want.tangent {
                let mut curvature = trace.curvature();
                curvature.0.iter_mut().for_each(|c| *c *= scale[0]);
                own[k].get_or_insert_with(Box::default).add(&curvature);
                *mixed[k].get_or_insert_with(Mat3::zeros) += first * scale[1];
                jj += scale[2] * of_trace;
            }
        });
        let [hh, ff] = own.map(|block| block.map_or(Block::Zero, Block::Full));
        Partials {
            value,
            first: (want.stress || want.tangent).then_some(Conjugates { f: by[1], h: by[0], j: by_j }),
            second: want.tangent.then_some(Curvature { ff, hh, jj, fh: Block::Zero, fj: mixed[1], hj: mixed[0] }),
        }
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        h: &Mat3,
        j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let mut sum = Conjugates::third_by_j(volumetric(self.bulk.at(at), j)[3], [a, b]);
        self.each(at, f, h, |term, of_f, trace| {
            let (da, db) = if of_f { (&a.f, &b.f) } else { (&a.h, &b.h) };
            let scale = term.scale(j);
            let (first, by_a, by_b) = (trace.first(), trace.second(da), trace.second(db));
            let own =
                trace.third(da, db) * scale[0] + (by_a * b.j + by_b * a.j) * scale[1] + first * (scale[2] * a.j * b.j);
            if of_f {
                sum.f += own
            } else {
                sum.h += own
            }
            sum.j += scale[1] * by_a.dot(db)
                + scale[2] * (first.dot(da) * b.j + first.dot(db) * a.j)
                + scale[3] * trace.value() * a.j * b.j;
        });
        Ok(sum)
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        let size = |term: &Term| 2.0 * term.s;
        let polyconvex = self.at(at).all(|term| size(&term) >= if term.of_f { 1.5 } else { 3.0 });
        let largest = |of_f: bool| self.at(at).filter(|t| t.of_f == of_f).map(|t| size(&t)).fold(0.0, f64::max);
        let (alpha, beta) = (largest(true), largest(false));
        let growth = Growth { p: 6.0 * alpha / (alpha + 6.0), q: 3.0 * beta / (beta + 3.0), r: 2.0 };
        Some(Existence { polyconvex, resists_collapse: true, growth })
    }

    /// The curvature by `F` fades as `J` grows: no positive tension leaves the sum convex. `None` where the law alone is not polyconvex.
    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        let polyconvex = self.conditions(at).is_some_and(|conditions| conditions.polyconvex);
        polyconvex.then(|| TensionBound::isotropic(0.0))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        for ([mu, alpha], (mu_name, alpha_name)) in self.terms.iter().zip(MU.into_iter().zip(ALPHA)) {
            mu.check_len(Self::NAME, mu_name, cells, points)?;
            alpha.check_len(Self::NAME, alpha_name, cells, points)?;
        }
        self.bulk.check_len(Self::NAME, "bulk", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let shear: f64 = self.terms.iter().map(|[mu, alpha]| 0.5 * mu.at(at) * alpha.at(at)).sum();
        Some(moduli(shear, self.bulk.at(at)))
    }
}

impl LinearInModuli for Ogden {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        let terms = MU.iter().zip(&self.terms).map(|(name, [mu, _])| (*name, mu.clone()));
        terms.chain([("bulk", self.bulk.clone())]).collect()
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        let terms = self.terms.iter().zip(theta).map(|([_, alpha], mu)| [(*mu).into(), alpha.clone()]);
        Ogden { terms: terms.collect(), bulk: theta[self.terms.len()].into() }
    }
}
