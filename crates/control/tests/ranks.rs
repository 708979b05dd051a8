//! Bodies over ranks that are threads, for tests: what ranks find beside what one process finds.

#[path = "../../fem/tests/common/ranks.rs"]
pub mod solver;

use nastic_control::{Evaluated, Reduced, ReducedWorkspace};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_opt::Objective;
use nastic_team::Team;
use nastic_team::threads::{self, Faults, ThreadRank};
use std::sync::Arc;
use std::time::Duration;

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// What every rank gave, or the message of its error. One that waits for a message that nobody sends fails.
pub fn on<T: Send>(ranks: usize, work: impl Fn(Arc<ThreadRank>) -> Outcome<T> + Sync) -> Vec<Result<T, String>> {
    on_faulty(ranks, None, work)
}

/// The same, where a rank is lost at one of its messages.
pub fn on_faulty<T: Send>(
    ranks: usize,
    lost: Option<(usize, usize)>,
    work: impl Fn(Arc<ThreadRank>) -> Outcome<T> + Sync,
) -> Vec<Result<T, String>> {
    let faults = Faults { lost, patience: Some(Duration::from_secs(60)), ..Faults::default() };
    threads::run(ranks, &faults, |rank| work(Arc::new(rank)).map_err(|error| error.to_string()))
}

/// The part of a rank, in blocks or cell by cell.
pub fn part(mesh: &Mesh, rank: &Arc<ThreadRank>, scattered: bool) -> Outcome<Solid> {
    let owners = match scattered {
        true => (0..mesh.cells()).map(|cell| (cell % rank.size()) as u32).collect(),
        false => mesh.bisected(rank.size())?,
    };
    let part = mesh.part(&owners, rank.rank() as u32)?;
    Ok(Solid::of_part(part, rank.clone())?.solver(&solver::Simple))
}

/// A bar of two regions, "near" and "far", between "x-" and "x+".
pub fn bar(kind: CellKind, n: usize) -> Outcome<Mesh> {
    let mesh = box_mesh([1.0, 0.2, 0.2], [3 * n, n, n], kind)?;
    let mut raw = RawMesh::new("bar");
    raw.points = mesh.points().to_vec();
    for block in mesh.blocks() {
        for cell in block.iter() {
            let middle = cell.iter().map(|&node| mesh.points()[node as usize][0]).sum::<f64>() / cell.len() as f64;
            raw.push(block.kind, cell, &[if middle < 0.5 { 1 } else { 2 }, 3]);
        }
    }
    for (tag, (name, facets)) in (1..).zip(mesh.surfaces()) {
        raw.name_group(2, tag, name);
        for &facet in facets {
            let (kind, nodes) = mesh.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    for (tag, name) in [(1, "near"), (2, "far"), (3, "body")] {
        raw.name_group(3, tag, name);
    }
    Ok(Mesh::build(raw)?)
}

/// Cost and derivative at a control.
pub fn valued(problem: &Reduced, m: &[f64]) -> Outcome<(f64, Vec<f64>)> {
    let mut point: Evaluated = problem.at(m)?;
    let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
    Ok((point.cost(), derivative))
}

/// The largest difference of two vectors of numbers as a share of the largest entry.
pub fn apart(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().chain(expected).all(|x| x.is_finite()), "{found:?} {expected:?}");
    let size = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / size
}
