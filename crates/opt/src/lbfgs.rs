//! Limited-memory quasi-Newton method within an admissible set.

use crate::failed::Failed;
use crate::inner_product::InnerProduct;
use crate::method::{Current, HessianProducts, Memory, Method, Secant};
use crate::model::{Curvature, Steepest, minimise};
use crate::optimizer::{Optimizer, Options};
use nastic_numeric::vector::{axpy, dot, scale};
use std::collections::VecDeque;

/// Limited-memory BFGS in the control's inner product. Each iteration minimises the quasi-Newton model over the local
/// model of the set (active bounds fixed, the free components by conjugate gradients preconditioned with the two-loop
/// recursion), then searches along that segment by backtracking. Derivatives are taken of accepted points alone; a pair
/// without positive curvature is left out and the next step is made longer. After a search that had to shorten its step the next
/// first trial is at most four times as long as the step that was accepted.
///
/// In directions that no stored pair covers, the curvature is `theta = |y|/|s|` of the last one (norms dual and primal in the inner product): the geometric
/// mean of the two lengths of Barzilai and Borwein, as of Dai, Al-Baali and Yang (2015), "A positive Barzilai-Borwein-like stepsize and an
/// extension for symmetric linear systems".
#[derive(Clone, Debug, PartialEq)]
pub struct Lbfgs {
    /// When to stop, and what to ask of evaluations.
    pub options: Options,
    /// Number of pairs kept.
    pub memory: usize,
}

impl Default for Lbfgs {
    fn default() -> Self {
        Self { options: Options::default(), memory: 20 }
    }
}

impl Optimizer for Lbfgs {
    fn name(&self) -> &'static str {
        "lbfgs"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn method(&self) -> Box<dyn Method> {
        let keep = self.memory.max(1);
        let (pairs, direction) = (VecDeque::new(), Vec::new());
        Box::new(QuasiNewton { keep, theta: 0.0, pairs, skipped: 0, direction, share: 1.0, reach: f64::INFINITY })
    }
}

#[derive(Clone, Debug)]
struct QuasiNewton {
    keep: usize,
    /// B begins as theta G.
    theta: f64,
    /// Oldest first.
    pairs: VecDeque<Secant>,
    /// Consecutive iterations without a usable pair.
    skipped: usize,
    direction: Vec<f64>,
    /// The direction's share of the step to the model's minimiser.
    share: f64,
    /// Largest length of the next direction: infinite unless the last search had to shorten its step.
    reach: f64,
}

impl QuasiNewton {
    /// Factor of theta where the curvature of the cost is not positive.
    const THETA_DECREASE: f64 = 0.25;
    /// Consecutive pairs left out before the memory is cleared.
    const MAX_SKIPPED: usize = 2;
    /// Length of a first trial after a search that shortened its step, in lengths of the step it accepted.
    const MAX_LENGTH_RATIO: f64 = 4.0;

    /// The step to the minimiser of the model over the set's local model.
    fn model_step(&mut self, here: &Current<'_>) -> Vec<f64> {
        if !self.pairs.is_empty() {
            let hessian = Bfgs::new(here.metric, self.theta, &self.pairs);
            let step = minimise(here.set, here.metric, here.m, here.derivative, &hessian);
            if dot(&step, here.derivative) < 0.0 {
                return step;
            }
            self.pairs.clear();
        }
        self.steepest(here)
    }

    fn steepest(&self, here: &Current<'_>) -> Vec<f64> {
        let curvature = Steepest { metric: here.metric, step: 1.0 / self.theta };
        minimise(here.set, here.metric, here.m, here.derivative, &curvature)
    }

    /// Pairs in the tangent space of a new control; those that lose their curvature on the way are dropped.
    fn carry(&mut self, from: &Current<'_>, to: &Current<'_>) {
        for pair in &mut self.pairs {
            let before = pair.s.clone();
            to.set.transport(from.m, to.m, &mut pair.s);
            to.set.transport(from.m, to.m, &mut pair.y);
            if pair.s != before {
                pair.ss = to.metric.inner(&pair.s, &pair.s);
                pair.yy = dot(&to.metric.riesz(&pair.y), &pair.y);
            }
            pair.sy = dot(&pair.s, &pair.y);
        }
        self.pairs.retain(Secant::is_convex);
    }
}

impl Method for QuasiNewton {
    fn restart(&mut self, step: f64, _cost: f64) {
        self.theta = 1.0 / step;
        self.pairs.clear();
        self.skipped = 0;
        self.reach = f64::INFINITY;
    }

    fn prepare(&mut self, here: &Current<'_>, _: &mut dyn HessianProducts) -> Result<(), Failed> {
        self.direction = self.model_step(here);
        self.share = (self.reach / here.metric.norm(&self.direction)).min(1.0);
        if self.share < 1.0 {
            scale(self.share, &mut self.direction);
        }
        Ok(())
    }

    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64> {
        let mut out = here.m.to_vec();
        here.set.retract(here.m, &self.direction, fraction, &mut out);
        out
    }

    fn step(&self, fraction: f64) -> f64 {
        self.share * fraction
    }

    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, trials: usize) {
        self.carry(from, to);
        let secant = Secant::between(from, to);
        self.reach = if trials > 1 { Self::MAX_LENGTH_RATIO * secant.ss.sqrt() } else { f64::INFINITY };
        if secant.is_convex() {
            // The largest curvature met, y.y / s.y, would be too stiff for most directions of an ill-posed problem; this is the geometric mean
            // of that and of s.y / s.s.
            self.theta = (secant.yy / secant.ss).sqrt();
            self.skipped = 0;
            self.pairs.push_back(secant);
            if self.pairs.len() > self.keep {
                self.pairs.pop_front();
            }
            return;
        }
        self.skipped += 1;
        if self.pairs.is_empty() {
            self.theta *= Self::THETA_DECREASE / self.step(fraction);
        } else if self.skipped >= Self::MAX_SKIPPED {
            // The step just taken, four times as long, is where the next gradient step begins. The gradient's part that pushes on
            // active bounds moves nothing.
            self.pairs.clear();
            let gradient = to.set.optimality(to.metric, to.m, to.derivative).norm;
            if gradient > 0.0 {
                self.theta = Self::THETA_DECREASE * gradient / secant.ss.sqrt();
            }
        }
    }

    fn recover(&mut self) -> bool {
        let had = !self.pairs.is_empty();
        self.pairs.clear();
        self.reach = f64::INFINITY;
        had
    }

    fn save(&self) -> Memory {
        let vectors = self.pairs.iter().flat_map(|pair| [pair.s.clone(), pair.y.clone()]).collect();
        let mut numbers = vec![self.theta, self.skipped as f64, self.reach];
        numbers.extend(self.pairs.iter().flat_map(|pair| [pair.ss, pair.sy, pair.yy]));
        Memory { numbers, vectors }
    }

    fn load(&mut self, memory: &Memory) -> bool {
        let [theta, skipped, reach, products @ ..] = &memory.numbers[..] else { return false };
        let pairs = products.len() / 3;
        let fits = products.len() == 3 * pairs && memory.vectors.len() == 2 * pairs && *theta > 0.0 && *reach > 0.0;
        if !fits {
            return false;
        }
        self.theta = *theta;
        self.skipped = *skipped as usize;
        self.reach = *reach;
        let pairs = memory.vectors.chunks(2).zip(products.chunks(3));
        let secant =
            |(v, p): (&[Vec<f64>], &[f64])| Secant { s: v[0].clone(), y: v[1].clone(), ss: p[0], sy: p[1], yy: p[2] };
        self.pairs = pairs.map(secant).collect();
        true
    }
}

/// The BFGS matrix of some pairs, as a sum (for B v) and by the two-loop recursion (for B^-1 d):
/// B = theta G + sum_i ( y_i y_i^T / s_i.y_i - b_i b_i^T / s_i.b_i ), b_i = B_i s_i.
struct Bfgs<'a> {
    metric: &'a dyn InnerProduct,
    theta: f64,
    pairs: &'a VecDeque<Secant>,
    /// b_i and s_i . b_i.
    images: Vec<(Vec<f64>, f64)>,
}

impl<'a> Bfgs<'a> {
    fn new(metric: &'a dyn InnerProduct, theta: f64, pairs: &'a VecDeque<Secant>) -> Self {
        let mut bfgs = Self { metric, theta, pairs, images: Vec::with_capacity(pairs.len()) };
        for pair in pairs {
            let image = bfgs.apply(&pair.s);
            let product = dot(&pair.s, &image);
            bfgs.images.push((image, product));
        }
        bfgs
    }
}

impl Curvature for Bfgs<'_> {
    fn apply(&self, v: &[f64]) -> Vec<f64> {
        let mut out = self.metric.apply(v);
        scale(self.theta, &mut out);
        for (pair, (image, product)) in self.pairs.iter().zip(&self.images) {
            axpy(dot(&pair.y, v) / pair.sy, &pair.y, &mut out);
            axpy(-dot(image, v) / product, image, &mut out);
        }
        out
    }

    fn solve(&self, d: &[f64]) -> Vec<f64> {
        let mut d = d.to_vec();
        let mut alphas = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs.iter().rev() {
            let alpha = dot(&pair.s, &d) / pair.sy;
            axpy(-alpha, &pair.y, &mut d);
            alphas.push(alpha);
        }
        let mut out = self.metric.riesz(&d);
        scale(1.0 / self.theta, &mut out);
        for (pair, alpha) in self.pairs.iter().zip(alphas.iter().rev()) {
            let beta = dot(&pair.y, &out) / pair.sy;
            axpy(alpha - beta, &pair.s, &mut out);
        }
        out
    }

    fn size(&self) -> f64 {
        self.theta
    }
}
