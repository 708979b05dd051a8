//! What the bench programs share: arguments, medians, memory, the reference body.

#![allow(dead_code)] // every program uses some of it

pub mod process;

use nastic::fem::{Controls, Solver, SolverFactory, Strategies, Strategy};
use nastic::numeric::Random;
use nastic::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// `key=value` arguments with known keys; cargo's own flags are passed over.
pub struct Arguments(BTreeMap<String, String>);

impl Arguments {
    pub fn read(known: &[&str]) -> Result<Self, Failure> {
        let mut given = BTreeMap::new();
        for argument in std::env::args().skip(1).filter(|a| !a.starts_with("--")) {
            let (key, value) = argument.split_once('=').ok_or(format!("key=value is wanted, not {argument:?}"))?;
            if !known.contains(&key) {
                return Err(format!("no argument {key:?}: there are {}", known.join(", ")).into());
            }
            given.insert(key.to_owned(), value.to_owned());
        }
        Ok(Self(given))
    }

    pub fn text(&self, key: &str, default: &str) -> String {
        self.0.get(key).cloned().unwrap_or_else(|| default.to_owned())
    }

    pub fn number(&self, key: &str, default: usize) -> Result<usize, Failure> {
        self.0.get(key).map_or(Ok(default), |v| v.parse().map_err(|_| format!("{key} is a number, not {v:?}").into()))
    }

    pub fn element(&self, key: &str, default: CellKind) -> Result<CellKind, Failure> {
        let Some(name) = self.0.get(key) else { return Ok(default) };
        CellKind::ALL.iter().copied().find(|k| k.name() == name).ok_or_else(|| format!("no element {name:?}").into())
    }

    /// `without=NAME,NAME`: all strategies but these.
    pub fn strategies(&self) -> Result<Strategies, Failure> {
        let names = self.text("without", "");
        names.split(',').filter(|name| !name.is_empty()).try_fold(Strategies::ALL, |all, name| {
            let known = || Strategy::ALL.map(Strategy::name).join(", ");
            let strategy =
                Strategy::named(name).ok_or_else(|| format!("no strategy {name:?}: there are {}", known()))?;
            Ok(all.without(strategy))
        })
    }

    /// `solver=NAME`, a linear solver by name; `None` where it is not given.
    pub fn solver(&self) -> Result<Option<&'static dyn SolverFactory>, Failure> {
        let Some(name) = self.0.get("solver") else { return Ok(None) };
        Solver::named(name).map(Some).ok_or_else(|| format!("no linear solver {name:?}").into())
    }

    /// `threads=N` for the pool all work runs in.
    pub fn use_threads(&self) -> Result<(), Failure> {
        let threads = self.number("threads", 0)?;
        Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?)
    }
}

/// Uniform on (low, high).
pub fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + 0.5 * (1.0 + random.symmetric()) * (high - low)
}

/// One of them, each as likely.
pub fn pick<T: Copy>(random: &mut Random, all: &[T]) -> T {
    all[(between(random, 0.0, all.len() as f64) as usize).min(all.len() - 1)]
}

pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// Median time of several runs, in seconds.
pub fn median<E>(repeat: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let mut times = Vec::new();
    for _ in 0..repeat.max(1) {
        let began = Instant::now();
        work()?;
        times.push(began.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}

/// The process's largest resident memory so far in megabytes; NaN where the system does not say.
pub fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |k| k / 1024.0)
}

/// The fibre cantilever with 5n x n x n cells.
pub fn cantilever(kind: CellKind, n: usize) -> Result<Solid, Failure> {
    cantilever_on(box_mesh([1.0, 0.2, 0.2], [5 * n, n, n], kind)?)
}

/// The fibre cantilever on another mesh of its box.
pub fn cantilever_on(mesh: Mesh) -> Result<Solid, Failure> {
    Ok(Solid::new(mesh)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// m(X) = -1.5e5 Z / 0.2 at the quadrature points.
pub fn tension(body: &Solid) -> Result<Controls, Failure> {
    let mut controls = body.controls();
    let at = body.discretization().points().positions(body.mesh(), None);
    let values: Vec<f64> = at.iter().map(|x| -1.5e5 * x[2] / 0.2).collect();
    controls.set(0, 0, &values)?;
    Ok(controls)
}
