//! Blocks of a case with identified numbers of materials, to paste.

use super::parameters::Parameter;
use nastic_case::lower::CaseProblem;
use nastic_opt::Covariance;
use serde_json::{Map, Value, json};

/// Directions whose deviation is above one scale are left out: there the readings decide nothing, and the linearisation says nothing.
pub(super) const MOST_SPREAD: f64 = 1.0;

/// A number of a material of the case that is one parameter.
struct Place<'p> {
    material: usize,
    key: String,
    parameter: &'p Parameter,
}

/// `materials` and `scenarios`; none of a case whose controls are no numbers of materials.
pub(super) fn of(
    problem: &CaseProblem,
    parameters: &[Parameter],
    covariance: &Covariance,
) -> (Option<Value>, Option<Value>) {
    let places = places(problem, parameters);
    let mut materials = problem.document.json().get("materials").cloned();
    let block = materials.as_mut().filter(|_| !places.is_empty()).map(|materials| {
        for place in &places {
            materials[place.material][&place.key] = json!(place.parameter.text(place.parameter.value));
        }
        materials.clone()
    });
    let scenarios = block.is_some().then(|| scenarios(parameters, &places, covariance));
    (block, scenarios.filter(|all| all.as_array().is_some_and(|all| !all.is_empty())))
}

fn places<'p>(problem: &CaseProblem, parameters: &'p [Parameter]) -> Vec<Place<'p>> {
    let of = |parameter: &'p Parameter| {
        let field = problem.controls.get(parameter.control).filter(|_| parameter.is_alone)?;
        let control = problem.case.controls.iter().find(|own| own.at == field.at)?;
        let mut materials = problem.case.materials.iter().enumerate();
        let (material, key) = materials.find_map(|(k, own)| Some((k, own.number_of(&control.of)?)))?;
        Some(Place { material, key: key.to_owned(), parameter })
    };
    parameters.iter().filter_map(of).collect()
}

/// Materials of equal probability with mean and covariance of the unknowns, `x +- sqrt(d) s_k v_k` along the d directions that are seen, as those of a fit.
fn scenarios(parameters: &[Parameter], places: &[Place<'_>], covariance: &Covariance) -> Value {
    let of = |part: &[f64], k: usize, length: f64| parameters[k].unknown + length * part[k] * parameters[k].scale;
    let is_seen = |deviation: &f64| *deviation <= MOST_SPREAD;
    let seen = covariance.directions.iter().filter_map(|one| Some((one, one.deviation.filter(is_seen)?)));
    let count = seen.clone().count() as f64;
    let mut out = Vec::new();
    for (one, deviation) in seen {
        for sign in [-1.0, 1.0] {
            let length = sign * count.sqrt() * deviation;
            let mut set = Map::new();
            for Place { material, key, parameter } in places {
                let Some(k) = parameters.iter().position(|own| std::ptr::eq(own, *parameter)) else { continue };
                let unknown = of(&one.components, k, length).clamp(parameter.bounds[0], parameter.bounds[1]);
                set.insert(format!("materials/{material}/{key}"), json!(parameter.text(parameter.value_at(unknown))));
            }
            out.push(json!({ "probability": 0.5 / count, "set": set }));
        }
    }
    Value::Array(out)
}
