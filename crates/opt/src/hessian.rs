//! Which second derivative is meant, and its products at an accepted control.

use crate::admissible::Admissible;
use crate::failed::Failed;
use crate::method::HessianProducts;
use crate::objective::Objective;

/// A second derivative of a cost j(m) = J(u(m), m) through a state u(m).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hessian {
    /// `d2j/dm2`.
    Exact,
    /// `u_m^T J_uu u_m + u_m^T J_um + J_mu u_m + J_mm`: the state linearised, the cost not. Needs no third derivatives of an energy;
    /// positive semidefinite wherever J is convex. For least squares it is the matrix of Gauss and Newton.
    GaussNewton,
}

/// The products of an objective at an evaluated control of a set, counted.
pub(crate) struct ProductsAt<'a, O: Objective> {
    pub objective: &'a O,
    pub set: &'a dyn Admissible,
    pub m: &'a [f64],
    /// Across the set too.
    pub whole_derivative: &'a [f64],
    pub point: &'a O::Point,
    pub workspace: &'a mut O::Workspace,
    pub count: &'a mut usize,
}

impl<O: Objective> HessianProducts for ProductsAt<'_, O> {
    fn product(&mut self, v: &[f64], which: Hessian) -> Result<Vec<f64>, Failed> {
        *self.count += 1;
        let mut out = self.objective.hessian_vector(self.point, v, which, self.workspace)?;
        if out.len() != self.m.len() {
            return Err(Failed::because(format!("{} second derivatives for {} controls", out.len(), self.m.len())));
        }
        if let Some(i) = out.iter().position(|x| !x.is_finite()) {
            return Err(Failed::because(format!("component {i} of a second derivative is {}", out[i])));
        }
        self.set.add_curvature(self.m, self.whole_derivative, v, &mut out);
        self.set.tangent(self.m, &mut out);
        Ok(out)
    }
}
