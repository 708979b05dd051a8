//! `scipy.json`: what SciPy's L-BFGS-B takes, as `scripts/scipy-bounded.py` writes it.

use serde_json::Value;

/// Iterations and evaluations, that of the start included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    pub iterations: usize,
    pub evaluations: usize,
}

#[derive(Clone, Debug)]
pub struct Scipy {
    pub name: String,
    pub start: Vec<f64>,
    pub first: f64,
    pub derivative: Vec<f64>,
    /// The least cost found from where SciPy ended, and where.
    pub optimum: f64,
    pub at: Vec<f64>,
    /// SciPy's own end.
    pub run: Reached,
    pub cost: f64,
    pub stop: String,
    /// When the cost was first down to [`target`](Self::target), if ever.
    pub reached: Option<Reached>,
}

impl Scipy {
    /// All problems of the file and SciPy's version.
    pub fn read() -> (String, Vec<Scipy>) {
        let file: Value = serde_json::from_str(include_str!("scipy.json")).unwrap();
        let problems = file["problems"].as_object().unwrap();
        (file["scipy"].as_str().unwrap().to_string(), problems.iter().map(|(name, p)| Self::of(name, p)).collect())
    }

    fn of(name: &str, problem: &Value) -> Self {
        let number = |key: &str| problem[key].as_f64().unwrap();
        let list = |key: &str| problem[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        Self {
            name: name.to_string(),
            start: list("start"),
            first: number("first"),
            derivative: list("derivative"),
            optimum: number("optimum"),
            at: list("at"),
            run: reached(&problem["run"]).unwrap(),
            cost: problem["run"]["cost"].as_f64().unwrap(),
            stop: problem["run"]["stop"].as_str().unwrap().to_string(),
            reached: reached(&problem["reached"]),
        }
    }

    /// What counts as the optimum: optimum + 1e-8 |optimum| + 1e-12 |first cost|.
    pub fn target(&self) -> f64 {
        self.optimum + 1e-8 * self.optimum.abs() + 1e-12 * self.first.abs()
    }
}

fn reached(counts: &Value) -> Option<Reached> {
    let count = |key: &str| counts[key].as_u64().map(|n| n as usize);
    Some(Reached { iterations: count("iterations")?, evaluations: count("evaluations")? })
}
