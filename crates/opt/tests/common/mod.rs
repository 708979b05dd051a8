//! Problems to test optimisers with.
#![allow(dead_code, clippy::expect_used)]

use nastic_opt::{
    Admissible, Bounds, Failed, Hessian, InnerProduct, NoSecondDerivatives, Objective, Optimizer, Request, Run,
    RunError, RunState,
};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

type Value = Box<dyn Fn(&[f64]) -> f64 + Sync>;
type Gradient = Box<dyn Fn(&[f64]) -> Vec<f64> + Sync>;
type Product = Box<dyn Fn(&[f64], &[f64]) -> Vec<f64> + Sync>;
type Test = Box<dyn Fn(&[f64]) -> bool + Sync>;

/// A cost given by two closures. Panics when evaluated outside its guard, fails where it is asked to, counts.
pub struct Cost {
    pub value: Value,
    pub derivative: Gradient,
    /// `H v` at m; else a difference of derivatives takes its place.
    pub hessian: Option<Product>,
    /// Whether there are no second derivatives at all.
    pub without_hessian: bool,
    pub guard: Box<dyn Admissible>,
    pub fails: Test,
    /// While it is raised, every evaluation fails fatally.
    pub lacking: Arc<AtomicBool>,
    /// Which second derivatives were asked for.
    pub asked: Mutex<Vec<Hessian>>,
    pub evaluations: AtomicUsize,
    pub derivatives: AtomicUsize,
}

impl Cost {
    pub fn new(
        guard: impl Admissible + 'static,
        value: impl Fn(&[f64]) -> f64 + Sync + 'static,
        derivative: impl Fn(&[f64]) -> Vec<f64> + Sync + 'static,
    ) -> Self {
        Self {
            value: Box::new(value),
            derivative: Box::new(derivative),
            hessian: None,
            without_hessian: false,
            guard: Box::new(guard),
            fails: Box::new(|_| false),
            lacking: Arc::default(),
            asked: Mutex::new(Vec::new()),
            evaluations: AtomicUsize::new(0),
            derivatives: AtomicUsize::new(0),
        }
    }

    pub fn with_hessian(mut self, product: impl Fn(&[f64], &[f64]) -> Vec<f64> + Sync + 'static) -> Self {
        self.hessian = Some(Box::new(product));
        self
    }

    pub fn without_hessian(mut self) -> Self {
        self.without_hessian = true;
        self
    }

    pub fn failing(mut self, fails: impl Fn(&[f64]) -> bool + Sync + 'static) -> Self {
        self.fails = Box::new(fails);
        self
    }

    pub fn failing_fatally(mut self, lacking: Arc<AtomicBool>) -> Self {
        self.lacking = lacking;
        self
    }

    pub fn counts(&self) -> (usize, usize) {
        (self.evaluations.load(Ordering::Relaxed), self.derivatives.load(Ordering::Relaxed))
    }
}

/// The central difference of a derivative along v.
fn difference(derivative: &Gradient, m: &[f64], v: &[f64]) -> Vec<f64> {
    let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size(v) == 0.0 {
        return vec![0.0; v.len()];
    }
    let t = 1e-5 * size(m).max(1e-3) / size(v);
    let at = |t: f64| derivative(&m.iter().zip(v).map(|(m, v)| m + t * v).collect::<Vec<_>>());
    at(t).iter().zip(at(-t)).map(|(a, b)| (a - b) / (2.0 * t)).collect()
}

impl Objective for Cost {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.guard.check(m).expect("nothing is evaluated outside the set");
        if self.lacking.load(Ordering::Relaxed) {
            return Err(Failed::because("no memory").fatal());
        }
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        if (self.fails)(m) { Err(Failed::because("told to fail")) } else { Ok(m.to_vec()) }
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        (self.value)(m)
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.derivatives.fetch_add(1, Ordering::Relaxed);
        Ok((self.derivative)(m))
    }

    fn hessian_vector(&self, m: &Vec<f64>, v: &[f64], which: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        self.asked.lock().expect("no test panics while it holds this").push(which);
        match (&self.hessian, self.without_hessian) {
            (Some(product), _) => Ok(product(m, v)),
            (None, false) => Ok(difference(&self.derivative, m, v)),
            (None, true) => Err(Failed::new(NoSecondDerivatives { objective: "a cost by two closures" })),
        }
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

/// A run over copies of a set and a product.
pub fn begin<O: Objective>(
    optimizer: &dyn Optimizer,
    objective: O,
    set: &(impl Admissible + Clone + 'static),
    metric: &(impl InnerProduct + Clone + 'static),
    m: &[f64],
) -> Result<Run<O>, RunError> {
    Run::start(optimizer, objective, Arc::new(set.clone()), Arc::new(metric.clone()), m)
}

/// The same, taken up.
pub fn resume<O: Objective>(
    optimizer: &dyn Optimizer,
    objective: O,
    set: &(impl Admissible + Clone + 'static),
    metric: &(impl InnerProduct + Clone + 'static),
    state: &RunState,
) -> Result<Run<O>, RunError> {
    Run::load(optimizer, objective, Arc::new(set.clone()), Arc::new(metric.clone()), state)
}

/// The extended Rosenbrock function of n (even) variables.
pub fn rosenbrock(guard: impl Admissible + 'static) -> Cost {
    let value = |m: &[f64]| m.chunks(2).map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2)).sum();
    let derivative = |m: &[f64]| {
        let pair = |p: &[f64]| {
            let e = p[1] - p[0] * p[0];
            [-400.0 * p[0] * e - 2.0 * (1.0 - p[0]), 200.0 * e]
        };
        m.chunks(2).flat_map(pair).collect()
    };
    Cost::new(guard, value, derivative)
}

/// unit_j * sum_i c_i/2 (m_i/unit_m - t_i)^2 + offset, separable: its minimiser in a box is the clamped target.
pub fn quadratic(
    guard: impl Admissible + 'static,
    c: Vec<f64>,
    target: Vec<f64>,
    unit_m: f64,
    unit_j: f64,
    offset: f64,
) -> Cost {
    let (c2, c3, target2) = (c.clone(), c.clone(), target.clone());
    let value = move |m: &[f64]| {
        let terms = m.iter().zip(&c).zip(&target).map(|((m, c), t)| 0.5 * c * (m / unit_m - t).powi(2));
        unit_j * (terms.sum::<f64>() + offset)
    };
    let derivative = move |m: &[f64]| {
        let terms = m.iter().zip(&c2).zip(&target2);
        terms.map(|((m, c), t)| unit_j * (c * (m / unit_m - t)) / unit_m).collect()
    };
    let product =
        move |_: &[f64], v: &[f64]| v.iter().zip(&c3).map(|(v, c)| unit_j * (c * (v / unit_m)) / unit_m).collect();
    Cost::new(guard, value, derivative).with_hessian(product)
}

/// The obstacle-like problem on a line: 1/2 m.K m - f.m with K the second difference matrix plus a little mass.
pub fn chain(guard: impl Admissible + 'static, n: usize, force: impl Fn(usize) -> f64 + Sync + 'static) -> Cost {
    let h = 1.0 / (n + 1) as f64;
    let apply = move |m: &[f64]| -> Vec<f64> {
        let at = |i: isize| if i < 0 || i as usize >= n { 0.0 } else { m[i as usize] };
        (0..n as isize).map(|i| (2.0 * at(i) - at(i - 1) - at(i + 1)) / h).collect()
    };
    let f: Vec<f64> = (0..n).map(|i| h * force(i)).collect();
    let g = f.clone();
    let value = move |m: &[f64]| {
        let km = apply(m);
        m.iter().zip(&km).zip(&f).map(|((m, k), f)| 0.5 * m * k - f * m).sum()
    };
    let derivative = move |m: &[f64]| apply(m).iter().zip(&g).map(|(k, f)| k - f).collect();
    Cost::new(guard, value, derivative)
}

/// The consistent product of linear elements on a line plus length^2 times that of the slopes; its Riesz map by
/// elimination (Thomas). Not diagonal.
#[derive(Clone, Debug)]
pub struct Tridiagonal {
    pub diagonal: f64,
    pub off: f64,
    pub n: usize,
}

impl Tridiagonal {
    pub fn h1(n: usize, length: f64) -> Self {
        let h = 1.0 / n as f64;
        let stiff = length * length / h;
        Self { diagonal: 4.0 * h / 6.0 + 2.0 * stiff, off: h / 6.0 - stiff, n }
    }
}

impl InnerProduct for Tridiagonal {
    fn len(&self) -> usize {
        self.n
    }

    fn apply(&self, v: &[f64]) -> Vec<f64> {
        let at = |i: usize, step: isize| v.get((i as isize + step) as usize).copied().unwrap_or(0.0);
        (0..self.n).map(|i| self.diagonal * v[i] + self.off * (at(i, -1) + at(i, 1))).collect()
    }

    fn riesz(&self, d: &[f64]) -> Vec<f64> {
        let (mut upper, mut x) = (vec![0.0; self.n], d.to_vec());
        let mut pivot = self.diagonal;
        for i in 0..self.n {
            if i > 0 {
                pivot = self.diagonal - self.off * upper[i - 1];
                x[i] -= self.off * x[i - 1];
            }
            upper[i] = self.off / pivot;
            x[i] /= pivot;
        }
        for i in (0..self.n - 1).rev() {
            x[i] -= upper[i] * x[i + 1];
        }
        x
    }
}

/// Largest difference of two vectors.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// No bounds, or wide ones of a method that needs them.
pub fn wide(name: &str) -> Bounds {
    if name == "mma" { Bounds::new(-10.0, 10.0).expect("they do not cross") } else { Bounds::none() }
}
