//! What memory there is, asked before a factor is allocated: a typed error in the place of an abort.

use crate::error::FactorError;
use std::sync::OnceLock;

/// The variable of the environment that limits the memory of the process: bytes, or with a suffix `K`, `M`, `G` (powers of 1024).
pub const LIMIT: &str = "NASTIC_MEMORY";

/// Below this size the machine is not asked, only the limit of the user: asking takes as long as a small factor.
const SMALL: usize = 64 << 20;

/// Bytes that can still be allocated; `None` where nothing tells.
///
/// The least of what the system calls available (`MemAvailable` of `/proc/meminfo`), what the control group leaves
/// (`memory.max` less `memory.current`), and [`LIMIT`] less the resident size of the process. On systems without `/proc` that is
/// [`LIMIT`] itself.
pub fn available() -> Option<usize> {
    [of_system(), of_control_group(), of_limit()].into_iter().flatten().min()
}

/// Whether so many bytes more can be allocated for `what`.
///
/// # Errors
/// [`FactorError::Memory`].
pub(crate) fn check(what: &'static str, needed: usize) -> Result<(), FactorError> {
    let available = if needed < SMALL { of_limit() } else { available() };
    match available {
        Some(available) if needed > available => Err(FactorError::Memory { what, needed, available }),
        _ => Ok(()),
    }
}

fn of_limit() -> Option<usize> {
    static SET: OnceLock<Option<usize>> = OnceLock::new();
    let limit = *SET.get_or_init(|| parse(&std::env::var(LIMIT).ok()?));
    limit.map(|limit| limit.saturating_sub(resident().unwrap_or(0)))
}

/// `"1500M"`; a text that is no size is no limit.
fn parse(text: &str) -> Option<usize> {
    let text = text.trim();
    let (digits, unit) = match text.chars().last()?.to_ascii_uppercase() {
        'K' => (&text[..text.len() - 1], 10),
        'M' => (&text[..text.len() - 1], 20),
        'G' => (&text[..text.len() - 1], 30),
        _ => (text, 0),
    };
    digits.trim().parse::<usize>().ok()?.checked_mul(1 << unit)
}

fn of_system() -> Option<usize> {
    kilobytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

fn resident() -> Option<usize> {
    kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// The value of a line such as `MemAvailable:   12345 kB`, in bytes.
fn kilobytes(text: &str, key: &str) -> Option<usize> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<usize>().ok()?.checked_mul(1024)
}

fn of_control_group() -> Option<usize> {
    let read =
        |name: &str| std::fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?.trim().parse::<usize>().ok();
    Some(read("memory.max")?.saturating_sub(read("memory.current")?))
}

#[cfg(test)]
mod tests {
    use super::{kilobytes, parse};

    #[test]
    fn sizes_are_read() {
        assert_eq!(
            [parse("1500M"), parse("2g"), parse("7"), parse("3 K")],
            [1500 << 20, 2 << 30, 7, 3 << 10].map(Some)
        );
        assert_eq!([parse("many"), parse(""), parse("-1")], [None; 3]);
        assert_eq!(kilobytes("A: 1 kB\nMemAvailable:    12 kB\n", "MemAvailable:"), Some(12 << 10));
    }
}
