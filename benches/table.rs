//! The whole table: nastic and its peers one after the other on this machine, as Markdown.
//!
//! `cargo bench --bench table -- peers=DIR [rows=forward,optimise,hausdorff,scenarios] [sizes=31k,98k] [python=python3]
//! ["launch=mpirun -n 2"] [points=100000] [numba=10000]`
//!
//! `peers` holds the scripts `dolfinx_peer.py` and `hausdorff.py`; without it, or without what a script needs, the peer
//! is named as skipped. Every figure is a process of its own, so that memory is its own too. Run on an idle machine.

#![allow(clippy::print_stdout, clippy::print_stderr)] // programs talk, libraries do not

mod common;

use common::Arguments;
use common::process::{last_json, number, own};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

type Failure = Box<dyn std::error::Error>;

/// Where the peers are and how they are run.
struct Peers {
    scripts: Option<PathBuf>,
    python: String,
    /// What starts the parallel ones, as `mpirun -n 2`; they run on one rank without.
    launch: Vec<String>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["peers", "launch", "python", "rows", "sizes", "numba", "points"])?;
    let scripts = Some(PathBuf::from(arguments.text("peers", ""))).filter(|p| p.is_dir());
    let launch = arguments.text("launch", "").split_whitespace().map(str::to_owned).collect();
    let peers = Peers { scripts, python: arguments.text("python", "python3"), launch };
    let rows = arguments.text("rows", "forward,optimise,hausdorff,scenarios");
    let sizes = arguments.text("sizes", "31k,98k");
    for row in rows.split(',') {
        match row {
            "forward" => forward(&peers, &sizes)?,
            "optimise" => optimise(&peers)?,
            "hausdorff" => hausdorff(&peers, &arguments)?,
            "scenarios" => scenarios()?,
            other => return Err(format!("no row {other:?}: there are forward, optimise, hausdorff, scenarios").into()),
        }
    }
    Ok(())
}

fn forward(peers: &Peers, sizes: &str) -> Result<(), Failure> {
    println!(
        "\n| forward solve and gradient | nastic s | FEniCSx s | ratio | Newton | factorisations | substitutions | gradient / (assembly + factor + solve) | MB | MB FEniCSx |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let all = [("31k", "hex8", 12, 1), ("31k", "hex27", 6, 2), ("98k", "hex8", 18, 1), ("98k", "hex27", 9, 2)];
    for (_, element, n, order) in all.into_iter().filter(|(size, ..)| sizes.split(',').any(|s| s == *size)) {
        let ours = own("forward", &[&format!("element={element}"), &format!("n={n}"), "repeat=3", "threads=2"])?;
        let problem = [format!("n={n}"), format!("order={order}")];
        let peer = peers.run_parallel("dolfinx_peer.py", &[&problem[0], &problem[1], "solver=mumps_chol"]);
        let iteration = number(&ours, "tangent_s") + number(&ours, "factor_s") + number(&ours, "solve_s");
        println!(
            "| {element}, {} unknowns | {:.2} | {} | {} | {} | {} | {} | {:.2} | {:.0} | {} |",
            number(&ours, "ndof"),
            number(&ours, "forward_s"),
            tell(&peer, "forward_s", 1),
            ratio(&peer, "forward_s", number(&ours, "forward_s")),
            number(&ours, "newton"),
            number(&ours, "factorisations"),
            number(&ours, "back_substitutions"),
            number(&ours, "gradient_s") / iteration,
            number(&ours, "rss_mb"),
            tell(&peer, "rss_mb", 0),
        );
    }
    Ok(())
}

fn optimise(peers: &Peers) -> Result<(), Failure> {
    println!(
        "\n| 20 iterations, 9,963 unknowns | seconds | cost at the end | evaluations | ratio |\n|---|---|---|---|---|"
    );
    let mut ours = Vec::new();
    for _ in 0..5 {
        ours.push(own("optimise", &["method=lbfgs", "threads=2"])?);
    }
    ours.sort_by(|a, b| number(a, "opt_s").total_cmp(&number(b, "opt_s")));
    let ours = &ours[2];
    let seconds = number(ours, "opt_s");
    println!("| nastic, `lbfgs` | {seconds:.2} | {:.2e} | {} | 1 |", number(ours, "J1"), number(ours, "opt_evals"));
    let peer = peers.run("dolfinx_peer.py", &["n=8", "opt=20", "solver=mumps", "threads=2"]);
    let cost = peer.as_ref().map_or("-".to_owned(), |p| format!("{:.2e}", number(p, "J1")));
    println!(
        "| FEniCSx + SciPy, L-BFGS-B | {} | {cost} | {} | {} |",
        tell(&peer, "opt_s", 2),
        tell(&peer, "opt_evals", 0),
        ratio(&peer, "opt_s", seconds)
    );
    Ok(())
}

fn hausdorff(peers: &Peers, arguments: &Arguments) -> Result<(), Failure> {
    println!(
        "\n| smoothed Hausdorff, value and gradient, alpha = 60 | nastic s | numba s | ratio |\n|---|---|---|---|"
    );
    // numba's cost is quadratic to the last digit: beyond `numba` points it is scaled up and marked.
    let most = arguments.number("numba", 10_000)?;
    let largest = arguments.number("points", 100_000)?;
    let mut known: Option<(f64, f64)> = None;
    for n in [1_000usize, 10_000, 100_000, 1_000_000].into_iter().filter(|n| *n <= largest) {
        let ours = own("hausdorff_peer", &[&format!("n={n}"), "check=0", "reps=5"])?;
        let seconds = number(&ours, "median_s");
        let measured =
            (n <= most).then(|| peers.run("hausdorff.py", &[&format!("N={n}"), "impl=numba", "alpha=60", "reps=3"]));
        let theirs = match measured {
            Some(Ok(peer)) => {
                let t = number(&peer, "time_s");
                known = Some((n as f64, t));
                Some((t, ""))
            }
            Some(Err(why)) => {
                eprintln!("numba skipped: {why}");
                None
            }
            None => known.map(|(size, t)| (t * (n as f64 / size).powi(2), " (scaled)")),
        };
        let told = theirs.map_or(("skipped".to_owned(), "-".to_owned()), |(t, note)| {
            (format!("{t:.3}{note}"), format!("{:.1}", t / seconds))
        });
        println!("| N = {n} | {seconds:.4} | {} | {} |", told.0, told.1);
    }
    Ok(())
}

fn scenarios() -> Result<(), Failure> {
    println!("\n| robust value and derivative | seconds | ratio | MB |\n|---|---|---|---|");
    // The eight differ in what they take: an average one of them on one thread is the measure.
    let alone = own("scenarios", &["count=8", "threads=1", "repeat=5"])?;
    let base = number(&alone, "value_and_derivative_s") / 8.0;
    println!("| one of 8 scenarios on average, 1 thread | {base:.3} | 1 | |");
    let eight = own("scenarios", &["count=8", "threads=2", "repeat=5"])?;
    let seconds = number(&eight, "value_and_derivative_s");
    println!("| 8 scenarios, 2 threads | {seconds:.3} | {:.2} | {:.0} |", seconds / base, number(&eight, "rss_mb"));
    Ok(())
}

impl Peers {
    /// On the ranks of `launch` with one thread each, else on one rank with two threads.
    fn run_parallel(&self, script: &str, arguments: &[&str]) -> Result<Value, String> {
        let Some((program, options)) = self.launch.split_first() else {
            return self.run(script, &[arguments, &["threads=2"]].concat());
        };
        let scripts = self.scripts.as_ref().ok_or("no peers=DIR given")?;
        let mut command = Command::new(program);
        command.current_dir(scripts).args(options).arg(&self.python).arg(script).args(arguments).arg("threads=1");
        last_json(command)
    }

    fn run(&self, script: &str, arguments: &[&str]) -> Result<Value, String> {
        let scripts = self.scripts.as_ref().ok_or("no peers=DIR given")?;
        let mut command = Command::new(&self.python);
        command.current_dir(scripts).arg(script).args(arguments);
        last_json(command)
    }
}

fn tell(peer: &Result<Value, String>, key: &str, digits: usize) -> String {
    match peer {
        Ok(peer) => format!("{:.digits$}", number(peer, key)),
        Err(why) => {
            eprintln!("skipped: {why}");
            "skipped".to_owned()
        }
    }
}

fn ratio(peer: &Result<Value, String>, key: &str, ours: f64) -> String {
    peer.as_ref().map_or("-".to_owned(), |peer| format!("{:.1}", number(peer, key) / ours))
}
