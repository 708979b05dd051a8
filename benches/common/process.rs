//! Programs that are run for the JSON they print last.

use serde_json::Value;
use std::process::Command;

/// One of our own bench programs.
pub fn own(bench: &str, arguments: &[&str]) -> Result<Value, String> {
    let mut command = Command::new(std::env::var("CARGO").unwrap_or("cargo".to_owned()));
    command.args(["bench", "--quiet", "--locked", "--bench", bench, "--"]).args(arguments);
    last_json(command)
}

pub fn last_json(mut command: Command) -> Result<Value, String> {
    let done = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    let line = text.lines().rev().find(|line| line.starts_with('{'));
    let found = line.and_then(|line| serde_json::from_str(line).ok());
    found.ok_or_else(|| {
        let why = String::from_utf8_lossy(&done.stderr).lines().last().unwrap_or_default().to_owned();
        format!("{command:?} printed no result: {why}")
    })
}

pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::NAN)
}
