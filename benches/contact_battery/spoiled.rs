//! Whether every check of the judge can fail: answers made wrong on purpose.

use crate::families::Family;
use crate::judge::law::Law;
use crate::judge::spoiled::Spoil;
use crate::judge::stability::falling_directions;
use crate::judge::{Check, checks};
use crate::problem::{self, Facts, Problem, Region, Task};
use crate::solve::{Solved, solve};
use nastic::prelude::*;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::Arc;

/// Solves problems of families and judges each answer once for everything that can be spoiled.
pub fn run(families: &[&Family], seed: u64, count: usize) -> Result<ExitCode, problem::Failure> {
    // by check what makes it fail
    let mut noticed: BTreeMap<&'static str, Vec<String>> = BTreeMap::new();
    for (family, index) in families.iter().flat_map(|family| (0..count).map(move |index| (family, index))) {
        let Ok(right) = solve(&crate::problem(family, seed, index as u64)?) else { continue };
        for spoil in Spoil::ALL {
            let mut problem = crate::problem(family, seed, index as u64)?;
            let Solved { states, scheme, newton } = &right;
            let mut wrong = Solved { states: states.clone(), scheme: scheme.clone(), newton: *newton };
            spoil.answer(&problem, &mut wrong);
            spoil.problem(&mut problem);
            for check in checks(&problem, &wrong, Some(spoil)).unwrap_or_default() {
                let fails = noticed.entry(check.name).or_default();
                let word = format!("{spoil:?}").to_lowercase();
                if Check::fails(&check) && !fails.contains(&word) {
                    fails.push(word);
                }
            }
        }
    }
    noticed.iter().for_each(|(name, fails)| println!("{name:38} fails with: {}", fails.join(", ")));
    let [at_rest, pressed] = [0.0, 0.3].map(column_falls);
    let (at_rest, pressed) = (at_rest?, pressed?);
    println!("directions in which a slender column falls: {at_rest} at rest, {pressed} pressed to 0.7");
    if at_rest != 0 || pressed == 0 {
        return Ok(ExitCode::FAILURE);
    }
    let blind: Vec<&str> = noticed.iter().filter(|(_, fails)| fails.is_empty()).map(|(name, _)| *name).collect();
    if blind.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    println!("never failed: {}", blind.join(", "));
    Ok(ExitCode::FAILURE)
}

/// In how many directions a column that is clamped at its ends and straight falls, pressed by a share of its length.
fn column_falls(share: f64) -> Result<usize, problem::Failure> {
    let mesh = rectangle([0.05, 1.0], [2, 20], CellKind::Quad4)?;
    let (mu, lambda) = (1e5, 2e5);
    let solid = Solid::new(mesh)?.material("body", NeoHooke::new(mu, lambda)?)?.clamp("y-")?;
    let u: Vec<f64> = solid.mesh().points().iter().flat_map(|x| [0.0, -share * x[1]]).collect();
    let state = State { u: Arc::new(u), ..solid.rest() };
    let law = Law::NeoHooke { mu, lambda };
    let region = Region { name: "body".into(), law, density: 0.0, mean_dilatation: false, rigid: false };
    let held = vec!["y-".to_owned(), "y+".to_owned()];
    let facts = Facts { regions: vec![region], held, ..Facts::default() };
    let task = Task::Rest(solid.controls());
    let problem = Problem { about: String::new(), solid, facts, task };
    Ok(falling_directions(&problem, &state)?)
}
