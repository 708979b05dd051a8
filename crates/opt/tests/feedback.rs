//! [`Feedback`] against the formula, its contraction against closed forms, and what has no law.

use nastic_opt::{Feedback, FeedbackInputs};

fn law(jacobian: &[Vec<f64>], weights: &[f64], scales: &[f64], damping: f64) -> Option<Feedback> {
    Feedback::of(&FeedbackInputs { jacobian, weights, scales, damping, rounding: 1e-8 })
}

/// `(S^T Q S + R) L = S^T Q`, whether there are more outputs or more controls.
#[test]
fn the_matrix_solves_its_normal_equations() -> Result<(), String> {
    let tall = vec![vec![2.0, -1.0], vec![0.5, 3.0], vec![1.0, 1.0]];
    let wide = vec![vec![2.0, 0.5, 1.0], vec![-1.0, 3.0, 1.0]];
    for (s, scales) in [(tall, vec![2.0, 0.1]), (wide, vec![1.0, 5.0, 0.3])] {
        let weights: Vec<f64> = (0..s.len()).map(|i| 1.0 + i as f64).collect();
        let found = law(&s, &weights, &scales, 0.05).ok_or("no law")?;
        let n = scales.len();
        for j in 0..n {
            for i in 0..s.len() {
                let mut left = found.penalty[j] * found.gain[j][i];
                for k in 0..n {
                    let entry: f64 = (0..s.len()).map(|o| s[o][j] * weights[o] * s[o][k]).sum();
                    left += entry * found.gain[k][i];
                }
                let right = s[i][j] * weights[i];
                assert!((left - right).abs() < 1e-12 * (1.0 + right.abs()), "{j} {i}: {left} {right}");
            }
        }
        assert_eq!(found.unmoved.len(), s.len().saturating_sub(n));
        for v in &found.unmoved {
            for j in 0..n {
                let along: f64 = (0..s.len()).map(|o| v[o] * weights[o].sqrt() * s[o][j]).sum();
                assert!(along.abs() < 1e-13, "{along}");
            }
        }
    }
    Ok(())
}

#[test]
fn errors_shrink_as_the_closed_form_says() -> Result<(), String> {
    // singular values 4 and 1 in the scales (2, 1): R = rho 16 / d^2
    let s = vec![vec![2.0, 0.0], vec![0.0, 1.0], vec![0.0, 0.0]];
    let found = law(&s, &[1.0; 3], &[2.0, 1.0], 0.01).ok_or("no law")?;
    let values: Vec<f64> = found.moved.iter().map(|one| one.value).collect();
    assert!((values[0] - 4.0).abs() < 1e-14 && (values[1] - 1.0).abs() < 1e-14, "{values:?}");
    assert!((found.penalty[0] - 0.04).abs() < 1e-15 && (found.penalty[1] - 0.16).abs() < 1e-15);
    let slowest = 0.16 / 1.16;
    assert!((found.contraction(&s).ok_or("none")? - slowest).abs() < 1e-14);
    // twice as much as was thought: 1 - 2 sigma^2 / (sigma^2 + r); the third output, which L does not see, counts for nothing
    let double: Vec<Vec<f64>> = s.iter().map(|row| row.iter().map(|entry| 2.0 * entry).collect()).collect();
    assert!((found.contraction(&double).ok_or("none")? - (2.0 * 16.0 / 16.16 - 1.0)).abs() < 1e-14);
    // a rotation by 90 degrees has complex eigenvalues: |1 - i g| > 1
    let turned = vec![vec![0.0, -1.0], vec![1.0, 0.0]];
    let own = law(&[vec![1.0, 0.0], vec![0.0, 1.0]], &[1.0; 2], &[1.0; 2], 0.0).ok_or("no law")?;
    assert!((own.contraction(&turned).ok_or("none")? - 2.0_f64.sqrt()).abs() < 1e-14);
    Ok(())
}

/// The loop with another body's derivatives shrinks by its contraction.
#[test]
fn loops_of_linear_bodies_converge_at_their_contraction() -> Result<(), String> {
    let s = vec![vec![2.0, -1.0, 0.3], vec![0.5, 3.0, 0.2]];
    let other: Vec<Vec<f64>> = s.iter().map(|row| row.iter().map(|x| 1.3 * x + 0.1).collect()).collect();
    let found = law(&s, &[1.0, 4.0], &[1.0, 2.0, 1.0], 0.02).ok_or("no law")?;
    let rate = found.contraction(&other).ok_or("none")?;
    let bounds = [[-1e9, 1e9]; 3];
    let (mut m, mut last) = (vec![0.0; 3], 1.0);
    let target = [1.0, -2.0];
    let mut ratio = 0.0;
    for _ in 0..12 {
        let errors: Vec<f64> =
            other.iter().zip(target).map(|(row, y)| row.iter().zip(&m).map(|(s, m)| s * m).sum::<f64>() - y).collect();
        let size = errors.iter().map(|e| e * e).sum::<f64>().sqrt();
        (ratio, last) = (size / last, size);
        m = found.step(&m, &errors, &bounds);
    }
    assert!(rate < 0.5 && (ratio / rate - 1.0).abs() < 0.05, "{ratio} {rate}");
    let clipped = found.step(&[0.0; 3], &[-100.0, 100.0], &[[-1.0, 1.0]; 3]);
    assert!(clipped.iter().all(|m| m.abs() <= 1.0) && clipped.iter().any(|m| m.abs() == 1.0), "{clipped:?}");
    Ok(())
}

/// At an optimum on a bound the law rests, though `-L (y - y*)` cut by the bounds would leave it; and from elsewhere it comes there.
#[test]
fn the_law_rests_at_optima_on_bounds() -> Result<(), String> {
    let s = vec![vec![2.0, 1.5], vec![1.0, 1.2]];
    let (bounds, target) = ([[0.0, 5.0]; 2], [3.0, 0.5]);
    // the least squares of the first control alone; the second would be negative
    let best = (2.0 * target[0] + target[1]) / 5.0;
    let errors = |m: &[f64]| -> Vec<f64> {
        s.iter().zip(target).map(|(row, y)| row.iter().zip(m).map(|(s, m)| s * m).sum::<f64>() - y).collect()
    };
    let found = law(&s, &[1.0; 2], &[1.0; 2], 1e-2).ok_or("no law")?;
    let optimum = [best, 0.0];
    let stays = found.step(&optimum, &errors(&optimum), &bounds);
    assert!((stays[0] - best).abs() < 1e-11 && stays[1] == 0.0, "{stays:?}");
    let cut = |j: usize| found.gain[j].iter().zip(errors(&optimum)).map(|(gain, error)| gain * error).sum::<f64>();
    assert!(cut(0).abs() > 0.1 && cut(1) > 0.1, "{} {}", cut(0), cut(1));
    let mut m = vec![4.0, 4.0];
    for _ in 0..60 {
        m = found.step(&m, &errors(&m), &bounds);
    }
    assert!((m[0] - best).abs() < 1e-9 && m[1] == 0.0, "{m:?}");
    Ok(())
}

#[test]
fn what_no_control_moves_has_no_law() {
    assert_eq!(law(&[vec![0.0, 0.0]], &[1.0], &[1.0, 1.0], 0.1), None);
    assert_eq!(law(&[vec![f64::NAN]], &[1.0], &[1.0], 0.1), None);
    assert_eq!(law(&[], &[], &[1.0], 0.1), None);
}
