//! Every displacement that a solver accepts, and every one that it evaluates, is reached by a straight move that all contributions bear.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{Outcome, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Contribution, ContributionPoint, Demand, Inadmissible, Inertia, Instant, Need, PathOptions, Scheme, Solid,
    SolveOptions, State, StateError, StepTo, Sums, TimeStepping, Trajectory, Workspace,
};
use nastic_linear::SparseMatrix;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// No node below `y = floor`: a barrier `-k log((y - floor) / d)` within a distance d, which is evaluated nowhere else.
#[derive(Debug, Clone)]
struct Floor {
    heights: Vec<f64>,
    floor: f64,
    stiffness: f64,
    evaluations: Arc<AtomicUsize>,
    beyond: Arc<AtomicUsize>,
}

const WITHIN: f64 = 0.05;

impl Floor {
    fn gap(&self, node: usize, u: &[f64]) -> f64 {
        self.heights[node] + u[2 * node + 1] - self.floor
    }

    fn outside() -> Inadmissible {
        Inadmissible::Penetrates { name: "floor".to_owned(), place: [0.0; 3], depth: 0.0 }
    }

    fn check(&self, u: &[f64]) -> Result<(), Inadmissible> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        if (0..self.heights.len()).all(|node| self.gap(node, u) > 0.0) {
            return Ok(());
        }
        self.beyond.fetch_add(1, Ordering::Relaxed);
        Err(Self::outside())
    }
}

impl Contribution for Floor {
    fn name(&self) -> &str {
        "floor"
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Floor {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        self.check(at.u)?;
        for node in 0..self.heights.len() {
            let gap = self.gap(node, at.u);
            if gap >= WITHIN {
                continue;
            }
            let (log, slope) = ((gap / WITHIN).ln(), gap - WITHIN);
            sums.energy -= self.stiffness * slope * slope * log;
            sums.energy_scale += (self.stiffness * slope * slope * log).abs();
            if demand.force {
                let force = -self.stiffness * (2.0 * slope * log + slope * slope / gap);
                sums.force[2 * node + 1] += force;
                sums.force_scale[2 * node + 1] += force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.check(at.u)?;
        let mut diagonal = vec![0.0; 2 * self.heights.len()];
        for node in 0..self.heights.len() {
            let gap = self.gap(node, at.u);
            if gap < WITHIN {
                let slope = gap - WITHIN;
                let curvature = 2.0 * (gap / WITHIN).ln() + 4.0 * slope / gap - (slope / gap).powi(2);
                diagonal[2 * node + 1] = -self.stiffness * curvature;
            }
        }
        tangent.add_diagonal(&diagonal);
        Ok(())
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        let nodes = 0..self.heights.len();
        if nodes.clone().any(|node| self.gap(node, at.u) <= 0.0) {
            return Err(Self::outside());
        }
        let share = |node: usize| {
            let (gap, fall) = (self.gap(node, at.u), -du[2 * node + 1]);
            if fall > 0.99 * gap { 0.9 * gap / fall } else { 1.0 }
        };
        Ok(nodes.map(share).fold(1.0, f64::min))
    }
}

/// A slender strip above a floor, with a load at its end, and the counts of evaluations and of those beyond.
fn strip(load: f64, floor: f64) -> Outcome<(Solid, Floor)> {
    let mesh = regular(CellKind::Quad8, [6.0, 0.3, 0.0], [24, 1, 1])?;
    let heights = mesh.points().iter().map(|x| x[1]).collect();
    let (evaluations, beyond) = (Arc::default(), Arc::default());
    let floor = Floor { heights, floor, stiffness: 30.0, evaluations, beyond };
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(100.0, 100.0)?)?
        .clamp("x-")?
        .traction("x+", Vec3::new(0.0, load, 0.0))?
        .inertia(Inertia::new("body", 1.0))?
        .contribution(floor.clone())?;
    Ok((solid, floor))
}

fn sound(floor: &Floor, states: &[&State]) {
    let (evaluations, beyond) = (floor.evaluations.load(Ordering::Relaxed), floor.beyond.load(Ordering::Relaxed));
    assert!(evaluations > 10 && beyond == 0, "{beyond} of {evaluations} evaluations were beyond the floor");
    for state in states {
        let least = (0..floor.heights.len()).map(|node| floor.gap(node, &state.u)).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0, "{least}");
    }
}

/// The strip as it would be, were there no floor.
fn without_floor(load: f64) -> Outcome<State> {
    let (solid, _) = strip(load, -1e3)?;
    Ok(solid.solve(&solid.controls(), &SolveOptions::default())?)
}

/// From rest the steps turn with the body: it bends down onto the floor, and up away from it.
#[test]
fn curved_steps_end_above() -> Outcome {
    for load in [-1.0, 0.6] {
        let (solid, floor) = strip(load, -0.4)?;
        let state = solid.solve(&solid.controls(), &SolveOptions::default())?;
        assert!(largest(&state.u) > 0.3, "{}", largest(&state.u));
        sound(&floor, &[&state]);
        if load < 0.0 {
            // it lies on the floor
            let least = (0..floor.heights.len()).map(|node| floor.gap(node, &state.u)).fold(f64::INFINITY, f64::min);
            assert!(least < WITHIN, "{least}");
        }
    }
    Ok(())
}

/// A guess beyond the floor is not taken, with a state nearby and without.
#[test]
fn guesses_beyond_are_not_taken() -> Outcome {
    let guess = without_floor(-1.0)?;
    let (solid, floor) = strip(-1.0, -0.4)?;
    let cold = solid.solve(&solid.controls(), &SolveOptions::default())?;
    for near in [None, Some(&cold)] {
        let how = SolveOptions { near, guess: Some(&guess.u), ..SolveOptions::default() };
        let state = solid.solve(&solid.controls(), &how)?;
        assert!(common::distance(&state.u, &cold.u) < 1e-6);
    }
    sound(&floor, &[&cold]);
    Ok(())
}

/// What begins beyond is refused by its type.
#[test]
fn starts_beyond_are_refused() -> Outcome {
    let beyond = without_floor(-1.0)?;
    let (solid, floor) = strip(-1.0, -0.4)?;
    let (how, controls, workspace) = (SolveOptions::default(), solid.controls(), &mut Workspace::default());
    let refused = |error: Option<StateError>| {
        assert!(matches!(error, Some(StateError::Start { .. })), "{error:?}");
    };
    refused(solid.solve(&controls, &SolveOptions::near(&beyond)).err());
    let options = PathOptions::default();
    refused(solid.model().stability().path(&beyond, (&controls, 1.0), &options, &how, workspace, &mut |_| ()).err());
    refused(solid.model().stability().equilibria(&beyond, 2, &how, workspace, &mut |_| ()).err());
    refused(solid.model().stability().descend(&beyond, &how, workspace).err());
    let steps = [StepTo { dt: 0.1, controls }];
    let mut trajectory = Trajectory::from_given(beyond);
    refused(solid.model().advance(&mut trajectory, &Scheme::backward_euler(), &steps, &how, workspace).err());
    assert_eq!(floor.beyond.load(Ordering::Relaxed), 0);
    // the body at rest, too
    let (sunk, floor) = strip(0.0, 0.1)?;
    refused(sunk.solve(&sunk.controls(), &how).err());
    assert_eq!(floor.beyond.load(Ordering::Relaxed), 0);
    Ok(())
}

/// The predictor of an arc-length step, and the starts of deflation along modes.
#[test]
fn paths_and_deflation_stay_above() -> Outcome {
    let (solid, floor) = strip(-0.5, -0.4)?;
    let (how, workspace) = (SolveOptions::default(), &mut Workspace::default());
    let options = PathOptions { step: 1.0, points: 40, ..PathOptions::default() };
    let controls = solid.controls();
    let path =
        solid.model().stability().path(&solid.rest(), (&controls, 1.0), &options, &how, workspace, &mut |_| ())?;
    println!("{} points, {:?}", path.points.len(), path.end);
    assert!(path.points.len() > 3);
    sound(&floor, &path.points.iter().map(|point| &point.state).collect::<Vec<_>>());
    let state = solid.solve(&controls, &how)?;
    let all = solid.model().stability().equilibria(&state, 2, &how, workspace, &mut |_| ())?;
    sound(&floor, &all.found.iter().map(|found| &found.state).collect::<Vec<_>>());
    Ok(())
}

/// A strip that falls towards the floor: starts of steps are extrapolated; a step that leads nowhere fails,
/// instead of beginning again at rest.
#[test]
fn steps_in_time_stay_above() -> Outcome {
    let (how, dt) = (SolveOptions::default(), 0.2);
    for scheme in [Scheme::backward_euler(), Scheme::bdf2(), Scheme::tr_bdf2(), Scheme::linearly_implicit_euler()] {
        let (solid, floor) = strip(-0.3, -0.4)?;
        let mut trajectory = Trajectory::from_given(solid.rest());
        let steps: Vec<StepTo> = (0..15).map(|_| StepTo { dt, controls: solid.controls() }).collect();
        let moved = solid.model().advance(&mut trajectory, &scheme, &steps, &how, &mut Workspace::default());
        println!(
            "{}: {} steps, {:?}",
            scheme.name(),
            trajectory.states().len() - 1,
            moved.as_ref().err().map(|e| e.code())
        );
        assert!(trajectory.states().len() > 3, "{}: {moved:?}", scheme.name());
        assert!(trajectory.states().iter().all(|state| state.report.restarts == 0));
        sound(&floor, &trajectory.states().iter().collect::<Vec<_>>());
        if !scheme.is_linearised() {
            moved?;
        }
    }
    Ok(())
}
