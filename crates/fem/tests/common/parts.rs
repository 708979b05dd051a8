//! Parts of bodies over ranks that are threads, for tests.

use super::Outcome;
use super::ranks::Simple;
use nastic_fem::{Instant, Share, Solid, SolveOptions};
use nastic_mesh::Mesh;
use nastic_team::Team;
use nastic_team::threads::{self, Faults, ThreadRank};
use std::sync::Arc;

pub type Sent<T> = Result<T, String>;

pub fn on<T: Send>(ranks: usize, faults: &Faults, work: impl Fn(Arc<ThreadRank>) -> Outcome<T> + Sync) -> Vec<Sent<T>> {
    threads::run(ranks, faults, |rank| work(Arc::new(rank)).map_err(|error| error.to_string()))
}

pub fn part(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Solid> {
    let part = mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?;
    Ok(Solid::of_part(part, rank.clone())?)
}

pub type Divide = fn(&Mesh, &Arc<ThreadRank>) -> Outcome<Solid>;

/// Cells dealt out one by one: parts that touch surfaces and each other with single nodes and edges.
pub fn scattered(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Solid> {
    let owners: Vec<u32> = (0..mesh.cells()).map(|cell| (cell % rank.size()) as u32).collect();
    Ok(Solid::of_part(mesh.part(&owners, rank.rank() as u32)?, rank.clone())?)
}

pub fn how() -> SolveOptions<'static> {
    SolveOptions { solver: Some(&Simple), parallel: false, ..SolveOptions::default() }
}

/// The sum over all ranks.
pub fn total(share: Option<&Arc<Share>>, here: f64) -> f64 {
    let mut sum = [here];
    if let Some(share) = share {
        share.sum(&mut sum);
    }
    sum[0]
}

/// `j = u . u / 2` at a tension, its derivative by the tension, the energy and the displacement.
pub fn valued(solid: &Solid, tension: f64, how: &SolveOptions) -> Outcome<(f64, f64, f64, Vec<f64>)> {
    let (space, mut controls) = (solid.model().unknowns(), solid.controls());
    controls.values_mut(0).fill(tension);
    let state = solid.solve(&controls, how)?;
    let rhs: Vec<f64> = state.u.iter().map(|u| -u).collect();
    let adjoint = solid.adjoint(&state, &[&rhs], how)?;
    let found = solid.model().vjp(&Instant::of(&state), &adjoint.lambda[0])?;
    let slope = space.total(found.controls.values(0).iter().sum());
    Ok((0.5 * space.dot(&state.u, &state.u), slope, state.report.energy, state.u.to_vec()))
}
