//! Every member of the catalogue, against the contract of an energy term.

use nastic_energy::catalogue::{self, Inputs, Parameter, Takes};
use nastic_energy::{EnergyError, EnergyTerm, Field, FormulaLaw, Grown, MaterialPoint, MooneyRivlin, NeoHooke, check};
use nastic_tensor::Vec3;
use std::sync::Arc;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

#[test]
fn every_material_keeps_its_contract_in_every_form() {
    for row in catalogue::materials() {
        for inputs in row.examples() {
            let name = format!("{} {inputs:?}", row.name);
            let law = row.build(&inputs).unwrap_or_else(|e| panic!("{name}: {e}"));
            check::passive(&law, HERE).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(check::second_stress_change(&law, HERE, &[]).unwrap().is_some(), "{name}: no second derivatives");
            assert!(law.moduli(HERE).is_some(), "{name} states no moduli");
            if row.name == FormulaLaw::NAME {
                // what its user writes may be anything
                assert!(row.existence.is_empty() && law.existence(HERE).is_none());
                continue;
            }
            assert!(!row.existence.is_empty(), "{name}: for which parameters does a minimiser exist?");
            let stated = law.existence(HERE).unwrap_or_else(|| panic!("{name} states nothing of existence"));
            let bounded = law.fiber_limit(HERE, &Vec3::x()).is_some();
            assert_eq!(bounded, stated.polyconvex, "{name}: a fiber limit is one of polyconvexity");
            assert_eq!(row.existence.contains("not polyconvex"), !stated.polyconvex, "{name}");
            assert_eq!(row.existence.contains("W -> inf"), stated.resists_collapse, "{name}");
            law.check(0, 0).unwrap();
            if let Some(density) = row.density(&inputs).unwrap() {
                check::convex_density(&*density, HERE).unwrap_or_else(|e| panic!("{name}: {e}"));
                check::tension_bound(&*density, HERE).unwrap_or_else(|e| panic!("{name}: {e}"));
            }
        }
    }
}

#[test]
fn every_actuation_keeps_its_contract_in_every_form() {
    for row in catalogue::actuations() {
        for inputs in row.examples() {
            let name = format!("{} {inputs:?}", row.name);
            let built = row.build(&inputs).unwrap_or_else(|e| panic!("{name}: {e}"));
            // its direction among its slots, of any length
            let turned = built.with_direction_slots();
            let turned = turned.map(|law| (law, [row.example.controls, &[0.9, 0.2, 0.8]].concat()));
            for (term, controls) in std::iter::once((built, row.example.controls.to_vec())).chain(turned) {
                let term = acting(term).unwrap_or_else(|e| panic!("{name}: {e}"));
                let rest: Vec<f64> = (0..controls.len()).map(|slot| term.rest(HERE, slot)).collect();
                for m in [&controls, &rest] {
                    check::actuation(&*term, HERE, m).unwrap_or_else(|e| panic!("{name}, {m:?}: {e}"));
                }
                assert!(
                    check::second_stress_change(&term, HERE, &controls).unwrap().is_some(),
                    "{name}: no second derivatives"
                );
                let by_control = check::control_stress_change(&*term, HERE, &controls).unwrap();
                assert!(by_control.is_some(), "{name}: no second derivatives by the controls");
                let work = check::drives(&*term, HERE, &controls, &row.example.gradient()).unwrap();
                assert!(work > 0.7, "{name}: a positive control works {work} on what it is said to drive");
            }
        }
    }
}

/// What acts of an actuation: itself, or a law behind its strain map.
fn acting(term: Arc<dyn EnergyTerm>) -> Result<Arc<dyn EnergyTerm>, EnergyError> {
    Ok(match term.strain_map() {
        None => term,
        Some(_) => Arc::new(Grown::new(Arc::new(NeoHooke::new(1e5, 4e5)?), term)?),
    })
}

/// The free cube moves the way the catalogue says: `towards : e > 0`. What turns a cube leaves a free one no rest.
#[test]
fn a_positive_control_moves_a_free_cube_as_stated() {
    let law = MooneyRivlin::new(1e5, 2e4, 1e6).unwrap();
    for row in catalogue::actuations().iter().filter(|row| row.example.gradient() == row.example.gradient().transpose())
    {
        for inputs in row.examples() {
            let f = check::free_cube(&law, &*row.build(&inputs).and_then(acting).unwrap(), HERE, row.example.controls)
                .unwrap();
            let moved = (f - nastic_tensor::Mat3::identity()).dot(&row.example.gradient());
            assert!(moved > 0.01, "{}: {f}", row.name);
        }
    }
}

#[test]
fn every_parameter_is_required_and_checked() {
    for row in catalogue::materials() {
        for (form, inputs) in row.forms.iter().zip(row.examples()) {
            for parameter in form.iter().filter(|p| !p.optional) {
                let without = form.iter().filter(|p| p.name != parameter.name).copied().collect::<Vec<_>>();
                let names = |form: &[Parameter]| form.iter().map(|p| p.name).collect::<Vec<_>>();
                if row.forms.iter().any(|form| names(form) == names(&without)) {
                    continue; // a shorter set of the same law, as of one family of fibres
                }
                let error = row.build(&Inputs::examples(&without)).unwrap_err();
                assert!(
                    matches!(&error, EnergyError::Missing { .. }) && error.to_string().contains(parameter.name),
                    "{}: {error}",
                    row.name
                );
                let (bad, wrong_kind) = match parameter.takes {
                    Takes::Number { .. } => {
                        let values = Field::cells(vec![f64::NAN; 2]);
                        (inputs.clone().number(parameter.name, values), inputs.clone().choice(parameter.name, "x"))
                    }
                    Takes::Direction { .. } => {
                        let values = Field::cells(vec![Vec3::new(0.0, 0.0, 2.0); 2]);
                        (inputs.clone().direction(parameter.name, values), inputs.clone().number(parameter.name, 1.0))
                    }
                    Takes::Choice { .. } => {
                        (inputs.clone().choice(parameter.name, "?"), inputs.clone().number(parameter.name, 1.0))
                    }
                    Takes::Energy { .. } | Takes::Numbers { .. } | Takes::Network { .. } | Takes::Modes { .. } => {
                        let number = inputs.clone().number(parameter.name, 1.0);
                        (number.clone(), number)
                    }
                };
                let error = row.build(&bad).unwrap_err().to_string();
                assert!(error.contains(parameter.name), "{}: {error}", row.name);
                assert!(matches!(row.build(&wrong_kind).unwrap_err(), EnergyError::Kind { .. }), "{}", row.name);
            }
        }
    }
}

#[test]
fn a_field_of_the_wrong_length_is_named_for_every_parameter() {
    for row in catalogue::materials() {
        let inputs = row.examples().swap_remove(0);
        for parameter in row.forms[0] {
            let with_field = match parameter.takes {
                Takes::Number { example, .. } => inputs.clone().number(parameter.name, Field::points(vec![example; 3])),
                Takes::Direction { example } => {
                    inputs.clone().direction(parameter.name, Field::points(vec![Vec3::from(example); 3]))
                }
                Takes::Choice { .. }
                | Takes::Energy { .. }
                | Takes::Numbers { .. }
                | Takes::Network { .. }
                | Takes::Modes { .. } => continue,
            };
            let law = row.build(&with_field).unwrap();
            assert!(law.check(1, 3).is_ok());
            let expected = format!(
                "{}: {} has 3 values, one per quadrature point, but the body has 8 quadrature points",
                row.name, parameter.name
            );
            assert_eq!(law.check(1, 8).unwrap_err().to_string(), expected);
        }
    }
}

#[test]
fn names_are_distinct_and_unknown_ones_are_answered() {
    let names: Vec<_> =
        catalogue::materials().iter().map(|r| r.name).chain(catalogue::actuations().iter().map(|r| r.name)).collect();
    for (n, name) in names.iter().enumerate() {
        assert!(!names[..n].contains(name), "{name} twice");
    }
    let error = catalogue::material("moony_rivlin").unwrap_err().to_string();
    assert_eq!(
        error,
        "no law is called `moony_rivlin` (did you mean `mooney_rivlin`?); there are: mooney_rivlin, \
         transverse_mooney_rivlin, neo_hooke, gel, neo_hooke_isochoric, yeoh, gent, arruda_boyce, ogden, \
         holzapfel_gasser_ogden, fiber_family, saint_venant_kirchhoff, arap, guccione, convex_network, formula"
    );
    assert!(catalogue::actuation("sinew").unwrap_err().to_string().contains("fiber_tension"));
}

#[test]
fn parameters_of_two_sets_are_refused() {
    let row = catalogue::material("mooney_rivlin").unwrap();
    let error = row.build(&Inputs::new().number("shear", 1.0).number("poisson", 0.3).number("share", 0.5)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "mooney_rivlin: poisson and shear belong to different parameter sets; it takes {mu1, mu2, mu3} or \
         {shear, bulk, share} or {young, poisson, share} or {c10, c01, d1}"
    );
    let error = row.build(&Inputs::new()).unwrap_err().to_string();
    assert!(error.starts_with("mooney_rivlin needs mu1 (nothing was given)"), "{error}");
    let error = row.build(&Inputs::new().number("young", 1.0).number("share", 0.5)).unwrap_err().to_string();
    assert!(error.starts_with("mooney_rivlin needs poisson (given: share, young)"), "{error}");
}
