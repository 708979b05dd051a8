//! Volume modes: the stiff part of a matrix, taken from it and added again.

use nastic_linear::{Pattern, SparseMatrix, VolumeModes};
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
