//! Random fields: covariance, eigenvalues, means.

use nastic_energy::{Field, MooneyRivlin};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_uncertainty::{FieldLaw, Modes, RandomField, Sample, UnitModes};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn block() -> Outcome<Mesh> {
    Ok(box_mesh([1.0, 0.4, 0.2], [6, 3, 2], CellKind::Hex8)?)
}

/// `sum_k l_k phi_k(i) phi_k(j)`.
fn covariance(field: &RandomField, i: usize, j: usize) -> f64 {
    field.modes().iter().map(|mode| mode[i] * mode[j]).sum()
}

#[test]
fn all_modes_reproduce_the_covariance() -> Outcome {
    let (mesh, length) = (block()?, 0.5);
    let field = RandomField::log_normal(&mesh, "body", 2e5, 0.3, length, Modes::Energy(1.0))?;
    let variance = 1.09f64.ln();
    assert!((field.captured() - 1.0).abs() < 1e-12);
    for i in 0..mesh.cells() {
        for j in 0..mesh.cells() {
            let (x, y) = (mesh.cell_centre(i), mesh.cell_centre(j));
            let distance = (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt();
            let exact = variance * (-distance / length).exp();
            assert!((covariance(&field, i, j) - exact).abs() < 1e-12, "{i} {j}");
        }
    }
    Ok(())
}

/// What the modes kept hold of the variance is what they say, and grows with their number.
#[test]
fn captured_energy_is_that_of_the_modes() -> Outcome {
    let mesh = block()?;
    let volume = 0.08 / mesh.cells() as f64;
    let mut last = 0.0;
    for count in [1, 3, 8, 20] {
        let field = RandomField::log_normal(&mesh, "body", 1.0, 0.2, 0.4, Modes::Count(count))?;
        assert_eq!((field.modes().len(), field.laws().len()), (count, count));
        let held: f64 = (0..mesh.cells()).map(|i| volume * covariance(&field, i, i)).sum();
        assert!((held / (field.variance() * 0.08) - field.captured()).abs() < 1e-12);
        assert!((field.eigenvalues().iter().sum::<f64>() / held - 1.0).abs() < 1e-12);
        assert!(field.captured() > last);
        last = field.captured();
    }
    let field = RandomField::log_normal(&mesh, "body", 1.0, 0.2, 0.4, Modes::Energy(0.9))?;
    let fewer = RandomField::log_normal(&mesh, "body", 1.0, 0.2, 0.4, Modes::Count(field.modes().len() - 1))?;
    assert!(field.captured() >= 0.9 && fewer.captured() < 0.9);
    Ok(())
}

/// On a thin bar: the eigenvalues of the exponential kernel on an interval, `2 l s^2/(1 + l^2 w^2)` with
/// `l w tan(w/2) = 1` and `l w + tan(w/2) = 0` in turn (Ghanem & Spanos, section 2.3.3), times the cross-section.
#[test]
fn eigenvalues_of_a_bar_are_the_closed_ones() -> Outcome {
    let (length, area) = (0.7, 1e-4);
    let mesh = box_mesh([1.0, 1e-2, 1e-2], [200, 1, 1], CellKind::Hex8)?;
    let field = RandomField::log_normal(&mesh, "body", 1.0, 0.5, length, Modes::Count(4))?;
    for (k, value) in field.eigenvalues().iter().enumerate() {
        // The k-th root lies where w/2 is in (k pi/2, (k+1) pi/2).
        let (mut low, mut high) = (k as f64 * std::f64::consts::PI, (k + 1) as f64 * std::f64::consts::PI);
        let excess = |w: f64| match k % 2 {
            0 => length * w * (0.5 * w).sin() - (0.5 * w).cos(),
            _ => length * w * (0.5 * w).cos() + (0.5 * w).sin(),
        };
        let rising = excess(high) > excess(low);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (excess(middle) > 0.0) == rising { high = middle } else { low = middle }
        }
        let exact = area * 2.0 * length * field.variance() / (1.0 + (length * low).powi(2));
        assert!((value / exact - 1.0).abs() < 2e-3, "mode {k}: {value:e} and {exact:e}");
    }
    Ok(())
}

/// The mean is the mean at every cell, and the variance that of the modes, however few are kept.
#[test]
fn values_have_the_stated_mean_and_variance() -> Outcome {
    let mesh = block()?;
    let field = RandomField::log_normal(&mesh, "body", 3e4, 0.3, 0.6, Modes::Count(2))?;
    let rule = Sample::tensor(&field.laws(), &[12, 12])?;
    let at = |xi: &[f64], cell: usize| match field.realise(xi) {
        Ok(Field::Cell(values)) => values[cell],
        other => panic!("{other:?}"),
    };
    for cell in [0, 7, 20] {
        assert!((rule.expectation(|xi| at(xi, cell)) / 3e4 - 1.0).abs() < 1e-12);
        let relative = rule.expectation(|xi| (at(xi, cell) / 3e4 - 1.0).powi(2));
        assert!((relative / covariance(&field, cell, cell).exp_m1() - 1.0).abs() < 1e-9);
    }
    assert!(field.realise(&[0.0]).is_err());
    // It is a parameter like any other.
    let law = MooneyRivlin::new(field.realise(&[1.0, -0.5])?, 2e4, 1e6)?;
    Solid::new(mesh)?.material("body", law)?.clamp("x-")?.check()?;
    Ok(())
}

#[test]
fn fields_that_make_no_sense_are_refused() -> Outcome {
    let mesh = block()?;
    for (numbers, modes, what) in [
        ((-1.0, 0.1, 0.1), Modes::Count(2), "mean"),
        ((1.0, 0.1, 0.0), Modes::Count(2), "length"),
        ((1.0, 0.1, 0.1), Modes::Count(0), "keeps no mode"),
        ((1.0, 0.1, 0.1), Modes::Energy(1.5), "keeps no mode"),
    ] {
        let text =
            RandomField::log_normal(&mesh, "body", numbers.0, numbers.1, numbers.2, modes).unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    }
    let text = RandomField::log_normal(&mesh, "bdy", 1.0, 0.1, 0.1, Modes::Count(2)).unwrap_err().to_string();
    assert!(text.contains("bdy") && text.contains("body"), "{text}");
    Ok(())
}

/// Modes of unit variance that something else has found: a field has the mean and the deviation that it is given, at every cell; linearised it has the median and
/// the slopes of its values.
#[test]
fn fields_of_given_modes() -> Outcome {
    let (mean, deviation) = (3e4, 6e3);
    let of =
        || UnitModes { cells: vec![1, 4], all_cells: 6, modes: vec![vec![0.6, -1.0], vec![0.8, 0.0]], captured: 0.7 };
    for law in [FieldLaw::LogNormal, FieldLaw::Gaussian] {
        let field = RandomField::of_modes(law, mean, deviation, of())?;
        let at = |xi: &[f64], cell: usize| match field.realise(xi) {
            Ok(Field::Cell(values)) => values[cell],
            other => panic!("{other:?}"),
        };
        let rule = Sample::tensor(&field.laws(), &[14, 14])?;
        for cell in [1, 4] {
            assert!((rule.expectation(|xi| at(xi, cell)) / mean - 1.0).abs() < 1e-12);
            let found = rule.expectation(|xi| (at(xi, cell) - mean).powi(2)).sqrt();
            assert!((found / deviation - 1.0).abs() < 1e-9, "{law:?}: {found}");
        }
        assert_eq!((at(&[1.0, 1.0], 0), field.captured()), (mean, 0.7));
        let (median, slopes) = field.linearised();
        let (step, zero) = (1e-4, [0.0, 0.0]);
        for (own, cell) in [1, 4].into_iter().enumerate() {
            assert!((at(&zero, cell) / median[own] - 1.0).abs() < 1e-14);
            for (k, slope) in slopes.iter().enumerate() {
                let along = |sign: f64| at(&[0, 1].map(|i| if i == k { sign * step } else { 0.0 }), cell);
                let found = (along(1.0) - along(-1.0)) / (2.0 * step);
                assert!((found - slope[own]).abs() < 1e-6 * deviation, "{law:?}: {found} and {}", slope[own]);
            }
        }
    }
    assert!(RandomField::of_modes(FieldLaw::LogNormal, -1.0, 0.1, of()).is_err());
    Ok(())
}

#[test]
fn a_gaussian_field_on_the_mesh() -> Outcome {
    let mesh = block()?;
    let field = RandomField::gaussian(&mesh, "body", -2.0, 0.5, 0.4, Modes::Energy(1.0))?;
    let (x, y) = (mesh.cell_centre(0), mesh.cell_centre(9));
    let distance = (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt();
    assert!((covariance(&field, 0, 9) - 0.25 * (-distance / 0.4).exp()).abs() < 1e-12);
    assert!(matches!(field.realise(&vec![0.0; field.modes().len()])?, Field::Cell(values) if values[3] == -2.0));
    let text = RandomField::log_normal(
        &box_mesh([1.0; 3], [17, 17, 17], CellKind::Hex8)?,
        "body",
        1.0,
        0.1,
        0.1,
        Modes::Count(2),
    );
    let text = text.unwrap_err().to_string();
    assert!(text.contains("4913 cells") && text.contains("\"kernel\": \"matern\""), "{text}");
    Ok(())
}
