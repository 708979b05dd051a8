//! Seeded random problems of contact in twelve families, each answer judged by code that shares nothing with the program: which are solved, at what
//! work, why others fail, and whether any answer is wrong.
//!
//! `cargo bench --bench contact_battery -- count=35 seed=1 family=press,drop`: problem k of a family and a seed is always the same; `only=K` solves one
//! alone, `threads=N`; `without=proximal_steps,rate` does without these strategies; `checks=1` says how near the judge's checks come to their bounds, `spoil=1` makes answers wrong on purpose and says which checks
//! notice (exit code 1 if one never fails). Elements quad4 to hex27 and tet10, Poisson's ratios up to 0.4995 with one pressure per cell, neo-Hookean and formula laws,
//! obstacles half-space, sphere, capsule, box and meshed box, friction 0.1 to 1, rigid bodies, chambers, motions by five schemes.
//!
//! **Wrong** is an answer that the judge (`judge/`) disagrees with, **failed** a typed error, **without solution** an error where the judge shows that
//! there is none in reach, **cut** one that used up its budget of Newton iterations. Each is printed with its number and words. Exit code 1 if any
//! answer is wrong or a family has more than `failures=N` failures, if that is given.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

#[path = "../common/mod.rs"]
mod common;
mod families;
mod judge;
mod problem;
mod solve;
mod spoiled;
mod tally;

use common::Arguments;
use families::{FAMILIES, Family};
use judge::Check;
use nastic::numeric::Random;
use problem::{Failure, Problem};
use solve::{Unsolved, solve};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;
use tally::{Tally, Verdict};

fn main() -> Result<std::process::ExitCode, Failure> {
    let arguments =
        Arguments::read(&["count", "seed", "only", "threads", "family", "failures", "checks", "spoil", "without"])?;
    arguments.use_threads()?;
    let strategies = arguments.strategies()?;
    problem::STRATEGIES.get_or_init(|| strategies);
    let (count, seed) = (arguments.number("count", 35)?, arguments.number("seed", 1)? as u64);
    let (only, most) = (arguments.number("only", usize::MAX)?, arguments.number("failures", usize::MAX)?);
    let shows_checks = arguments.number("checks", 0)? > 0;
    let wanted = arguments.text("family", "all");
    let is_wanted = |family: &&Family| wanted == "all" || wanted.split(',').any(|name| name == family.name);
    let families: Vec<&Family> = FAMILIES.iter().filter(is_wanted).collect();
    if families.is_empty() {
        let names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
        return Err(format!("no family {wanted:?}: there are {}", names.join(", ")).into());
    }
    if arguments.number("spoil", 0)? > 0 {
        return spoiled::run(&families, seed, count);
    }
    let (mut tallies, mut worst) = (Vec::new(), Vec::<Check>::new());
    for family in families {
        let mut tally = Tally::of(family.name);
        for index in (0..count).filter(|index| only == usize::MAX || *index == only) {
            let began = Instant::now();
            let (about, verdict) = run(family, seed, index as u64);
            let seconds = began.elapsed().as_secs_f64();
            if let Some(words) = verdict.words() {
                println!("{} {index} seed={seed} {seconds:6.1} s  {words}\n      {about}", family.name);
            }
            if let Verdict::Solved { checks, .. } | Verdict::Wrong { checks, .. } = &verdict {
                tally::keep_worst(&mut worst, checks);
            }
            tally.add(&verdict, seconds);
        }
        println!("{}", tally.line());
        tallies.push(tally);
    }
    println!("\n{}", tally::table(&tallies));
    if shows_checks {
        println!("{}", tally::checks(&worst));
    }
    let is_bad = |tally: &Tally| tally.wrong > 0 || tally.failed + tally.cut > most;
    Ok(if tallies.iter().any(is_bad) { std::process::ExitCode::FAILURE } else { std::process::ExitCode::SUCCESS })
}

/// Problem k of a family and a seed.
fn problem(family: &Family, seed: u64, index: u64) -> Result<Problem, Failure> {
    let name = family.name.bytes().fold(0_u64, |sum, byte| sum.wrapping_mul(31).wrapping_add(u64::from(byte)));
    (family.make)(&mut Random::new(seed.wrapping_mul(1_000_003).wrapping_add(index) ^ (name << 20)))
}

fn run(family: &Family, seed: u64, index: u64) -> (String, Verdict) {
    let problem = match problem(family, seed, index) {
        Ok(problem) => problem,
        Err(error) => return (String::new(), Verdict::Failed(format!("REFUSED: {error}"))),
    };
    let verdict = match catch_unwind(AssertUnwindSafe(|| solve(&problem))) {
        Err(_) => Verdict::Wrong { checks: Vec::new(), words: "PANIC".to_owned() },
        Ok(Ok(solved)) => match judge::checks(&problem, &solved, None) {
            Err(error) => Verdict::Wrong { checks: Vec::new(), words: format!("WRONG: {error}") },
            Ok(checks) => tally::judged(solved.newton, checks),
        },
        Ok(Err(unsolved)) => without_answer(&problem, &unsolved),
    };
    (problem.about, verdict)
}

/// Whether the judge has an argument why there is none.
fn without_answer(problem: &Problem, Unsolved { why, cut, last }: &Unsolved) -> Verdict {
    let falls = last.as_ref().map(|state| judge::stability::falling_directions(problem, state));
    match falls {
        Some(Ok(count)) if count > 0 => Verdict::NoSolution(format!(
            "NO SOLUTION: the body falls in {count} directions with all held that touches; {why}"
        )),
        _ if *cut => Verdict::Cut(format!("CUT: {why}")),
        Some(Ok(_)) => Verdict::Failed(format!("FAILED (the body is stable where it stopped): {why}")),
        Some(Err(reason)) => Verdict::Failed(format!("FAILED ({reason}): {why}")),
        None => Verdict::Failed(format!("FAILED: {why}")),
    }
}
