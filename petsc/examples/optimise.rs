//! The tension of the fibre cantilever optimised on the ranks of MPI, 5n x n x n hex8: `mpirun -n 3 optimise tracking|sprung|shared|hausdorff N ITERATIONS [DIRECTORY]`.
//!
//! With `serial` in the place of a directory every process has the whole body and a solver of nastic. Rank 0 prints a line of JSON: cost at the start and at the end, the
//! derivative's size at the start, iterations, trials, a hash of the bits of control and cost, and on how many ranks that is the same. Into a directory each rank writes its part, rank 0
//! the index. `sprung` is tracking with a spring along the cantilever, which ends in the first and in the last part; `shared` with two springs from
//! different parts to one node set.

use nastic_control::{ControlNorm, Reduced, ReducedWorkspace, SmoothedHausdorff, Space, Target, Tracking};
use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Solid, Spring};
use nastic_io::{write_pvtu, write_vtu};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_opt::{Bounds, Lbfgs, Objective, Optimizer};
use nastic_petsc::{PETSC, Session};
use nastic_team::{Team, exchange};
use nastic_tensor::Vec3;
use std::io::Write;
use std::path::Path;
use std::time::Instant as Clock;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// The end turned and lifted.
fn lifted(x: [f64; 3]) -> [f64; 3] {
    let r = x[2] - 0.1;
    [0.90 - 0.55f64.sin() * r, x[1], 0.35 + 0.55f64.cos() * r]
}

fn bent(x: [f64; 3]) -> [f64; 3] {
    let (s, c) = (0.5 * x[0]).sin_cos();
    [(2.0 - x[2]) * s, x[1], 2.0 - (2.0 - x[2]) * c]
}

/// The bar with the node set `tip`, the upper edge of its end.
fn with_tip(bar: &Mesh) -> Outcome<Mesh> {
    let mut raw = RawMesh::new("bar");
    raw.points = bar.points().to_vec();
    for block in bar.blocks() {
        block.iter().for_each(|cell| raw.push(block.kind, cell, &[1]));
    }
    for (tag, (name, facets)) in (1..).zip(bar.surfaces()) {
        for &facet in facets {
            let (kind, nodes) = bar.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
        raw.name_group(2, tag, name);
    }
    let tip = (0..).zip(bar.points()).filter(|(_, x)| x[0] > 0.999 && x[2] > 0.199);
    raw.vertices.extend(tip.map(|(node, _)| (node, 1)));
    raw.name_group(3, 1, "body");
    raw.name_group(0, 1, "tip");
    Ok(Mesh::build(raw)?)
}

fn springs(cost: &str) -> Vec<Spring> {
    match cost {
        "sprung" => vec![Spring::between("strut", [0.13, 0.1, 0.2], [0.95, 0.07, 0.0], 5e3).rest_length(0.6)],
        "shared" => vec![
            Spring::between("long", [0.13, 0.1, 0.2], "tip", 5e3).rest_length(0.6),
            Spring::between("short", [0.53, 0.1, 0.0], "tip", 3e3).rest_length(0.3),
        ],
        _ => Vec::new(),
    }
}

fn problem(session: &Session, (cost, n): (&str, usize), serial: bool) -> Outcome<Reduced> {
    let (rank, mesh) = (session.rank().clone(), with_tip(&box_mesh([1.0, 0.2, 0.2], [5 * n, n, n], CellKind::Hex8)?)?);
    let springs = springs(cost);
    let body = if serial {
        Solid::new(mesh)?
    } else {
        let sets: Vec<Vec<u32>> = springs.iter().map(|spring| spring.nodes(&mesh)).collect::<Result<_, _>>()?;
        let part = mesh.part_reaching(&mesh.bisected(rank.size())?, rank.rank() as u32, &sets)?;
        Solid::of_part(part, rank)?.solver(PETSC)
    };
    let body = body
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let body = springs.into_iter().try_fold(body, Solid::spring)?;
    let problem = Reduced::new(body).sequential().control("tension", Space::Node)?;
    let problem = problem.cost(ControlNorm::of("tension", 1e-12)?)?;
    Ok(match cost {
        "tracking" | "sprung" | "shared" => problem.cost(Tracking::surface("x+", Target::position(lifted)))?,
        "hausdorff" => {
            let target = box_mesh([1.0, 0.2, 0.2], [5, 1, 1], CellKind::Hex20)?.mapped(bent)?;
            problem.cost(SmoothedHausdorff::to(target).stages([(2.0, 4.0, 4.0), (4.0, 8.0, 4.0)]))?
        }
        _ => return Err(USAGE.into()),
    })
}

/// FNV-1a.
fn hash(numbers: &[f64]) -> u64 {
    let bytes = numbers.iter().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn optimised(session: &Session, (cost, n, iterations): (&str, usize, usize), to: Option<&str>) -> Outcome<String> {
    let (rank, began, serial) = (session.rank().clone(), Clock::now(), to == Some("serial"));
    let problem = problem(session, (cost, n), serial)?;
    let control = problem.layout().block("tension")?.basis.positions().iter();
    let mut start = problem.at(&control.map(|x| -1e4 * (1.0 + 10.0 * x[2])).collect::<Vec<_>>())?;
    let slope = problem.derivative(&mut start, &mut ReducedWorkspace::default())?;
    let size = slope.iter().map(|d| d * d).sum::<f64>().sqrt();
    let best =
        Lbfgs::default().within(Bounds::new(-2e5, 0.0)?).max_iterations(iterations).minimize(&problem, &start)?;
    let bits = hash(&[best.m.as_slice(), &best.derivative, &[best.cost]].concat());
    let all = exchange(&*rank, bits.to_le_bytes().to_vec())?;
    let same = all.iter().filter(|other| **other == bits.to_le_bytes()).count();
    if let Some(directory) = to.filter(|_| !serial) {
        let name = |part: usize| format!("optimised_{part}.vtu");
        let shot = problem.snapshot(&best.point, Some(&best.derivative))?;
        write_vtu(&Path::new(directory).join(name(rank.rank())), &shot)?;
        if rank.leads() {
            let parts: Vec<String> = (0..rank.size()).map(name).collect();
            write_pvtu(&Path::new(directory).join("optimised.pvtu"), &shot, &parts)?;
        }
    }
    Ok(format!(
        "{{\"ranks\": {}, \"controls\": {}, \"start\": {:.16e}, \"size\": {size:.16e}, \"cost\": {:.16e}, \"iterations\": {}, \"trials\": {}, \
         \"bits\": \"{bits:016x}\", \"same\": {same}, \"seconds\": {:.2}}}",
        rank.size(),
        best.m.len(),
        start.cost(),
        best.cost,
        best.counts.iterations,
        best.counts.trials,
        began.elapsed().as_secs_f64()
    ))
}

const USAGE: &str = "optimise tracking|sprung|shared|hausdorff N ITERATIONS [serial|DIRECTORY]";

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [cost, n, iterations, rest @ ..] = arguments.as_slice() else { return Err(USAGE.into()) };
    let (n, iterations) = (n.parse()?, iterations.parse()?);
    let work = |session: &Session| -> Outcome {
        let line = optimised(session, (cost, n, iterations), rest.first().map(String::as_str))?;
        if session.rank().leads() {
            writeln!(std::io::stdout().lock(), "{line}")?;
        }
        Ok(())
    };
    // nothing is left to do where an error cannot be written either
    let say = |session: &Session, error: Box<dyn std::error::Error>| {
        let _ = writeln!(std::io::stderr().lock(), "rank {}: {error}", session.rank().rank());
    };
    Ok(Session::run("", work, say)?)
}
