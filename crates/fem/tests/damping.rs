//! The numerical damping of every scheme: as it is computed, and seen on a point mass on a linear spring that the
//! stepper itself moves.

use crate::common;

use common::Outcome;
use common::motion::{motion, oscillator, schemes, uniform};
use nalgebra::{Complex, DMatrix};
use nastic_fem::{Scheme, Solid};

type C = Complex<f64>;

/// Displacement, velocity and acceleration of one free unknown after so many unit steps, from a small multiple of a
/// state.
fn after(solid: &Solid, scheme: &Scheme, [u, v, a]: [f64; 3], count: usize) -> Outcome<Vec<[f64; 3]>> {
    const SIZE: f64 = 1e-2;
    let begin = uniform(solid, SIZE * u, SIZE * v, Some(SIZE * a));
    let free = solid.supports().fixed().iter().position(|fixed| !fixed).ok_or("nothing is free")?;
    let trajectory = motion(solid, scheme, begin, count, 1.0)?;
    let entry = |values: &Option<std::sync::Arc<Vec<f64>>>| values.as_ref().map_or(0.0, |v| v[free] / SIZE);
    Ok(trajectory.states().iter().map(|s| [s.u[free] / SIZE, entry(&s.velocity), entry(&s.acceleration)]).collect())
}

/// `|R|` from the eigenvalues of the amplification matrix of (u, v, a), column by column from unit states: the
/// largest of a conjugate pair, if there is one.
fn of_matrix(solid: &Solid, scheme: &Scheme) -> Outcome<f64> {
    let mut matrix = DMatrix::zeros(3, 3);
    for k in 0..3 {
        let mut unit = [0.0; 3];
        unit[k] = 1.0;
        let end = after(solid, scheme, unit, 1)?[1];
        (0..3).for_each(|i| matrix[(i, k)] = end[i]);
    }
    let eigenvalues = matrix.complex_eigenvalues();
    let paired: Vec<f64> = eigenvalues.iter().filter(|e| e.im != 0.0).map(|e| e.norm()).collect();
    let all = if paired.is_empty() { eigenvalues.iter().map(|e| e.norm()).collect() } else { paired };
    Ok(all.into_iter().fold(0.0, f64::max))
}

/// `|R|` of a scheme over two steps: with `mu^2 + c mu + w^2 = 0`, `z = v - conj(mu) u` follows `z' = mu z` and so
/// `z_{n+1} = p z_n + q z_{n-1}`, `R^2 = p R + q`, p and q from the steps
/// after the first.
fn of_recurrence(solid: &Solid, scheme: &Scheme, (w, c): (f64, f64)) -> Outcome<f64> {
    let mu = C::new(-0.5 * c, (w * w - 0.25 * c * c).sqrt());
    let z: Vec<C> =
        after(solid, scheme, [1.0, 0.3, 0.0], 4)?[1..].iter().map(|[u, v, _]| C::from(*v) - mu.conj() * *u).collect();
    let determinant = z[1] * z[1] - z[2] * z[0];
    let (p, q) = ((z[2] * z[1] - z[3] * z[0]) / determinant, (z[1] * z[3] - z[2] * z[2]) / determinant);
    let root = (p * p + q * 4.0).sqrt();
    Ok(((p + root) / 2.0).norm().max(((p - root) / 2.0).norm()))
}

/// `d/w = -(2/t) ln |R|` with `t = h w`, seen in steps.
fn seen(scheme: &Scheme, t: f64, physical: f64) -> Outcome<f64> {
    let solid = oscillator(t, physical * t)?;
    let r = if scheme.start().is_some() {
        of_recurrence(&solid, scheme, (t, physical * t))?
    } else {
        of_matrix(&solid, scheme)?
    };
    Ok(-2.0 / t * r.ln())
}

/// Closed forms; of generalised alpha from its published matrix below.
fn closed_form(name: &str, t: f64) -> Outcome<f64> {
    let t2 = t * t;
    match name {
        "backward_euler" | "linearly_implicit_euler" => Ok((1.0 + t2).ln() / t),
        "bdf2" => {
            let s = (1.0 + 4.0 * t2).sqrt();
            Ok(((9.0 + 4.0 * t2) / (4.0 + s + 2.0 * (2.0 * (1.0 + s)).sqrt())).ln() / t)
        }
        "tr_bdf2" => Ok((1.0 + t2 * t2 / (144.0 + 25.0 * t2)).ln() / t),
        "trapezoidal" | "implicit_midpoint" => Ok(0.0),
        // every step from rest: u' = u / (1 + t^2)
        "quasi_dynamic" => Ok(2.0 * (1.0 + t2).ln() / t),
        // det of the amplification matrix, |R|^2: Hughes, The Finite Element Method (1987), section 9.1
        "newmark" => {
            let (beta, gamma) = (0.3025, 0.6);
            Ok(-(1.0 - (gamma - 0.5) * t2 / (1.0 + beta * t2)).ln() / t)
        }
        "generalized_alpha" => Ok(-2.0 / t * generalized_alpha(0.8, t).ln()),
        _ => Err(format!("no closed form of {name}").into()),
    }
}

/// `|R|` of generalised alpha from its equations, written once more: `A_1 y = A_0 y_n`, `y = (u, h v, h^2 a)`.
fn generalized_alpha(rho: f64, t: f64) -> f64 {
    let (m, f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
    let (gamma, beta) = (0.5 - m + f, 0.25 * (1.0 - m + f) * (1.0 - m + f));
    let new = DMatrix::from_row_slice(3, 3, &[(1.0 - f) * t * t, 0.0, 1.0 - m, 1.0, 0.0, -beta, 0.0, 1.0, -gamma]);
    let old = DMatrix::from_row_slice(3, 3, &[-f * t * t, 0.0, -m, 1.0, 1.0, 0.5 - beta, 0.0, 1.0, 1.0 - gamma]);
    let Some(inverse) = new.try_inverse() else { return f64::NAN };
    (inverse * old).complex_eigenvalues().iter().filter(|e| e.im != 0.0).map(|e| e.norm()).fold(0.0, f64::max)
}

#[test]
fn every_scheme_damps_as_its_closed_form_says() -> Outcome {
    // without inertia nothing vibrates: tests/quasi_static.rs; modes that move exactly: tests/siere.rs
    let seen_here = |scheme: &Scheme| !scheme.is_quasi_static() && scheme.exact_modes() == 0;
    for (scheme, _) in schemes()?.into_iter().filter(|(scheme, _)| seen_here(scheme)) {
        for t in [0.1, 1.0, 10.0] {
            let expected = closed_form(scheme.name(), t)?;
            let found = scheme.modal_damping(0.5, 2.0 * t, 0.0, 0.0)?.effective;
            let seen = seen(&scheme, t, 0.0)?;
            println!("{:<24} h w = {t:4}: d/w = {found:.6e}, closed form {expected:.6e}", scheme.name());
            assert!((found - expected).abs() < 1e-10, "{} at {t}: {found:e}, not {expected:e}", scheme.name());
            assert!((seen - expected).abs() < 1e-10, "{} at {t}: steps show {seen:e}", scheme.name());
        }
    }
    Ok(())
}

/// With a physical damping of d/w = 0.2 the trapezoidal rule loses it at large steps. Four digits, from the closed
/// forms with a complex frequency.
#[test]
fn physical_damping_is_changed_by_the_scheme() -> Outcome {
    let table = [
        (Scheme::backward_euler(), [0.2956, 0.7885, 0.4635]),
        (Scheme::bdf2(), [0.1985, 0.2555, 0.2453]),
        (Scheme::tr_bdf2(), [0.1998, 0.1838, 0.1732]),
        (Scheme::trapezoidal(), [0.1995, 0.1603, 0.0077]),
    ];
    for (scheme, expected) in &table {
        for (t, expected) in [0.1, 1.0, 10.0].into_iter().zip(expected) {
            let h = 0.01;
            // half of d/w by the mass, half by the stiffness
            let found = scheme.modal_damping(h, t / h, 0.1 * t / h, 0.1 * h / t)?;
            assert!((found.physical - 0.2).abs() < 1e-15);
            let (found, seen) = (found.effective, seen(scheme, t, 0.2)?);
            println!("{:<18} h w = {t:4}, d/w = 0.2: {found:.10}", scheme.name());
            assert!((found - seen).abs() < 1e-10, "{} at {t}: {found:e}, steps show {seen:e}", scheme.name());
            assert!((found - expected).abs() < 6e-5, "{} at {t}: {found}, not {expected}", scheme.name());
        }
    }
    Ok(())
}

/// Closed forms of `arg R / t`: backward Euler and the trapezoidal rule have R = 1/(1 - i t) and (1 + i t/2)/(1 - i t/2); at
/// t = 1 the others to four digits. A mode that creeps back has no frequency.
#[test]
fn every_scheme_lowers_the_frequency_as_its_closed_form_says() -> Outcome {
    let frequency = |scheme: &Scheme, t: f64| -> Outcome<f64> {
        scheme.modal_damping(1.0, t, 0.0, 0.0)?.frequency.ok_or_else(|| "no frequency".into())
    };
    for t in [0.1, 1.0, 10.0] {
        for (scheme, expected) in [
            (Scheme::backward_euler(), f64::atan(t) / t),
            (Scheme::trapezoidal(), 2.0 * f64::atan(0.5 * t) / t),
            (Scheme::implicit_midpoint(), 2.0 * f64::atan(0.5 * t) / t),
        ] {
            let found = frequency(&scheme, t)?;
            assert!((found - expected).abs() < 1e-10, "{} at {t}: {found}, not {expected}", scheme.name());
        }
    }
    for (scheme, expected) in [(Scheme::bdf2(), 0.8238), (Scheme::tr_bdf2(), 0.9615), (Scheme::trapezoidal(), 0.9273)] {
        let found = frequency(&scheme, 1.0)?;
        assert!((found - expected).abs() < 6e-5, "{}: {found}, not {expected}", scheme.name());
    }
    for (scheme, _) in schemes()?.into_iter().filter(|(scheme, _)| !scheme.is_quasi_static()) {
        let (exact, at_rest) = (scheme.modal_damping(1e-3, 1.0, 0.2, 0.0)?, scheme.name() == "quasi_dynamic");
        let kept =
            exact.frequency.is_some_and(|ratio| (ratio - 1.0).abs() < 1e-3) && (exact.effective - 0.2).abs() < 2e-3;
        assert!(kept != at_rest, "{}: {exact:?}", scheme.name());
        assert_eq!(scheme.modal_damping(0.1, 1.0, 2.5, 0.0)?.frequency, None);
    }
    Ok(())
}

/// A mode beyond critical damping: the slower of its two exponentials, in short steps.
#[test]
fn an_overdamped_mode_decays_as_its_slower_part() -> Outcome {
    let (d, h): (f64, f64) = (3.0, 1e-3);
    let expected = d - (d * d - 4.0).sqrt();
    for (scheme, order) in schemes()?.into_iter().filter(|(_, order)| *order > 0) {
        let found = scheme.modal_damping(h, 1.0, d, 0.0)?.effective;
        let tolerance = if order == 1 { 1e-3 } else { 1e-6 };
        assert!((found - expected).abs() < tolerance, "{}: {found} instead of {expected}", scheme.name());
    }
    Ok(())
}

#[test]
fn a_mode_that_is_none_is_refused() {
    for (h, w, a0) in
        [(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (1.0, f64::NAN, 0.0), (1.0, 1.0, -0.1), (f64::INFINITY, 1.0, 0.0)]
    {
        let refused = Scheme::backward_euler().modal_damping(h, w, a0, 0.0);
        assert!(refused.is_err_and(|error| error.to_string().contains("h w")), "{h}, {w}, {a0}");
    }
    let refused = Scheme::quasi_static().amplification(1.0, 0.0);
    assert!(refused.is_err_and(|error| error.to_string().contains("inertia")));
}

/// Newmark's scheme with 1/4 and 1/2 and generalised alpha with rho = 1 are the trapezoidal and the midpoint rule on
/// linear problems; with rho = 0 nothing is left of a mode of infinite frequency.
#[test]
fn special_parameters_are_special_schemes() -> Outcome {
    for t in [0.1, 1.0, 10.0] {
        let solid = oscillator(t, 0.1)?;
        let end =
            |scheme: &Scheme| -> Outcome<[f64; 3]> { Ok(after(&solid, scheme, [1.0, 0.4, -t * t - 0.04], 3)?[3]) };
        let trapezoidal = end(&Scheme::trapezoidal())?;
        for other in [Scheme::newmark(0.25, 0.5)?, Scheme::generalized_alpha(1.0)?] {
            let found = end(&other)?;
            for k in 0..2 {
                assert!((found[k] - trapezoidal[k]).abs() < 1e-11 * (1.0 + t), "{}: {found:?}", other.name());
            }
        }
    }
    // the acceleration of generalised alpha has an eigenvalue of -1 there, which is not that of the mode
    for (t, damping) in [(0.1, 0.2), (1.0, 0.2), (10.0, 0.2), (0.1, 3.0)] {
        let of = |scheme: Scheme| scheme.modal_damping(1.0, t, damping * t, 0.0);
        let (expected, found) = (of(Scheme::trapezoidal())?, of(Scheme::generalized_alpha(1.0)?)?);
        assert!((found.effective - expected.effective).abs() < 1e-10, "{t}, {damping}: {found:?}, {expected:?}");
    }
    let stiff = oscillator(1e4, 0.0)?;
    let gone = after(&stiff, &Scheme::generalized_alpha(0.0)?, [1.0, 0.0, -1e8], 3)?[3][0];
    assert!(gone.abs() < 1e-6, "{gone:e}");
    Ok(())
}
