use nastic_energy::EnergyTerm;
use nastic_tensor::{Mat3, Vec3};

use crate::FitError;
use crate::specimen::Specimen;

/// A homogeneous deformation of a material that keeps its volume (but for [`Volumetric`](Self::Volumetric)), by one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// `F = diag(l, l2, 1/(l l2))`: tension or compression of a bar whose sides are free; `l2 = l^(-1/2)` without fibres.
    Uniaxial,
    /// `F = diag(l, l, l^(-2))`.
    Equibiaxial,
    /// `F = diag(l, 1, 1/l)`: a wide strip, "pure shear".
    Planar,
    /// `F = I + g e1 e2`: the shear stress alone.
    SimpleShear,
    /// A thin spherical balloon of thickness H and radius R, stretched by l: pressure `2 (H/R) P / l^2`, P the nominal stress of equibiaxial tension.
    Inflation {
        /// `H/R` of the balloon at rest.
        thickness_to_radius: f64,
    },
    /// `F = J^(1/3) I`: pressure against the ratio of volumes; for [`bulk`](crate::bulk) alone.
    Volumetric,
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Force per area at rest, Pa.
    Nominal,
    /// Force per deformed area, Pa.
    Cauchy,
    /// Shear stress, Pa: nominal and Cauchy are the same.
    Shear,
    /// Pressure, Pa.
    Pressure,
}

/// How a specimen with fibres was loaded: direction 1 of the [`Mode`] along axis 1 of the law ([`Law`](crate::Law)) or axis 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fibers {
    /// Direction 1 is axis 1: along one family, along the bisector of two.
    #[default]
    Along,
    /// Direction 1 is axis 2, which lies in the plane of the fibres too.
    Across,
}

/// One test: pairs of deformation and response.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// For people.
    pub name: String,
    /// How the material was deformed.
    pub mode: Mode,
    /// What was measured.
    pub response: Response,
    /// How the specimen lay to its fibres, where it has some.
    pub fibers: Option<Fibers>,
    /// Deformation (a stretch, an amount of shear, a ratio of volumes) and response (Pa).
    pub points: Vec<[f64; 2]>,
    /// Weight of each of its squared residuals.
    pub weight: f64,
}

impl Mode {
    /// Its name in data files.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Uniaxial => "uniaxial",
            Mode::Equibiaxial => "equibiaxial",
            Mode::Planar => "planar",
            Mode::SimpleShear => "simple_shear",
            Mode::Inflation { .. } => "inflation",
            Mode::Volumetric => "volumetric",
        }
    }

    /// What its deformation is called.
    pub fn deformation(self) -> &'static str {
        match self {
            Mode::SimpleShear => "amount of shear",
            Mode::Volumetric => "volume ratio",
            _ => "stretch",
        }
    }

    /// The one of tension, equibiaxial tension and pure shear whose deformations it has, simple shear up to a rotation; none of volumetric tests.
    pub fn kind(self) -> Option<Mode> {
        match self {
            Mode::Uniaxial => Some(Mode::Uniaxial),
            Mode::Equibiaxial | Mode::Inflation { .. } => Some(Mode::Equibiaxial),
            Mode::Planar | Mode::SimpleShear => Some(Mode::Planar),
            Mode::Volumetric => None,
        }
    }

    /// The deformation gradient of a material without fibres; `None` where there is none.
    pub(crate) fn gradient(self, x: f64) -> Option<Mat3> {
        // det diag(l, l, l^-2) = 1 for negative l too
        if !x.is_finite() || (x <= 0.0 && self != Mode::SimpleShear) {
            return None;
        }
        Some(match self {
            Mode::Uniaxial => diagonal(x, x.powf(-0.5), x.powf(-0.5)),
            Mode::Equibiaxial | Mode::Inflation { .. } => diagonal(x, x, x.powi(-2)),
            Mode::Planar => diagonal(x, 1.0, 1.0 / x),
            Mode::SimpleShear => Mat3::new(1.0, x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            Mode::Volumetric => Mat3::from_diagonal_element(x.cbrt()),
        })
    }

    pub(crate) fn is_rest(self, x: f64) -> bool {
        x == if self == Mode::SimpleShear { 0.0 } else { 1.0 }
    }

    /// The response is `A : P` with the stress P of the law: the pressure that keeps the volume, and so any volumetric part, drops out of
    /// `l1 P11 - l3 P33`. `l3` is the stretch of the thickness.
    pub(crate) fn projection(self, response: Response, x: f64, l3: f64) -> Mat3 {
        let thickness = |scale: f64| diagonal(scale, 0.0, -scale * l3 / x);
        let nominal = match self {
            Mode::Uniaxial | Mode::Equibiaxial | Mode::Planar => thickness(1.0),
            Mode::Inflation { thickness_to_radius } => thickness(2.0 * thickness_to_radius / (x * x)),
            Mode::SimpleShear => Mat3::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            Mode::Volumetric => Mat3::from_diagonal_element(-x.powf(-2.0 / 3.0) / 3.0),
        };
        if response == Response::Cauchy { nominal * x } else { nominal }
    }

    /// Whether a test of this mode may give it.
    pub fn takes(self, response: Response) -> bool {
        match self {
            Mode::Uniaxial | Mode::Equibiaxial | Mode::Planar => {
                matches!(response, Response::Nominal | Response::Cauchy)
            }
            Mode::SimpleShear => response == Response::Shear,
            Mode::Inflation { .. } | Mode::Volumetric => response == Response::Pressure,
        }
    }

    fn gives(self) -> &'static str {
        match self {
            Mode::Uniaxial | Mode::Equibiaxial | Mode::Planar => "a nominal or a Cauchy stress",
            Mode::SimpleShear => "a shear stress",
            Mode::Inflation { .. } | Mode::Volumetric => "a pressure",
        }
    }
}

impl Response {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Response::Nominal => "a nominal stress",
            Response::Cauchy => "a Cauchy stress",
            Response::Shear => "a shear stress",
            Response::Pressure => "a pressure",
        }
    }
}

impl Test {
    /// A test of weight 1.
    ///
    /// # Errors
    /// [`FitError::Response`] of another mode; [`FitError::Point`] for a stretch or ratio that is not positive, or what is not finite;
    /// [`FitError::Setting`] for a ratio of thickness to radius that is not positive.
    pub fn new(name: &str, mode: Mode, response: Response, points: Vec<[f64; 2]>) -> Result<Self, FitError> {
        if !mode.takes(response) {
            let (mode, expected, found) = (mode.name(), mode.gives(), response.name());
            return Err(FitError::Response { test: name.to_owned(), mode, expected, found });
        }
        let test = Test { name: name.to_owned(), mode, response, fibers: None, points, weight: 1.0 };
        test.check().map(|()| test)
    }

    /// With another weight.
    ///
    /// # Errors
    /// [`FitError::Setting`] for a weight that is not a positive number.
    pub fn weighted(self, weight: f64) -> Result<Self, FitError> {
        let test = Test { weight, ..self };
        test.check().map(|()| test)
    }

    /// Of a specimen with fibres.
    ///
    /// # Errors
    /// [`FitError::Fibers`] of a balloon, which does not stay a sphere, and of volumetric tests, which give the bulk modulus alone.
    pub fn loaded(self, fibers: Fibers) -> Result<Self, FitError> {
        let test = Test { fibers: Some(fibers), ..self };
        test.check().map(|()| test)
    }

    /// How many points are at rest, where every law is free of stress: fits leave them out.
    pub fn at_rest(&self) -> usize {
        self.points.iter().filter(|[x, _]| self.mode.is_rest(*x)).count()
    }

    /// What [`new`](Self::new) and [`weighted`](Self::weighted) promise; fields are public, so that fits check it too.
    pub(crate) fn check(&self) -> Result<(), FitError> {
        let positive = |what, value: f64| {
            let (test, requirement) = (self.name.clone(), "it must be a positive number");
            let good = value > 0.0 && value.is_finite();
            if good { Ok(()) } else { Err(FitError::Setting { test, what, value, requirement }) }
        };
        positive("weight", self.weight)?;
        let (test, mode) = (self.name.clone(), self.mode.name());
        match (self.fibers, self.mode) {
            (Some(_), Mode::Inflation { .. }) => {
                return Err(FitError::Fibers { test, mode, why: "a balloon with fibres does not stay a sphere" });
            }
            (Some(_), Mode::Volumetric) => {
                return Err(FitError::Fibers { test, mode, why: "it gives the bulk modulus alone" });
            }
            _ => {}
        }
        if let Mode::Inflation { thickness_to_radius } = self.mode {
            positive("thickness over radius", thickness_to_radius)?;
        }
        for (point, [x, y]) in self.points.iter().enumerate() {
            let wrong = |what, value, requirement| {
                Err(FitError::Point { test: self.name.clone(), point, what, value, requirement })
            };
            if self.mode.gradient(*x).is_none() {
                let shear = self.mode == Mode::SimpleShear;
                let requirement = if shear { "it must be a finite number" } else { "it must be positive and finite" };
                return wrong(self.mode.deformation(), *x, requirement);
            }
            if !y.is_finite() {
                return wrong("response", *y, "it must be a finite number");
            }
        }
        Ok(())
    }
}

/// The response of a law at some deformations, NaN where it has none: a curve to be drawn.
pub fn curve(law: &dyn EnergyTerm, mode: Mode, fibers: Fibers, response: Response, at: &[f64]) -> Vec<f64> {
    let one = |x: &f64| {
        let specimen = Specimen { law, fibers };
        let f = specimen.gradient(mode, *x)?;
        Some(specimen.turn(mode.projection(response, *x, f[(2, 2)])).dot(&specimen.stress(f)?))
    };
    at.iter().map(|x| one(x).unwrap_or(f64::NAN)).collect()
}

/// `1 - sum (y - measured)^2 / sum (measured - mean)^2` over all points of a test: 1 of a law that meets them, below 0 of one that is worse than their mean. `None` where the law has no response, or the
/// points no spread.
pub fn r_squared(law: &dyn EnergyTerm, test: &Test) -> Option<f64> {
    let at: Vec<f64> = test.points.iter().map(|[x, _]| *x).collect();
    let model = curve(law, test.mode, test.fibers.unwrap_or_default(), test.response, &at);
    let mean = test.points.iter().map(|[_, y]| y).sum::<f64>() / test.points.len() as f64;
    let squares = |of: &dyn Fn(usize, f64) -> f64| -> f64 {
        test.points.iter().enumerate().map(|(n, [_, y])| of(n, *y).powi(2)).sum()
    };
    let (rest, spread) = (squares(&|n, y| model[n] - y), squares(&|_, y| y - mean));
    let share = 1.0 - rest / spread;
    share.is_finite().then_some(share)
}

fn diagonal(a: f64, b: f64, c: f64) -> Mat3 {
    Mat3::from_diagonal(&Vec3::new(a, b, c))
}
