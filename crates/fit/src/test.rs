use nastic_energy::{EnergyTerm, PointBatch, Response as Answer, Slots, Want};
use nastic_tensor::{Kinematics, Mat3, Vec3};

use crate::FitError;

/// A homogeneous deformation of a material that keeps its volume (but for [`Volumetric`](Self::Volumetric)), by one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// `F = diag(l, l^(-1/2), l^(-1/2))`: tension or compression of a bar.
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

/// One test: pairs of deformation and response.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// For people.
    pub name: String,
    /// How the material was deformed.
    pub mode: Mode,
    /// What was measured.
    pub response: Response,
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

    /// The deformation gradient; `None` where there is none.
    pub(crate) fn state(self, x: f64) -> Option<Kinematics> {
        // det diag(l, l, l^-2) = 1 for negative l too
        if !x.is_finite() || (x <= 0.0 && self != Mode::SimpleShear) {
            return None;
        }
        let f = match self {
            Mode::Uniaxial => diagonal(x, x.powf(-0.5), x.powf(-0.5)),
            Mode::Equibiaxial | Mode::Inflation { .. } => diagonal(x, x, x.powi(-2)),
            Mode::Planar => diagonal(x, 1.0, 1.0 / x),
            Mode::SimpleShear => Mat3::new(1.0, x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            Mode::Volumetric => Mat3::from_diagonal_element(x.cbrt()),
        };
        Kinematics::new(f).ok()
    }

    pub(crate) fn is_rest(self, x: f64) -> bool {
        x == if self == Mode::SimpleShear { 0.0 } else { 1.0 }
    }

    /// The response is `A : P` with the stress P of the law: the pressure that keeps the volume, and so any volumetric part, drops out of
    /// `l1 P11 - l3 P33`.
    pub(crate) fn projection(self, response: Response, x: f64) -> Mat3 {
        let thickness = |free: f64, scale: f64| diagonal(scale, 0.0, -scale * free / x);
        let nominal = match self {
            Mode::Uniaxial => thickness(x.powf(-0.5), 1.0),
            Mode::Equibiaxial => thickness(x.powi(-2), 1.0),
            Mode::Inflation { thickness_to_radius } => thickness(x.powi(-2), 2.0 * thickness_to_radius / (x * x)),
            Mode::Planar => thickness(1.0 / x, 1.0),
            Mode::SimpleShear => Mat3::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            Mode::Volumetric => diagonal(-x.powf(-2.0 / 3.0), 0.0, 0.0),
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
        let test = Test { name: name.to_owned(), mode, response, points, weight: 1.0 };
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
        if let Mode::Inflation { thickness_to_radius } = self.mode {
            positive("thickness over radius", thickness_to_radius)?;
        }
        for (point, [x, y]) in self.points.iter().enumerate() {
            let wrong = |what, value, requirement| {
                Err(FitError::Point { test: self.name.clone(), point, what, value, requirement })
            };
            if self.mode.state(*x).is_none() {
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
pub fn curve(law: &dyn EnergyTerm, mode: Mode, response: Response, at: &[f64]) -> Vec<f64> {
    let one = |x: &f64| {
        let state = [mode.state(*x)?];
        let point = PointBatch { kinematics: &state, cell: 0, first: 0 };
        law.check_domain(&point).ok()?;
        let mut stress = [Mat3::zeros()];
        let mut answer = Answer { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        law.respond(&point, Slots::none(), Want::STRESS, &mut answer);
        Some(mode.projection(response, *x).dot(&stress[0]))
    };
    at.iter().map(|x| one(x).unwrap_or(f64::NAN)).collect()
}

fn diagonal(a: f64, b: f64, c: f64) -> Mat3 {
    Mat3::from_diagonal(&Vec3::new(a, b, c))
}
