//! Which second derivative is meant, and its products at an accepted control.

use crate::failed::Failed;
use crate::method::HessianProducts;
use crate::objective::Objective;
use crate::search::{Iterate, Setting};

/// A second derivative of a cost j(m) = J(u(m), m) through a state u(m).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hessian {
    /// `d2j/dm2`.
    Exact,
    /// `u_m^T J_uu u_m + u_m^T J_um + J_mu u_m + J_mm`: the state linearised, the cost not. Needs no third derivatives of an energy;
    /// positive semidefinite wherever J is convex. For least squares it is the matrix of Gauss and Newton.
    GaussNewton,
}

/// The products of an objective at an iterate, counted.
pub(crate) struct ProductsAt<'a, O: Objective> {
    pub setting: &'a Setting<O>,
    pub at: &'a Iterate<O::Point>,
    pub workspace: &'a mut O::Workspace,
    pub count: &'a mut usize,
}

impl<O: Objective> HessianProducts for ProductsAt<'_, O> {
    fn product(&mut self, v: &[f64], which: Hessian) -> Result<Vec<f64>, Failed> {
        *self.count += 1;
        let (Setting { objective, set, .. }, Iterate { m, whole_derivative, point, .. }) = (self.setting, self.at);
        let mut out = objective.hessian_vector(point, v, which, self.workspace)?;
        if out.len() != m.len() {
            return Err(Failed::because(format!("{} second derivatives for {} controls", out.len(), m.len())));
        }
        if let Some(i) = out.iter().position(|x| !x.is_finite()) {
            return Err(Failed::because(format!("component {i} of a second derivative is {}", out[i])));
        }
        set.add_curvature(m, whole_derivative, v, &mut out);
        set.tangent(m, &mut out);
        Ok(out)
    }
}
