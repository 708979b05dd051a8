//! Energies written as formulas: the numbers of the built-in laws, derivatives to third order, what is refused and how.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_energy::catalogue::{Inputs, material};
use nastic_energy::{
    EnergyError, EnergyTerm, Field, FormulaLaw, MaterialPoint, PointBatch, Response, Slots, Want, check,
};
use nastic_language::expression::{EnergyFormula, Formula};
use nastic_language::quantity::Units;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
const FIBER: [f64; 3] = [0.6, 0.8, 0.0];

/// The law of a text with parameters in SI units, and a fibre where it names one.
fn law(text: &str, parameters: &[(&str, &str)]) -> Result<FormulaLaw, EnergyError> {
    let formulas: Vec<(&str, Formula)> =
        parameters.iter().map(|(name, text)| (*name, Formula::parse(text, &Units::default()).unwrap())).collect();
    let named: Vec<(&str, Option<&Formula>)> = formulas.iter().map(|(name, formula)| (*name, Some(formula))).collect();
    let energy = EnergyFormula::parse(text, &Units::default(), &named).unwrap_or_else(|error| panic!("{error}"));
    let values = formulas.iter().map(|(name, f)| ((*name).to_owned(), Field::Uniform(f.constant().unwrap()))).collect();
    let fiber = energy.expression().depends_on(nastic_energy::formula::Invariant::Fiber);
    FormulaLaw::new(energy.expression(), &values, fiber.then(|| Field::Uniform(FIBER.into())))
}

fn refused(text: &str, parameters: &[(&str, &str)]) -> String {
    law(text, parameters).map(|_| ()).unwrap_err().to_string()
}

fn unread(text: &str, parameters: &[(&str, &str)]) -> String {
    let formulas: Vec<(&str, Formula)> =
        parameters.iter().map(|(name, text)| (*name, Formula::parse(text, &Units::default()).unwrap())).collect();
    let named: Vec<(&str, Option<&Formula>)> = formulas.iter().map(|(name, formula)| (*name, Some(formula))).collect();
    EnergyFormula::parse(text, &Units::default(), &named).map(|_| ()).unwrap_err().to_string()
}

fn built_in(name: &str, inputs: &Inputs) -> Arc<dyn EnergyTerm> {
    material(name).unwrap().build(inputs).unwrap()
}

/// Energy, stress, tangent, its products and third derivatives of two laws agree to this share.
fn assert_same(one: &dyn EnergyTerm, other: &dyn EnergyTerm, allowed: f64) {
    for k in check::states() {
        let (a, b) = (check::evaluate(one, HERE, &k, &[]), check::evaluate(other, HERE, &k, &[]));
        let tangent = b.tangent.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        let between = a.tangent.0.iter().zip(&b.tangent.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!((a.energy - b.energy).abs() <= allowed * (b.energy.abs() + tangent), "{} {}", a.energy, b.energy);
        assert!((a.stress - b.stress).norm() <= allowed * (b.stress.norm() + tangent), "{} {}", a.stress, b.stress);
        assert!(between <= allowed * tangent, "{between} of {tangent}");
        let at = PointBatch { kinematics: std::slice::from_ref(&k), cell: 0, first: 0 };
        let (u, v) = (k.f().transpose() * 0.3, k.h() * 0.2);
        let second = |law: &dyn EnergyTerm| {
            let mut out = [k.f() * 0.0];
            law.second_stress_change(&at, Slots::none(), [&[u], &[v]], &mut out).unwrap();
            out[0]
        };
        let (a, b) = (second(one), second(other));
        assert!((a - b).norm() <= allowed * 10.0 * b.norm(), "{a} {b}");
    }
}

#[test]
fn formulas_of_built_in_laws_are_these_laws() {
    let mooney = law(
        "mu1 * (I1 - 3) + mu2 * (I2 - 3) + mu3 * (J - 1)^2 - 2 * (mu1 + 2 * mu2) * log(J)",
        &[("mu1", "100 kPa"), ("mu2", "20 kPa"), ("mu3", "0.3 MPa")],
    );
    let inputs = Inputs::new().number("mu1", 1e5).number("mu2", 2e4).number("mu3", 3e5);
    assert_same(&mooney.unwrap(), &built_in("mooney_rivlin", &inputs), 1e-12);
    let isochoric = law("mu / 2 * (I1b - 3) + k / 4 * (J^2 - 1 - 2 * log(J))", &[("mu", "100 kPa"), ("k", "500 kPa")]);
    let inputs = Inputs::new().number("mu", 1e5).number("kappa", 5e5);
    assert_same(&isochoric.unwrap(), &built_in("neo_hooke_isochoric", &inputs), 1e-12);
    let gent = law(
        "-mu * jm / 2 * log(1 - (J^(-2/3) * I1 - 3) / jm) + k / 4 * (J^2 - 1 - 2 * log(J))",
        &[("mu", "1e5"), ("jm", "60"), ("k", "1e6")],
    );
    let inputs = Inputs::new().number("mu", 1e5).number("jm", 60.0).number("bulk", 1e6);
    assert_same(&gent.unwrap(), &built_in("gent", &inputs), 1e-12);
}

/// Every operation, with differences of the energy, of the stress, and of its change.
/// K is the unit of temperatures, and in a law a bulk modulus if its user says so.
#[test]
fn a_parameter_may_be_called_as_the_unit_of_temperatures() {
    let named = |name: &str| {
        let text = format!("mu / 2 * (I1 - 3 - 2 * log(J)) + {name} / 2 * (J - 1)^2");
        law(&text, &[("mu", "0.1 MPa"), (name, "0.4 MPa")]).unwrap()
    };
    assert!(EnergyFormula::refuses_name("K").is_none() && EnergyFormula::refuses_name("V").is_some());
    assert_same(&named("K"), &named("bulk"), 0.0);
    let product = unread("2 K * (J - 1)^2", &[("K", "0.4 MPa")]);
    assert!(product.contains("products need \"*\""), "{product}");
}

#[test]
fn derivatives_are_exact_to_third_order() {
    let texts = [
        "c * (exp(b * E_ff^2) - 1) + mu / 2 * (I1 - 3 - 2 * log(J)) + k / 2 * (J - 1)^2",
        "mu * (sqrt(I1 * I2) - 3) - 3 * mu * log(J) + c * (I4^b - 1 - b * log(I4)) + k * (J - 1)^2",
        "mu * (I2b^1.5 - 3^1.5) + k * (cos(J - 1) - 1)^2 + k * (J - 1)^2 + c * sin(b * (I4b - 1))^2 * I1",
        "mu * (max(I1b - 3, (I1b - 3) / 2) + abs(J - 1)^4) + k * (J - 1 / J)^2 + c * (I4 > 1) * (I4 - 1)^4 + b * 0 * mu",
        "mu * (min(I1, 3) - 3)^2 * (I1 <= 4) + k * (J - 1)^2 + (I1 / 3)^(I2 / 3) * mu - mu - 2 / 3 * mu * log(J) \
         + c * (J^b - 1)^2 * (I4 / I4) + c * (I4 >= 1) * (I4 - 1)^4",
    ];
    for text in texts {
        let parameters = [("c", "2 kPa"), ("b", "0.02"), ("mu", "10 kPa"), ("k", "1 MPa")];
        let law = law(text, &parameters).unwrap_or_else(|error| panic!("{error}"));
        for finding in [
            check::accumulation(&law, HERE, &[]),
            check::stress(&law, HERE, &[]),
            check::tangent(&law, HERE, &[]),
            check::stress_change(&law, HERE, &[]),
            check::major_symmetry(&law, HERE, &[]),
            check::objectivity(&law, HERE, &[], &|_, _| {}),
        ] {
            finding.unwrap_or_else(|error| panic!("{text}: {error}"));
        }
        let second = check::second_stress_change(&law, HERE, &[]);
        assert!(second.unwrap_or_else(|error| panic!("{text}: {error}")).is_some());
        check::moduli(&law, HERE).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}

#[test]
fn what_is_no_energy_of_a_law_is_refused_with_its_size() {
    let mu = [("mu", "10 kPa")];
    let at_rest = refused("mu / 2 * (I1 - 2 * log(J))", &mu);
    assert!(at_rest.contains("is 1.5e4 (unit of stress) at rest, F = I, where an energy is 0"), "{at_rest}");
    let stressed = refused("mu / 2 * (I1 - 3)", &mu);
    assert!(
        stressed.contains("has the stress 1e4 I at rest") && stressed.contains("subtract 1e4 * log(J)"),
        "{stressed}"
    );
    let along = refused("mu / 2 * (I1 - 3 - 2 * log(J)) + mu * (I4 - 1)", &mu);
    assert!(along.contains("2e4 more along the fibre"), "{along}");
    assert!(along.contains("+ 2e4 * (I4 - 1) / 2"), "{along}");
    law("mu / 2 * (I1 - 3 - 2 * log(J)) + mu * (I4 - 1) - 2e4 * (I4 - 1) / 2", &mu).unwrap();
    let root = refused("mu * sqrt(I1 - 3) - 2 * mu * (J - 1)", &mu);
    assert!(root.contains("has no finite value at rest"), "{root}");
    let unused = refused("mu / 2 * (I1 - 3 - 2 * log(J))", &[("mu", "1 kPa"), ("k", "2 kPa")]);
    assert!(unused.contains("does not name the parameter k"), "{unused}");
    let kink = refused("mu / 2 * (I1 - 3 - 2 * log(J)) + mu * max(J - 1.2, 0)", &mu);
    assert!(kink.contains("the stress jumps by") && kink.contains("J = 1.2000"), "{kink}");
    let step = refused("mu / 2 * (I1 - 3 - 2 * log(J)) + mu * (I1 > 3.5)", &mu);
    assert!(step.contains("the energy jumps by") && step.contains("I1 = 3.5000"), "{step}");
    let long = vec!["mu * (J - 1)^2"; 2000].join(" + ");
    assert!(refused(&long, &mu).contains("is too long"), "long");
}

#[test]
fn what_cannot_be_read_is_named_with_its_column() {
    let mu = [("mu", "10 kPa")];
    let name = unread("mu / 2 * (I3 - 3)", &mu);
    assert!(name.contains("unknown name \"I3\" (one of: I1, I2, J, I4, I1b") && name.contains("column 11"), "{name}");
    let coordinate = unread("mu * X * (I1 - 3)", &mu);
    assert!(coordinate.contains("unknown name \"X\""), "{coordinate}");
    let unit = unread("mu^2 * (I1 - 3)", &mu);
    assert!(unit.contains("an energy per volume has the unit of a pressure"), "{unit}");
    let sum = unread("mu * (I1 - 3) + 3 mm * (J - 1)", &mu);
    assert!(sum.contains("cannot be added"), "{sum}");
    let equal = unread("mu * (I1 == 3)", &mu);
    assert!(equal.contains("compare with < or >"), "{equal}");
    for (name, why) in
        [("J", "is an invariant"), ("m", "is a unit or a function"), ("log", "is a unit"), ("2a", "is no name")]
    {
        assert!(EnergyFormula::refuses_name(name).unwrap().contains(why), "{name}");
    }
    assert_eq!(EnergyFormula::refuses_name("k_1"), None);
}

#[test]
fn deformations_without_an_energy_are_beyond_the_domain() {
    let gent = law(
        "-mu * jm / 2 * log(1 - (I1b - 3) / jm) + k / 4 * (J^2 - 1 - 2 * log(J))",
        &[("mu", "1e5"), ("jm", "0.5"), ("k", "1e6")],
    )
    .unwrap();
    let fung = law("c * (exp(1e4 * (I1b - 3)) - 1) + 1 MPa * (J - 1)^2", &[("c", "1 kPa")]).unwrap();
    for k in check::states() {
        let at = PointBatch { kinematics: std::slice::from_ref(&k), cell: 0, first: 0 };
        let far = k.f().norm_squared() * k.j().powf(-2.0 / 3.0) - 3.0;
        let outside = gent.check_domain(&at, Slots::none());
        assert_eq!(outside.is_err(), far >= 0.5, "{far}");
        if let Err(outside) = outside {
            assert!(outside.to_string().contains("formula: what the energy takes a logarithm of = -"), "{outside}");
        }
        let outside = fung.check_domain(&at, Slots::none());
        assert_eq!(outside.is_err(), far > 0.0708, "{far}");
    }
}

/// A parameter that differs from point to point is that of its place.
#[test]
fn parameters_may_vary_over_the_body() {
    let mooney = "mu / 2 * (I1 - 3 - 2 * log(J)) + k * (J - 1)^2";
    let formulas = ["mu", "k"].map(|name| (name, None));
    let energy = EnergyFormula::parse(mooney, &Units::default(), &formulas).unwrap();
    let fields = [("mu", Field::points(vec![1e3, 2e3])), ("k", Field::Uniform(1e5))];
    let fields = fields.into_iter().map(|(name, field)| (name.to_owned(), field)).collect();
    let varying = FormulaLaw::new(energy.expression(), &fields, None).unwrap();
    let k = check::states().swap_remove(3);
    for (point, mu) in ["1e3", "2e3"].into_iter().enumerate() {
        let uniform = law(mooney, &[("mu", mu), ("k", "1e5")]).unwrap();
        let expected = check::evaluate(&uniform, HERE, &k, &[]);
        let found = check::evaluate(&varying, MaterialPoint { cell: 0, point }, &k, &[]);
        assert!((found.stress - expected.stress).norm() <= 1e-14 * expected.stress.norm());
        assert!((found.energy - expected.energy).abs() <= 1e-14 * expected.energy);
    }
    assert!(varying.check(1, 3).unwrap_err().to_string().contains("has 2 values"));
}

/// Nanoseconds of a law by point, the least of many rounds.
fn cost(law: &dyn EnergyTerm, want: Want) -> f64 {
    let states: Vec<_> = check::states().into_iter().cycle().take(64).collect();
    let mut energy = vec![0.0; states.len()];
    let mut stress = vec![states[0].f() * 0.0; states.len()];
    let mut tangent = vec![check::evaluate(law, HERE, &states[0], &[]).tangent; states.len()];
    let at = PointBatch { kinematics: &states, cell: 0, first: 0 };
    let mut round = || {
        let began = Instant::now();
        for _ in 0..200 {
            let mut out = Response { energy: &mut energy, stress: &mut stress, tangent: &mut tangent };
            law.respond(black_box(&at), Slots::none(), want, &mut out);
        }
        began.elapsed().as_secs_f64() / (200.0 * 64.0) * 1e9
    };
    (0..50).map(|_| round()).fold(f64::INFINITY, f64::min)
}

#[test]
#[ignore = "prints times, which depend on the machine"]
fn costs_beside_the_built_in_law() {
    let formula = law(
        "mu1 * (I1 - 3) + mu2 * (I2 - 3) + mu3 * (J - 1)^2 - 2 * (mu1 + 2 * mu2) * log(J)",
        &[("mu1", "100 kPa"), ("mu2", "20 kPa"), ("mu3", "0.3 MPa")],
    )
    .unwrap();
    let own = built_in("mooney_rivlin", &Inputs::new().number("mu1", 1e5).number("mu2", 2e4).number("mu3", 3e5));
    let none = Want { energy: false, stress: false, tangent: false };
    for (name, want) in [
        ("energy", Want { energy: true, ..none }),
        ("stress", Want { stress: true, ..none }),
        ("tangent", Want { tangent: true, ..none }),
        ("all", Want::ALL),
    ] {
        let (formula, own) = (cost(&formula, want), cost(&*own, want));
        println!("{name:<8} formula {formula:6.1} ns, mooney_rivlin {own:6.1} ns, ratio {:.2}", formula / own);
    }
}
