use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra_of_levenberg_marquardt::{DMatrix, DVector, Dyn, Owned};
use nastic_numeric::Random;

use crate::data::Data;
use crate::law::Scale;
use crate::network::NetworkData;
use crate::statistics::covariance;
use crate::{Criteria, Estimate, FitError, Law, Test, student};

/// What residuals are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Errors {
    /// Pa: large stresses count most.
    #[default]
    Absolute,
    /// Shares of the measured value, or of a twentieth of the test's largest where that is more: small stresses count as much.
    Relative,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// What residuals are measured in.
    pub errors: Errors,
    /// Random starts of Ogden's law and of networks.
    pub starts: usize,
    /// Of the random numbers.
    pub seed: u64,
    /// Evaluations of the residuals that a start may take, for each parameter and one more.
    pub patience: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions { errors: Errors::Absolute, starts: 16, seed: 1, patience: 200 }
    }
}

/// The parameters of least squares, and what they are worth.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The law.
    pub law: Law,
    /// Its parameters without the bulk modulus.
    pub parameters: Vec<Estimate>,
    /// Correlation of each pair of parameters, row by row; `None` where one has no deviation.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Weighted sum of squared residuals: Pa^2 with absolute errors.
    pub squares: f64,
    /// Number of points.
    pub points: usize,
    /// `sqrt(S / (n - k))`: the scatter about the curve.
    pub scatter: f64,
    /// For comparisons with other laws.
    pub criteria: Criteria,
    /// Where its starts ended.
    pub starts: Starts,
    pub(crate) free: Free,
}

/// Where the starts of a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Starts {
    /// How many there were.
    pub tried: usize,
    /// How many converged.
    pub converged: usize,
    /// How many ran out of evaluations.
    pub exhausted: usize,
    /// How many of either led to the sum of squares of the best (to a thousandth).
    pub alike: usize,
    /// Whether the best one ran out of evaluations: its parameters may not be those of least squares.
    pub best_exhausted: bool,
}

/// The fit in free numbers.
#[derive(Clone, Debug)]
pub(crate) struct Free {
    pub x: Vec<f64>,
    pub signs: Vec<f64>,
    pub scale: Scale,
    pub covariance: Option<DMatrix<f64>>,
}

impl Fit {
    /// The values of the parameters.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}

/// Fits a law to all tests but volumetric ones.
///
/// The Levenberg-Marquardt method of MINPACK (J. J. Moré, 1978) on free numbers that are taken smoothly to admissible parameters, from several
/// starts, of which the best is kept; the same input gives the same bits. Intervals and correlation are those of the linearised problem
/// (Gauss-Newton): they hold for scatter that is normal and alike at all points after weighting, and not where a parameter lies on the
/// border of what its law admits, whose deviation is then `None`.
///
/// # Errors
/// [`FitError::NoStress`], [`FitError::WrongSign`], [`FitError::NegativeShear`], [`FitError::ZeroTest`], [`FitError::TooFew`],
/// [`FitError::NotConverged`], [`FitError::Exhausted`]; what [`Test::new`] refuses.
pub fn fit(law: Law, tests: &[Test], options: &FitOptions) -> Result<Fit, FitError> {
    let data = Data::new(law, tests, options.errors)?;
    let (points, parameters) = (data.targets.len(), law.parameters().len());
    if points <= parameters {
        return Err(FitError::TooFew { law: law.label(), parameters, points });
    }
    let scale = data.scale()?;
    let network = NetworkData::new(law, &data)?;
    let starts = law.starts(&mut Random::new(options.seed), options.starts);
    let tried = starts.len();
    let (mut ends, mut why): (Vec<End<'_>>, _) = (Vec::new(), String::new());
    for (x, signs) in starts {
        let problem = Problem { law, data: &data, network: network.as_ref(), scale, signs, x: DVector::from_vec(x) };
        let patience = if law.is_network() { options.patience.div_ceil(NETWORK_PATIENCE) } else { options.patience };
        let tolerance = if law.is_network() { NETWORK_TOLERANCE } else { 1e-13 };
        let method = LevenbergMarquardt::new().with_tol(tolerance).with_patience(patience.max(1));
        let (problem, report) = method.minimize(problem);
        let reason = report.termination;
        let exhausted = reason == TerminationReason::LostPatience;
        let done =
            exhausted || reason.was_successful() || matches!(reason, TerminationReason::NoImprovementPossible(_));
        match problem.sum_of_squares() {
            Some(squares) if done => ends.push(End { squares, exhausted, problem }),
            _ => why = failure(&reason),
        }
    }
    ends.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    let exhausted = ends.iter().filter(|end| end.exhausted).count();
    let converged = ends.len() - exhausted;
    if converged == 0 && exhausted > 0 && !law.is_network() {
        return Err(FitError::Exhausted { law: law.label(), starts: tried, exhausted });
    }
    let Some(least) = ends.first().map(|end| end.squares) else {
        return Err(FitError::NotConverged { law: law.label(), starts: tried, why });
    };
    let alike = ends.iter().filter(|end| end.squares <= least * 1.001).count();
    let best = ends.swap_remove(0);
    let starts = Starts { tried, converged, exhausted, alike, best_exhausted: best.exhausted };
    Ok(best.problem.sorted().assess(best.squares, starts))
}

/// Why a start led nowhere, in words.
fn failure(reason: &TerminationReason) -> String {
    match reason {
        TerminationReason::User(_) | TerminationReason::Numerical(_) => {
            "the law has no response, or none that is finite, at parameters that it was tried with".to_owned()
        }
        other => format!("{other:?}"),
    }
}

/// Where a start ended.
struct End<'a> {
    squares: f64,
    exhausted: bool,
    problem: Problem<'a>,
}

/// The weighted sum of squares of any parameters: what [`fit`] makes least.
///
/// # Errors
/// Parameters that the law refuses, or a test beyond its domain ([`FitError::NotConverged`]).
pub fn squares(law: Law, parameters: &[f64], tests: &[Test], errors: Errors) -> Result<f64, FitError> {
    let data = Data::new(law, tests, errors)?;
    let residuals = data.residuals(&*law.incompressible(parameters)?);
    let why = "a test lies beyond the domain of the law".to_owned();
    let residuals = residuals.ok_or(FitError::NotConverged { law: law.label(), starts: 0, why })?;
    Ok(residuals.iter().map(|r| r * r).sum::<f64>() * data.unit * data.unit)
}

/// The numbers of a network are not determined one by one: its starts end where the sum of squares falls by less than this share, or earlier than others by this factor.
const NETWORK_TOLERANCE: f64 = 1e-7;
const NETWORK_PATIENCE: usize = 4;

/// Of differences, by numbers of the order of one.
const STEP: f64 = 1e-4;

/// Central differences of fourth order about zero.
fn slope(at: &dyn Fn(f64) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
    let [one, back, two, far] = [at(STEP)?, at(-STEP)?, at(2.0 * STEP)?, at(-2.0 * STEP)?];
    let of = |i: usize| (8.0 * (one[i] - back[i]) - (two[i] - far[i])) / (12.0 * STEP);
    Some((0..one.len()).map(of).collect())
}

/// The problem as the method sees it: residuals as functions of free numbers.
struct Problem<'a> {
    law: Law,
    data: &'a Data,
    network: Option<&'a NetworkData>,
    scale: Scale,
    signs: Vec<f64>,
    x: DVector<f64>,
}

/// A residual that no step is taken for: of free numbers without a law.
const FAR: f64 = 1e8;

impl Problem<'_> {
    fn decoded(&self, x: &[f64]) -> Vec<f64> {
        self.law.decode(x, &self.scale, &self.signs)
    }

    fn at(&self, x: &[f64]) -> Option<Vec<f64>> {
        if let Some(network) = self.network {
            return network.responses(&self.decoded(x)).map(|model| self.data.residuals_of(&model));
        }
        self.data.residuals(&*self.law.incompressible(&self.decoded(x)).ok()?)
    }

    fn sum_of_squares(&self) -> Option<f64> {
        let residuals = self.at(self.x.as_slice())?;
        Some(residuals.iter().map(|r| r * r).sum::<f64>() * self.data.unit * self.data.unit)
    }

    /// Derivatives by the free numbers.
    fn derivatives(&self, of: &dyn Fn(&[f64]) -> Option<Vec<f64>>) -> Option<DMatrix<f64>> {
        let columns = (0..self.x.len()).map(|k| {
            let at = |step: f64| {
                let mut x = self.x.as_slice().to_vec();
                x[k] += step;
                of(&x)
            };
            slope(&at).map(DVector::from_vec)
        });
        Some(DMatrix::from_columns(&columns.collect::<Option<Vec<_>>>()?))
    }

    /// Derivatives of the residuals. The sides of a bar with fibres follow the law, by `tau_2 - tau_3 = g(e, x) = 0` for `e = ln l2`: with the bar held as it is,
    /// and `de/dx = -(dg/dx) / (dg/de)`, instead of a search for its sides at every difference.
    fn slopes(&self) -> Option<DMatrix<f64>> {
        if let Some(network) = self.network {
            let mut slopes = network.slopes(&self.decoded(self.x.as_slice()));
            for (k, mut column) in slopes.column_iter_mut().enumerate() {
                let own = self.law.weight_slope(k, self.x[k], &self.scale);
                column.iter_mut().zip(&self.data.factors).for_each(|(y, factor)| *y *= own * factor / self.data.unit);
            }
            return slopes.iter().all(|slope| slope.is_finite()).then_some(slopes);
        }
        let law_at = |x: &[f64]| self.law.incompressible(&self.decoded(x)).ok();
        let law = law_at(self.x.as_slice())?;
        if !self.data.has_free_sides(&*law) {
            return self.derivatives(&|x| self.at(x));
        }
        let shape = self.data.gradients(&*law)?;
        let both = |[answers, across]: [Vec<f64>; 2]| [answers, across].concat();
        let by_number = self.derivatives(&|x| self.data.answers(&*law_at(x)?, &shape).map(both))?;
        let by_side = slope(&|step| self.data.answers(&*law, &self.data.thinned(&shape, step)).map(both))?;
        let count = self.data.targets.len();
        let slope = |i: usize, k: usize| {
            let (held, across) = (by_number[(i, k)], by_number[(count + i, k)]);
            let sides = if across == 0.0 { 0.0 } else { by_side[i] * across / by_side[count + i] };
            (held - sides) * self.data.factors[i] / self.data.unit
        };
        let slopes = DMatrix::from_fn(count, self.x.len(), slope);
        slopes.iter().all(|slope| slope.is_finite()).then_some(slopes)
    }

    /// Ogden's terms by what they contribute to the shear modulus, the largest first.
    fn sorted(mut self) -> Self {
        if self.law.has_terms() {
            let pairs = self.x.as_slice().chunks_exact(2).map(<[f64]>::to_vec).zip(self.signs.clone());
            let mut pairs: Vec<(Vec<f64>, f64)> = pairs.collect();
            pairs.sort_by(|a, b| b.0[0].total_cmp(&a.0[0]));
            self.signs = pairs.iter().map(|(_, sign)| *sign).collect();
            self.x = DVector::from_vec(pairs.into_iter().flat_map(|(x, _)| x).collect());
        }
        self
    }

    fn assess(self, squares: f64, starts: Starts) -> Fit {
        let values = self.decoded(self.x.as_slice());
        let (n, k) = (self.data.targets.len(), values.len());
        let (unit, free) = (self.data.unit, (n - k) as f64);
        let jacobian = self.slopes();
        let by_free = self.derivatives(&|x| Some(self.decoded(x)));
        let variance = squares / (unit * unit) / free;
        let border = self.law.on_border(self.x.as_slice());
        let of_free = jacobian.and_then(|jacobian| covariance(&jacobian, &border, variance));
        let of_values = of_free.as_ref().zip(by_free).map(|(c, t)| &t * c * t.transpose());
        let deviation = |i: usize| {
            let variance = of_values.as_ref()?[(i, i)];
            (variance > 0.0).then(|| variance.sqrt())
        };
        let estimate = |(i, name): (usize, &'static str)| {
            let half_width = deviation(i).map(|d| student(free) * d);
            let at_least = border[i] && self.law.has_least(i);
            Estimate {
                name,
                unit: self.law.unit(name),
                value: values[i],
                deviation: deviation(i),
                half_width,
                at_least,
            }
        };
        let parameters = self.law.parameters().into_iter().enumerate().map(estimate).collect();
        let correlation = |i: usize, j: usize| Some(of_values.as_ref()?[(i, j)] / (deviation(i)? * deviation(j)?));
        Fit {
            law: self.law,
            parameters,
            correlation: (0..k).map(|i| (0..k).map(|j| correlation(i, j)).collect()).collect(),
            squares,
            points: n,
            scatter: (squares / free).sqrt(),
            criteria: Criteria::of(squares, n, k),
            starts,
            free: Free { x: self.x.as_slice().to_vec(), signs: self.signs, scale: self.scale, covariance: of_free },
        }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.x.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.x.clone()
    }

    /// Where there is no law: so far away that the step is shortened.
    fn residuals(&self) -> Option<DVector<f64>> {
        let far = || vec![FAR; self.data.targets.len()];
        Some(DVector::from_vec(self.at(self.x.as_slice()).unwrap_or_else(far)))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        self.slopes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fibers, Mode, Response};

    /// Derivatives with free sides that follow the law are those of differences for which the sides are sought anew.
    #[test]
    fn slopes_follow_free_sides() -> Result<(), FitError> {
        let law = Law::named("holzapfel_gasser_ogden_2")?;
        let values = [1.5e4, 2e4, 1.3, 0.1, 40.0];
        let at: Vec<f64> = (1..6).map(|k| 1.0 + 0.05 * f64::from(k)).collect();
        let test = |mode, fibers, response| -> Result<Test, FitError> {
            let stresses = crate::curve(&*law.incompressible(&values)?, mode, fibers, response, &at);
            let points = at.iter().zip(stresses).map(|(x, y)| [*x, 1.1 * y]).collect();
            Test::new("", mode, response, points)?.loaded(fibers)
        };
        let tests = [
            test(Mode::Uniaxial, Fibers::Along, Response::Nominal)?,
            test(Mode::Uniaxial, Fibers::Across, Response::Cauchy)?,
            test(Mode::Planar, Fibers::Across, Response::Nominal)?,
        ];
        let data = Data::new(law, &tests, Errors::Absolute)?;
        let scale = data.scale()?;
        let x = DVector::from_vec(vec![-0.4, -0.5, 0.3, 0.9, 0.7]);
        let problem = Problem { law, data: &data, network: None, scale, signs: vec![], x };
        let (Some(found), Some(expected)) = (problem.slopes(), problem.derivatives(&|x| problem.at(x))) else {
            unreachable!("the law has a response")
        };
        let far = (&found - &expected).amax() / expected.amax();
        assert!(far < 1e-7, "{far}: {found} {expected}");
        // held sides are another derivative
        let law_at = |x: &[f64]| law.incompressible(&problem.decoded(x)).ok();
        let shape = law_at(problem.x.as_slice()).and_then(|law| data.gradients(&*law)).unwrap_or_default();
        let held = |x: &[f64]| data.answers(&*law_at(x)?, &shape).map(|[answers, _]| answers);
        let held = problem.derivatives(&held).map(|held| held / data.unit);
        assert!(held.is_some_and(|held| (held - &expected).amax() > 1e-2 * expected.amax()));
        Ok(())
    }

    /// Derivatives by all numbers of a network are those of differences, and its responses those of the law.
    #[test]
    fn slopes_of_networks_are_those_of_differences() -> Result<(), FitError> {
        for label in ["convex_network_1x4", "convex_network_2x4"] {
            let law = Law::named(label)?;
            let points: Vec<[f64; 2]> = (1..30).map(|k| 1.0 + 0.15 * f64::from(k)).map(|l| [l, 1e5 * l * l]).collect();
            let bar = Test::new("bar", Mode::Uniaxial, Response::Nominal, points.clone())?;
            let tests = [bar, Test::new("sheet", Mode::Equibiaxial, Response::Cauchy, points)?];
            let data = Data::new(law, &tests, Errors::Relative)?;
            let (scale, network) = (data.scale()?, NetworkData::new(law, &data)?);
            let (x, signs) = law.starts(&mut Random::new(3), 1).swap_remove(0);
            let problem =
                Problem { law, data: &data, network: network.as_ref(), scale, signs, x: DVector::from_vec(x) };
            let (Some(found), Some(expected)) = (problem.slopes(), problem.derivatives(&|x| problem.at(x))) else {
                unreachable!("the law has a response")
            };
            let far = (&found - &expected).amax() / expected.amax();
            assert!(far < 1e-9, "{label}: {far}");
            let own = data.residuals(&*law.incompressible(&problem.decoded(problem.x.as_slice()))?).unwrap_or_default();
            let direct = problem.at(problem.x.as_slice()).unwrap_or_default();
            let far = own.iter().zip(&direct).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(direct.len() == 58 && far < 1e-9, "{label}: {far}");
        }
        Ok(())
    }
}
