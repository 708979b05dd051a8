//! Spectral projected gradient: Barzilai-Borwein lengths, non-monotone search.

use crate::failed::Failed;
use crate::method::{Current, HessianProducts, Memory, Method, Secant};
use crate::model::{Steepest, minimise};
use crate::optimizer::{Optimizer, Options};

/// Spectral projected gradient (Birgin, Martínez & Raydan 2000) with the adaptive choice between the two
/// Barzilai-Borwein lengths of Frassoldati, Zanni & Zanghirati (2008): d = P(m - t gradient) - m, searched along the
/// segment against the largest of the last costs (Grippo, Lampariello & Lucidi 1986). The cost may rise on the way:
/// the best point is kept, and returned unless the tolerance is met at one as good.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectral {
    /// When to stop, and what to ask of evaluations.
    pub options: Options,
    /// How many costs a trial is compared with; 1 makes it monotone.
    pub window: usize,
}

impl Default for Spectral {
    fn default() -> Self {
        Self { options: Options::default(), window: 8 }
    }
}

impl Optimizer for Spectral {
    fn name(&self) -> &'static str {
        "spectral"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn method(&self) -> Box<dyn Method> {
        let window = self.window.max(1);
        Box::new(BarzilaiBorwein { window, step: 0.0, direction: Vec::new(), costs: Vec::new(), short: Vec::new() })
    }
}

#[derive(Clone, Debug)]
struct BarzilaiBorwein {
    window: usize,
    /// Next length t.
    step: f64,
    /// Present d.
    direction: Vec<f64>,
    /// The last costs, at most `window`.
    costs: Vec<f64>,
    /// The last short lengths s.y/y.y.
    short: Vec<f64>,
}

impl BarzilaiBorwein {
    /// Growth of the step where the curvature of the cost is not positive.
    const STEP_GROWTH: f64 = 4.0;
    /// Largest ratio of the short to the long length at which the short one is taken.
    const MAX_SHORT_RATIO: f64 = 0.5;
    /// Short lengths that are held.
    const MEMORY: usize = 3;
}

impl Method for BarzilaiBorwein {
    fn restart(&mut self, step: f64, cost: f64) {
        self.step = step;
        self.costs = vec![cost];
        self.short.clear();
    }

    fn prepare(&mut self, here: &Current<'_>, _: &mut dyn HessianProducts) -> Result<(), Failed> {
        let curvature = Steepest { metric: here.metric, step: self.step };
        self.direction = minimise(here.set, here.metric, here.m, here.derivative, &curvature);
        Ok(())
    }

    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64> {
        let mut out = here.m.to_vec();
        here.set.retract(here.m, &self.direction, fraction, &mut out);
        out
    }

    fn step(&self, fraction: f64) -> f64 {
        self.step * fraction
    }

    fn reference(&self, cost: f64) -> f64 {
        self.costs.iter().fold(cost, |most, c| most.max(*c))
    }

    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, _trials: usize) {
        push(&mut self.costs, to.cost, self.window);
        let secant = Secant::between(from, to);
        if !secant.is_convex() {
            self.step *= fraction * Self::STEP_GROWTH;
            self.short.clear();
            return;
        }
        let (long, short) = (secant.ss / secant.sy, secant.sy / secant.yy);
        push(&mut self.short, short, Self::MEMORY);
        let shortest = self.short.iter().fold(short, |least, t| least.min(*t));
        self.step = if short < Self::MAX_SHORT_RATIO * long { shortest } else { long };
    }

    fn save(&self) -> Memory {
        Memory { numbers: vec![self.step], vectors: vec![self.costs.clone(), self.short.clone()] }
    }

    fn load(&mut self, memory: &Memory) -> bool {
        match (&memory.numbers[..], &memory.vectors[..]) {
            ([step], [costs, short]) if *step > 0.0 && costs.len() <= self.window => {
                self.step = *step;
                self.costs.clone_from(costs);
                self.short.clone_from(short);
                true
            }
            _ => false,
        }
    }
}

/// Appends to a list that keeps only its last entries.
fn push(list: &mut Vec<f64>, value: f64, keep: usize) {
    list.push(value);
    if list.len() > keep {
        list.remove(0);
    }
}
