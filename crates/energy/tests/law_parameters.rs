//! Laws with parameters as slots: those of the catalogue that have some, against the law itself and the contract of an actuation.

use nastic_energy::catalogue::{self, Takes};
use nastic_energy::{Actuation, EnergyTerm};
use nastic_energy::{EnergyError, Field, MaterialPoint, MooneyRivlin, NeoHooke, Parametrised, Role, check};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

#[test]
fn every_law_gives_its_parameters_or_says_that_it_has_none() {
    let mut with_parameters = Vec::new();
    for row in catalogue::materials() {
        for inputs in row.examples() {
            let law = row.build(&inputs).unwrap();
            let term = match law.parametrised() {
                Ok(term) => term,
                Err(error) => {
                    assert!(matches!(error, EnergyError::NoParameters { .. }), "{}: {error}", row.name);
                    assert!(error.to_string().contains("EnergyTerm::parametrised"), "{error}");
                    continue;
                }
            };
            with_parameters.push(row.name);
            assert!(term.is_material());
            let own: Vec<f64> = (0..term.slots().len()).map(|k| term.rest(HERE, k)).collect();
            for (slot, value) in term.slots().iter().zip(&own) {
                assert_eq!(slot.role, Role::Design { rest: *value });
                let known = row.parameters().into_iter().find(|parameter| parameter.name == slot.group).unwrap();
                assert!(matches!(known.takes, Takes::Number { unit, .. } if unit == slot.unit), "{}", slot.group);
            }
            // Where nothing gives others, and at its own ones, it is the law to the bit.
            for k in check::states() {
                let expected = check::evaluate(&law, HERE, &k, &[]);
                assert_eq!(check::evaluate(&term, HERE, &k, &[]), expected, "{}", row.name);
                assert_eq!(check::evaluate(&term, HERE, &k, &own), expected, "{}", row.name);
            }
            let others: Vec<f64> = own.iter().map(|value| 1.7 * value + 3e4).collect();
            for values in [&own, &others] {
                let report = check::actuation(&*term, HERE, values).unwrap_or_else(|e| panic!("{}: {e}", row.name));
                let second = |what: &str| report.findings.iter().any(|finding| finding.check.starts_with(what));
                assert!(second("the change of dP/dm") && second("the second change of P"), "{report}");
            }
        }
    }
    with_parameters.dedup();
    assert_eq!(with_parameters, ["mooney_rivlin", "neo_hooke"]);
}

/// Parameters that vary are at rest those of the place.
#[test]
fn parameters_of_a_field_are_those_of_the_place() {
    let law = NeoHooke::new(Field::cells(vec![1e5, 2e5]), 4e5).unwrap();
    let term = Parametrised::new(law);
    assert_eq!([0, 1].map(|cell| term.rest(MaterialPoint { cell, point: 0 }, 0)), [1e5, 2e5]);
    assert!(matches!(term.check(3, 8), Err(EnergyError::Length { name: "mu", .. })));
    let law = MooneyRivlin::new(1e5, 2e4, 3e5).unwrap().parametrised().unwrap();
    assert_eq!(law.slots().iter().map(|slot| slot.group).collect::<Vec<_>>(), ["mu1", "mu2", "mu3"]);
}
