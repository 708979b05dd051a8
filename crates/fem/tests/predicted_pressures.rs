//! Newton's method with pressures that every step predicts: nearly incompressible bodies take about as many iterations as others, with any linear solver.
//!
//! The table of docs/development/large-bodies.md:
//! `cargo test --release -p nastic-fem --test all predicted_pressures -- --ignored --nocapture`

#![allow(clippy::print_stdout)] // what solves take is worth reading

use crate::common;

use common::block::STRICT;
use common::{Outcome, bending, distance, largest, regular};
use nastic_energy::{FiberTension, KinematicGrowth, NeoHooke, NeoHookeIsochoric, Scale, Weighted};
use nastic_fem::{
    Formulation, Inertia, Scheme, Solid, SolveOptions, SolveReport, Solver, State, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_linear::SolverFactory;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

const KINDS: [CellKind; 4] = [CellKind::Hex8, CellKind::Tet4, CellKind::Hex27, CellKind::Tet10];
/// Bulk modulus: 10,000 times the shear modulus.
const HARD: f64 = 0.49995;

/// The formulation of a kind of cells for nearly incompressible bodies.
fn formulation(kind: CellKind) -> Formulation {
    Formulation::nearly_incompressible(kind).unwrap_or_default()
}

/// The fibre cantilever with as many nodes as `n` first-order cells over its thickness give, which its tension bends to 0.14 of its length.
fn cantilever(kind: CellKind, n: usize, poisson: f64) -> Outcome<Solid> {
    let n = if kind.order() == 2 { n / 2 } else { n };
    Ok(Solid::new(regular(kind, [1.0, 0.2, 0.2], [5 * n, n, n])?)?
        .material("body", NeoHooke::from_young_poisson(3e5, poisson)?)?
        .formulation("body", formulation(kind))?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

fn solve(solid: &Solid, solver: Option<&'static dyn SolverFactory>) -> Outcome<State> {
    Ok(solid.solve(&bending(-2e4, solid), &SolveOptions { solver, ..SolveOptions::default() })?)
}

/// Newton iterations and cycles of the cantilever at the smallest size at which all cells have some: at most three more and, of cells that satisfy the inf-sup
/// condition, twice the cycles.
#[test]
fn iterations_are_about_those_of_compressible_bodies() -> Outcome {
    for kind in KINDS {
        for solver in [Solver::DIRECT, Solver::MULTIGRID] {
            let of = |poisson: f64| -> Outcome<SolveReport> {
                Ok(solve(&cantilever(kind, 4, poisson)?, Some(solver))?.report)
            };
            let soft = of(0.3)?;
            for poisson in [0.49, 0.4994, HARD] {
                let hard = of(poisson)?;
                let (name, counts) = (solver.name(), [hard.newton, hard.factorisations, hard.cycles]);
                println!("{kind}, {poisson}, {name}: {counts:?} iterations, factors, cycles; {} at 0.3", soft.newton);
                let more = if solver == Solver::MULTIGRID { 3 } else { 2 };
                assert!(hard.newton <= soft.newton + more, "{kind}, {poisson}: {hard:?}");
                assert!(hard.factorisations <= soft.factorisations + 3, "{kind}, {poisson}: {hard:?}");
                assert!(hard.cycles <= if kind == CellKind::Hex8 { 4 } else { 2 } * soft.cycles, "{kind}: {hard:?}");
                assert_eq!((hard.shifted, hard.unpredicted, hard.load_steps), (0, 0, 1), "{kind}, {poisson}: {hard:?}");
            }
        }
    }
    Ok(())
}

/// A bar that a load across its end bends to most of its length, in cells of every formulation.
fn bar(kind: CellKind, formulation: Formulation, ratio: f64, load: f64) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [10.0, 2.0, 1.0], [12, 3, 2])?)?
        .material("body", NeoHookeIsochoric::new(1.0, ratio)?)?
        .formulation("body", formulation)?
        .clamp("x-")?
        .traction("x+", if kind.dim() == 2 { Vec3::y() } else { Vec3::z() } * load)?)
}

#[test]
fn bodies_that_turn_far_take_few_iterations() -> Outcome {
    let projected = [CellKind::Hex8, CellKind::Tet4, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10];
    let projected = projected.into_iter().map(|kind| (kind, formulation(kind)));
    let standard = [CellKind::Hex20, CellKind::Hex27, CellKind::Tet10].map(|kind| (kind, Formulation::Standard));
    for (kind, formulation) in projected.chain(standard) {
        for (ratio, most) in [(1e3, 14), (1e4, 18)] {
            let solid = bar(kind, formulation, ratio, 0.02)?;
            let state = solid.solve(&solid.controls(), &SolveOptions::default())?;
            let report = state.report;
            println!("{kind}, {formulation}, {ratio:e}: {} and {} factors", report.newton, report.factorisations);
            assert!(report.newton <= most && report.factorisations <= 2 * most, "{kind}, {formulation}: {report:?}");
            assert_eq!((report.unpredicted, report.load_steps), (0, 1), "{kind}, {formulation}: {report:?}");
            assert_eq!(solid.negative_pivots(&state)?, 0, "{kind}, {formulation}");
        }
    }
    Ok(())
}

/// In ten load steps from rest, by another linear solver.
#[test]
fn states_are_those_of_short_load_steps() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Quad9, CellKind::Tri6] {
        let (found, mut near) = (bar(kind, formulation(kind), 1e4, 0.02)?, None::<State>);
        let found = found.solve(&found.controls(), &STRICT)?;
        for step in 1..=10 {
            let solid = bar(kind, formulation(kind), 1e4, 0.002 * f64::from(step))?;
            let options =
                SolveOptions { near: near.as_ref(), solver: Some(Solver::MULTIGRID), ..SolveOptions::default() };
            near = Some(solid.solve(&solid.controls(), &options)?);
        }
        let near = near.ok_or("no state")?;
        let apart = distance(&found.u, &near.u) / largest(&found.u);
        assert!(apart < 1e-8, "{kind}: {apart:e}");
    }
    Ok(())
}

#[test]
fn one_thread_and_three_give_the_same_bits() -> Outcome {
    let solid = cantilever(CellKind::Tet4, 6, HARD)?;
    let on = |threads: usize| -> Outcome<State> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        Ok(pool.install(|| solve(&solid, None).map_err(|error| error.to_string()))?)
    };
    let (one, three) = (on(1)?, on(3)?);
    assert_eq!(one.report, three.report);
    assert_eq!(one.u, three.u);
    Ok(())
}

/// Four-node tetrahedra of the displacement formulation lock, and wrinkle as they bend: predicted pressures lead nowhere, which is counted, and steps by the displacement arrive.
#[test]
fn where_they_lead_nowhere_the_displacement_alone_does_it() -> Outcome {
    let solid = bar(CellKind::Tet4, Formulation::Standard, 1e3, 0.2)?;
    let (how, mut workspace) = (SolveOptions::default(), Workspace::default());
    let state = solid.solve_with(&solid.controls(), &how, &mut workspace)?;
    assert!(state.report.unpredicted > 0 && state.report.residual < 1e-9, "{:?}", state.report);
    assert_eq!(solid.negative_pivots(&state)?, 0);
    // after two failures in a row no more attempts are made
    let again = solid.solve_with(&solid.controls(), &how, &mut workspace)?.report;
    let last = solid.solve_with(&solid.controls(), &how, &mut workspace)?.report;
    assert!(state.report.unpredicted + again.unpredicted == 2 && last.unpredicted == 0, "{again:?} {last:?}");
    Ok(())
}

/// A load that comes at once bends a bar with mass, in steps of a quarter of its slowest swing's order.
#[test]
fn time_steps_take_few_iterations() -> Outcome {
    let solid = bar(CellKind::Hex8, formulation(CellKind::Hex8), 1e4, 0.005)?.inertia(Inertia::new("body", 1.0));
    let solid = solid?;
    let begin = State { velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() };
    let mut trajectory = Trajectory::from_given(begin);
    let steps: Vec<StepTo> = (0..5).map(|_| StepTo { dt: 10.0, controls: solid.controls() }).collect();
    let how = SolveOptions::default();
    solid.model().advance(&mut trajectory, &Scheme::backward_euler(), &steps, &how, &mut Workspace::default())?;
    for state in &trajectory.states()[1..] {
        println!("{} Newton iterations, {} factors", state.report.newton, state.report.factorisations);
        assert!(state.report.newton <= 7 && state.report.unpredicted == 0, "{:?}", state.report);
    }
    Ok(())
}

/// A bar behind a density of one tenth, and one whose moduli are a tenth: the same energy, so the same steps.
#[test]
fn densities_change_no_number_of_iterations() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Hex27] {
        for solver in [Solver::DIRECT, Solver::MULTIGRID] {
            let mesh = || regular(kind, [10.0, 2.0, 1.0], [12, 3, 2]);
            let loaded = |solid: Solid| -> Outcome<Solid> {
                Ok(solid.formulation("body", formulation(kind))?.clamp("x-")?.traction("x+", Vec3::z() * 0.002)?)
            };
            let law = Arc::new(NeoHookeIsochoric::new(1.0, 1e3)?);
            let behind = Weighted::scaled("rho", law, Scale::Factor)?;
            let behind = loaded(Solid::new(mesh()?)?.actuate("body", "stiff", behind)?)?;
            let plain = loaded(Solid::new(mesh()?)?.material("body", NeoHookeIsochoric::new(0.1, 100.0)?)?)?;
            let mut tenth = behind.controls();
            tenth.values_mut(0).fill(0.1);
            let how = SolveOptions { solver: Some(solver), ..SolveOptions::default() };
            let [of, by] = [(&behind, &tenth), (&plain, &plain.controls())].map(|(solid, m)| solid.solve(m, &how));
            let (of, by) = (of?, by?);
            println!("{kind}, {}: {:?}, {:?}", solver.name(), of.report, by.report);
            // rounding may end one of them an iteration earlier
            assert!(of.report.newton.abs_diff(by.report.newton) <= 1, "{kind}, {}", solver.name());
            assert_eq!([of.report.unpredicted, by.report.unpredicted], [0, 0], "{kind}, {}", solver.name());
            assert!(distance(&of.u, &by.u) < 1e-8 * largest(&by.u), "{kind}, {}", solver.name());
        }
    }
    Ok(())
}

/// A clamped bar that swells by a tenth of its volume and bends: pressures are those of the grown laws.
#[test]
fn a_body_that_swells_takes_few_iterations() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Hex27] {
        for solver in [Solver::DIRECT, Solver::MULTIGRID] {
            let solid = bar(kind, formulation(kind), 1e3, 0.005)?;
            let solid = solid.actuate("body", "growth", KinematicGrowth::isotropic())?;
            let mut swollen = solid.controls();
            swollen.values_mut(0).fill(0.03);
            let how = SolveOptions { solver: Some(solver), ..SolveOptions::default() };
            let report = solid.solve(&swollen, &how)?.report;
            println!("{kind}, {}: {report:?}", solver.name());
            assert!(report.newton <= 12 && report.unpredicted == 0, "{kind}, {}: {report:?}", solver.name());
        }
    }
    Ok(())
}

#[test]
#[ignore = "prints the table"]
fn table() -> Outcome {
    for n in [8, 18] {
        for kind in KINDS {
            for poisson in [0.3, 0.49, 0.4994, HARD] {
                let solid = cantilever(kind, n, poisson)?;
                for solver in [Solver::DIRECT, Solver::MULTIGRID] {
                    let SolveReport { newton, shifted, factorisations, cycles, .. } =
                        solve(&solid, Some(solver))?.report;
                    println!(
                        "{kind}, {} unknowns, {poisson}, {}: {newton} iterations, {shifted} shifted, {factorisations} factors, {cycles} cycles",
                        solid.model().unknowns().len(),
                        solver.name()
                    );
                }
            }
        }
    }
    Ok(())
}

/// Where no force is left the residual has nothing to be measured by but those of the way.
#[test]
fn a_body_that_is_unloaded_comes_back_to_rest() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet4] {
        for solver in [Solver::DIRECT, Solver::MULTIGRID] {
            let [loaded, free] = [0.02, 0.0].map(|load| bar(kind, formulation(kind), 1e4, load));
            let (loaded, free) = (loaded?, free?);
            let how = SolveOptions { solver: Some(solver), ..SolveOptions::default() };
            let bent = loaded.solve(&loaded.controls(), &how)?;
            let rest = free.solve(&free.controls(), &SolveOptions { near: Some(&bent), ..how })?;
            let report = rest.report;
            println!("{kind}, {}: {report:?}, {:.1e}", solver.name(), largest(&rest.u));
            assert!(largest(&rest.u) < 1e-8 * largest(&bent.u), "{kind}: {:e}", largest(&rest.u));
            assert_eq!((report.unpredicted, report.load_steps), (0, 1), "{kind}, {}: {report:?}", solver.name());
        }
    }
    Ok(())
}

/// Steps that move supports are taken whole: their volumes follow them.
#[test]
fn supports_that_move_take_the_volumes_along() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let solid = Solid::new(regular(kind, [10.0, 2.0, 1.0], [6, 2, 2])?)?
            .material("body", NeoHookeIsochoric::new(1.0, 50.0)?)?
            .formulation("body", formulation(kind))?
            .clamp("x-")?
            .displace("x+", [Some(0.02), Some(0.0), Some(0.3)])?;
        let of =
            |solver| solid.solve(&solid.controls(), &SolveOptions { solver: Some(solver), ..SolveOptions::default() });
        let (direct, multigrid) = (of(Solver::DIRECT)?, of(Solver::MULTIGRID)?);
        let apart = distance(&direct.u, &multigrid.u) / largest(&direct.u);
        println!("{kind}: {:?}, {:?}, {apart:.1e}", direct.report, multigrid.report);
        assert!(apart < 1e-8, "{kind}: {apart:e}");
        assert_eq!(multigrid.report.unpredicted, direct.report.unpredicted, "{kind}");
    }
    Ok(())
}
