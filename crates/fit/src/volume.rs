use crate::{Fibers, FitError, Law, Mode, Response, Test, curve, student};

/// A bulk modulus from volumetric tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulk {
    /// Pa.
    pub value: f64,
    /// Standard deviation, Pa; `None` for a single point.
    pub deviation: Option<f64>,
    /// Half-width of the 95 % confidence interval.
    pub half_width: Option<f64>,
}

/// The bulk modulus of least squares for volumetric tests of a law whose other parameters are known. The pressure of every law is affine in it: a
/// linear problem.
///
/// # Errors
/// [`FitError::Volume`] without a change of volume, or for data that no positive bulk modulus fits; parameters that the law refuses.
pub fn bulk(law: Law, parameters: &[f64], tests: &[Test]) -> Result<Bulk, FitError> {
    let volumetric = || tests.iter().filter(|test| test.mode == Mode::Volumetric);
    let trial = 1e3 * law.shear(parameters)?;
    let (mut along, mut own, mut n) = (0.0, 0.0, 0.0);
    let mut rows = Vec::new();
    for test in volumetric() {
        test.check()?;
        let [low, high] = [trial, 2.0 * trial].map(|bulk| pressures(law, parameters, bulk, &test.points));
        for (([x, y], low), high) in
            test.points.iter().zip(low?).zip(high?).filter(|((point, _), _)| !test.mode.is_rest(point[0]))
        {
            let slope = (high - low) / trial;
            let rest = y - (low - slope * trial);
            along += test.weight * slope * rest;
            own += test.weight * slope * slope;
            n += 1.0;
            rows.push((slope, rest, test.weight, *x));
        }
    }
    if own == 0.0 {
        return Err(FitError::Volume("no point has another volume than at rest".to_owned()));
    }
    let value = along / own;
    if value <= 0.0 {
        let why = format!(
            "the bulk modulus of least squares is {value:.4e} Pa, which must be positive; pressures are positive where the volume ratio is below 1"
        );
        return Err(FitError::Volume(why));
    }
    let squares: f64 = rows.iter().map(|(slope, rest, weight, _)| weight * (rest - slope * value).powi(2)).sum();
    let deviation = (n > 1.0).then(|| (squares / (n - 1.0) / own).sqrt());
    law.build(parameters, value)?;
    Ok(Bulk { value, deviation, half_width: deviation.map(|d| student(n - 1.0) * d) })
}

/// Pressures (Pa) of a law at the volume ratios of volumetric points.
fn pressures(law: Law, parameters: &[f64], bulk: f64, points: &[[f64; 2]]) -> Result<Vec<f64>, FitError> {
    let ratios: Vec<f64> = points.iter().map(|[x, _]| *x).collect();
    Ok(curve(&*law.build(parameters, bulk)?, Mode::Volumetric, Fibers::Along, Response::Pressure, &ratios))
}
