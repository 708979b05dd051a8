//! A bar hinged along one edge, let go where it is horizontal: every step of every scheme converges, and what energy
//! is lost.

use crate::common;

use common::motion::{schemes, steps};
use common::{Outcome, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Demand, Inertia, Instant, Solid, SolveOptions, State, TimeStepping, Trajectory, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::f64::consts::TAU;

const RHO: f64 = 1000.0;
const G: f64 = 9.81;
const THICK: f64 = 0.1;

fn bar() -> Outcome<Solid> {
    let solid = Solid::new(regular(CellKind::Hex20, [1.0, THICK, THICK], [5, 1, 1])?)?
        .material("body", NeoHooke::from_young_poisson(1e6, 0.3)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -RHO * G))?;
    let edge = |x: &[f64; 3]| x[0] < 1e-9 && x[2] < 1e-9;
    let points = solid.mesh().points();
    let hinge: Vec<u32> = (0..).zip(points).filter(|(_, x)| edge(x)).map(|(node, _)| node).collect();
    Ok(solid.displace_nodes("hinge", &hinge, |_, _| [Some(0.0); 3])?.inertia(Inertia::new("body", RHO))?)
}

/// Strain energy, less the work of gravity, and kinetic energy (J).
fn energy(solid: &Solid, state: &State) -> Outcome<f64> {
    let at = Instant::new(&state.u, &state.controls, 1.0);
    let potential = solid.model().evaluate(&at, Demand { energy: true, force: false })?.energy;
    let (mass, Some(v)) = (solid.model().energies().mass()?, &state.velocity) else { return Ok(potential) };
    let mut p = vec![0.0; v.len()];
    mass.multiply(v, &mut p);
    Ok(potential + 0.5 * v.iter().zip(&p).map(|(v, p)| v * p).sum::<f64>())
}

#[test]
fn a_hinged_bar_swings_from_the_horizontal() -> Outcome {
    let solid = bar()?;
    // a rigid rod hinged at its end, small swings: w^2 = 3 g / (2 L)
    let period = TAU / (1.5 * G).sqrt();
    // from there to its lowest place, the centre half a thickness above the hinge at first
    let available = RHO * THICK * THICK * G * (0.5 * THICK + 0.5f64.hypot(0.5 * THICK));
    let mut losses = Vec::new();
    for (scheme, _) in schemes()?.iter().filter(|(_, order)| *order > 0) {
        let mut run = Trajectory::from_given(solid.rest());
        let how = SolveOptions::default();
        let steps = steps(100, period / 50.0, |_| solid.controls());
        solid.model().advance(&mut run, scheme, &steps, &how, &mut Workspace::default())?;
        let states = &run.states()[1..];
        assert_eq!(states.len(), 100);
        let min_j = states.iter().map(|s| s.report.min_j).fold(f64::INFINITY, f64::min);
        let [newton, cuts, restarts] =
            states.iter().fold([0; 3], |[n, c, r], s| [n + s.report.newton, c + s.report.cuts, r + s.report.restarts]);
        let lowest = states.iter().map(|s| s.u.iter().copied().fold(0.0, f64::min)).fold(0.0, f64::min);
        let loss = (energy(&solid, &run.states()[0])? - energy(&solid, run.end())?) / available;
        println!(
            "{:<24} min J {min_j:.3}, {newton} Newton iterations, {cuts} cuts, {restarts} restarts, energy lost {:.3} %",
            scheme.name(),
            100.0 * loss
        );
        assert!(min_j > 0.9 && restarts == 0, "{}", scheme.name());
        // 409 and 983 where every stage begins at the one before instead of where its acceleration leads
        let most = [("backward_euler", 380), ("tr_bdf2", 800)].into_iter().find(|(name, _)| *name == scheme.name());
        assert!(most.is_none_or(|(_, most)| newton < most), "{}: {newton} Newton iterations", scheme.name());
        // the far end, 1 m from the hinge, passed the lowest place, and the bar swung to the other side
        assert!(lowest < -0.95 && largest(&run.end().u) < 2.3, "{}: {lowest}", scheme.name());
        losses.push((scheme.name(), loss));
    }
    let of = |name: &str| losses.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, loss)| *loss);
    assert!(of("backward_euler") > 0.85 && of("linearly_implicit_euler") > 0.85, "{losses:?}");
    assert!(of("newmark") < 0.5 * of("backward_euler"), "{losses:?}");
    assert!(of("bdf2") < 0.5 * of("newmark") && of("tr_bdf2") < 0.2 * of("bdf2") && of("tr_bdf2") > 0.0, "{losses:?}");
    assert!(of("trapezoidal").abs() < 0.01 && of("generalized_alpha").abs() < 0.01, "{losses:?}");
    // no damping, and at this step the axial vibrations of a bar that turns are not resolved: it gains
    assert!(of("implicit_midpoint").abs() < 0.15, "{losses:?}");
    Ok(())
}
