//! Seeded random bodies pushed into random obstacles at the defaults: how many are solved, at what work, why the others fail.
//!
//! `cargo bench --bench contact_battery -- count=300 seed=1`: problem k of a seed is always the same; `only=K` solves one alone. Blocks in plane
//! strain and in space, seven elements, Poisson's ratio 0.1 to 0.45, held at the bottom; half-spaces (tilted), spheres, capsules, boxes and meshed
//! boxes (with a rounding radius) of a fifth of the block's size to twice that, which go into its top by up to 0.3 of its height, and
//! sideways by up to half of that: in one static solve, or with friction (0.1 to 1) in ten quasi-static steps. Prints every problem that failed, was
//! pressed through, took more than 300 Newton iterations, or has a node deeper inside the obstacle than its contact reports (by a tenth of the
//! layer's thickness; measured from where nodes are), and a summary.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, between, pick};
use nastic::fem::time::catalogue::SCHEMES;
use nastic::fem::{Contact, Controls, Instant as At, SolveOptions, State, StepTo, Trajectory, Workspace};
use nastic::mesh::spatial::Obstacle;
use nastic::numeric::Random;
use nastic::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// Newton iterations above which a solve is told.
const MANY: usize = 300;
/// Steps of a problem with friction.
const STEPS: usize = 10;

/// A problem and what it is, in words.
struct Problem {
    solid: Solid,
    /// At rest.
    obstacle: Obstacle,
    /// Where the obstacle goes.
    way: [f64; 3],
    friction: bool,
    about: String,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["count", "seed", "only", "threads"])?;
    arguments.use_threads()?;
    let (count, seed) = (arguments.number("count", 300)?, arguments.number("seed", 1)? as u64);
    let only = arguments.number("only", usize::MAX)?;
    let (mut solved, mut through, mut unreported, mut failed, mut panicked, mut newton) = (0, 0, 0, 0, 0, Vec::new());
    for index in (0..count).filter(|index| only == usize::MAX || *index == only) {
        let problem = problem(seed, index as u64)?;
        let began = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| solve(&problem)));
        let seconds = began.elapsed().as_secs_f64();
        let tell = |what: &str| println!("{index:5} {seconds:6.1} s  {what}\n      {}", problem.about);
        match done {
            Err(_) => {
                panicked += 1;
                tell("PANIC");
            }
            Ok(Err(error)) => {
                failed += 1;
                tell(&format!("FAILED: {error}"));
            }
            Ok(Ok((state, iterations))) => {
                solved += 1;
                newton.push(iterations);
                let touch = problem.solid.model().touches(&At::of(&state)).remove(0).1;
                if touch.sunk > 0.0 {
                    through += 1;
                    tell(&format!("pressed through by {:.2e}", touch.sunk));
                }
                let depth = depth(&problem, &state)?;
                if depth
                    > (-touch.smallest_gap).max(0.0) + 0.1 * problem.solid.model().touch_parameters()[0].1.thickness
                {
                    unreported += 1;
                    tell(&format!(
                        "UNREPORTED: a node is inside by {depth:.2e}, the gap is {:.2e}",
                        touch.smallest_gap
                    ));
                }
                if iterations > MANY {
                    tell(&format!("{iterations} Newton iterations, {} cuts", state.report.cuts));
                }
            }
        }
    }
    newton.sort_unstable();
    let at = |share: f64| newton.get((share * newton.len() as f64) as usize).copied().unwrap_or(0);
    println!(
        "{solved} of {} solved ({through} of them pressed through, {unreported} unreported), {failed} failed, {panicked} panics; Newton iterations: median {}, \
         nine of ten below {}, most {}",
        solved + failed + panicked,
        at(0.5),
        at(0.9),
        newton.last().copied().unwrap_or(0)
    );
    Ok(())
}

/// How deep inside of the obstacle, where it is at the end, the deepest node of the surface that may touch is.
fn depth(problem: &Problem, state: &State) -> Result<f64, Failure> {
    let mesh = problem.solid.mesh();
    let (dim, top) = (mesh.dim(), if mesh.dim() == 2 { "y+" } else { "z+" });
    let distance = |node: &u32| {
        let (n, x) = (*node as usize, mesh.points()[*node as usize]);
        let u = |i: usize| if i < dim { state.u[dim * n + i] } else { 0.0 };
        problem.obstacle.distance(&std::array::from_fn(|i| x[i] + u(i) - problem.way[i]))
    };
    Ok(-problem.solid.nodes_of(top)?.iter().map(distance).fold(f64::INFINITY, f64::min))
}

/// The last state, and the Newton iterations that it took.
fn solve(problem: &Problem) -> Result<(State, usize), Failure> {
    let Problem { solid, way, friction, .. } = problem;
    let at = |share: f64| -> Controls {
        let mut controls = solid.controls();
        (0..3).for_each(|i| controls.values_mut(0)[i] = share * way[i]);
        controls
    };
    let how = SolveOptions::default();
    if !friction {
        let state = solid.solve(&at(1.0), &how)?;
        let newton = state.report.newton;
        return Ok((state, newton));
    }
    let row = SCHEMES.iter().find(|row| row.name == "quasi_static").ok_or("no such scheme")?;
    let steps: Vec<StepTo> = (1..=STEPS).map(|n| StepTo { dt: 0.1, controls: at(n as f64 / STEPS as f64) }).collect();
    let mut trajectory = Trajectory::from_given(solid.rest());
    solid.model().advance(&mut trajectory, &(row.build)()?, &steps, &how, &mut Workspace::default())?;
    let newton = trajectory.states().iter().skip(1).map(|state| state.report.newton).sum();
    Ok((trajectory.end().clone(), newton))
}

fn problem(seed: u64, index: u64) -> Result<Problem, Failure> {
    let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(index));
    let kinds = [
        CellKind::Quad4,
        CellKind::Quad9,
        CellKind::Tri6,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Tet4,
        CellKind::Tet10,
    ];
    let kind = pick(&mut random, &kinds);
    let plane = kind.dim() == 2;
    let height = between(&mut random, 0.3, 1.5);
    let up = (2.0 + 4.0 * height) as usize;
    let mesh = match plane {
        true => rectangle([1.0, height], [6, up], kind)?,
        false => box_mesh([1.0, 1.0, height], [4, 4, up.min(4)], kind)?,
    };
    let (bottom, top) = if plane { ("y-", "y+") } else { ("z-", "z+") };
    let (young, poisson) = (10f64.powf(between(&mut random, 4.0, 6.0)), between(&mut random, 0.1, 0.45));
    let solid = Solid::new(mesh)?.material("body", NeoHooke::from_young_poisson(young, poisson)?)?.clamp(bottom)?;
    // in the order across, (depth,) up
    let place = |across: f64, depth: f64, up: f64| if plane { [across, up, 0.0] } else { [across, depth, up] };
    let depth = between(&mut random, 0.02, 0.3) * height;
    let sideways = between(&mut random, -0.5, 0.5) * depth;
    let (obstacle, what) = obstacle(&mut random, height, place)?;
    let friction = (random.symmetric() > 0.0).then(|| between(&mut random, 0.1, 1.0));
    let contact = Contact::of("contact", top, obstacle.clone());
    let contact = match friction {
        Some(friction) => contact.friction(friction, 0.01),
        None => contact,
    };
    let about = format!(
        "{}, height {height:.2}, E = {young:.1e}, nu = {poisson:.2}; {what} goes in by {depth:.3} and aside by {sideways:.3}{}",
        kind.name(),
        friction.map_or_else(String::new, |friction| format!(", friction {friction:.2}"))
    );
    let way = place(sideways, 0.3 * sideways, -depth - 0.05);
    Ok(Problem { solid: solid.contact(contact)?, obstacle, way, friction: friction.is_some(), about })
}

/// Above the middle of the top, by 0.05.
fn obstacle(
    random: &mut Random,
    height: f64,
    place: impl Fn(f64, f64, f64) -> [f64; 3],
) -> Result<(Obstacle, &'static str), Failure> {
    let size = between(random, 0.1, 1.0);
    let (across, gap) = (between(random, 0.3, 0.7), height + 0.05);
    let (low, high) = (place(across - size, 0.5 - size, gap), place(across + size, 0.5 + size, gap + size));
    Ok(match pick(random, &["half-space", "sphere", "capsule", "box", "solid"]) {
        "half-space" => {
            let tilt = between(random, -0.1, 0.1);
            (Obstacle::half_space(place(0.5, 0.5, gap + 0.05), place(tilt, 0.5 * tilt, -1.0)), "a half-space")
        }
        "sphere" => (Obstacle::Sphere { center: place(across, 0.5, gap + size), radius: size }, "a sphere"),
        "capsule" => {
            let ends = [place(across - size, 0.2, gap + size), place(across + size, 0.8, gap + size)];
            (Obstacle::Capsule { ends, radius: size }, "a capsule")
        }
        "box" => {
            let deep = if low[2] == high[2] { size } else { 0.0 };
            let (low, high) = ([low[0], low[1], low[2] - deep], [high[0], high[1], high[2] + deep]);
            (Obstacle::aligned_box(low, high).rounded(0.05 * size), "a box")
        }
        _ => {
            let plane = low[2] == 0.0 && high[2] == 0.0;
            let sides: [f64; 3] = std::array::from_fn(|i| high[i] - low[i]);
            let mesh = match plane {
                true => rectangle([sides[0], sides[1]], [1, 1], CellKind::Quad4)?,
                false => box_mesh(sides, [1, 1, 1], CellKind::Hex8)?,
            };
            let lifted = mesh.mapped(|x| std::array::from_fn(|i| x[i] + low[i]))?;
            let rounding = 0.02;
            let moved = lifted.mapped(|x| {
                let up = place(0.0, 0.0, rounding);
                std::array::from_fn(|i| x[i] + up[i])
            })?;
            (Obstacle::solid(&moved)?.rounded(rounding), "a meshed box")
        }
    })
}
