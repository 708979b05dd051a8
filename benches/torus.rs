//! The soft torus of Drake's deformable example: drops on a floor, and grips between moving fingers, as lines of JSON.
//!
//! `cargo bench --bench torus -- mesh=torus.vtk what=reference|drop|grip threads=1`: the mesh is Drake's, legacy VTK, scaled by 0.65;
//! `reference` is the gripped torus of 24 steps with its gradient, against another program's numbers (docs/development/verification.md).
//! `drop`: modulus=5000 height=0.28 step=1e-2 mu=1.15 until=0.6, out=FILE for the positions at the end. `grip`: modulus=5000 closed=0.4
//! finger=capsule|box step=1e-2 until=5.5. Both: thickness in m, refine (0 for the defaults),
//! accuracy=1e-11 and slip=1e-3 m/s.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::Arguments;
use nastic::energy::NeoHooke;
use nastic::fem::{
    Contact, Controls, Inertia, Instant, Scheme, Solid, SolveOptions, State, StatePartials, StepTo, TimeStepping,
};
use nastic::fem::{TimeStep, Trajectory, Workspace};
use nastic::mesh::spatial::Obstacle;
use nastic::mesh::{Mesh, RawMesh};
use nastic::tensor::Vec3;
use std::time::Instant as Clock;

type Failure = Box<dyn std::error::Error>;

const DENSITY: f64 = 800.0;
const GRAVITY: f64 = 9.81;
/// Length that the fingers' distances are measured in, m.
const KL: f64 = 0.0585;

fn main() -> Result<(), Failure> {
    let known = [
        "mesh",
        "what",
        "modulus",
        "height",
        "step",
        "closed",
        "finger",
        "until",
        "threads",
        "thickness",
        "slip",
        "mu",
        "out",
        "refine",
        "accuracy",
    ];
    let arguments = Arguments::read(&known)?;
    arguments.use_threads()?;
    let mesh = nastic::io::read_vtk(arguments.text("mesh", ""), 0.65)?;
    match arguments.text("what", "reference").as_str() {
        "reference" => reference(&mesh),
        "drop" => drop(&mesh, &arguments),
        "grip" => grip(&mesh, &arguments),
        other => Err(format!("what is reference, drop or grip, not {other:?}").into()),
    }
}

fn real(arguments: &Arguments, key: &str, default: f64) -> Result<f64, Failure> {
    Ok(arguments.text(key, &default.to_string()).parse()?)
}

/// With its lowest point at a height.
fn lifted(mesh: &Mesh, height: f64) -> Result<Mesh, Failure> {
    let lowest = mesh.points().iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
    let mut raw = RawMesh::new("torus");
    raw.name_group(3, 1, "body");
    raw.points = mesh.points().iter().map(|x| [x[0], x[1], x[2] - lowest + height]).collect();
    (0..mesh.cells()).for_each(|cell| raw.push(mesh.cell(cell).kind, mesh.cell(cell).nodes, &[1]));
    Ok(Mesh::build(raw)?)
}

/// The free body with weight, mass and the damping of 0.01 s.
fn torus(mesh: Mesh, modulus: f64) -> Result<Solid, Failure> {
    let nu = 0.4;
    let law = NeoHooke::new(0.5 * modulus / (1.0 + nu), modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)))?;
    let solid = Solid::new(mesh)?
        .material("body", law)?
        .body_force("body", Vec3::new(0.0, 0.0, -GRAVITY * DENSITY))?
        .inertia(Inertia::new("body", DENSITY))?
        .rayleigh_damping(0.0, 0.01)?;
    Ok(solid)
}

fn floor() -> Contact {
    Contact::of("floor", "skin", Obstacle::half_space([0.0; 3], [0.0, 0.0, 1.0]))
}

fn at_rest(solid: &Solid, controls: Controls) -> State {
    let still = vec![0.0; solid.rest().u.len()];
    State { velocity: Some(still.into()), controls: controls.into(), ..solid.rest() }
}

/// Mean displacement by mass, and its derivative.
fn centre(solid: &Solid) -> Result<Vec<f64>, Failure> {
    let mass = solid.model().energies().mass()?;
    let n = solid.rest().u.len();
    let ones: Vec<f64> = (0..n).map(|dof| f64::from(u8::from(dof % 3 == 2))).collect();
    let mut of = vec![0.0; n];
    mass.multiply(&ones, &mut of);
    let total: f64 = of.iter().sum();
    Ok(of.iter().map(|m| m / total).collect())
}

struct Run {
    trajectory: Trajectory,
    seconds: f64,
    newton: usize,
    cuts: usize,
    min_j: f64,
    gap: f64,
}

fn run(solid: &Solid, steps: &[StepTo], begin: Controls, how: &SolveOptions) -> Result<Run, Failure> {
    let mut trajectory = Trajectory::from_given(at_rest(solid, begin));
    let (mut workspace, clock) = (Workspace::default(), Clock::now());
    let done = solid.model().advance(&mut trajectory, &Scheme::backward_euler(), steps, how, &mut workspace);
    let seconds = clock.elapsed().as_secs_f64();
    if let Err(error) = done {
        println!("{{\"failed_at\": {:.4}, \"why\": {:?}}}", trajectory.end().time, error.to_string());
    }
    let mut found = Run { seconds, newton: 0, cuts: 0, min_j: 1.0, gap: f64::INFINITY, trajectory };
    for state in found.trajectory.states().iter().skip(1) {
        found.newton += state.report.newton;
        found.cuts += state.report.cuts;
        found.min_j = found.min_j.min(state.report.min_j);
        let all = solid.model().quantities(&Instant::of(state))?;
        let gaps = all.iter().filter(|(_, name, _)| *name == "smallest_gap").map(|(.., gap)| *gap);
        found.gap = gaps.fold(found.gap, f64::min);
    }
    Ok(found)
}

fn print(solid: &Solid, run: &Run, title: &str, further: &str) -> Result<(), Failure> {
    let count = run.trajectory.states().len() - 1;
    let mean = centre(solid)?;
    let rest: f64 = solid.mesh().points().iter().zip(mean.chunks_exact(3)).map(|(x, m)| x[2] * m[2]).sum();
    let height = |state: &State| rest + state.u.iter().zip(&mean).map(|(u, m)| u * m).sum::<f64>();
    let heights: Vec<f64> = run.trajectory.states().iter().map(height).collect();
    let (lowest, at) =
        heights.iter().zip(0..).fold((f64::INFINITY, 0), |(l, k), (h, n)| if *h < l { (*h, n) } else { (l, k) });
    let rebound = heights[at..].iter().copied().fold(0.0, f64::max);
    println!(
        "{{\"case\": \"{title}\", \"steps\": {count}, \"newton_per_step\": {:.2}, \"cuts\": {}, \"min_j\": {:.4}, \"smallest_gap_mm\": {:.3}, \
         \"ms_per_step\": {:.2}, \"centre_lowest_mm\": {:.2}, \"rebound_mm\": {:.2}, \"centre_end_mm\": {:.2}{further}}}",
        run.newton as f64 / count as f64,
        run.cuts,
        run.min_j,
        1e3 * run.gap,
        1e3 * run.seconds / count as f64,
        1e3 * lowest,
        1e3 * rebound,
        1e3 * heights[count],
    );
    Ok(())
}

fn drop(mesh: &Mesh, arguments: &Arguments) -> Result<(), Failure> {
    let (modulus, height, h): (f64, f64, f64) =
        (real(arguments, "modulus", 5000.0)?, real(arguments, "height", 0.28)?, real(arguments, "step", 1e-2)?);
    let tube = mesh.points().iter().map(|x| -x[2]).fold(0.0, f64::max);
    let (mu, slip) = (real(arguments, "mu", 1.15)?, real(arguments, "slip", 1e-3)?);
    let contact = layer(if mu > 0.0 { floor().friction(mu, slip) } else { floor() }, arguments)?;
    let solid = torus(lifted(mesh, height - tube)?, modulus)?.contact(contact)?;
    let until: f64 = real(arguments, "until", 0.6)?;
    let steps = vec![StepTo { dt: h, controls: solid.controls() }; (until / h).round() as usize];
    let found = run(&solid, &steps, solid.controls(), &accuracy(arguments)?)?;
    let out = arguments.text("out", "");
    if !out.is_empty() {
        let u = &found.trajectory.end().u;
        let place = |(n, x): (usize, &[f64; 3])| {
            format!("{} {} {}\n", x[0] + u[3 * n], x[1] + u[3 * n + 1], x[2] + u[3 * n + 2])
        };
        std::fs::write(out, solid.mesh().points().iter().enumerate().map(place).collect::<String>())?;
    }
    print(&solid, &found, &format!("drop, E {modulus}, from {height}, step {h}"), "")
}

fn layer(contact: Contact, arguments: &Arguments) -> Result<Contact, Failure> {
    let (thickness, refine) = (real(arguments, "thickness", 0.0)?, arguments.number("refine", 0)?);
    let contact = if thickness > 0.0 { contact.thickness(thickness) } else { contact };
    Ok(if refine > 0 { contact.refine(refine) } else { contact })
}

fn accuracy(arguments: &Arguments) -> Result<SolveOptions<'static>, Failure> {
    let default = SolveOptions::default();
    Ok(SolveOptions { accuracy: real(arguments, "accuracy", default.accuracy)?, ..default })
}

/// The schedule of the fingers: distance of the pads and lift.
fn schedule(t: f64, closed: f64) -> (f64, f64) {
    let ramp = |from: f64, to: f64| ((t - from) / (to - from)).clamp(0.0, 1.0);
    let open = 1.5 * KL;
    let w = open + (closed * KL - open) * (ramp(0.0, 1.5) - ramp(5.5, 7.0));
    (w, 0.18 * (ramp(1.5, 3.0) - ramp(5.5, 7.0)))
}

fn grip(mesh: &Mesh, arguments: &Arguments) -> Result<(), Failure> {
    let (modulus, h, closed, until): (f64, f64, f64, f64) = (
        real(arguments, "modulus", 5000.0)?,
        real(arguments, "step", 1e-2)?,
        real(arguments, "closed", 0.4)?,
        real(arguments, "until", 5.5)?,
    );
    let finger = arguments.text("finger", "capsule");
    let slip: f64 = real(arguments, "slip", 1e-3)?;
    let tube = 0.5 * KL;
    let pad = |side: f64| {
        let y = 0.06 + side * (0.0105 + 0.75 * KL);
        let z = 0.051;
        let shape = match finger.as_str() {
            "box" => {
                Obstacle::aligned_box([-0.014, y - 0.0035, z - 0.0405], [0.014, y + 0.0035, z + 0.0405]).rounded(0.002)
            }
            _ => Obstacle::capsule([0.0, y, z - 0.04], [0.0, y, z + 0.04], 0.01),
        };
        Contact::of(if side < 0.0 { "left" } else { "right" }, "skin", shape).friction(1.15, slip)
    };
    let lowest = mesh.points().iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
    let solid = torus(lifted(mesh, tube + lowest)?, modulus)?
        .contact(layer(floor().friction(1.15, slip), arguments)?)?
        .contact(layer(pad(-1.0), arguments)?)?
        .contact(layer(pad(1.0), arguments)?)?;
    let at = |t: f64| {
        let (w, lift) = schedule(t, closed);
        let mut controls = solid.controls();
        for (block, side) in [(1, -1.0), (2, 1.0)] {
            let values = controls.values_mut(block);
            (values[1], values[2]) = (side * 0.5 * (w - 1.5 * KL), lift);
        }
        controls
    };
    let steps: Vec<StepTo> =
        (1..=(until / h).round() as usize).map(|n| StepTo { dt: h, controls: at(n as f64 * h) }).collect();
    let found = run(&solid, &steps, at(0.0), &accuracy(arguments)?)?;
    // friction depends on the velocities of the last step
    let states = found.trajectory.states();
    let step = TimeStep::between(&states[states.len().saturating_sub(2)], found.trajectory.end());
    let all = solid.model().quantities(&Instant::of(found.trajectory.end()).in_step(&step))?;
    let force = |of: &str, name: &str| all.iter().find(|(c, n, _)| c == of && *n == name).map_or(0.0, |(.., f)| *f);
    let weight: f64 =
        solid.model().quantities(&Instant::of(&solid.rest()))?.iter().find(|q| q.1 == "mass").map_or(0.0, |q| q.2);
    let further = format!(
        ", \"pads_n\": [{:.3}, {:.3}], \"pads_lift_n\": {:.4}, \"weight_n\": {:.4}, \"on_floor_n\": {:.4}",
        force("left", "force_y"),
        force("right", "force_y"),
        force("left", "force_z") + force("right", "force_z"),
        weight * GRAVITY,
        force("floor", "force_z"),
    );
    print(&solid, &found, &format!("grip, {finger}, E {modulus}, closed to {closed}, step {h}"), &further)
}

/// j = 0.3 y + z of the centre after 24 steps, its derivatives by closing width, lift, friction and stiffness.
fn reference(mesh: &Mesh) -> Result<(), Failure> {
    const STEPS: usize = 24;
    let layer = |contact: Contact| contact.thickness(1e-3).stiffness(5e4).friction(1.15, 1e-2).refine(4);
    let capsule = |name: &str, y: f64| {
        layer(Contact::of(name, "skin", Obstacle::capsule([0.0, y, 0.005], [0.0, y, 0.085], 0.01)))
    };
    let (first, second) = (0.0495 - 0.5 * KL, 0.0705 + 0.5 * KL);
    let solid = torus(lifted(mesh, 5e-4)?, 5000.0)?
        .contact(layer(floor()))?
        .contact(capsule("left", first))?
        .contact(capsule("right", second))?;
    // closing width 0.036, lift 0.02
    let path = |n: usize, w: f64, lift: f64| {
        let t = n as f64 / STEPS as f64;
        let (a, b) = ((2.0 * t).min(1.0), (2.0 * t - 1.0).max(0.0));
        ((1.0 - a) * KL + a * w, b * lift)
    };
    let at = |n: usize| {
        let (w, z) = path(n, 0.036, 0.02);
        let mut controls = solid.controls();
        for (block, side) in [(1, -1.0), (2, 1.0)] {
            (controls.values_mut(block)[1], controls.values_mut(block)[2]) = (side * 0.5 * (w - KL), z);
        }
        controls
    };
    let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: 1e-2, controls: at(n) }).collect();
    let found = run(&solid, &steps, at(0), &SolveOptions::default())?;
    let mut q = centre(&solid)?;
    (0..q.len()).step_by(3).for_each(|dof| q[dof + 1] = 0.3 * q[dof + 2]);
    let j: f64 = found.trajectory.end().u.iter().zip(&q).map(|(u, q)| u * q).sum();
    let zero = vec![0.0; q.len()];
    let partials: Vec<StatePartials> = (0..=STEPS)
        .map(|n| StatePartials::by_displacement(if n == STEPS { q.clone() } else { zero.clone() }))
        .collect();
    let clock = Clock::now();
    let swept = solid.model().reverse_sweep(
        &found.trajectory,
        &partials,
        &SolveOptions::default(),
        &mut Workspace::default(),
    )?;
    let gradient = clock.elapsed().as_secs_f64();
    let (mut by_w, mut by_lift, mut by_mu, mut by_k) = (0.0, 0.0, 0.0, 0.0);
    for (n, by) in swept.controls.iter().enumerate() {
        let (w, z) = path(n, 1.0, 1.0);
        let (w, z) = (w - path(n, 0.0, 1.0).0, z);
        for (block, side) in [(0, 0.0), (1, -1.0), (2, 1.0)] {
            by_w += side * 0.5 * w * by.values(block)[1];
            by_lift += if block > 0 { z * by.values(block)[2] } else { 0.0 };
            by_k += by.values(block)[6];
            by_mu += by.values(block)[7];
        }
    }
    for (name, found, expected) in [
        ("j", j, 0.0026644867845467),
        ("by closing width", by_w, -2.3431438775e-02),
        ("by lift", by_lift, 2.6248286654e-01),
        ("by friction", by_mu, 1.3763009320e-04),
        ("by stiffness", by_k, 2.5095610236e-09),
    ] {
        println!(
            "{{\"of\": \"{name}\", \"found\": {found:.12e}, \"other\": {expected:.12e}, \"error\": {:.1e}}}",
            (found / expected - 1.0).abs()
        );
    }
    print(&solid, &found, "reference", &format!(", \"gradient_over_run\": {:.3}", gradient / found.seconds))
}
