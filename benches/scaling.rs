//! Time and memory over sizes, and what of the machine is used: lines of JSON, which `scripts/plots.py` draws.
//!
//! `cargo bench --bench scaling -- out=scaling.jsonl [peers=DIR] [python=python3] [cells=5,7,12,18,30] [points=1000,10000]`:
//! the forward solve with hex8 (5n x n x n cells; hex27 at half of n where n is even), smoothed Hausdorff sums, and, where `peers` holds the script
//! `limits.py`, what the machine does at best. Every line is a process of its own. Run on an idle machine.

#![allow(clippy::print_stdout, clippy::print_stderr)] // programs talk, libraries do not

mod common;

use common::Arguments;
use common::process::{last_json, own};
use serde_json::{Value, json};
use std::fs::File;
use std::io::Write;
use std::process::Command;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["out", "peers", "python", "cells", "points"])?;
    let mut out = File::create(arguments.text("out", "scaling.jsonl"))?;
    let mut put = |kind: &str, line: Result<Value, String>| -> Result<(), Failure> {
        match line {
            Ok(value) => {
                println!("{kind}: {value}");
                writeln!(out, "{}", json!({ "kind": kind, "result": value }))?;
            }
            Err(why) => eprintln!("{kind} skipped: {why}"),
        }
        Ok(())
    };
    let peers = arguments.text("peers", "");
    if !peers.is_empty() {
        for threads in [1, 2] {
            let mut command = Command::new(arguments.text("python", "python3"));
            command.current_dir(&peers).arg("limits.py").arg(format!("threads={threads}"));
            put("limits", last_json(command))?;
        }
    }
    for n in arguments.text("cells", "5,7,12,18,30").split(',') {
        let n: usize = n.parse()?;
        let repeat = if n > 20 { "repeat=1" } else { "repeat=3" };
        put("forward", own("forward", &["element=hex8", &format!("n={n}"), repeat, "threads=2"]))?;
        if n.is_multiple_of(2) && n <= 18 {
            put("forward", own("forward", &["element=hex27", &format!("n={}", n / 2), "repeat=3", "threads=2"]))?;
        }
    }
    for n in arguments.text("points", "1000,3000,10000,30000,100000").split(',') {
        put("hausdorff", own("hausdorff_peer", &[&format!("n={n}"), "check=0", "reps=3"]))?;
    }
    Ok(())
}
