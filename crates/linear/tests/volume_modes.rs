//! Volume modes: the stiff part of a matrix, taken from it and added again.

use crate::support::Random;
use crate::support::case::Case;
use nastic_linear::solver::{Configuration, Step, System};
use nastic_linear::{Corners, LinearWork, Pattern, Rotations, Solver, SparseMatrix, VolumeModes};
use std::sync::Arc;

type Outcome = Result<(), Box<dyn std::error::Error>>;

#[test]
fn the_rest_and_the_modes_make_the_matrix() -> Outcome {
    let points: Vec<[f64; 3]> = (0..4).map(|i| [i as f64, 0.0, 0.0]).collect();
    let elements: [&[u32]; 2] = [&[2, 0, 1], &[1, 3, 2]];
    let pattern = Arc::new(Pattern::of_elements(&points, 2, elements)?);
    let mut matrix = SparseMatrix::zeros(pattern.clone());
    matrix.values.iter_mut().enumerate().for_each(|(k, value)| *value = (k as f64).sin());
    // the diagonal blocks are symmetric
    matrix.values.chunks_exact_mut(4).for_each(|block| block[2] = block[1]);
    let fixed = [false, false, false, true, false, false, false, false];
    let mut modes = VolumeModes::none(2);
    let mode = |seed: usize| (0..6).map(|k| ((k + seed) as f64).cos()).collect::<Vec<f64>>();
    modes.push(elements[0], &[mode(1), mode(2)], [3.0, 0.5]);
    modes.push(elements[1], &[mode(3)], [7.0, 0.25]);
    let modes = modes.supported(&fixed);
    assert_eq!((modes.len(), modes.is_empty()), (3, false));
    let rest = modes.rest(&matrix)?;
    let v: Vec<f64> = (0..8).map(|k| (1.0 + k as f64).ln()).collect();
    let (mut whole, mut sum, mut p) = ([0.0; 8], [0.0; 8], [0.0; 3]);
    matrix.multiply(&v, &mut whole);
    rest.multiply(&v, &mut sum);
    modes.of(&v, &mut p, false);
    p.iter_mut().zip(modes.stiffness()).for_each(|(p, [c, _])| *p *= c);
    modes.add(&p, &mut sum, true);
    let apart = whole.iter().zip(&sum).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-13, "{apart:e}");
    // nothing of it at a supported unknown
    let mut force = [0.0; 8];
    modes.add(&p, &mut force, false);
    assert!(force[3] == 0.0 && force[2] != 0.0);
    // nodes 0 and 3 are not coupled
    let mut foreign = VolumeModes::none(2);
    foreign.push(&[0, 3], &[vec![1.0; 4]], [1.0, 1.0]);
    assert!(foreign.supported(&fixed).rest(&matrix).is_err());
    Ok(())
}

/// A body at rest with volume modes.
struct WithModes<'a>(&'a Case, VolumeModes);

impl Configuration for WithModes<'_> {
    fn positions(&self) -> &[[f64; 3]] {
        &self.0.at.points
    }

    fn rotations(&self) -> &Arc<Rotations> {
        &self.0.at.rotations
    }

    fn corners(&self) -> Option<&Corners> {
        None
    }

    fn volume_modes(&self) -> Option<&VolumeModes> {
        Some(&self.1)
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Two steps of multigrid, the second with the levels of the first: `A x + B^T p = b` with `p = c (B x - d)` to a hundredth of what the expected changes leave of b, of
/// which they make nearly all; without them the residual of the matrix.
#[test]
fn a_step_that_expects_changes_leaves_some() -> Outcome {
    const STIFF: f64 = 1e4;
    let case = Case::new([6, 3, 3]);
    let (mut matrix, mut random) = (case.grid.laplacian(&case.pattern, 1.0), Random::new(5));
    let rest = matrix.clone();
    let mut modes = VolumeModes::none(3);
    for nodes in case.grid.cliques() {
        let mode = random.vector(3 * nodes.len());
        let element: Vec<f64> = mode.iter().flat_map(|a| mode.iter().map(move |b| STIFF * a * b)).collect();
        case.pattern.scatter(&case.pattern.scatter_map(nodes)?, &element, &mut matrix.values);
        modes.push(nodes, &[mode], [STIFF, 8.0]);
    }
    let modes = modes.supported(&case.fixed);
    let expected = random.vector(modes.len());
    let mut b = random.vector(case.pattern.dofs());
    let small = norm(&b);
    let pressures: Vec<f64> = expected.iter().map(|e| STIFF * e).collect();
    modes.add(&pressures, &mut b, false);
    let residual = |x: &[f64], left: Option<&[f64]>| {
        let (mut r, mut p) = (vec![0.0; x.len()], vec![0.0; modes.len()]);
        rest.multiply(x, &mut r);
        modes.of(x, &mut p, false);
        p.iter_mut().enumerate().for_each(|(k, p)| *p = STIFF * (*p - left.map_or(0.0, |left| left[k])));
        modes.add(&p, &mut r, false);
        r.iter_mut().zip(&b).for_each(|(r, b)| *r = b - *r);
        norm(&r)
    };
    for expects in [true, false] {
        let own = if expects { modes.clone().expecting(expected.clone()) } else { modes.clone() };
        let at = WithModes(&case, own);
        let system = System { configuration: &at, ..case.system(&matrix) };
        let mut solver = Solver::MULTIGRID.make(&case.structure);
        for _ in 0..2 {
            let mut work = LinearWork::default();
            let Step { x, changes_left, .. } = solver.step(&system, &b, 1e-9, &mut work)?;
            assert_eq!(changes_left.is_some(), expects);
            let left = residual(&x, changes_left.as_deref());
            // the finest step there is
            let most = if expects { 10.0 * small } else { norm(&b) };
            assert!(left <= 1e-4 * most, "{left:e} of {most:e}");
            assert!(!expects || residual(&x, None) > 1e-3 * small, "nothing is left");
        }
    }
    Ok(())
}
