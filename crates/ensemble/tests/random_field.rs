//! Fields of Whittle and Matern: covariance, variance at boundaries, eigenvalues, refinement.

use nastic_ensemble::{Kept, Matern, MaternModes};
use nastic_fem::Discretization;
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_numeric::Random;
use nastic_numeric::vector::norm;
use std::f64::consts::PI;
use std::time::Instant;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn field(mesh: Mesh, length: f64) -> Outcome<Matern> {
    let disc = Discretization::new(mesh.into())?;
    Ok(Matern::new(&disc, &"body".into(), length)?)
}

/// The unknown nearest to a place.
fn near(field: &Matern, x: [f64; 3]) -> usize {
    let apart = |y: &[f64; 3]| (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>();
    let at = field.positions();
    (0..at.len()).min_by(|a, b| apart(&at[*a]).total_cmp(&apart(&at[*b]))).unwrap_or(0)
}

/// In the middle of a box eight lengths wide the covariance is `exp(-r/L)`, on hexahedra and on tetrahedra, two sizes of each, with what the
/// boundary reflects; what the mesh does not resolve near r = 0 is none of these distances.
#[test]
fn the_covariance_in_the_middle_is_exponential() -> Outcome {
    for (kind, cells) in [(CellKind::Hex8, 24), (CellKind::Hex8, 32), (CellKind::Tet4, 32), (CellKind::Tet4, 40)] {
        let field = field(box_mesh([8.0; 3], [cells; 3], kind)?, 1.0)?;
        let column = field.covariance(near(&field, [4.0; 3]));
        for distance in [1.0, 1.5, 2.0] {
            let at = near(&field, [4.0 + distance, 4.0, 4.0]);
            let (found, exact) = (column[at], reflected(field.positions()[at]));
            println!("{kind} {cells}, r = {distance}: {found} and {exact}");
            assert!((found / exact - 1.0).abs() < 0.02, "{kind} {cells}, r = {distance}: {found} and {exact}");
        }
    }
    Ok(())
}

/// `sum exp(-|X - Y|)` over the source in the middle of the box and its reflections, which are eight apart.
fn reflected(x: [f64; 3]) -> f64 {
    let places = [-1.0, 0.0, 1.0].map(|n| 4.0 + 8.0 * n);
    let mut sum = 0.0;
    for a in places {
        for b in places {
            for c in places {
                sum += (-norm(&[x[0] - a, x[1] - b, x[2] - c])).exp();
            }
        }
    }
    sum
}

/// The natural boundary reflects: the variance on a face, an edge, a corner is 2, 4, 8 times that in the middle before it is scaled, and 1 everywhere after.
#[test]
fn the_variance_at_boundaries_is_scaled_away() -> Outcome {
    // an edge or a corner of a box that tetrahedra fill has unlike numbers of them, on which the variance at a node depends
    for (kind, cells, tolerances) in [(CellKind::Hex8, 24, [0.01; 3]), (CellKind::Tet4, 24, [0.01, 0.05, 0.1])] {
        let field = field(box_mesh([8.0; 3], [cells; 3], kind)?, 1.0)?;
        let variance = |x: [f64; 3]| {
            let at = near(&field, x);
            field.covariance(at)[at]
        };
        let middle = variance([4.0; 3]);
        let places = [([0.0, 4.0, 4.0], 2.0), ([0.0, 0.0, 4.0], 4.0), ([0.0; 3], 8.0)];
        for ((x, factor), tolerance) in places.into_iter().zip(tolerances) {
            let found = variance(x) / middle;
            println!("{kind} {x:?}: {found}");
            assert!((found / factor - 1.0).abs() < tolerance, "{kind} at {x:?}: {found} and {factor}");
        }
        let modes = field.modes(Kept::Count(20))?;
        assert!(modes.before[1] / modes.before[0] > 2.5, "{:?}", modes.before);
        for c in 0..modes.cells.len() {
            let found: f64 = modes.at_cells.iter().map(|a| a[c] * a[c]).sum();
            assert!((found - 1.0).abs() < 1e-12, "cell {c}: {found}");
        }
    }
    Ok(())
}

/// Along a bar the modes are cosines, `lambda_k = (k pi / length)^2`, found to second order.
#[test]
fn eigenvalues_of_a_bar_converge_at_second_order() -> Outcome {
    let errors = |cells: usize| -> Outcome<Vec<f64>> {
        let found = field(box_mesh([2.0, 0.05, 0.05], [cells, 1, 1], CellKind::Hex8)?, 0.5)?.modes(Kept::Count(5))?;
        assert!(found.counted);
        let exact = |k: usize| (k as f64 * PI / 2.0).powi(2);
        assert!(found.lambda[0] < 1e-9);
        Ok((1..5).map(|k| (found.lambda[k] / exact(k) - 1.0).abs()).collect())
    };
    let (coarse, fine) = (errors(20)?, errors(40)?);
    for (k, (coarse, fine)) in coarse.iter().zip(&fine).enumerate() {
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.05 && *fine < 1e-2, "mode {}: {coarse:e}, {fine:e}, order {order}", k + 1);
    }
    Ok(())
}

/// `sum_k a_k xi_k` by cell.
fn realise(modes: &MaternModes, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut out = vec![0.0; modes.cells.len()];
    for a in &modes.at_cells {
        let xi = random.symmetric() * 3.0_f64.sqrt();
        out.iter_mut().zip(a).for_each(|(out, a)| *out += xi * a);
    }
    out
}

/// The same random numbers are the same field on a finer mesh, also of a square bar, whose modes come in pairs, and of other cells.
#[test]
fn a_field_stays_what_it_is_on_other_meshes() -> Outcome {
    for width in [0.7, 1.0] {
        let modes = |n: usize, kind: CellKind| -> Outcome<MaternModes> {
            let mesh = box_mesh([2.0, width, 1.0], [2 * n, n, n], kind)?;
            Ok(field(mesh, 0.6)?.modes(Kept::Count(12))?)
        };
        let coarse = modes(6, CellKind::Hex8)?;
        let fine = modes(12, CellKind::Hex8)?;
        for seed in 0..4 {
            let (a, b) = (realise(&coarse, seed), realise(&fine, seed));
            // a coarse cell has the mean of its eight
            let mut mean = vec![0.0; a.len()];
            for (c, value) in b.iter().enumerate() {
                let [i, j, k] = [c % 24, c / 24 % 12, c / 288].map(|i| i / 2);
                mean[i + 12 * (j + 6 * k)] += value / 8.0;
            }
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            let correlation = dot(&a, &mean) / (dot(&a, &a) * dot(&mean, &mean)).sqrt();
            println!("{width} {seed}: {correlation}");
            assert!(correlation > 0.99, "width {width}, seed {seed}: {correlation}");
        }
    }
    Ok(())
}

/// A share of the variance is kept by as few modes as hold it; the share of a number of modes is what they say to the error that goes with it.
#[test]
fn shares_of_the_variance() -> Outcome {
    let field = field(box_mesh([1.0, 0.5, 0.5], [10, 5, 5], CellKind::Hex8)?, 0.4)?;
    let nodes = field.positions().len();
    let all = field.modes(Kept::Count(nodes))?;
    assert!((all.share[0] - 1.0).abs() < 1e-5, "{:?}", all.share);
    let variance = |lambda: f64| (1.0 + 0.16 * lambda).powi(-2);
    let total: f64 = all.lambda.iter().map(|lambda| variance(*lambda)).sum();
    let half = field.modes(Kept::Share(0.8))?;
    let kept = |count: usize| all.lambda[..count].iter().map(|lambda| variance(*lambda)).sum::<f64>() / total;
    let count = half.at_cells.len();
    let [share, error] = half.share;
    assert!((share - kept(count)).abs() < 4.0 * error.max(1e-4), "{share} +- {error}, {}", kept(count));
    assert!(share >= 0.8 && kept(count - 1) < 0.8 + 4.0 * error, "{count} modes");
    for (kept, what) in
        [(Kept::Count(0), "1 to"), (Kept::Count(nodes + 1), "1 to"), (Kept::Share(1.5), "between 0 and 1")]
    {
        let text = field.modes(kept).unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    }
    let short = self::field(box_mesh([1.0; 3], [8; 3], CellKind::Hex8)?, 0.05)?;
    assert!((short.spacing() * 8.0 - 1.0).abs() < 1e-12);
    let text = short.modes(Kept::Share(0.95)).unwrap_err().to_string();
    assert!(text.contains("512 modes") && text.contains("95.0 %"), "{text}");
    assert!(self::field(box_mesh([1.0; 3], [1; 3], CellKind::Hex8)?, 0.0).is_err());
    Ok(())
}

/// What `{ "kernel": "matern" }` takes of a hundred thousand cells.
#[test]
#[ignore = "prints times, which depend on the machine"]
fn a_hundred_modes_of_a_hundred_thousand_cells() -> Outcome {
    let began = Instant::now();
    let field = field(box_mesh([1.0, 1.3, 0.8], [46, 47, 47], CellKind::Hex8)?, 0.2)?;
    let built = began.elapsed();
    let modes = field.modes(Kept::Count(100))?;
    println!("built {built:?}, all {:?}; share {:?}, before {:?}", began.elapsed(), modes.share, modes.before);
    assert!(modes.counted && modes.at_cells.len() == 100);
    Ok(())
}
