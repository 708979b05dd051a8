//! Laws with fibres: free sides, data that give their parameters back, and what is refused.
#![allow(clippy::unwrap_used)] // a test may

use nastic_fit::{Fibers, FitError, FitOptions, Law, Mode, Response, Test, bulk, curve, fit, scenarios, stable_range};

pub const TRUE: [(&str, &[f64]); 3] = [
    ("transverse_mooney_rivlin", &[8e4, 1.5e4, 2.5e5]),
    ("holzapfel_gasser_ogden_1", &[7.6e4, 9e5, 8.0, 0.12]),
    ("holzapfel_gasser_ogden_2", &[1.5e4, 9.9e5, 52.0, 0.226, 50.0]),
];

/// The law of a label.
fn named(label: &str) -> Law {
    Law::named(label).unwrap()
}

fn test(law: Law, values: &[f64], mode: Mode, fibers: Fibers, to: f64) -> Test {
    let term = law.incompressible(values).unwrap();
    let response = if mode == Mode::SimpleShear { Response::Shear } else { Response::Cauchy };
    let rest = if mode == Mode::SimpleShear { 0.0 } else { 1.0 };
    let at: Vec<f64> = (1..=15).map(|k| rest + (to - 1.0) * f64::from(k) / 15.0).collect();
    let points = at.iter().zip(curve(&*term, mode, fibers, response, &at)).map(|(x, y)| [*x, y]).collect();
    Test::new(mode.name(), mode, response, points).unwrap().loaded(fibers).unwrap()
}

fn battery(law: Law, values: &[f64]) -> Vec<Test> {
    let modes = [(Mode::Uniaxial, 1.4), (Mode::Equibiaxial, 1.25), (Mode::SimpleShear, 1.5)];
    let each = |(mode, to)| [Fibers::Along, Fibers::Across].map(|fibers| test(law, values, mode, fibers, to));
    modes.into_iter().flat_map(each).collect()
}

#[test]
fn parameters_come_back() {
    for (law, values) in TRUE.map(|(label, values)| (named(label), values)) {
        let found = fit(law, &battery(law, values), &FitOptions::default()).unwrap();
        println!("{law:?}: {:?}, squares {:.3e}, {:?}", found.values(), found.squares, found.starts);
        for (found, expected) in found.parameters.iter().zip(values) {
            let error = (found.value / expected - 1.0).abs();
            assert!(error < 1e-5, "{law:?}: {} = {} for {expected}", found.name, found.value);
        }
        assert_eq!(scenarios(&found).len(), 2 * values.len());
    }
}

/// Bars of the transverse law: with `I4 = F f . F f` and `|H f|^2` by hand, l2 of the free sides from the quadratic of `tau_2 = tau_3`.
///
/// Along: the sides are alike. Across, fibres along direction 2: `tau_2 - tau_3 = 2 (mu1 + mu3) l2^2 - 2 mu2 / l2^2 - 2 mu3 / l2^2
/// - 2 mu1 l3^2 + 2 mu2 / l3^2 = 0` with `l3 = 1/(l l2)`, of degree two in `l2^4`.
#[test]
fn free_sides_by_hand() {
    let [mu1, mu2, mu3] = [8e4, 1.5e4, 2.5e5];
    let law = named("transverse_mooney_rivlin").incompressible(&[mu1, mu2, mu3]).unwrap();
    for l in [0.6f64, 0.9, 1.3, 2.5] {
        let along = curve(&*law, Mode::Uniaxial, Fibers::Along, Response::Cauchy, &[l])[0];
        let expected = 2.0 * (mu1 + mu3) * l * l - 2.0 * (mu2 + mu3) / (l * l) - 2.0 * mu1 / l + 2.0 * mu2 * l;
        assert!((along / expected - 1.0).abs() < 1e-12, "{l}: {along} {expected}");
        // (mu1 + mu3 + mu2 l^2) l2^4 = mu2 + mu3 + mu1 / l^2
        let fourth = (mu2 + mu3 + mu1 / (l * l)) / (mu1 + mu3 + mu2 * l * l);
        let l2 = fourth.powf(0.25);
        let l3 = 1.0 / (l * l2);
        let across = curve(&*law, Mode::Uniaxial, Fibers::Across, Response::Cauchy, &[l])[0];
        let own = |l: f64, mu1: f64, mu2: f64| 2.0 * mu1 * l * l - 2.0 * mu2 / (l * l);
        let expected = own(l, mu1, mu2) - own(l3, mu1, mu2);
        assert!((across / expected - 1.0).abs() < 1e-11, "{l}: {across} {expected}");
        let residual = own(l2, mu1 + mu3, mu2 + mu3) - own(l3, mu1, mu2);
        assert!(residual.abs() < 1e-9 * mu1);
    }
}

/// Two families at 45 degrees are the same along and across; at 0 degrees they are one of twice the stiffness.
#[test]
fn families_at_special_angles() {
    let two = |angle| named("holzapfel_gasser_ogden_2").incompressible(&[5e4, 3e5, 2.0, 0.1, angle]).unwrap();
    let at = [1.1, 1.2, 1.35];
    for mode in [Mode::Uniaxial, Mode::Planar] {
        let [along, across] =
            [Fibers::Along, Fibers::Across].map(|fibers| curve(&*two(45.0), mode, fibers, Response::Nominal, &at));
        assert!(along.iter().zip(&across).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{along:?} {across:?}");
        let one = named("holzapfel_gasser_ogden_1").incompressible(&[5e4, 6e5, 2.0, 0.1]).unwrap();
        let single = curve(&*one, mode, Fibers::Along, Response::Nominal, &at);
        let double = curve(&*two(0.0), mode, Fibers::Along, Response::Nominal, &at);
        assert!(single.iter().zip(&double).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{single:?} {double:?}");
    }
}

#[test]
fn the_bulk_modulus_of_a_transverse_law() {
    let (law, values) = (named("transverse_mooney_rivlin"), [8e4, 1.5e4, 2.5e5]);
    let term = law.build(&values, 3e7).unwrap();
    // p = K (1 - J) near rest, of the mean stress
    let near = curve(&*term, Mode::Volumetric, Fibers::Along, Response::Pressure, &[1.0 - 1e-6])[0];
    assert!((near / 30.0 - 1.0).abs() < 1e-4, "{near}");
    let at = [0.9, 0.95, 0.98];
    let pressures = curve(&*term, Mode::Volumetric, Fibers::Along, Response::Pressure, &at);
    let points = at.iter().zip(pressures).map(|(x, y)| [*x, y]).collect();
    let found =
        bulk(law, &values, &[Test::new("squeezed", Mode::Volumetric, Response::Pressure, points).unwrap()]).unwrap();
    assert!((found.value / 3e7 - 1.0).abs() < 1e-9, "{}", found.value);
}

/// Cords in a matrix a thousand times softer.
#[test]
fn stiff_fibres_are_fitted() {
    let (law, values) = (named("transverse_mooney_rivlin"), [8e3, 1.5e3, 5e7]);
    let found = fit(law, &battery(law, &values), &FitOptions::default()).unwrap();
    for (found, expected) in found.parameters.iter().zip(values) {
        assert!((found.value / expected - 1.0).abs() < 1e-3, "{}: {} for {expected}", found.name, found.value);
    }
    let error = law.build(&values, 1e6).err().unwrap().to_string();
    assert!(error.contains("bulk modulus") && error.contains("1.1113e8"), "{error}");
}

#[test]
fn fibres_are_asked_for_and_refused() {
    let (law, values) = (named(TRUE[0].0), TRUE[0].1);
    let mut tests = battery(law, values);
    tests[1].fibers = None;
    let error = fit(law, &tests, &FitOptions::default()).unwrap_err();
    assert!(matches!(&error, FitError::NoFibers { .. }), "{error}");
    assert!(fit(named("neo_hooke"), &tests, &FitOptions::default()).is_ok(), "a law without fibres does not ask");
    for (mode, response) in
        [(Mode::Inflation { thickness_to_radius: 0.1 }, Response::Pressure), (Mode::Volumetric, Response::Pressure)]
    {
        let refused = Test::new("x", mode, response, vec![[1.1, 1.0]]).unwrap().loaded(Fibers::Across);
        assert!(matches!(refused, Err(FitError::Fibers { .. })), "{mode:?}");
    }
}

#[test]
fn fitted_fibres_are_stable_within_the_data() {
    for (law, values) in TRUE.map(|(label, values)| (named(label), values)) {
        let term = law.incompressible(values).unwrap();
        for fibers in [Fibers::Along, Fibers::Across] {
            let range = stable_range(&*term, Mode::Uniaxial, fibers, 1.4);
            assert!(range.from <= 1.0 && range.to >= 1.39, "{law:?} {fibers:?}: {range:?}");
        }
    }
}
