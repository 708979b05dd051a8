//! One pressure for stems nobody knows exactly: the control that is best for the mean material, put into the random model,
//! against the control that is best for the random model (the comparison of the survey's figure 12).
//!
//! The stem of `turgor_stem`, of one random material: shear modulus Gamma (mean 0.8 MPa, variation 0.2), bulk modulus
//! Gamma (6 MPa, 0.25), share Beta (0.7, variance 0.005), independent. How far the flank swells goes like the inverse of
//! the bulk modulus, and how far the stem sags under its weight like that of the shear modulus: the cost is far from
//! linear in the material, so the mean material is not what is met on average.
//!
//! Both controls are judged on the Gauss nodes the robust one was found with, and on a Monte Carlo sample that nothing was
//! ever optimised on. `cargo run --release --example robust_turgor [NODES] [SAMPLE] [RISK] [SEED]`: Gauss nodes per parameter
//! (3: 27 scenarios), size of the sample (800), what is minimised (mean, mean_deviation, cvar, worst_case), its seed. To
//! `out/robust_turgor`: mean shape and point-wise standard deviation of the position under both controls on the sample,
//! both controls in the mean material, and the costs of every draw as `costs.csv`.

#![allow(clippy::print_stdout, clippy::print_stderr)] // programs talk, libraries do not

use nastic::control::Finished;
use nastic::prelude::*;
use nastic::uncertainty::risk::{self, Estimate, conditional_value_at_risk, deviation};
use nastic::uncertainty::{Beta, Gamma, Inadmissible, MaterialScenarios, Risk, Sample, StochasticMooneyRivlin};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const LENGTH: f64 = 0.1;
const ANGLE: f64 = 0.5;
/// What jumps of the pressure cost, mm^2/(Pa^2 m): 1 MPa between all neighbours costs 0.7 mm^2.
const ROUGHNESS: f64 = 1e-10;
const OUT: &str = "out/robust_turgor";

fn on_arc(x: [f64; 3]) -> [f64; 3] {
    let radius = LENGTH / ANGLE;
    let (s, c) = (x[0] / radius).sin_cos();
    [(radius - x[2]) * s, x[1], radius - (radius - x[2]) * c]
}

/// The control problem of a stem of one material. The cost is half the mean squared distance of the tracked part from
/// where it should be, in square millimetres.
fn stem(mesh: &Arc<Discretization>, law: MooneyRivlin) -> Outcome<Reduced> {
    let body = Solid::on(mesh.clone())
        .material("body", law)?
        .actuate("flank", "turgor", Turgor::new())?
        .body_force("body", Vec3::new(0.0, 0.0, -1e4))?
        .clamp("clamp")?;
    let weight = 1e6 / body.mesh().surface_area("track")?;
    let tracking = Tracking::surface("track", Target::position(on_arc)).weight(weight);
    Ok(Reduced::new(body)
        .control("turgor", Space::Cell)?
        .cost(tracking)?
        .cost(ControlSmoothness::of("turgor", ROUGHNESS)?)?)
}

fn model() -> Outcome<StochasticMooneyRivlin> {
    Ok(StochasticMooneyRivlin {
        shear: Gamma::from_mean_variation(0.8e6, 0.2)?,
        bulk: Gamma::from_mean_variation(6e6, 0.25)?,
        share: Beta::from_mean_variance(0.7, 0.005)?,
    })
}

/// A stem for every material. With `keep_factors` each keeps its factor between solves; without, none does.
fn stems(
    mesh: &Arc<Discretization>,
    materials: &MaterialScenarios,
    measure: Box<dyn Risk>,
    keep_factors: bool,
) -> Outcome<Ensemble> {
    let mut all = Ensemble::new(measure).keep_factors(keep_factors);
    for material in &materials.scenarios {
        let name = format!("{:04}", material.node);
        all = all.scenario(&name, material.probability, stem(mesh, material.law.clone())?);
    }
    if std::io::stderr().is_terminal() {
        let done = AtomicUsize::new(0);
        all = all.watched_by(move |finished: &Finished| {
            let done = done.fetch_add(1, Ordering::Relaxed) % finished.of + 1;
            eprint!("\r{done} of {} scenarios{}", finished.of, if done == finished.of { "\r\x1b[K" } else { "" });
        });
    }
    Ok(all.build()?)
}

fn main() -> Outcome {
    let mut args = std::env::args().skip(1);
    let nodes: usize = args.next().map_or(Ok(3), |n| n.parse())?;
    let draws: usize = args.next().map_or(Ok(800), |n| n.parse())?;
    let measure = args.next().unwrap_or("mean".to_owned());
    let seed: u64 = args.next().map_or(Ok(2023), |n| n.parse())?;

    let mesh = Discretization::new(nastic::io::read_gmsh("meshes/stem.msh")?.into())?;
    let model = model()?;
    let rule = model.scenarios(&Sample::tensor(&model.laws(), &[nodes; 3])?, Inadmissible::Refuse)?;
    // A draw with mu3 <= 0 is no material: left out and counted.
    let unseen = model.scenarios(&Sample::monte_carlo(&model.laws(), draws, seed)?, Inadmissible::Truncate)?;
    println!("{} scenarios; {draws} draws of seed {seed}, {} left out", rule.scenarios.len(), unseen.left_out.len());

    // The best control for the mean material, and from there the best for all.
    let mean_law = MooneyRivlin::from_shear_bulk(0.8e6, 6e6, 0.7)?;
    let mean_stem = stem(&mesh, mean_law)?;
    let mut search = Lbfgs::default().within(Bounds::new(0.0, 2e6)?).tolerance(1e-3);
    let certain = search.minimize(&mean_stem, 0.0)?;
    println!("deterministic: cost {:.4} mm^2, {}", certain.cost, certain.stop);

    let all = stems(&mesh, &rule, risk::by_name(&measure)?, true)?;
    let first = all.at(&certain.m)?;
    let mut run = search.start(&all, &first)?;
    let stop = run.run(&mut |trial: &Trial<'_, EnsemblePoint>| println!("{trial}"));
    let factors = run.workspace().factor_bytes() as f64 / 1e6;
    let robust = run.finish(stop);
    println!("robust: {measure} {:.4} mm^2, {}", robust.cost, robust.stop);
    println!("factors of {} scenarios: {:.1} MB", all.members().len(), factors);

    let on_rule = [first.costs, robust.point.costs];
    println!("\non the {} nodes of the rule", rule.scenarios.len());
    table(all.probabilities(), &on_rule);

    let sample = stems(&mesh, &unseen, risk::by_name("mean")?, false)?;
    let mut on_sample: [Vec<f64>; 2] = Default::default();
    for (costs, (name, m)) in on_sample.iter_mut().zip([("deterministic", &certain.m), ("robust", &robust.m)]) {
        let point = sample.at(m)?;
        nastic::io::write_vtu(format!("{OUT}/mean_shape_{name}.vtu"), &sample.mean_shape(&point, "")?)?;
        let in_the_mean = mean_stem.at(m)?;
        nastic::io::write_vtu(format!("{OUT}/mean_material_{name}.vtu"), &mean_stem.snapshot(&in_the_mean, None)?)?;
        *costs = point.costs;
    }
    println!("\non {} draws that were never optimised on", unseen.scenarios.len());
    table(sample.probabilities(), &on_sample);
    let [certain, robust] = &on_sample;
    for (name, costs) in [("deterministic", certain), ("robust", robust)] {
        let found = Estimate::of(costs).ok_or("too few draws")?;
        println!("mean of {name}: {:.3} +- {:.3} mm^2 (standard error)", found.mean, found.error);
    }
    let gain = Estimate::paired(certain, robust).ok_or("too few draws")?;
    let ratio = gain.mean / gain.error;
    println!("saved in pairs: {:.4} +- {:.4} mm^2, {ratio:.1} standard errors", gain.mean, gain.error);

    write_costs(&unseen, &on_sample)?;
    if let Some(peak) = peak_memory() {
        println!("peak memory {peak}");
    }
    Ok(())
}

/// Mean, deviation, CVaR and worst of the costs under both controls.
fn table(p: &[f64], costs: &[Vec<f64>; 2]) {
    type Measure = fn(&[f64], &[f64]) -> f64;
    let mean: Measure = |p, j| p.iter().zip(j).map(|(p, j)| p * j).sum();
    let rows: [(&str, Measure); 4] = [
        ("mean", mean),
        ("deviation", deviation),
        ("CVaR 0.9", |p, j| conditional_value_at_risk(p, j, 0.9)),
        ("worst", |p, j| conditional_value_at_risk(p, j, 1.0)),
    ];
    println!("{:10} {:>13} {:>13}  (mm^2)", "", "deterministic", "robust");
    for (name, measure) in rows {
        println!("{name:10} {:13.3} {:13.3}", measure(p, &costs[0]), measure(p, &costs[1]));
    }
}

fn write_costs(materials: &MaterialScenarios, [certain, robust]: &[Vec<f64>; 2]) -> Outcome {
    let mut text = "shear,bulk,share,deterministic,robust\n".to_owned();
    for ((s, a), b) in materials.scenarios.iter().zip(certain).zip(robust) {
        text += &format!("{:.6e},{:.6e},{:.6},{a:.9e},{b:.9e}\n", s.shear, s.bulk, s.share);
    }
    nastic::io::write_atomically(format!("{OUT}/costs.csv"), |out| out.write_all(text.as_bytes()))?;
    Ok(())
}

/// The largest amount of memory this program held, as Linux shows it; nothing elsewhere.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| Some(line.strip_prefix("VmHWM:")?.trim().to_owned()))
}
