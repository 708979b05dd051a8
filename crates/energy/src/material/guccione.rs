use nastic_tensor::{Mat3, Tangent, Vec3};

use super::volumetric::volumetric;
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, Outside,
};

/// Guccione's law of passive heart muscle: transversely isotropic about the fibre, exponential in the Green-Lagrange strain.
///
/// **Energy.** `W = C/2 (exp Q - 1) + U(J)`, `E = (F^T F - 1)/2`, with `f` the fibre, `s` and `n` across it,
///
/// `Q = b_f E_ff^2 + b_t (E_ss^2 + E_nn^2 + 2 E_sn^2) + 2 b_fs (E_fs^2 + E_fn^2) = E : L E`,
/// `L E = b_t E + (b_fs - b_t) (f (.) E f + E f (.) f) + (b_f + b_t - 2 b_fs) E_ff f (.) f`,
///
/// and the volumetric part `U = kappa/4 (J^2 - 1 - 2 log J)`, where the source has a body that keeps its volume.
///
/// **Stress and tangent.** `S_F = F S`, `S = C exp(Q) L E`; along changes of F with `a = sym(F^T A)`,
/// `S[a] = C exp(Q) (L a + 2 (LE : a) LE)`, `S[a, b] = C exp(Q) (2 (LE : b) L a + 2 (LE : a) L b + 2 (La : b) LE + 4 (LE : a)(LE : b) LE)`;
/// `S_F[A] = A S + F S[a]`. `P` and `dP/dF` by the chain rule of [`ConvexDensity`].
///
/// **Parameters.** `C > 0` and `kappa > 0` in Pa, `b_f, b_t, b_fs > 0` pure numbers, the unit vector `fiber`. Each a [`Field`]. `Q > 600` is refused as a
/// deformation beyond the domain ([`Outside`]): the energy would be no number.
///
/// **Convexity.** Not polyconvex: like every function of E that resists to compression it softens there. `W -> inf` as `J -> 0`. In the directions that stretch
/// it grows faster than any power.
///
/// **At rest.** `mu_T = C b_t/2`, `mu_L = C b_fs/2`, `lambda = kappa`, `beta = C (b_f + b_t - 2 b_fs)`.
///
/// **Source.** J. M. Guccione, A. D. McCulloch & L. K. Waldman, J. Biomech. Eng. 113 (1991) 42-55, doi 10.1115/1.2894084; in this form S. Land et al.,
/// Proc. R. Soc. A 471 (2015) 20150641, doi 10.1098/rspa.2015.0641, equations 2.1 and 2.2.
#[derive(Clone, Debug)]
pub struct Guccione {
    c: Field<f64>,
    b: [Field<f64>; 3],
    bulk: Field<f64>,
    fiber: Field<Vec3>,
}

/// `Q` beyond which the exponential is no longer evaluated.
const LARGEST: f64 = 600.0;
const B: [&str; 3] = ["bf", "bt", "bfs"];

impl Guccione {
    /// Name in case files and messages.
    pub const NAME: &str = "guccione";

    /// From `C` (Pa), `[b_f, b_t, b_fs]`, the bulk modulus (Pa) and the fibre.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless all numbers are positive; [`EnergyError::Direction`] unless `|f| = 1` to 1e-6.
    pub fn new(
        c: impl Into<Field<f64>>,
        b: [Field<f64>; 3],
        bulk: impl Into<Field<f64>>,
        fiber: impl Into<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let (c, bulk) = (c.into(), bulk.into());
        c.require_positive(Self::NAME, "c")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        b.iter().zip(B).try_for_each(|(b, name)| b.require_positive(Self::NAME, name))?;
        Ok(Self { c, b, bulk, fiber: fiber.into().unit_directions(Self::NAME, "fiber")? })
    }

    fn strained(&self, at: MaterialPoint, f: &Mat3) -> Strained {
        let [bf, bt, bfs] = [0, 1, 2].map(|k| self.b[k].at(at));
        let form = Form { fiber: self.fiber.at(at), factors: [bt, bfs - bt, bf + bt - 2.0 * bfs] };
        let e = (f.transpose() * f - Mat3::identity()) * 0.5;
        let le = form.of(&e);
        Strained { form, le, q: e.dot(&le), c: self.c.at(at) }
    }
}

/// The quadratic form Q.
struct Form {
    fiber: Vec3,
    factors: [f64; 3],
}

impl Form {
    /// `L E`
    fn of(&self, e: &Mat3) -> Mat3 {
        let ([all, along, own], f) = (self.factors, &self.fiber);
        let ef = e * f;
        let outer = f * ef.transpose();
        e * all + (outer + outer.transpose()) * along + f * f.transpose() * (own * f.dot(&ef))
    }
}

/// A state of strain.
struct Strained {
    form: Form,
    le: Mat3,
    q: f64,
    c: f64,
}

impl Strained {
    /// `S`
    fn stress(&self) -> Mat3 {
        self.le * (self.c * self.q.exp())
    }

    /// `S[a]`
    fn change(&self, a: &Mat3) -> Mat3 {
        (self.form.of(a) + self.le * (2.0 * self.le.dot(a))) * (self.c * self.q.exp())
    }

    /// `S[a, b]`
    fn second_change(&self, a: &Mat3, b: &Mat3) -> Mat3 {
        let (la, lb) = (self.form.of(a), self.form.of(b));
        let (by_a, by_b) = (self.le.dot(a), self.le.dot(b));
        let own = self.le * (2.0 * la.dot(b) + 4.0 * by_a * by_b);
        (la * (2.0 * by_b) + lb * (2.0 * by_a) + own) * (self.c * self.q.exp())
    }
}

/// `sym(F^T A)`
fn strain(f: &Mat3, a: &Mat3) -> Mat3 {
    let product = f.transpose() * a;
    (product + product.transpose()) * 0.5
}

impl ConvexDensity for Guccione {
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> f64 {
        let state = self.strained(at, f);
        0.5 * state.c * state.q.exp_m1() + volumetric(self.bulk.at(at), j)[0]
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Conjugates {
        let by_j = volumetric(self.bulk.at(at), j)[1];
        Conjugates { f: f * self.strained(at, f).stress(), h: Mat3::zeros(), j: by_j }
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let state = self.strained(at, f);
        let stress = state.stress();
        let ff = Tangent::from_map(|a| a * stress + f * state.change(&strain(f, a)));
        Curvature::split(Block::Full(Box::new(ff)), Block::Zero, volumetric(self.bulk.at(at), j)[2])
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        _h: &Mat3,
        j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let state = self.strained(at, f);
        let (ea, eb, eab) = (strain(f, &a.f), strain(f, &b.f), strain(&a.f, &b.f));
        let within = state.second_change(&ea, &eb) + state.change(&eab);
        let by_f = a.f * state.change(&eb) + b.f * state.change(&ea) + f * within;
        Ok(Conjugates { f: by_f, ..Conjugates::third_by_j(volumetric(self.bulk.at(at), j)[3], [a, b]) })
    }

    fn domain(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, _j: f64) -> Result<(), Outside> {
        let value = self.strained(at, f).q;
        if value <= LARGEST {
            return Ok(());
        }
        let (measure, meaning) = ("Q of its strain", "where exp(Q) is still a number");
        Err(Outside { law: Self::NAME, measure, value, limit: LARGEST, meaning, point: 0 })
    }

    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        let growth = Growth { p: 4.0, q: 0.0, r: 2.0 };
        Some(Existence { polyconvex: false, resists_collapse: true, growth })
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.c.check_len(Self::NAME, "c", cells, points)?;
        self.b.iter().zip(B).try_for_each(|(b, name)| b.check_len(Self::NAME, name, cells, points))?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)?;
        self.fiber.check_len(Self::NAME, "fiber", cells, points)
    }

    fn fiber(&self, at: MaterialPoint) -> Option<Vec3> {
        Some(self.fiber.at(at))
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let (c, [bf, bt, bfs]) = (self.c.at(at), [0, 1, 2].map(|k| self.b[k].at(at)));
        Some(Moduli {
            lambda: self.bulk.at(at),
            mu_t: 0.5 * c * bt,
            mu_l: 0.5 * c * bfs,
            alpha: 0.0,
            beta: c * (bf + bt - 2.0 * bfs),
            fiber: Some(self.fiber.at(at)),
        })
    }
}

impl LinearInModuli for Guccione {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("c", self.c.clone()), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        Guccione { c: theta[0].into(), bulk: theta[1].into(), ..self.clone() }
    }
}
