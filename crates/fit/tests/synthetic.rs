//! Data made by a law give its parameters back, whatever was measured; intervals, borders and refusals.
#![allow(clippy::unwrap_used)] // a test may

use nastic_fit::{
    End, Errors, Fibers, FitError, FitOptions, Law, Mode, Response, Test, bulk, curve, fit, r_squared, scenarios,
    stable_range, student,
};

const TRUE: [(&str, &[f64]); 8] = [
    ("neo_hooke", &[4e5]),
    ("neo_hooke_isochoric", &[4e5]),
    ("mooney_rivlin", &[1.5e5, 3e4]),
    ("yeoh", &[1.7e5, -1.5e3, 4e1]),
    ("gent", &[3e5, 45.0]),
    ("arruda_boyce", &[2.8e5, 4.5]),
    ("ogden_1", &[3e5, 2.4]),
    ("ogden_2", &[6e5, 1.5, -2e4, -2.2]),
];

/// Degrees of freedom, and Student's two-sided 95 % point (mpmath, 30 digits).
const STUDENT: [(f64, f64); 8] = [
    (1.0, 12.706_204_736_174_7),
    (3.0, 3.182_446_305_283_71),
    (4.0, 2.776_445_105_197_794),
    (10.0, 2.228_138_851_986_275),
    (57.0, 2.002_465_459_291_007),
    (200.0, 1.971_896_223_633_909),
    (201.0, 1.971_836_506_779_859),
    (1e5, 1.959_987_707_534_61),
];

/// The law of a label.
fn named(label: &str) -> Law {
    Law::named(label).unwrap()
}

fn test(law: Law, values: &[f64], mode: Mode, response: Response, to: f64) -> Test {
    let term = law.incompressible(values).unwrap();
    let at: Vec<f64> = (1..=15).map(|k| (to - 1.0) * f64::from(k) / 15.0).collect();
    let at: Vec<f64> = at.iter().map(|x| if mode == Mode::SimpleShear { *x } else { 1.0 + x }).collect();
    let stresses = curve(&*term, mode, Fibers::Along, response, &at);
    Test::new(mode.name(), mode, response, at.into_iter().zip(stresses).map(|(x, y)| [x, y]).collect()).unwrap()
}

fn battery(law: Law, values: &[f64]) -> Vec<Test> {
    let balloon = Mode::Inflation { thickness_to_radius: 0.02 };
    vec![
        test(law, values, Mode::Uniaxial, Response::Nominal, 5.0),
        test(law, values, Mode::Uniaxial, Response::Cauchy, 0.6),
        test(law, values, Mode::Equibiaxial, Response::Cauchy, 3.0),
        test(law, values, Mode::Planar, Response::Nominal, 4.0),
        test(law, values, Mode::SimpleShear, Response::Shear, 2.5),
        test(law, values, balloon, Response::Pressure, 3.5).weighted(1e3).unwrap(),
    ]
}

#[test]
fn parameters_come_back() {
    for (law, values) in TRUE.map(|(label, values)| (named(label), values)) {
        for errors in [Errors::Absolute, Errors::Relative] {
            let found = fit(law, &battery(law, values), &FitOptions { errors, ..FitOptions::default() }).unwrap();
            for (found, expected) in found.parameters.iter().zip(values) {
                let error = (found.value / expected - 1.0).abs();
                assert!(error < 1e-5, "{law:?} {errors:?}: {} = {} for {expected}", found.name, found.value);
            }
        }
    }
}

#[test]
fn every_law_that_can_be_fitted_is_among_those_that_come_back() {
    let known: Vec<&str> = TRUE.iter().chain(&crate::fibers::TRUE).map(|(label, _)| named(label).name()).collect();
    // the numbers of networks do not come back, their stresses do
    for law in Law::all().into_iter().filter(|law| !law.is_network()) {
        assert!(known.contains(&law.name()), "{law:?}: give true parameters of it");
    }
}

/// A network from stresses of one: the same stresses, whatever its numbers are.
#[test]
fn stresses_of_a_network_come_back() {
    let law = named("convex_network_1x4");
    let own = [0.05, 2e-4, 0.02, 0.0, 0.3, 1e-3, 0.0, 1e-4, -3.0, 0.5, -6.0, -1.0, 4e6, 2e6, 1e6, 5e5];
    let truth = law.incompressible(&own).unwrap();
    let at: Vec<f64> = (1..20).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
    let test = |mode: Mode| {
        let stresses = curve(&*truth, mode, Fibers::Along, Response::Nominal, &at);
        let points = at.iter().zip(stresses).map(|(x, y)| [*x, y]).collect();
        Test::new(mode.name(), mode, Response::Nominal, points).unwrap()
    };
    let tests = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar].map(test);
    let found = fit(law, &tests, &FitOptions { starts: 4, ..FitOptions::default() }).unwrap();
    let again = law.incompressible(&found.values()).unwrap();
    for test in &tests {
        let share = r_squared(&*again, test).unwrap();
        assert!(share > 1.0 - 1e-5, "{}: {share} {:?}", test.name, found.starts);
    }
}

/// Stresses of the neo-Hookean law by hand: thin balloon `p = 2 (H/R) mu (1/l - 1/l^7)`, simple shear `mu g`.
#[test]
fn modes_by_hand() {
    let law = named("neo_hooke_isochoric").incompressible(&[2.0]).unwrap();
    let at = |mode: Mode, response: Response, x: f64| curve(&*law, mode, Fibers::Along, response, &[x])[0];
    for l in [0.7f64, 1.4, 2.6] {
        for (found, expected) in [
            (at(Mode::Uniaxial, Response::Nominal, l), 2.0 * (l - l.powi(-2))),
            (at(Mode::Uniaxial, Response::Cauchy, l), 2.0 * (l * l - 1.0 / l)),
            (at(Mode::Equibiaxial, Response::Nominal, l), 2.0 * (l - l.powi(-5))),
            (at(Mode::Planar, Response::Cauchy, l), 2.0 * (l * l - l.powi(-2))),
            (at(Mode::SimpleShear, Response::Shear, l), 2.0 * l),
            (
                at(Mode::Inflation { thickness_to_radius: 0.05 }, Response::Pressure, l),
                2.0 * 0.05 * 2.0 * (1.0 / l - l.powi(-7)),
            ),
        ] {
            assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

/// One parameter, linear: `mu = sum a y / sum a^2`, its variance `s^2 / sum a^2`, the interval by Student's t.
#[test]
fn the_interval_of_a_linear_problem() {
    let noise = [0.3, -0.2, 0.1, -0.4, 0.25, -0.05];
    let points: Vec<[f64; 2]> = noise.iter().enumerate().map(|(k, e)| [1.2 + 0.3 * k as f64, 0.0 + e]).collect();
    let a = |l: f64| l - l.powi(-2);
    let points: Vec<[f64; 2]> = points.iter().map(|[l, e]| [*l, 10.0 * a(*l) + e]).collect();
    let own: f64 = points.iter().map(|[l, _]| a(*l).powi(2)).sum();
    let mu = points.iter().map(|[l, y]| a(*l) * y).sum::<f64>() / own;
    let squares: f64 = points.iter().map(|[l, y]| (y - mu * a(*l)).powi(2)).sum();
    let deviation = (squares / 5.0 / own).sqrt();
    let test = Test::new("bar", Mode::Uniaxial, Response::Nominal, points).unwrap();
    let found = fit(named("neo_hooke"), &[test], &FitOptions::default()).unwrap();
    let shear = &found.parameters[0];
    assert!((shear.value / mu - 1.0).abs() < 1e-8);
    assert!((found.squares / squares - 1.0).abs() < 1e-8);
    assert!((shear.deviation.unwrap() / deviation - 1.0).abs() < 1e-6);
    // tabulated: t = 2.5706 for five degrees of freedom
    assert!((shear.half_width.unwrap() / (2.5706 * deviation) - 1.0).abs() < 2e-3);
    assert!((student(1.0) - 12.7062).abs() < 1e-4 && (student(2.0) - 4.3027).abs() < 1e-4);
    for (nu, expected) in STUDENT {
        assert!((student(nu) / expected - 1.0).abs() < 1e-9, "{nu}: {} {expected}", student(nu));
    }
    let spread = scenarios(&found);
    assert_eq!(spread.len(), 2);
    let mean = 0.5 * (spread[0].parameters[0] + spread[1].parameters[0]);
    let half = 0.5 * (spread[1].parameters[0] - spread[0].parameters[0]);
    assert!((mean / mu - 1.0).abs() < 1e-3 && (half / deviation - 1.0).abs() < 1e-3);
}

/// A law whose second parameter the data push against its border: no interval for it.
#[test]
fn a_parameter_on_its_border_has_no_interval() {
    let tests = [test(named("gent"), &[4e5, 60.0], Mode::Uniaxial, Response::Nominal, 6.0)];
    let found = fit(named("mooney_rivlin"), &tests, &FitOptions::default()).unwrap();
    let [c10, c01] = &found.parameters[..] else { unreachable!() };
    assert!(c01.value < 1e-4 * c10.value && c01.deviation.is_none(), "{c01:?}");
    assert!(c10.deviation.is_some() && found.correlation[0][1].is_none());
}

#[test]
fn a_bulk_modulus_from_volumetric_data() {
    let kappa = 2.2e9;
    for (law, values) in TRUE.map(|(label, values)| (named(label), values)) {
        let term = law.build(values, kappa).unwrap();
        let at = [0.99, 0.995, 1.002];
        let points = at
            .iter()
            .zip(curve(&*term, Mode::Volumetric, Fibers::Along, Response::Pressure, &at))
            .map(|(x, y)| [*x, y]);
        let test = Test::new("press", Mode::Volumetric, Response::Pressure, points.collect()).unwrap();
        let found = bulk(law, values, std::slice::from_ref(&test)).unwrap();
        assert!((found.value / kappa - 1.0).abs() < 1e-6, "{law:?}: {found:?}");
        let turned = Test { points: test.points.iter().map(|[x, y]| [*x, -y]).collect(), ..test };
        assert!(bulk(law, values, &[turned]).unwrap_err().to_string().contains("must be positive"));
    }
    assert!(matches!(bulk(named("neo_hooke"), &[1.0], &[]), Err(FitError::Volume(_))));
}

/// `c20 < 0` beyond what the data show: Yeoh's law is unstable where its stress falls; a neo-Hookean one nowhere.
#[test]
fn the_range_of_stability() {
    let neo = named("neo_hooke_isochoric").incompressible(&[1.0]).unwrap();
    let range = stable_range(&*neo, Mode::Equibiaxial, Fibers::Along, 5.0);
    assert_eq!((range.from, range.to, range.ends), (0.2, 5.0, [End::Examined; 2]));
    let gent = named("gent").incompressible(&[1.0, 10.0]).unwrap();
    let range = stable_range(&*gent, Mode::Uniaxial, Fibers::Along, 6.0);
    // to its limit, l^2 + 2/l - 3 = 10
    assert!(range.ends[1] == End::Undefined && (range.to.powi(2) + 2.0 / range.to - 13.0).abs() < 1e-2, "{range:?}");
    // sigma = 2 (c10 + 2 c20 x + 3 c30 x^2)(..) with a deep valley
    let yeoh = named("yeoh").incompressible(&[1.0, -0.17, 0.01]).unwrap();
    let range = stable_range(&*yeoh, Mode::Uniaxial, Fibers::Along, 6.0);
    assert!(range.ends[1] == End::Unstable && range.to > 1.5 && range.to < 2.9, "{range:?}");
}

#[test]
fn refusals_say_what_and_where() {
    let bar = |points: Vec<[f64; 2]>| Test::new("bar", Mode::Uniaxial, Response::Nominal, points);
    let error = bar(vec![[1.0, 0.0], [-0.2, 3.0]]).unwrap_err().to_string();
    assert_eq!(error, "test \"bar\", point 1: stretch = -0.2, but it must be positive and finite");
    let error = Test::new("bar", Mode::SimpleShear, Response::Cauchy, vec![]).unwrap_err().to_string();
    assert_eq!(error, "test \"bar\": a test of kind simple_shear gives a shear stress, not a Cauchy stress");
    let few = [bar(vec![[1.0, 0.0], [1.2, 1.0], [1.4, 2.0], [1.6, 2.5]]).unwrap()];
    let error = fit(named("yeoh"), &few, &FitOptions::default()).unwrap_err();
    assert_eq!(error, FitError::TooFew { law: "yeoh".into(), parameters: 3, points: 3 });
    let still = [bar(vec![[1.2, 0.0], [1.4, 0.0], [1.6, 0.0]]).unwrap()];
    assert_eq!(fit(named("neo_hooke"), &still, &FitOptions::default()).unwrap_err(), FitError::NoStress);
}

/// A start that ran out of evaluations has not converged.
#[test]
fn exhausted_starts_are_counted_apart() {
    let tests = battery(named("ogden_2"), &[6e5, 1.5, -2e4, -2.2]);
    let with = |patience: usize| fit(named("ogden_2"), &tests, &FitOptions { patience, ..FitOptions::default() });
    let starts = with(200).unwrap().starts;
    assert!(starts.exhausted > 0 && starts.converged > 0 && !starts.best_exhausted, "{starts:?}");
    assert!(starts.tried == 16 && starts.exhausted + starts.converged <= 16, "{starts:?}");
    let none = with(1).unwrap_err();
    assert_eq!(none, FitError::Exhausted { law: "ogden_2".into(), starts: 16, exhausted: 16 });
    // one term too many: those that run out come nearer than those that converge
    let tests = battery(named("ogden_2"), &[4e5, 1.3, -5e4, -3.1]);
    let with = |patience: usize| fit(named("ogden_3"), &tests, &FitOptions { patience, ..FitOptions::default() });
    assert!((5..14).any(|patience| with(patience).is_ok_and(|found| found.starts.best_exhausted)));
}

/// `n <= K + 1`: AICc is infinite whatever the fit, and BIC decides.
#[test]
fn without_aicc_laws_are_compared_by_bic() {
    let points = vec![[1.2, 0.9], [1.5, 2.1], [2.0, 3.6]];
    let tests = [Test::new("bar", Mode::Uniaxial, Response::Nominal, points).unwrap()];
    let of = |law: Law| fit(law, &tests, &FitOptions::default()).unwrap().criteria;
    let (neo, mooney) = (of(named("neo_hooke")), of(named("mooney_rivlin")));
    assert!(neo.aicc == f64::INFINITY && mooney.aicc == f64::INFINITY && neo.bic != mooney.bic);
    assert_eq!(neo.compare(&mooney), neo.bic.total_cmp(&mooney.bic));
}

/// `det diag(l, l, l^-2) = 1` for negative l too.
#[test]
fn stretches_are_positive_in_every_mode() {
    let balloon = Mode::Inflation { thickness_to_radius: 0.02 };
    for (mode, response) in [
        (Mode::Uniaxial, Response::Nominal),
        (Mode::Equibiaxial, Response::Nominal),
        (Mode::Planar, Response::Cauchy),
        (balloon, Response::Pressure),
        (Mode::Volumetric, Response::Pressure),
    ] {
        for x in [-1.5, -0.5, 0.0, f64::NAN, f64::INFINITY] {
            let error = Test::new("t", mode, response, vec![[1.2, 1.0], [x, 1.0]]).unwrap_err();
            let FitError::Point { point: 1, requirement, .. } = error else { unreachable!("{mode:?} {x}: {error:?}") };
            assert_eq!(requirement, "it must be positive and finite");
        }
    }
    let shear = |g: f64| Test::new("t", Mode::SimpleShear, Response::Shear, vec![[g, -1.0]]);
    assert!(shear(-0.5).is_ok());
    assert!(shear(f64::NAN).unwrap_err().to_string().contains("it must be a finite number"));
}

#[test]
fn stresses_that_oppose_the_deformation_are_told() {
    let bar =
        |name: &str, points: &[[f64; 2]]| Test::new(name, Mode::Uniaxial, Response::Nominal, points.to_vec()).unwrap();
    let tension = bar("tension", &[[1.0, 0.0], [1.2, 1.0], [1.5, 2.0], [2.0, 3.0]]);
    let pressed = bar("pressed", &[[1.0, 0.0], [0.9, 1.0], [0.8, 2.0], [0.7, 3.0]]);
    let options = FitOptions::default();
    for tests in [vec![pressed.clone()], vec![tension.clone(), pressed]] {
        let error = fit(named("neo_hooke"), &tests, &options).unwrap_err();
        assert_eq!(error, FitError::WrongSign { test: "pressed".into(), points: 3 });
    }
    let mixed = bar("mixed", &[[1.1, 0.1], [1.5, -2.0], [2.0, -3.0]]);
    assert!(
        matches!(fit(named("neo_hooke"), &[mixed], &options), Err(FitError::NegativeShear { shear }) if shear < 0.0)
    );
    let still = bar("still", &[[1.0, 0.0], [1.2, 0.0]]);
    let relative = FitOptions { errors: Errors::Relative, ..options };
    let both = [tension, still];
    assert_eq!(fit(named("neo_hooke"), &both, &relative).unwrap_err(), FitError::ZeroTest { test: "still".into() });
    assert!(fit(named("neo_hooke"), &both, &options).is_ok());
}

#[test]
fn wrong_numbers_of_parameters_and_weights_are_errors() {
    for (law, values) in TRUE.map(|(label, values)| (named(label), values)) {
        let more = [values, &[1.0]].concat();
        for wrong in [&values[1..], &more] {
            let expected = FitError::Parameters { law: law.label(), expected: values.len(), found: wrong.len() };
            assert_eq!(law.shear(wrong), Err(expected.clone()));
            assert_eq!(law.incompressible(wrong).err(), Some(expected.clone()));
            assert_eq!(law.build(wrong, 1e9).err(), Some(expected));
        }
    }
    let good = test(named("neo_hooke"), &[1.0], Mode::Uniaxial, Response::Nominal, 2.0);
    for weight in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(good.clone().weighted(weight), Err(FitError::Setting { what: "weight", .. })), "{weight}");
        let put = Test { weight, ..good.clone() };
        assert!(
            matches!(fit(named("neo_hooke"), &[put], &FitOptions::default()), Err(FitError::Setting { .. })),
            "{weight}"
        );
    }
    let balloon = Mode::Inflation { thickness_to_radius: f64::NAN };
    let error = Test::new("balloon", balloon, Response::Pressure, vec![[1.5, 1.0]]).unwrap_err();
    assert!(error.to_string().contains("thickness over radius = NaN, but it must be a positive number"), "{error}");
}
