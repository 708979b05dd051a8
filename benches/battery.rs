//! Seeded random equilibrium problems with default options: how many are solved, at what work, why the others fail.
//!
//! `cargo bench --bench battery -- count=400 seed=1`: problem k of a seed is always the same; `only=K` solves one alone.
//! Bodies from stout to slender (1:1 to 1:60), six elements, three laws, Poisson's ratio 0.2 to 0.4999; fibre tension up
//! to 90 % of the convexity bound (uniform, by cell or linear across the body), turgor, magnets with
//! beta = |B_r| |B_a| / (mu0 E) up to 20 (h/L)^2 but no more than 1 (`beta=20` allows more: stout bodies are then stretched
//! tenfold; 0.2 T in 0.4 T at E = 100 kPa is 0.6), dead loads. `without=curved_step,point_strains` does without these strategies. Prints every problem that failed, took more than 1,000
//! Newton iterations or is unstable, and a summary.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, between, pick};
use nastic::energy::magnet::VACUUM_PERMEABILITY;
use nastic::fem::{Controls, SolveOptions, StrategyCounts};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// A problem and what it is, in words.
struct Problem {
    solid: Solid,
    controls: Controls,
    about: String,
}

/// Young's modulus of all bodies, Pa.
const YOUNG: f64 = 1e5;
/// Newton iterations above which a solve is listed.
const MANY: usize = 1_000;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["count", "seed", "only", "threads", "beta", "without"])?;
    arguments.use_threads()?;
    let (count, seed) = (arguments.number("count", 300)?, arguments.number("seed", 1)? as u64);
    let only = arguments.number("only", usize::MAX)?;
    let largest = arguments.number("beta", 1)? as f64;
    let how = SolveOptions { strategies: arguments.strategies()?, ..SolveOptions::default() };
    let mut tried = StrategyCounts::default();
    let (mut solved, mut unstable, mut failed, mut panicked, mut newton) = (0, 0, 0, 0, Vec::new());
    let mut longest: f64 = 0.0;
    for index in (0..count).filter(|index| only == usize::MAX || *index == only) {
        let Problem { solid, controls, about } = problem(seed, index as u64, largest)?;
        let began = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| solid.solve(&controls, &how)));
        let seconds = began.elapsed().as_secs_f64();
        longest = longest.max(seconds);
        let tell = |what: &str| println!("{index:5} {seconds:6.1} s  {what}\n      {about}");
        match done {
            Err(_) => {
                panicked += 1;
                tell("PANIC");
            }
            Ok(Err(error)) => {
                failed += 1;
                tell(&format!("FAILED: {error}"));
            }
            Ok(Ok(state)) => {
                solved += 1;
                tried.add(&state.report.strategies);
                newton.push(state.report.newton);
                let pivots = solid.negative_pivots(&state);
                if !matches!(pivots, Ok(0)) {
                    unstable += 1;
                    tell(&format!("unstable: {pivots:?}"));
                }
                if state.report.newton > MANY {
                    tell(&format!("{} Newton iterations, {} cuts", state.report.newton, state.report.cuts));
                }
            }
        }
    }
    newton.sort_unstable();
    let at = |share: f64| newton.get((share * newton.len() as f64) as usize).copied().unwrap_or(0);
    println!(
        "{solved} of {} solved ({unstable} of them unstable), {failed} failed, {panicked} panics; Newton iterations: \
         median {}, nine of ten below {}, most {}; longest {longest:.1} s",
        solved + failed + panicked,
        at(0.5),
        at(0.9),
        newton.last().copied().unwrap_or(0)
    );
    let tried: Vec<String> = tried.tried().map(|(strategy, count)| format!("{} {count}", strategy.name())).collect();
    println!("tried: {}; {} Newton iterations in all", tried.join(", "), newton.iter().sum::<usize>());
    Ok(())
}

fn problem(seed: u64, index: u64, beta: f64) -> Result<Problem, Failure> {
    let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(index));
    let kind = pick(
        &mut random,
        &[CellKind::Quad8, CellKind::Quad9, CellKind::Tri6, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10],
    );
    let slenderness = 60f64.powf(between(&mut random, 0.0, 1.0));
    let width = 1.0 / slenderness;
    let along = (2.0 * slenderness).clamp(3.0, 20.0) as usize;
    let mesh = match kind.dim() {
        2 => rectangle([1.0, width], [along, 2], kind)?,
        _ => box_mesh([1.0, between(&mut random, 1.0, 3.0) * width, width], [along, 1, 2], kind)?,
    };
    let poisson = pick(&mut random, &[0.2, 0.3, 0.4, 0.45, 0.49, 0.499, 0.4999]);
    let solid = Solid::new(mesh)?;
    let law = pick(&mut random, &["mooney_rivlin", "neo_hooke", "neo_hooke_isochoric"]);
    let solid = match law {
        "mooney_rivlin" => solid.material(
            "body",
            MooneyRivlin::from_young_poisson(
                YOUNG,
                poisson,
                between(&mut random, if poisson < 0.4 { 0.8 } else { 0.2 }, 0.9),
            )?,
        )?,
        "neo_hooke" => solid.material("body", NeoHooke::from_young_poisson(YOUNG, poisson)?)?,
        _ => solid.material("body", NeoHookeIsochoric::from_young_poisson(YOUNG, poisson)?)?,
    };
    let solid = solid.clamp("x-")?;
    let head = format!("{}, 1:{slenderness:.1}, {law} at nu = {poisson}", kind.name());
    match pick(&mut random, &["fibre", "fibre", "turgor", "magnet", "load"]) {
        "fibre" => fibre(solid, head, &mut random),
        "turgor" => {
            let solid = solid.actuate("body", "turgor", Turgor::new())?;
            // Up to a stretch of about a half: p against three bulk moduli is a volume, p against E a shape.
            let p = between(&mut random, -0.5, 1.0) * YOUNG;
            let controls = field(&solid, p, &mut random)?;
            Ok(Problem { solid, controls, about: format!("{head}; turgor {p:.3e} Pa") })
        }
        "magnet" => magnet(solid, head, (slenderness, beta), &mut random),
        _ => {
            let dim = solid.mesh().dim();
            // Deflections of the order of the length: E h^3 / (12 L^2) per height h.
            let size = between(&mut random, -6.0, 6.0) * YOUNG / (12.0 * slenderness.powi(3));
            let pull = between(&mut random, 0.0, 0.3) * YOUNG;
            let traction = if dim == 2 { Vec3::new(pull * 0.1, size, 0.0) } else { Vec3::new(pull * 0.1, 0.0, size) };
            let solid = solid.traction("x+", traction)?;
            let controls = solid.controls();
            Ok(Problem { solid, controls, about: format!("{head}; traction {traction:?} Pa") })
        }
    }
}

/// A tension up to nine tenths of the convexity bound, contraction up to E.
fn fibre(solid: Solid, head: String, random: &mut Random) -> Result<Problem, Failure> {
    let solid = solid.actuate("body", "tension", FiberTension::along(Vec3::x())?)?;
    let bound = solid.body().fiber_limit(0).unwrap_or(YOUNG / 3.0);
    let m = if random.symmetric() > 0.0 { 0.9 * bound } else { -between(random, 0.0, 1.0) * YOUNG };
    let controls = field(&solid, m, random)?;
    Ok(Problem { solid, controls, about: format!("{head}; tension {m:.3e} Pa, bound {bound:.3e}") })
}

fn magnet(
    solid: Solid,
    head: String,
    (slenderness, largest): (f64, f64),
    random: &mut Random,
) -> Result<Problem, Failure> {
    let solid = solid.actuate("body", "magnet", Magnet::new())?;
    // beta (L/h)^2 of some tens turns a slender body round.
    let beta = (between(random, 0.0, 20.0) / slenderness.max(1.0).powi(2)).min(largest);
    let product = beta * VACUUM_PERMEABILITY * YOUNG;
    let angle = between(random, 0.3, 2.8);
    let mut controls = solid.controls();
    let (remanence, across) = (product.sqrt(), if solid.mesh().dim() == 2 { 4 } else { 5 });
    let points = solid.discretization().points().len();
    controls.set(0, 0, &vec![remanence; points])?;
    controls.set(0, 3, &vec![remanence * angle.cos(); points])?;
    controls.set(0, across, &vec![remanence * angle.sin(); points])?;
    Ok(Problem { solid, controls, about: format!("{head}; magnet beta = {beta:.3e}, field at {angle:.2} rad") })
}

/// The first slot: uniform, by cell at random, or linear across the body from -m to m.
fn field(solid: &Solid, m: f64, random: &mut Random) -> Result<Controls, Failure> {
    let mut controls = solid.controls();
    let disc = solid.discretization();
    let positions = disc.points().positions(solid.mesh(), None);
    let (axis, height) = (solid.mesh().dim() - 1, solid.mesh().size()[solid.mesh().dim() - 1]);
    let values: Vec<f64> = match pick(random, &[0, 1, 2]) {
        0 => vec![m; positions.len()],
        1 => disc
            .points_of_cells()
            .iter()
            .flat_map(|(_, count)| {
                let value = m * 0.5 * (1.0 + random.symmetric());
                vec![value; *count]
            })
            .collect(),
        _ => positions.iter().map(|x| m * (x[axis] / height)).collect(),
    };
    controls.set(0, 0, &values)?;
    Ok(controls)
}
