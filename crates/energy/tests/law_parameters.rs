//! Laws with numbers that they are written with as slots: every form of the catalogue, against the law itself and the contract of slots.

use nastic_energy::catalogue::{self, Inputs, Takes};
use nastic_energy::{EnergyError, EnergyTerm, Field, MaterialPoint, MooneyRivlin, NeoHooke, Parametrised, Role, check};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

/// Numbers that laws depend on otherwise than linearly.
const HELD: [&str; 13] = [
    "chi",
    "swelling",
    "jm",
    "lambda_m",
    "alpha1",
    "alpha2",
    "alpha3",
    "alpha4",
    "k2",
    "dispersion",
    "toe",
    "bf",
    "bt",
];

/// The numbers of an example by their names, and whether each can be a slot.
fn numbers(row: &catalogue::MaterialRow, form: usize) -> Vec<(&'static str, bool)> {
    let mut out = Vec::new();
    for parameter in row.forms[form] {
        match parameter.takes {
            Takes::Number { .. } => {
                out.push((parameter.name, !HELD.contains(&parameter.name) && parameter.name != "bfs"));
            }
            Takes::Numbers { example } => out.extend(example.iter().map(|(name, _)| (*name, true))),
            _ => {}
        }
    }
    out
}

#[test]
fn every_form_of_every_law_has_its_moduli_as_slots_and_refuses_the_others() {
    let mut checked = 0;
    for row in catalogue::materials() {
        for (form, inputs) in row.examples().iter().enumerate() {
            let law = row.build(inputs).unwrap();
            let all = numbers(row, form);
            let free: Vec<&str> = all.iter().filter(|(_, free)| *free).map(|(name, _)| *name).collect();
            for (name, _) in all.iter().filter(|(_, free)| !free) {
                let refused = row.parametrised(inputs, &[name]).unwrap_err();
                assert!(matches!(&refused, EnergyError::NotLinear { known, .. } if !known.is_empty()), "{refused}");
            }
            let term = row.parametrised(inputs, &free).unwrap_or_else(|error| panic!("{} {form}: {error}", row.name));
            assert!(term.is_material() && !free.is_empty());
            let own: Vec<f64> = (0..term.slots().len()).map(|k| term.rest(HERE, k)).collect();
            for ((slot, value), name) in term.slots().iter().zip(&own).zip(&free) {
                assert_eq!((slot.role, slot.group), (Role::Design { rest: *value }, *name));
                let known = row.parameters().into_iter().find(|parameter| parameter.name == slot.group);
                let unit =
                    known.map_or("", |known| if let Takes::Number { unit, .. } = known.takes { unit } else { "" });
                assert_eq!(unit, slot.unit, "{}", slot.group);
            }
            for k in check::states() {
                let expected = check::evaluate(&law, HERE, &k, &[]);
                let close = |found: check::Evaluation| {
                    let scale = expected.tangent.0.iter().fold(expected.energy.abs(), |most, x| most.max(x.abs()));
                    let stress = (found.stress - expected.stress).norm();
                    let rest = found.tangent.0.iter().zip(&expected.tangent.0).map(|(a, b)| (a - b).abs());
                    let off = rest.fold(stress.max((found.energy - expected.energy).abs()), f64::max);
                    assert!(off <= 1e-12 * scale, "{} {form}: off by {off:e} of {scale:e}", row.name);
                };
                close(check::evaluate(&term, HERE, &k, &[]));
                close(check::evaluate(&term, HERE, &k, &own));
            }
            let others: Vec<f64> = own.iter().map(|value| 1.02 * value).collect();
            for values in [&own, &others] {
                let keyed = free.iter().all(|name| row.parameters().iter().any(|parameter| parameter.name == *name));
                if keyed {
                    // the conversion away from the values that it is written with
                    let at = |inputs: Inputs, (name, value): (&&str, &f64)| inputs.number(name, *value);
                    let law = row.build(&free.iter().zip(values).fold(inputs.clone(), at)).unwrap();
                    let k = check::states()[0];
                    let own = check::evaluate(&term, HERE, &k, values);
                    let expected = check::evaluate(&law, HERE, &k, &[]);
                    let scale = expected.tangent.0.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                    assert!(
                        (own.stress - expected.stress).norm() <= 1e-12 * scale,
                        "{} {form} at {values:?}",
                        row.name
                    );
                }
                let report =
                    check::actuation(&*term, HERE, values).unwrap_or_else(|e| panic!("{} {form}: {e}", row.name));
                let second = |what: &str| report.findings.iter().any(|finding| finding.check.starts_with(what));
                assert!(second("the change of dP/dm") && second("the second change of P"), "{report}");
            }
            checked += 1;
        }
    }
    assert!(checked >= 40, "{checked}");
}

/// A number that is no slot is held, and the derivative is that at the others: of Young's modulus all moduli scale.
#[test]
fn young_s_modulus_scales_the_law_while_poisson_s_ratio_is_held() {
    let inputs = Inputs::new().number("young", 3e5).number("poisson", 0.4);
    let row = catalogue::material("neo_hooke").unwrap();
    let term = row.parametrised(&inputs, &["young"]).unwrap();
    assert_eq!(term.slots().len(), 1);
    let law = row.build(&inputs).unwrap();
    for k in check::states() {
        let (doubled, own) = (check::evaluate(&term, HERE, &k, &[6e5]), check::evaluate(&law, HERE, &k, &[]));
        assert!((doubled.stress - own.stress * 2.0).norm() <= 1e-13 * own.stress.norm());
    }
    let wrong = row.parametrised(&inputs, &["mu"]).unwrap_err();
    assert!(wrong.to_string().contains("poisson, young can"), "{wrong}");
}

/// Parameters that vary are at rest those of the place.
#[test]
fn parameters_of_a_field_are_those_of_the_place() {
    let law = NeoHooke::new(Field::cells(vec![1e5, 2e5]), 4e5).unwrap();
    let term = Parametrised::new(law);
    assert_eq!([0, 1].map(|cell| term.rest(MaterialPoint { cell, point: 0 }, 0)), [1e5, 2e5]);
    assert!(matches!(term.check(3, 8), Err(EnergyError::Length { name: "mu", .. })));
    let law = Parametrised::new(MooneyRivlin::new(1e5, 2e4, 3e5).unwrap());
    assert_eq!(law.slots().iter().map(|slot| slot.group).collect::<Vec<_>>(), ["mu1", "mu2", "mu3"]);
}
