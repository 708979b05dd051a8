//! The L2 distance between the optimal controls of several runs on one mesh, whatever spaces their controls have:
//!
//! ```sh
//! cargo run --release -p nastic-case --example control_distance -- CASE DIR DIR ...
//! ```
//!
//! CASE is the case that the runs were made from (files that it names are found beside it), every DIR the result directory of an `optimize`. A row
//! for every run and every control that all members share: the total variation and the norm `(int |m|^2 dX)^(1/2)` by the quadrature points of the
//! mesh, the distance `(int |m - m_before|^2 dX)^(1/2)` from the run before, its share of the norm, and the observed order,
//! `log2` of the last distance by this one: 1 where it is halved.

#![allow(clippy::print_stdout)] // a program prints its table

use nastic_case::lower::CaseProblem;
use nastic_control::ControlTarget;
use nastic_language::syntax::Document;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// A control of a run.
struct Field {
    name: String,
    total_variation: f64,
    /// Reference volumes of the quadrature points.
    weights: Vec<f64>,
    /// Vectors at the points, one after the other.
    at_points: Vec<f64>,
}

impl Field {
    /// The norm of the difference from values at the same points.
    fn distance(&self, other: &[f64]) -> f64 {
        let components = self.at_points.len() / self.weights.len().max(1);
        let squares = self.at_points.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
        let weights = self.weights.iter().flat_map(|w| std::iter::repeat_n(w, components));
        squares.zip(weights).map(|(square, w)| w * square).sum::<f64>().sqrt()
    }
}

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, directories @ ..] = arguments.as_slice() else { return Err("give CASE DIR DIR ...".into()) };
    let mut before: Vec<(Field, f64)> = vec![];
    println!(
        "{:<24} {:<20} {:>12} {:>12} {:>12} {:>9} {:>6}",
        "run", "control", "variation", "norm", "distance", "share", "order"
    );
    for directory in directories {
        let mut here = vec![];
        for field in fields(case, Path::new(directory))? {
            let norm = field.distance(&vec![0.0; field.at_points.len()]);
            print!("{directory:<24} {:<20} {:>12.5e} {norm:>12.5e}", field.name, field.total_variation);
            let old = before.iter().find(|(old, _)| old.name == field.name);
            let distance = match old {
                Some((old, _)) if old.at_points.len() != field.at_points.len() => {
                    return Err(format!("{directory}: another mesh than the run before").into());
                }
                Some((old, _)) => field.distance(&old.at_points),
                None => f64::NAN,
            };
            if distance.is_finite() {
                print!(" {distance:>12.5e} {:>9.5}", distance / norm);
            }
            if let Some((_, last)) = old.filter(|(_, last)| last.is_finite()) {
                print!(" {:>6.2}", (last / distance).log2());
            }
            println!();
            here.push((field, distance));
        }
        before = here;
    }
    Ok(())
}

/// The controls of a run that all members share.
fn fields(case: &str, directory: &Path) -> Outcome<Vec<Field>> {
    let read = |name: &str| {
        let path = directory.join(name);
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    };
    let problem = CaseProblem::lower(Document::parse(case, &read("case.json")?)?, Arc::default())?;
    let controls: Value = serde_json::from_str(&read("controls.json")?)?;
    let mut out = vec![];
    for (place, field) in problem.ensemble.blocks().iter().zip(&problem.controls) {
        let owner = problem.ensemble.members()[place.owner].problem();
        let (layout, discretization) = (owner.layout(), owner.solid().discretization());
        let block = &layout.blocks()[place.field];
        if field.load_case.is_some() || block.basis.is_of_contribution() {
            continue;
        }
        let values = controls[&field.name].as_array().ok_or_else(|| format!("no {} in controls.json", field.name))?;
        let values: Vec<f64> = values.iter().filter_map(Value::as_f64).collect();
        if values.len() != block.len() {
            return Err(format!(
                "{}: {} values of {}, not {}",
                directory.display(),
                values.len(),
                field.name,
                block.len()
            )
            .into());
        }
        let mut m = vec![0.0; layout.len()];
        m[block.first..][..values.len()].copy_from_slice(&values);
        let all = layout.to_points(&m)?;
        let ControlTarget { actuation, slot, slots, .. } = block.targets[0];
        let points = all.values(actuation).chunks_exact(all.slots(actuation));
        let at_points = points.flat_map(|at| at[slot..][..slots].to_vec()).collect();
        let total_variation = block.total_variation(discretization, &values);
        out.push(Field {
            name: field.name.clone(),
            total_variation,
            weights: discretization.points().weights().to_vec(),
            at_points,
        });
    }
    Ok(out)
}
