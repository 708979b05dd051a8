//! Large bodies: forward solve, gradient, memory and threads, as rows of a table.
//!
//! `cargo bench --bench large_bodies -- [sizes=hex8:18,hex8:30,hex27:15] [threads=1,2]`: the fibre cantilever with 5n x n x n cells,
//! solved once from rest and once more for the time (hex8: n = 18 is 98,553 unknowns, 30 is 435,333, 44 is 1,345,005; hex27 has as many
//! at half of n). Every row is a process of its own; its memory is the peak of the whole process after the first solve, body and controls included.
//! Run on an idle machine; speed-up is the time of the first number of threads over that of the last.

#![allow(clippy::print_stdout, clippy::print_stderr)] // programs talk, libraries do not

mod common;

use common::Arguments;
use common::process::{number, own};
use serde_json::Value;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["sizes", "threads"])?;
    let (sizes, threads) = (arguments.text("sizes", "hex8:18,hex8:30,hex27:15"), arguments.text("threads", "1,2"));
    println!(
        "| | unknowns | threads | solver | forward s | Newton | cycles | gradient s | gradient / forward | B per unknown | tip |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for size in sizes.split(',') {
        let (element, n) = size.split_once(':').ok_or(format!("element:n is wanted, not {size:?}"))?;
        let mut times = Vec::new();
        for threads in threads.split(',') {
            let given =
                [format!("element={element}"), format!("n={n}"), format!("threads={threads}"), "repeat=1".to_owned()];
            let given: Vec<&str> = given.iter().map(String::as_str).collect();
            match own("forward", &given) {
                Ok(found) => {
                    times.push(number(&found, "forward_s"));
                    row(&found);
                }
                Err(why) => eprintln!("{size} skipped: {why}"),
            }
        }
        if let (Some(first), Some(last)) = (times.first(), times.last().filter(|_| times.len() > 1)) {
            println!("{size}: {:.2}x", first / last);
        }
    }
    Ok(())
}

fn row(found: &Value) {
    let of = |key: &str| number(found, key);
    let (forward, gradient) = (of("forward_s"), of("gradient_s"));
    println!(
        "| {} | {} | {} | {} | {forward:.2} | {} | {} | {gradient:.2} | {:.3} | {:.0} | {} |",
        found["element"].as_str().unwrap_or_default(),
        found["ndof"],
        found["threads"],
        found["solver"].as_str().unwrap_or_default(),
        found["newton"],
        found["cycles"],
        gradient / forward,
        1_048_576.0 * of("solve_mb") / of("ndof"),
        found["tip_corner"]
    );
}
