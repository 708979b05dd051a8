//! The structure of tangents: how often it is put in order and analysed; and solvers of one's own for them.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Controls, Foundation, Solid, SolveOptions, Solver, SolverFactory, Spring, StateError, StructureCounts, Tendon,
    Workspace,
};
use nastic_linear::solver::{Accuracy, Definite, Solution, SolverState, Step, System};
use nastic_linear::{LinearError, LinearSolver, LinearWork, Structure, Symmetry};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// A bar with five contributions beside its energy, four of which couple nodes that share no cell.
fn bar() -> Outcome<(Solid, Controls)> {
    let along = |y: f64| [[0.3, y, 0.1], [1.0, y, 0.2], [1.7, y, 0.1]];
    let solid = Solid::new(regular(CellKind::Hex8, [2.0, 0.4, 0.4], [8, 2, 2])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .clamp("x-")?
        .foundation(Foundation::on("z-", 10.0))?
        .tendon(Tendon::through("first", along(0.1)).stiffness(50.0))?
        .tendon(Tendon::through("second", along(0.3)))?
        .spring(Spring::between("spring", [0.2, 0.2, 0.2], [1.9, 0.2, 0.3], 40.0).rest_length(1.6))?
        .spring(Spring::between("other", [0.4, 0.0, 0.4], [1.6, 0.4, 0.0], 40.0))?
        .traction("x+", Vec3::new(0.0, 0.0, 2.0))?;
    let mut controls = solid.controls();
    (0..controls.len()).for_each(|k| controls.values_mut(k).fill(0.01));
    Ok((solid, controls))
}

/// One order and one analysis, however many contributions, solves and solids there are; no analysis where multigrid solves.
#[test]
fn a_body_is_analysed_once_and_only_for_a_factor() -> Outcome {
    let counts = |orderings, analyses| StructureCounts { orderings, analyses };
    let (solid, controls) = bar()?;
    let of = |solid: &Solid| solid.discretization().structure_counts();
    assert_eq!(of(&solid), counts(0, 0), "nothing was asked for");
    let how = SolveOptions { solver: Some(Solver::MULTIGRID), accuracy: 1e-10, ..SolveOptions::default() };
    let by_multigrid = solid.solve(&controls, &how)?;
    assert_eq!((by_multigrid.report.solver, of(&solid)), ("multigrid", counts(1, 0)));
    let state = solid.solve(&controls, &STRICT)?;
    assert_eq!((state.report.solver, of(&solid)), ("direct", counts(1, 1)));
    assert!(common::distance(&state.u, &by_multigrid.u) < 1e-7 * largest(&state.u));
    solid.adjoint(&state, &[&state.u], &STRICT)?;
    assert_eq!(solid.negative_pivots(&state)?, 0);
    solid.modes(&state, 2, &STRICT)?;
    let softer = solid.clone().traction("x+", Vec3::new(0.0, 0.0, -1.0))?;
    softer.solve_with(&controls, &STRICT, &mut Workspace::default())?;
    assert_eq!(of(&solid), counts(1, 1));
    // what couples no more nodes needs no other structure, what does gets one
    let same = solid.clone().foundation(Foundation::on("z+", 1.0))?;
    assert!(Arc::ptr_eq(same.model().tangent_structure(), solid.model().tangent_structure()));
    let wider = solid.clone().spring(Spring::between("third", [0.1, 0.4, 0.4], [2.0, 0.0, 0.0], 4.0))?;
    wider.solve(&controls, &STRICT)?;
    assert_eq!(of(&solid), counts(2, 2));
    Ok(())
}

/// The solver of another crate: a direct one that does not say what it knows of eigenvalues.
#[derive(Debug)]
struct Silent;

#[derive(Clone, Debug)]
struct SilentSolver(Box<dyn LinearSolver>);

impl SolverFactory for Silent {
    fn name(&self) -> &'static str {
        "silent"
    }

    fn about(&self) -> &'static str {
        "a direct solver that counts nothing"
    }

    fn takes(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn make(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(SilentSolver(Solver::DIRECT.make(structure)))
    }
}

impl LinearSolver for SilentSolver {
    fn state(&self) -> SolverState {
        SolverState { name: "silent", takes_products: false, ..self.0.state() }
    }

    fn restart(&mut self) {
        self.0.restart();
    }

    fn clear(&mut self) {
        self.0.clear();
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        self.0.prepare(system, work)
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        self.0.step(system, b, tolerance, work)
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        Ok(Solution { negative: None, ..self.0.solve(system, b, accuracy, work)? })
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.0.solve_definite(system, b, which, work)
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(SilentSolver(self.0.anew(structure)))
    }
}

/// It solves; the number of negative eigenvalues is refused, and never reported as 0.
#[test]
fn a_solver_of_ones_own_solves_and_need_not_count() -> Outcome {
    let (solid, controls) = bar()?;
    let how = SolveOptions { solver: Some(&Silent), ..STRICT };
    let (own, direct) = (solid.solve(&controls, &how)?, solid.solve(&controls, &STRICT)?);
    assert_eq!((own.report.solver, &own.u), ("silent", &direct.u));
    let refused = |counted: Result<usize, StateError>| match counted {
        Err(StateError::Linear(why @ LinearError::NotCounted { solver: "silent" })) => why.to_string(),
        other => panic!("{other:?}"),
    };
    assert!(refused(solid.negative_pivots_by(&own, &how)).contains("\"silent\""));
    // with a constraint, whose step is decided by that number
    let held =
        solid.tendon(Tendon::through("cable", [[0.3, 0.2, 0.3], [1.0, 0.2, 0.3], [1.7, 0.2, 0.3]]).inextensible())?;
    let mut controls = held.controls();
    (0..controls.len()).for_each(|k| controls.values_mut(k).fill(0.01));
    let state = held.solve(&controls, &STRICT)?;
    refused(held.negative_pivots_by(&state, &how));
    assert!(held.adjoint(&state, &[&state.u], &how).is_ok(), "an adjoint needs no count");
    refused(held.solve(&controls, &how).map(|_| 0));
    Ok(())
}
