//! Quadrature rules on the reference domains: computed Gauss rules, tensor products, tabulated and conical simplex rules.

mod gauss;
mod simplex;

pub use gauss::{gauss_jacobi, gauss_legendre};

/// Points and weights on a reference domain. Weights are positive and sum to the measure of the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Reference coordinates; unused components are 0.
    pub points: Vec<[f64; 3]>,
    /// One weight per point.
    pub weights: Vec<f64>,
}

impl Rule {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points; no rule of this crate is empty.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Points and weights together.
    pub fn iter(&self) -> impl Iterator<Item = (&[f64; 3], f64)> {
        self.points.iter().zip(self.weights.iter().copied())
    }

    /// Gauss-Legendre with n points per direction on [-1,1]^dim, first coordinate fastest. Exact to degree 2n - 1 in
    /// each variable.
    pub fn tensor(dim: usize, n: usize) -> Rule {
        let (x, w) = gauss_legendre(n.max(1));
        let mut rule = Rule { points: vec![[0.0; 3]], weights: vec![1.0] };
        for d in 0..dim.min(3) {
            rule =
                x.iter().zip(&w).flat_map(|(&x, &w)| rule.iter().map(move |(&p, v)| (with(p, d, x), v * w))).collect();
        }
        rule
    }
}

impl FromIterator<([f64; 3], f64)> for Rule {
    fn from_iter<I: IntoIterator<Item = ([f64; 3], f64)>>(points: I) -> Rule {
        let (points, weights) = points.into_iter().unzip();
        Rule { points, weights }
    }
}

fn with(mut point: [f64; 3], axis: usize, x: f64) -> [f64; 3] {
    point[axis] = x;
    point
}
