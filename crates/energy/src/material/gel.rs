use nastic_tensor::Mat3;

use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, Outside, TensionBound, combine,
};

/// Hydrogel in equilibrium with a solvent: a Gaussian network and the mixing of Flory and Huggins. Diffusion is not solved.
///
/// **Energy.** Per volume of the reference, which is a free gel swollen by the stretch s over the dry network, with `x = s^3 J`,
///
/// ```text
/// W = N/(2 s) (|F|^2 - 3) - N/s^3 log J + c/s^3 (h(x) - h(s^3)) - p0 (J - 1)      h(x) = (x - 1) log(1 - 1/x) + chi (1 - 1/x)
/// p0 = N (1/s - 1/s^3) + c h'(s^3)                                                 h'(x) = log(1 - 1/x) + 1/x + chi / x^2
/// ```
///
/// infinite for `x <= 1`, where no solvent is left ([`Outside`]). `p0 = c mu0 / kT`, so that it has no stress at rest: mu0 is the chemical potential of the
/// solvent there. That of another solvent, `mu`, is a [`Turgor`](crate::Turgor) of the pressure `c (mu - mu0) / kT`.
///
/// **Stress and tangent.** `S_F = N/s F`, `S_J = c h'(x) - N/(s^3 J) - p0`; `W_FF = N/s I`, `W_JJ = N/(s^3 J^2) + c s^3 h''(x)`,
/// `W_JJJ = -2 N/(s^3 J^3) + c s^6 h'''(x)`, no mixed parts; `P` and `dP/dF` by the chain rule of [`ConvexDensity`]. Small strain: `mu = N/s`,
/// `lambda = W_JJ(1) - mu`.
///
/// **Convexity.** Polyconvex for `chi <= 1/2`, which is required: `h'' = (x - 2 chi (x - 1)) / (x^3 (x - 1)) > 0`. A fibre tension keeps it
/// polyconvex exactly up to `m = N/s`.
///
/// **Parameters.** `network` N k T, shear modulus of the dry network, and `mixing` c = k T / v, v the volume of a molecule of the solvent (136 MPa in water
/// at 25 degrees Celsius), in Pa; `chi`, a pure number; `swelling` s > 1, or, without it, that of a free gel in pure solvent, `mu0 = 0`, with the moduli as they are written. Each a [`Field`].
///
/// **Source.** P. J. Flory, J. Rehner, J. Chem. Phys. 11 (1943) 521-526; W. Hong, Z. Liu, Z. Suo, Int. J. Solids Struct. 46 (2009) 3282-3289,
/// doi 10.1016/j.ijsolstr.2009.04.022, equations 9 to 14.
#[derive(Clone, Debug)]
pub struct Gel {
    network: Field<f64>,
    mixing: Field<f64>,
    chi: Field<f64>,
    swelling: Field<f64>,
}

/// The law at a point.
struct Here {
    network: f64,
    mixing: f64,
    chi: f64,
    swelling: f64,
    /// Cube of it.
    volume: f64,
}

/// h' of chi at x.
fn slope(chi: f64, x: f64) -> f64 {
    let polymer = 1.0 / x;
    (-polymer).ln_1p() + polymer + chi * polymer * polymer
}

impl Here {
    fn pressure_at_rest(&self) -> f64 {
        let elastic = 1.0 / self.swelling - 1.0 / self.volume;
        self.network * elastic + self.mixing * slope(self.chi, self.volume)
    }

    fn mixed(&self, x: f64) -> f64 {
        (x - 1.0) * (-1.0 / x).ln_1p() + self.chi * (1.0 - 1.0 / x)
    }

    /// W_JJ
    fn curvature(&self, j: f64) -> f64 {
        let x = self.volume * j;
        let mixing = (x - 2.0 * self.chi * (x - 1.0)) / (x.powi(3) * (x - 1.0));
        self.network / (self.volume * j * j) + self.mixing * self.volume * mixing
    }
}

impl Gel {
    /// Name in case files and messages.
    pub const NAME: &str = "gel";
    /// Bound of the volume ratio of a gel that swells freely.
    const LARGEST_SWELLING: f64 = 1e9;

    /// A chemical potential below this part of kT is zero.
    const ROUNDING: f64 = 1e-12;

    /// With a reference swollen by a stretch over the dry network.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `network > 0`, `mixing > 0` (Pa), `chi <= 1/2`, `swelling > 1`, all finite.
    pub fn new(
        network: impl Into<Field<f64>>,
        mixing: impl Into<Field<f64>>,
        chi: impl Into<Field<f64>>,
        swelling: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let law = Self { network: network.into(), mixing: mixing.into(), chi: chi.into(), swelling: swelling.into() };
        law.network.require_positive(Self::NAME, "network")?;
        law.mixing.require_positive(Self::NAME, "mixing")?;
        let requirement = "it must be at most 1/2, beyond which the energy is not polyconvex";
        law.chi.require(Self::NAME, "chi", |chi| chi <= 0.5, requirement)?;
        let requirement = "it must be above 1: a dry network, J = 1, has no solvent to mix with";
        law.swelling.require(Self::NAME, "swelling", |stretch| stretch > 1.0, requirement)?;
        Ok(law)
    }

    /// With a reference that is swollen freely in pure solvent.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn in_solvent(
        network: impl Into<Field<f64>>,
        mixing: impl Into<Field<f64>>,
        chi: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (network, mixing, chi) = (network.into(), mixing.into(), chi.into());
        // what they must fulfil comes before what follows from them
        Self::new(network.clone(), mixing.clone(), chi.clone(), 2.0)?;
        let named = [("network", &network), ("mixing", &mixing), ("chi", &chi)];
        let [swelling] = combine(Self::NAME, named, |_, [n, c, chi]| Ok([Self::free_swelling(n / c, chi)]))?;
        Self::new(network, mixing, chi, swelling)
    }

    /// The stretch s over the dry network with `h'(s^3) + n (1/s - 1/s^3) = 0`, by bisection: the left side rises from minus infinity and is positive
    /// in the end.
    fn free_swelling(n: f64, chi: f64) -> f64 {
        let excess = |x: f64| slope(chi, x) + n * (1.0 / x.cbrt() - 1.0 / x);
        let (mut low, mut high) = (1.0_f64, Self::LARGEST_SWELLING);
        for _ in 0..200 {
            let middle = 1.0 + ((low - 1.0).max(1e-15) * (high - 1.0)).sqrt();
            if excess(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high.cbrt()
    }

    fn here(&self, at: MaterialPoint) -> Here {
        let swelling = self.swelling.at(at);
        Here {
            network: self.network.at(at),
            mixing: self.mixing.at(at),
            chi: self.chi.at(at),
            swelling,
            volume: swelling.powi(3),
        }
    }
}

impl ConvexDensity for Gel {
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> f64 {
        let own = self.here(at);
        let mixed = own.mixing * (own.mixed(own.volume * j) - own.mixed(own.volume)) / own.volume;
        0.5 * own.network / own.swelling * (f.norm_squared() - 3.0) - own.network / own.volume * j.ln() + mixed
            - own.pressure_at_rest() * (j - 1.0)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Conjugates {
        let own = self.here(at);
        let mixing = own.mixing * slope(own.chi, own.volume * j);
        let by_j = mixing - own.network / (own.volume * j) - own.pressure_at_rest();
        Conjugates { f: f * (own.network / own.swelling), h: Mat3::zeros(), j: by_j }
    }

    fn second(&self, at: MaterialPoint, _f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let own = self.here(at);
        Curvature::split(Block::Isotropic(own.network / own.swelling), Block::Zero, own.curvature(j))
    }

    fn third(
        &self,
        at: MaterialPoint,
        _f: &Mat3,
        _h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let own = self.here(at);
        let x = own.volume * j;
        let mixing = 6.0 * own.chi / x.powi(4) - (3.0 * x - 2.0) / (x.powi(3) * (x - 1.0).powi(2));
        let by_j = own.mixing * own.volume.powi(2) * mixing - 2.0 * own.network / (own.volume * j.powi(3));
        Ok(Conjugates::third_by_j(by_j, along))
    }

    fn domain(&self, at: MaterialPoint, _f: &Mat3, _h: &Mat3, j: f64) -> Result<(), Outside> {
        let value = 1.0 / (self.swelling.at(at).powi(3) * j);
        if value < 1.0 {
            return Ok(());
        }
        let meaning = "where no solvent is left and only the dry network is";
        Err(Outside { law: Self::NAME, measure: "1 / (swelling^3 J)", value, limit: 1.0, meaning, point: 0 })
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        // -p0 J outweighs |F|^2 where p0 is positive; that of a reference in pure solvent is zero up to rounding
        let own = self.here(at);
        let p = if own.pressure_at_rest() > Self::ROUNDING * own.mixing { 0.0 } else { 2.0 };
        Some(Existence { polyconvex: true, resists_collapse: true, growth: Growth { p, q: 0.0, r: 0.0 } })
    }

    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        let own = self.here(at);
        Some(TensionBound::isotropic(own.network / own.swelling))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.network.check_len(Self::NAME, "network", cells, points)?;
        self.mixing.check_len(Self::NAME, "mixing", cells, points)?;
        self.chi.check_len(Self::NAME, "chi", cells, points)?;
        self.swelling.check_len(Self::NAME, "swelling", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let own = self.here(at);
        let mu = own.network / own.swelling;
        Some(Moduli::isotropic(own.curvature(1.0) - mu, mu))
    }
}

impl LinearInModuli for Gel {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("network", self.network.clone()), ("mixing", self.mixing.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        Gel { network: theta[0].into(), mixing: theta[1].into(), ..self.clone() }
    }
}
