//! The method of moving asymptotes, globally convergent.

mod asymptotes;
mod dual;
mod method;
mod subproblem;

pub use asymptotes::Asymptotes;

use crate::admissible::Admissible;
use crate::method::Method;
use crate::optimizer::{Optimizer, Options, Unfit};
use method::MovingAsymptotes;

/// Svanberg's method of moving asymptotes in its globally convergent form (GCMMA). Cost and constraints `d_i <= 0`, f_0 and f_1 .. f_K, are each replaced at
/// the control m by a separable convex function with asymptotes at m_j - s_j and m_j + s_j, whose value and derivative there are theirs:
///
/// ```text
/// F_i(m + x) = f_i + sum_j s_j x_j ( a_ij/(s_j - x_j) - b_ij/(s_j + x_j) )
/// a_ij = 1.001 max(f_i,j, 0) + 0.001 max(-f_i,j, 0) + c_i/(4 s_j),   b_ij the same of -f_i,j
/// ```
///
/// The next trial minimises F_0 + r sum_i max(0, F_i) within the bounds, the move limit and 0.9 s_j, through its dual: the K multipliers between 0 and r. The
/// artificial variables max(0, F_i) make it feasible always; r is the [penalty](crate::AugmentedLagrangian::penalty).
///
/// A trial is accepted when F_0 is no less than the cost there and every constraint is met or no more than its F_i; else c_i grows (the convex term is
/// `c_i x_j^2 / (2 (s_j^2 - x_j^2))`) and the same asymptotes give a shorter step: an evaluation each, no derivative. So the cost with the penalty never rises, and
/// once the constraints are met they stay met. A trial that cannot be evaluated moves the asymptotes closer. Asymptotes of a component that turns back come
/// closer, of one that goes on move away ([`Asymptotes`]); in a new stage, and under a new penalty, they begin anew.
///
/// Only bounds are admissible ([`Admissible::intervals`]), and finite ones; constraints are inequalities ([`Unfit`]). The inner product measures the
/// gradient and the length of a move alone. Each constraint costs the derivative of its own at every accepted control.
///
/// Sources: K. Svanberg, Int. J. Numer. Meth. Engng 24 (1987) 359; SIAM J. Optim. 12 (2002) 555, sections 3 to 5 (rules for c_i and s_j). There a
/// constraint that is met with room is refused too where its F_i is less.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mma {
    /// When to stop, and what to ask of evaluations.
    pub options: Options,
    /// Where asymptotes are.
    pub asymptotes: Asymptotes,
}

impl Optimizer for Mma {
    fn name(&self) -> &'static str {
        "mma"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn method(&self) -> Box<dyn Method> {
        Box::new(MovingAsymptotes::new(self.asymptotes))
    }

    fn holds_constraints(&self) -> bool {
        true
    }

    fn check_set(&self, set: &dyn Admissible, len: usize) -> Result<(), Unfit> {
        let method = self.name();
        let all = set.intervals(len).map_err(|set| Unfit::Set { method, set })?;
        match all.lower.iter().zip(&all.upper).position(|(lower, upper)| !(upper - lower).is_finite()) {
            Some(index) => Err(Unfit::Range { method, index, lower: all.lower[index], upper: all.upper[index] }),
            None => Ok(()),
        }
    }
}
