//! What a program's problem is, as far as it can be written down: a checkpoint goes on only with an equal one.

use crate::run::study::control_set::ControlSet;
use nastic_case::lower::ControlProblem;
use nastic_control::Space;
use nastic_ensemble::{Ensemble, EnsemblePoint, Member};
use nastic_fem::{Demand, Instant, Solid};
use nastic_io::Fingerprint;
use nastic_language::schema::Case;
use nastic_mesh::Mesh;
use nastic_numeric::format::scientific;
use nastic_opt::{Objective, Optimizer};
use serde_json::{Map, Value, json};

/// The cost and the potential of a state computed again, relative: rounding is less, another law or cost is more.
const SAME: f64 = 1e-9;

/// Meshes, supports, costs, controls, inner products, sets, starts, optimiser. Laws, actuations and the insides of costs are code: what they give is compared when an
/// optimisation goes on.
pub(super) fn identity(
    ensemble: &Ensemble,
    controls: &[(ControlSet, ControlProblem)],
    optimizer: &dyn Optimizer,
    case: &Case,
) -> Value {
    let members: Vec<Value> = ensemble.members().iter().map(|member| of_member(ensemble, member)).collect();
    let blocks = ensemble.blocks().iter().zip(controls).map(|(block, (set, control))| {
        let owner = ensemble.members()[block.owner].problem();
        let own = &owner.layout().blocks()[block.field];
        let entry = json!({
            "space": space(own.basis.space()), "values": block.len, "set": format!("{set:?}"), "start": hash(&control.start),
            "weight": own.weight, "length": own.length(), "log": own.log, "metric": format!("{:?}", owner.metric_kind()),
        });
        (block.name.clone(), entry)
    });
    json!({
        "members": members,
        "controls": blocks.collect::<Map<_, _>>(),
        "risk": format!("{:?}", ensemble.risk()),
        "optimizer": format!("{optimizer:?}"),
        "starts": case.optimizer.starts,
        "seed": case.optimizer.seed,
        "early_stopping": case.optimizer.early_stopping,
        "snapshots_every": case.output.every,
        "checkpoints_every": case.output.checkpoint,
    })
}

fn of_member(ensemble: &Ensemble, member: &Member) -> Value {
    let problem = member.problem();
    let mesh = problem.solid().mesh();
    json!({
        "name": member.name(), "probability": ensemble.probabilities()[member.scenario()], "weight": member.weight(),
        "mesh": mesh.name(), "cells": mesh.cells(), "nodes": hash_of_mesh(mesh),
        "unknowns": problem.solid().discretization().dofs(), "supports": hash_of_supports(problem.solid()),
        "costs": problem.term_names(),
    })
}

fn hash_of_mesh(mesh: &Mesh) -> String {
    hash(mesh.points().as_flattened())
}

/// Of which degrees of freedom are fixed, and of the displacements there.
fn hash_of_supports(solid: &Solid) -> String {
    let supports = solid.supports();
    let held = supports.fixed().iter().zip(supports.values());
    hash(&held.flat_map(|(fixed, value)| [f64::from(u8::from(*fixed)), *value]).collect::<Vec<_>>())
}

/// Of the bits of numbers.
fn hash(values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    format!("{:016x}", Fingerprint::of_bytes(&bytes))
}

/// Name of a space, with the cells of a grid.
fn space(space: Space) -> String {
    match space {
        Space::Grid(cells) => format!("{} {cells:?}", space.name()),
        other => other.name().to_owned(),
    }
}

/// Whether laws and costs, which no record holds, give a point of a checkpoint the values that it has there.
pub(in crate::run) fn same_program(ensemble: &Ensemble, point: &EnsemblePoint) -> Result<(), String> {
    let stage = point.members.iter().map(|at| at.stage).max().unwrap_or(0);
    let again = ensemble.restage(stage, point).map_err(|failed| failed.to_string())?;
    // A value that is no number is not the same either.
    let same = (again.risk - point.risk).abs() <= SAME * point.risk.abs();
    if !same {
        let (cost, was) = (scientific(again.risk, 6), scientific(point.risk, 6));
        return Err(format!("its control costs {cost} now and cost {was} before: a cost of the program has changed"));
    }
    for (member, at) in ensemble.members().iter().zip(&point.members) {
        let state = at.state();
        let place = Instant::of(state);
        let now = member.problem().solid().model().evaluate(&place, Demand { energy: true, force: false });
        let now = now.map_err(|error| error.to_string())?;
        let same = (now.energy - state.report.energy).abs() <= SAME * now.energy_scale;
        if !same {
            let (now, was) = (scientific(now.energy, 6), scientific(state.report.energy, 6));
            return Err(format!(
                "its state has the potential {now} now and had {was} before: a law or a load of the program has changed"
            ));
        }
    }
    Ok(())
}
