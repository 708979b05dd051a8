//! [`Skin`]: what follows from the displacement of the skin of a free shape.

use super::ControlMap;
use nastic_fem::{Discretization, SkinMap};
use nastic_tensor::Mat3;
use std::sync::Arc;

/// The displacement s of the drawn body from that of its skin, [`SkinMap`], at the nodes, or `grad s` at the quadrature points, `dim^2` numbers by rows.
#[derive(Debug, Clone)]
pub(crate) struct Skin {
    /// The shape in words.
    pub shape: String,
    pub map: Arc<SkinMap>,
    pub disc: Arc<Discretization>,
    /// Whether it is the gradient.
    pub gradient: bool,
}

impl ControlMap for Skin {
    fn describe(&self) -> String {
        format!("{} of {}", if self.gradient { "gradient" } else { "displacement" }, self.shape)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        let (s, dim) = (self.map.displacement(x), self.disc.dim());
        if !self.gradient {
            return s;
        }
        let rows = |g: Mat3| (0..dim * dim).map(move |k| g[(k / dim, k % dim)]);
        self.disc.points().gradients(&s).into_iter().flat_map(rows).collect()
    }

    fn change(&self, _: &[f64], v: &[f64]) -> Vec<f64> {
        self.values(v)
    }

    fn vjp(&self, _: &[f64], g: &[f64]) -> Vec<f64> {
        let dim = self.disc.dim();
        if !self.gradient {
            return self.map.vjp(g.to_vec());
        }
        let entry = |at: &[f64], i: usize, j: usize| if i < dim && j < dim { at[dim * i + j] } else { 0.0 };
        let stress: Vec<Mat3> = g.chunks_exact(dim * dim).map(|at| Mat3::from_fn(|i, j| entry(at, i, j))).collect();
        let mut by_s = vec![0.0; self.disc.dofs()];
        self.disc.points().spread_stress(&stress, &mut by_s);
        self.map.vjp(by_s)
    }
}
