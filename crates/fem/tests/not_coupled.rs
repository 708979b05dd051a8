//! A contribution that forgets its couplings is refused by name, in any build: nothing of its tangent is dropped.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::own_contributions::bar;
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, FemError, Inadmissible, Instant, Need, Scheme, Solid,
    SolveOptions, Solver, StateError, StepTo, Sums, Tendon, TimeStepping, Trajectory, Workspace, check_contribution,
};
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_tensor::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A spring of length zero between two nodes, `k/2 |u_a - u_b|^2`, with a mass of its own.
#[derive(Debug, Clone)]
struct Link {
    nodes: [u32; 2],
    coupled: bool,
    mass: f64,
    tangents: Arc<AtomicUsize>,
}

const STIFFNESS: f64 = 30.0;

impl Link {
    fn element(factor: f64) -> Vec<f64> {
        let sign = |at: usize| if at / 18 == at % 6 / 3 { factor } else { -factor };
        (0..36).map(|at| if at / 6 % 3 == at % 3 { sign(at) } else { 0.0 }).collect()
    }
}

impl Contribution for Link {
    fn name(&self) -> &str {
        "link"
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        if self.coupled { vec![self.nodes.to_vec()] } else { Vec::new() }
    }

    fn add_mass(&self, _: &Instant, mass: &mut SparseMatrix) -> Result<(), NotCoupled> {
        if self.mass > 0.0 { mass.add_pairs(&self.nodes, &Link::element(self.mass)) } else { Ok(()) }
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Link {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let [a, b] = self.nodes.map(|node| 3 * node as usize);
        for i in 0..3 {
            let force = STIFFNESS * (at.u[a + i] - at.u[b + i]);
            sums.energy += 0.5 * force * (at.u[a + i] - at.u[b + i]);
            sums.energy_scale += 0.5 * (force * (at.u[a + i] - at.u[b + i])).abs();
            if demand.force {
                sums.force[a + i] += force;
                sums.force[b + i] -= force;
                sums.force_scale[a + i] += force.abs();
                sums.force_scale[b + i] += force.abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.tangents.fetch_add(1, Ordering::Relaxed);
        Ok(tangent.add_pairs(&self.nodes, &Link::element(STIFFNESS))?)
    }
}

/// The bar with a link between nodes that share no cell.
fn linked(coupled: bool, mass: f64) -> Outcome<(Solid, [u32; 2])> {
    counted(coupled, mass, &Arc::default())
}

fn counted(coupled: bool, mass: f64, tangents: &Arc<AtomicUsize>) -> Outcome<(Solid, [u32; 2])> {
    let bar = bar()?.traction("x+", Vec3::new(0.0, 0.0, 2.0))?;
    let ends = [bar.nodes_of("x+")?[0], bar.nodes_of("x-")?[0] + 1];
    Ok((bar.contribution(Link { nodes: ends, coupled, mass, tangents: tangents.clone() })?, ends))
}

fn message<T: std::fmt::Debug>(found: Result<T, StateError>, nodes: [u32; 2]) {
    let Err(StateError::Problem(error)) = found else { panic!("{found:?}") };
    let FemError::NotCoupled { contribution, lacking: NotCoupled { a, b } } = &error else { panic!("{error}") };
    assert_eq!(
        (contribution.as_str(), a.min(b), a.max(b)),
        ("link", nodes.iter().min().unwrap(), nodes.iter().max().unwrap())
    );
    let text = error.to_string();
    assert!(text.contains("\"link\"") && text.contains("couplings") && text.contains("add_beyond"), "{text}");
}

#[test]
fn a_missing_coupling_ends_solves_and_adjoints() -> Outcome {
    let (solid, _) = linked(true, 0.0)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    check_contribution(solid.model(), "link", 1)?;
    let (broken, nodes) = linked(false, 0.0)?;
    let controls: Controls = broken.controls();
    for solver in [None, Some(Solver::MULTIGRID)] {
        let how = SolveOptions { solver, ..STRICT };
        message(broken.solve(&controls, &how), nodes);
        message(broken.adjoint(&state, &[&state.u], &how).map(|found| found.lambda), nodes);
        message(broken.negative_pivots_by(&state, &how), nodes);
    }
    message(broken.modes(&state, 1, &STRICT), nodes);
    assert!(check_contribution(broken.model(), "link", 1).is_err());
    // no step is cut for it: the first tangent ends the way
    let tangents = Arc::default();
    let (broken, nodes) = counted(false, 0.0, &tangents)?;
    message(broken.solve(&controls, &STRICT), nodes);
    assert_eq!(tangents.load(Ordering::Relaxed), 1);
    Ok(())
}

#[test]
fn a_missing_coupling_ends_motions_and_constrained_solves() -> Outcome {
    let (broken, nodes) = linked(false, 0.0)?;
    let heavy = broken.clone().inertia(nastic_fem::Inertia::new("body", 1.0))?;
    let controls = heavy.controls();
    let steps = [StepTo { dt: 0.1, controls }];
    let (mut motion, mut workspace) = (Trajectory::from_given(heavy.rest()), Workspace::default());
    let scheme = Scheme::backward_euler();
    message(heavy.model().advance(&mut motion, &scheme, &steps, &STRICT, &mut workspace).map(|_| ()), nodes);
    let (mass, nodes) = linked(false, 0.5)?;
    let Err(FemError::NotCoupled { contribution, .. }) = mass.model().energies().mass() else {
        panic!("its mass is dropped")
    };
    assert_eq!(contribution, "link");
    let cable = Tendon::through("cable", [[0.3, 0.1, 0.1], [0.45, 0.2, 0.2]]).inextensible();
    let held = broken.tendon(cable)?;
    message(held.solve(&held.controls(), &STRICT), nodes);
    Ok(())
}
