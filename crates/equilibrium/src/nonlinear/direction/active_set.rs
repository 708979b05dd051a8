//! [`settle`]: which inequality constraints act in a linearised problem.

/// Sets that are tried.
const MAX_SETS: usize = 1000;

/// What a set of acting constraints leads to.
pub(super) struct Trial<T> {
    pub found: T,
    /// By constraint, by how much it is wrong: of an acting inequality its negative multiplier, of another one its negative `g`. 0 where it
    /// is right.
    pub wrong: Vec<f64>,
}

/// What the set of acting constraints leads to that solves the complementarity problem `g >= 0`, `p >= 0`, `p g = 0` of the inequalities in a linearised
/// problem, where `trial` gives what any set leads to; `None` where no set is right.
///
/// Constraints that are wrong change sides one by one: those that act first, then the one that is violated most, until a set comes
/// again; from then on the first of them, a rule under which none comes again where the matrix of the problem has positive principal
/// minors, as where the tangent is positive definite under the constraints. Source: Murty, "Linear Complementarity, Linear and Nonlinear
/// Programming" (1988), chapter 4 (principal pivoting by the least index).
///
/// # Errors
/// What `trial` says.
pub(super) fn settle<T, E>(
    first: Vec<bool>,
    mut trial: impl FnMut(&[bool]) -> Result<Trial<T>, E>,
) -> Result<Option<T>, E> {
    let (mut acting, mut tried, mut by_index) = (first, Vec::new(), false);
    for _ in 0..MAX_SETS {
        let Trial { found, wrong } = trial(&acting)?;
        let candidates = || (0..wrong.len()).filter(|&k| wrong[k] > 0.0);
        let worst = |of: bool| {
            let own = candidates().filter(|&k| acting[k] == of);
            own.fold(None, |worst: Option<usize>, k| Some(worst.filter(|&w| wrong[w] >= wrong[k]).unwrap_or(k)))
        };
        if tried.contains(&acting) {
            if by_index {
                return Ok(None);
            }
            by_index = true;
            tried.clear();
        }
        let Some(next) = (if by_index { candidates().next() } else { worst(true).or(worst(false)) }) else {
            return Ok(Some(found));
        };
        tried.push(acting.clone());
        acting[next] = !acting[next];
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// `w = q + M p`, `w >= 0`, `p >= 0`, `p . w = 0` from no acting constraint: p, and the sets that were tried.
    fn solve<const N: usize>(m: [[f64; N]; N], q: [f64; N]) -> (Option<[f64; N]>, usize) {
        let (matrix, offset) = (DMatrix::from_fn(N, N, |i, j| m[i][j]), DVector::from_row_slice(&q));
        let mut tried = 0;
        let found = settle(vec![false; N], |acting| {
            tried += 1;
            let mut system = DMatrix::identity(N, N);
            (0..N).filter(|&i| acting[i]).for_each(|i| system.set_row(i, &matrix.row(i)));
            let rhs = DVector::from_fn(N, |i, _| if acting[i] { -offset[i] } else { 0.0 });
            let p = system.lu().solve(&rhs).ok_or("singular")?;
            let w = &offset + &matrix * &p;
            let wrong = (0..N).map(|i| if acting[i] { -p[i] } else { -w[i] }.max(0.0)).collect();
            Ok::<_, &str>(Trial { found: std::array::from_fn(|i| p[i]), wrong })
        });
        (found.ok().flatten(), tried)
    }

    #[test]
    fn constraints_act_or_do_not() {
        let (p, _) = solve([[2.0, 1.0], [1.0, 2.0]], [-1.0, 1.0]);
        assert!(p.is_some_and(|p| (p[0] - 0.5).abs() < 1e-15 && p[1] == 0.0), "{p:?}");
        let (p, _) = solve([[2.0, -1.0], [-1.0, 2.0]], [-1.0, 0.1]);
        let exact = [(2.0 - 0.1) / 3.0, (1.0 - 0.2) / 3.0];
        assert!(p.is_some_and(|p| p.iter().zip(exact).all(|(p, exact)| (p - exact).abs() < 1e-15)), "{p:?}");
    }

    /// Positive principal minors (Murty 1974: p = 1 everywhere), on which one change after the other goes round.
    #[test]
    fn a_set_that_comes_again_changes_the_rule() {
        let (p, tried) = solve([[1.0, 2.0, 0.0], [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]], [-1.0; 3]);
        assert!(p.is_some_and(|p| p.iter().all(|p| (p - 1.0 / 3.0).abs() < 1e-15)), "{p:?}");
        assert!(tried > 7, "{tried}");
    }

    /// A negative diagonal: neither set is right, and that is said.
    #[test]
    fn a_problem_without_a_solution_ends() {
        assert_eq!(solve([[-1.0]], [-1.0]), (None, 5));
        assert_eq!(solve([[-1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0]).0, None);
    }
}
