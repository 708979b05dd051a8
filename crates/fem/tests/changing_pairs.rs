//! A contribution whose pairs of nodes change with the displacement: blocks beyond the pattern of the tangent.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{
    Contribution, ContributionPoint, Controls, Demand, Inadmissible, Increment, Inertia, Instant, Need, Scheme,
    SecondDerivativeError, SecondSensitivities, Solid, SolveOptions, Solver, StatePartials, StepTo, StructureCounts,
    Sums, TimeStepping, Trajectory, Workspace, check_contribution,
};
use nastic_linear::SparseMatrix;
use nastic_mesh::CellKind;
use nastic_tensor::{Mat3, Vec3};

/// Nodes that repel each other: `sum_(a < b) strength / 12 <reach^2 - |x_a - x_b|^2>^6` over their current positions.
#[derive(Debug, Clone)]
struct Repulsion {
    nodes: Vec<(u32, Vec3)>,
    reach: f64,
    strength: f64,
}

impl Repulsion {
    /// Pairs no further apart than so many times the reach, with the vector from the second to the first.
    fn pairs(&self, u: &[f64], times: f64) -> impl Iterator<Item = ([u32; 2], Vec3)> {
        let at = |(node, x): &(u32, Vec3)| x + Vec3::from_column_slice(&u[3 * *node as usize..][..3]);
        let apart = move |a: &(u32, Vec3), b: &(u32, Vec3)| ([a.0, b.0], at(a) - at(b));
        let all = self.nodes.iter().enumerate();
        let all = all.flat_map(move |(k, a)| self.nodes[k + 1..].iter().map(move |b| apart(a, b)));
        all.filter(move |(_, d)| d.norm() < times * self.reach)
    }

    fn depth(&self, d: &Vec3) -> f64 {
        (self.reach * self.reach - d.norm_squared()).max(0.0)
    }

    /// The second derivative by d.
    fn hessian(&self, d: &Vec3) -> Mat3 {
        let depth = self.depth(d);
        self.strength * depth.powi(4) * (10.0 * d * d.transpose() - depth * Mat3::identity())
    }
}

impl Contribution for Repulsion {
    fn name(&self) -> &str {
        "repulsion"
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for Repulsion {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        for ([a, b], d) in self.pairs(at.u, 1.0) {
            let energy = self.strength / 12.0 * self.depth(&d).powi(6);
            sums.energy += energy;
            sums.energy_scale += energy;
            let force = -self.strength * self.depth(&d).powi(5) * d;
            for i in (0..3).filter(|_| demand.force) {
                for (node, sign) in [(a, 1.0), (b, -1.0)] {
                    sums.force[3 * node as usize + i] += sign * force[i];
                    sums.force_scale[3 * node as usize + i] += force[i].abs();
                }
            }
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        // also pairs that are near, whose block is zero: one structure then serves while they move a little
        for (pair, d) in self.pairs(at.u, 1.3) {
            let hessian = self.hessian(&d);
            let sign = |at: usize| if at / 18 == at % 6 / 3 { 1.0 } else { -1.0 };
            tangent.add_beyond(&pair, (0..36).map(|at| sign(at) * hessian[(at / 6 % 3, at % 3)]).collect());
        }
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        for ([a, b], d) in self.pairs(at.u, 1.0) {
            let of = |v: &[f64]| {
                let at = |node: u32| Vec3::from_column_slice(&v[3 * node as usize..][..3]);
                at(a) - at(b)
            };
            let (l, v) = (of(lambda), of(along.u));
            let sum = v * d.dot(&l) + d * v.dot(&l) + l * d.dot(&v);
            let depth = self.depth(&d);
            let change = 10.0 * self.strength * depth.powi(3) * (depth * sum - 8.0 * d.dot(&v) * d.dot(&l) * d);
            for i in 0..3 {
                into.u[3 * a as usize + i] += change[i];
                into.u[3 * b as usize + i] -= change[i];
            }
        }
        Ok(())
    }
}

/// A bar that a fibre shortens, nodes of one side of which repel each other: the shorter it is, the more of them do.
fn bar() -> Outcome<(Solid, Controls, Repulsion)> {
    let solid = Solid::new(regular(CellKind::Hex8, [2.0, 0.4, 0.4], [8, 2, 2])?)?
        .material("body", NeoHooke::new(1e3, 2e3)?)?
        .clamp("x-")?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .inertia(Inertia::new("body", 2.0))?
        .traction("x+", Vec3::new(0.0, 0.0, 4.0))?;
    let points = solid.mesh().points();
    let nodes = solid.nodes_of("z+")?.into_iter().map(|node| (node, Vec3::from(points[node as usize])));
    let repulsion = Repulsion { nodes: nodes.collect(), reach: 0.54, strength: 1e4 };
    let mut controls = solid.controls();
    controls.values_mut(0).fill(400.0);
    Ok((solid.contribution(repulsion.clone())?, controls, repulsion))
}

#[test]
fn pairs_that_change_are_solved_with_by_every_solver() -> Outcome {
    let (solid, controls, repulsion) = bar()?;
    (0..3).try_for_each(|seed| check_contribution(solid.model(), "repulsion", seed))?;
    let exact = solid.solve(&controls, &STRICT)?;
    let [rest, there] = [&solid.rest().u, &exact.u].map(|u| repulsion.pairs(u, 1.0).count());
    assert!(there + 20 < rest, "pairs {rest} -> {there}");
    // the whole tangent is in the steps: some dozen iterations without it
    assert!(exact.report.newton <= 12, "{}", exact.report.newton);
    let found = solid.discretization().structure_counts();
    assert_eq!(found.orderings, 1);
    assert!(found.analyses <= 3, "{} analyses in {} iterations", found.analyses, exact.report.newton);
    for solver in Solver::CATALOGUE {
        let how = SolveOptions { solver: Some(solver), accuracy: 1e-11, ..STRICT };
        let state = solid.solve(&controls, &how)?;
        assert_eq!(state.report.solver, solver.name());
        assert!(common::distance(&state.u, &exact.u) < 1e-8 * largest(&exact.u), "{solver}");
    }
    let StructureCounts { orderings, .. } = solid.discretization().structure_counts();
    assert_eq!(orderings, 1, "the elimination order stays");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let again = alone.install(|| solid.solve(&controls, &STRICT).map_err(|e| e.to_string()))?;
    assert_eq!(again.u, exact.u, "the bits depend on the number of threads");
    Ok(())
}

/// Adjoint, second derivative, modes and the count of negative eigenvalues have the pairs of the state in them.
#[test]
fn pairs_that_change_are_in_derivatives_and_modes() -> Outcome {
    let (solid, controls, _) = bar()?;
    let state = solid.solve(&controls, &STRICT)?;
    let g: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let value = |tension: f64| -> Outcome<(f64, f64)> {
        let mut moved = controls.clone();
        moved.values_mut(0).fill(tension);
        let state = solid.solve(&moved, &SolveOptions { near: Some(&state), ..STRICT })?;
        let adjoint = solid.adjoint(&state, &[&g], &STRICT)?;
        let by = solid.model().vjp(&Instant::new(&state.u, &moved, 1.0), &adjoint.lambda[0])?;
        let by_controls: f64 = by.controls.values(0).iter().sum();
        Ok((g.iter().zip(state.u.iter()).map(|(g, u)| g * u).sum(), -by_controls))
    };
    let (h, found) = (0.2, value(400.0)?.1);
    let difference = |s: f64| -> Outcome<f64> { Ok(value(400.0 + s * h)?.0 - value(400.0 - s * h)?.0) };
    let expected = (45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * h);
    assert!((found - expected).abs() < 1e-6 * expected.abs(), "{found:e}, differences {expected:e}");
    assert_eq!(solid.negative_pivots(&state)?, 0);
    let modes = solid.modes(&state, 2, &STRICT)?;
    let shape = &modes.shapes[0];
    let mut image = vec![0.0; shape.len()];
    let mut tangent = solid.model().tangents().matrix();
    solid.model().tangents().add_tangent(&Instant::new(&state.u, &controls, 1.0), &mut tangent)?;
    assert!(!tangent.beyond().is_empty());
    tangent.multiply(shape, &mut image);
    let mass = solid.discretization().nodal_volumes();
    let free = |i: &usize| !solid.supports().fixed()[*i];
    let off = |i: usize| (image[i] - modes.eigenvalues[0] * mass[i / 3] * shape[i]).abs();
    let most = (0..shape.len()).filter(free).map(off).fold(0.0, f64::max);
    assert!(most < 1e-7 * largest(&image), "{most:e}");
    Ok(())
}

/// Steps in time and their reverse sweep.
#[test]
fn pairs_that_change_move() -> Outcome {
    let (solid, _, _) = bar()?;
    let g: Vec<f64> = (0..solid.rest().u.len()).map(noise).collect();
    let run = |tension: f64| -> Outcome<Trajectory> {
        let mut controls = solid.controls();
        controls.values_mut(0).fill(tension);
        let steps: Vec<_> = (0..4).map(|_| StepTo { dt: 0.02, controls: controls.clone() }).collect();
        let mut trajectory = Trajectory::from_given(solid.rest());
        let scheme = Scheme::backward_euler();
        solid.model().advance(&mut trajectory, &scheme, &steps, &STRICT, &mut Workspace::default())?;
        Ok(trajectory)
    };
    let end = |trajectory: &Trajectory| -> f64 {
        let u = &trajectory.states().last().unwrap().u;
        g.iter().zip(u.iter()).map(|(g, u)| g * u).sum()
    };
    let base = run(400.0)?;
    let mut partials = vec![StatePartials::default(); base.states().len()];
    partials.last_mut().unwrap().u = g.clone();
    let swept = solid.model().reverse_sweep(&base, &partials, &STRICT, &mut Workspace::default())?;
    let found: f64 = swept.controls.iter().map(|controls| controls.values(0).iter().sum::<f64>()).sum();
    let h = 0.2;
    let difference = |s: f64| -> Outcome<f64> { Ok(end(&run(400.0 + s * h)?) - end(&run(400.0 - s * h)?)) };
    let expected = (45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * h);
    assert!((found - expected).abs() < 1e-6 * expected.abs(), "{found:e}, differences {expected:e}");
    Ok(())
}
