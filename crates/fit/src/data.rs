//! [`Data`]: all points of all tests as one problem of least squares.

use nastic_energy::{EnergyTerm, MaterialPoint};
use nastic_tensor::{Mat3, Vec3};

use crate::law::{Scale, unit_law};
use crate::specimen::{Specimen, turned};
use crate::{Errors, Fibers, FitError, Law, Mode, Response, Test, curve};

/// All points of all tests.
pub(crate) struct Data {
    points: Vec<Point>,
    pub targets: Vec<f64>,
    /// Factors of the residuals.
    pub factors: Vec<f64>,
    /// Largest response: residuals are shares of it.
    pub unit: f64,
}

/// What was done to the material, and what was measured.
#[derive(Clone, Copy)]
struct Point {
    mode: Mode,
    fibers: Fibers,
    response: Response,
    x: f64,
}

impl Data {
    pub fn new(law: Law, tests: &[Test], errors: Errors) -> Result<Self, FitError> {
        let mut out = Data { points: vec![], targets: vec![], factors: vec![], unit: 1.0 };
        for test in tests.iter().filter(|test| test.mode != Mode::Volumetric) {
            test.check()?;
            check_signs(test)?;
            if law.has_fibers() && test.fibers.is_none() {
                return Err(FitError::NoFibers { law: law.label(), test: test.name.clone() });
            }
            let most = test.points.iter().fold(0.0f64, |most, [_, y]| most.max(y.abs()));
            for [x, y] in &test.points {
                // at rest every law is free of stress: nothing to learn
                if test.mode.is_rest(*x) {
                    continue;
                }
                if errors == Errors::Relative && most == 0.0 {
                    return Err(FitError::ZeroTest { test: test.name.clone() });
                }
                let size = if errors == Errors::Relative { y.abs().max(0.05 * most) } else { 1.0 };
                let Test { mode, response, fibers, .. } = test;
                let fibers = fibers.unwrap_or_default();
                out.points.push(Point { mode: *mode, fibers, response: *response, x: *x });
                out.targets.push(*y);
                out.factors.push(test.weight.sqrt() / size);
            }
        }
        let scaled = out.targets.iter().zip(&out.factors);
        out.unit = scaled.map(|(y, factor)| (y * factor).abs()).fold(0.0, f64::max);
        Ok(out)
    }

    /// The neo-Hookean modulus of least squares, and the largest `I1 - 3`.
    pub fn scale(&self) -> Result<Scale, FitError> {
        let curve = self.responses(&unit_law()?).unwrap_or_default();
        let (mut along, mut own) = (0.0, 0.0);
        for ((a, y), factor) in curve.iter().zip(&self.targets).zip(&self.factors) {
            along += factor * factor * a * y;
            own += factor * factor * a * a;
        }
        let gradients = self.points.iter().filter_map(|point| point.mode.gradient(point.x));
        let reach = gradients.map(|f| f.norm_squared() - 3.0).fold(0.0, f64::max);
        let shear = along / own;
        match shear {
            _ if self.unit == 0.0 => Err(FitError::NoStress),
            _ if shear > 0.0 && reach > 0.0 => Ok(Scale { shear, reach }),
            _ => Err(FitError::NegativeShear { shear }),
        }
    }

    /// Responses of a law; `None` where a point lies beyond its domain.
    fn responses(&self, law: &dyn EnergyTerm) -> Option<Vec<f64>> {
        self.answers(law, &self.gradients(law)?).map(|[answers, _]| answers)
    }

    /// Whether sides of bars follow the law: those of a law with a direction.
    pub fn has_free_sides(&self, law: &dyn EnergyTerm) -> bool {
        law.direction(MaterialPoint { cell: 0, point: 0 }).is_some()
            && self.points.iter().any(|point| point.mode == Mode::Uniaxial)
    }

    /// Deformation gradients of all points, in the axes of the law; `None` where there is none.
    pub fn gradients(&self, law: &dyn EnergyTerm) -> Option<Vec<Mat3>> {
        self.points.iter().map(|point| Specimen { law, fibers: point.fibers }.gradient(point.mode, point.x)).collect()
    }

    /// The same bars with sides `l2 exp(step)` and `l3 exp(-step)`.
    pub fn thinned(&self, gradients: &[Mat3], step: f64) -> Vec<Mat3> {
        let change = Mat3::from_diagonal(&Vec3::new(1.0, step.exp(), (-step).exp()));
        let of = |(point, f): (&Point, &Mat3)| {
            if point.mode == Mode::Uniaxial { turned(point.fibers, change) * f } else { *f }
        };
        self.points.iter().zip(gradients).map(of).collect()
    }

    /// Responses of a law at deformation gradients in its axes, and of bars tau_2 - tau_3; `None` where one lies beyond its domain.
    pub fn answers(&self, law: &dyn EnergyTerm, gradients: &[Mat3]) -> Option<[Vec<f64>; 2]> {
        // in the axes of the law, so that the batch may hold specimens of either kind
        let stress = Specimen { law, fibers: Fibers::Along }.stresses(gradients)?;
        let (mut answers, mut across) = (Vec::with_capacity(stress.len()), Vec::with_capacity(stress.len()));
        for ((point, f), p) in self.points.iter().zip(gradients).zip(&stress) {
            let projection = turned(point.fibers, point.mode.projection(point.response, point.x, f[(2, 2)]));
            answers.push(projection.dot(p));
            let tau = turned(point.fibers, p * f.transpose());
            across.push(if point.mode == Mode::Uniaxial { tau[(1, 1)] - tau[(2, 2)] } else { 0.0 });
        }
        answers.iter().chain(&across).all(|y| y.is_finite()).then_some([answers, across])
    }

    pub fn residuals(&self, law: &dyn EnergyTerm) -> Option<Vec<f64>> {
        self.responses(law).map(|model| self.residuals_of(&model))
    }

    /// Those of responses.
    pub fn residuals_of(&self, model: &[f64]) -> Vec<f64> {
        let measured = self.targets.iter().zip(&self.factors);
        model.iter().zip(measured).map(|(y, (target, factor))| (y - target) * factor / self.unit).collect()
    }
}

/// Whether any response has the sign that every law gives it: that of the neo-Hookean one.
fn check_signs(test: &Test) -> Result<(), FitError> {
    let at: Vec<f64> = test.points.iter().map(|[x, _]| *x).collect();
    let expected = curve(&unit_law()?, test.mode, Fibers::Along, test.response, &at);
    let signs = || expected.iter().zip(&test.points).map(|(a, [_, y])| a * y).filter(|product| *product != 0.0);
    let points = signs().count();
    if points > 0 && signs().all(|product| product < 0.0) {
        return Err(FitError::WrongSign { test: test.name.clone(), points });
    }
    Ok(())
}
