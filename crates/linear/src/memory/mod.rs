//! What memory there is, asked before a factor is allocated: a typed error in the place of an abort.

mod control_group;
mod packing;

use crate::error::FactorError;
use packing::Buffers;
use std::sync::OnceLock;

/// The variable of the environment that limits the memory of the process: see [`limit`].
pub const LIMIT: &str = "NASTIC_MEMORY";

/// Size from which the memory of the machine is queried, not the limit of the user alone: a query takes as long as a small factor.
const MIN_CHECKED_BYTES: usize = 64 << 20;
/// Size of the first factor before which it is queried too: from it on dense products allocate their buffers.
const MIN_BUFFERED_BYTES: usize = 128 << 10;

/// [`LIMIT`] holds a text that is no size.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{LIMIT}=\"{text}\" is no size of memory: give bytes, or a number with one of the suffixes K, M, G, T (powers of 1024; B or \
     iB may follow), such as 1500M, 8.5G or 8GiB"
)]
pub struct LimitError {
    /// The text found.
    pub text: String,
}

/// Bytes that can still be allocated; `None` where nothing is known.
///
/// The least of what the system calls available (`MemAvailable` of `/proc/meminfo`), what the control groups of the process leave, its
/// limits of address space and of data (`ulimit -v`, `ulimit -d`) less what it has and the buffers of dense products, which are as large as caches are, and [`limit`] less the resident size of the process. A control group (version 1 or 2), and each one above it, leaves its limit less
/// its usage without the cached files, which the system gives up before it refuses memory. On systems without `/proc` only
/// [`limit`] counts.
///
/// # Errors
/// [`LimitError`].
pub fn available() -> Result<Option<usize>, LimitError> {
    Ok([of_system(), control_group::left(), of_resources(), of_limit()?].into_iter().flatten().min())
}

/// What [`LIMIT`] allows the process, in bytes; `None` if it is not set. It is read once.
///
/// A number, which may have decimals, and one of the suffixes `K`, `M`, `G`, `T` for powers of 1024, in either case; `B` or `iB` may
/// follow.
///
/// # Errors
/// [`LimitError`] if it is set to anything else.
pub fn limit() -> Result<Option<usize>, LimitError> {
    static SET: OnceLock<Result<Option<usize>, LimitError>> = OnceLock::new();
    let read = || std::env::var_os(LIMIT).map(|text| parse(&text.to_string_lossy())).transpose();
    SET.get_or_init(read).clone()
}

/// Whether `needed` more bytes can be allocated for `what`.
///
/// # Errors
/// [`FactorError::Memory`], [`FactorError::Limit`].
pub(crate) fn check(what: &'static str, needed: usize) -> Result<(), FactorError> {
    compare(what, needed, if needed < MIN_CHECKED_BYTES { of_limit()? } else { available()? })
}

/// The same of a factor, whose dense products have buffers.
///
/// # Errors
/// As [`check`].
pub(crate) fn check_factor(what: &'static str, needed: usize) -> Result<(), FactorError> {
    let uses = match needed {
        0..MIN_BUFFERED_BYTES => Buffers::None,
        MIN_BUFFERED_BYTES..MIN_CHECKED_BYTES => Buffers::OfOneThread,
        _ => Buffers::OfAll,
    };
    let first = packing::made() < uses;
    compare(what, needed, if needed < MIN_CHECKED_BYTES && !first { of_limit()? } else { available()? })?;
    packing::make(uses);
    Ok(())
}

fn compare(what: &'static str, needed: usize, available: Option<usize>) -> Result<(), FactorError> {
    match available {
        Some(available) if needed > available => Err(FactorError::Memory { what, needed, available }),
        _ => Ok(()),
    }
}

fn of_limit() -> Result<Option<usize>, LimitError> {
    Ok(limit()?.map(|limit| limit.saturating_sub(resident().unwrap_or(0))))
}

/// `"1500M"`, `"8.5 GiB"`.
fn parse(text: &str) -> Result<usize, LimitError> {
    size(&text.trim().to_ascii_lowercase()).ok_or_else(|| LimitError { text: text.to_owned() })
}

fn size(text: &str) -> Option<usize> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match &text[digits.len()..] {
        "" => 0,
        "k" | "kb" | "kib" => 1,
        "m" | "mb" | "mib" => 2,
        "g" | "gb" | "gib" => 3,
        "t" | "tb" | "tib" => 4,
        _ => return None,
    };
    let digits = digits.trim_end();
    // Neither signs nor exponents.
    let plain = digits.chars().all(|c| c.is_ascii_digit() || c == '.');
    let number = digits.parse::<f64>().ok().filter(|_| plain)?;
    Some((number * 1024_f64.powi(power)) as usize)
}

/// Largest resident size of the process so far, in bytes; `None` on systems without `/proc`.
#[must_use]
pub fn peak() -> Option<usize> {
    kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

fn of_system() -> Option<usize> {
    kilobytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// What `ulimit -v` and `ulimit -d` leave beside the buffers of dense products; `None` without such limits.
fn of_resources() -> Option<usize> {
    let read = |file: &str| std::fs::read_to_string(file).ok();
    let left = left_of_resources(&read("/proc/self/limits")?, &read("/proc/self/status")?)?;
    Some(left.saturating_sub(packing::buffers()))
}

fn left_of_resources(limits: &str, status: &str) -> Option<usize> {
    let left = |(name, key): (&str, &str)| {
        let line = limits.lines().find_map(|line| line.strip_prefix(name))?;
        let limit: usize = line.split_whitespace().next()?.parse().ok()?;
        Some(limit.saturating_sub(kilobytes(status, key)?))
    };
    [("Max address space", "VmSize:"), ("Max data size", "VmData:")].into_iter().filter_map(left).min()
}

fn resident() -> Option<usize> {
    kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// The value of a line such as `MemAvailable:   12345 kB`, in bytes.
fn kilobytes(text: &str, key: &str) -> Option<usize> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<usize>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::{LIMIT, kilobytes, left_of_resources, parse};

    #[test]
    fn sizes_are_read() {
        let cases = [
            ("1500M", 1500 << 20),
            ("2g", 2 << 30),
            ("7", 7),
            ("3 K", 3 << 10),
            ("8GB", 8 << 30),
            ("8GiB", 8 << 30),
            (" 8.5 G ", 17 << 29),
            ("0.5t", 1 << 39),
            ("0", 0),
        ];
        cases.iter().for_each(|(text, bytes)| assert_eq!(parse(text), Ok(*bytes), "{text}"));
        assert_eq!(kilobytes("A: 1 kB\nMemAvailable:    12 kB\n", "MemAvailable:"), Some(12 << 10));
    }

    #[test]
    fn limits_of_address_space_and_of_data_count() {
        let status = "VmSize:\t    3 kB\nVmData:\t    2 kB\n";
        let limits = |data: &str, space: &str| {
            format!(
                "Limit   Soft Limit  Hard Limit  Units\nMax data size   {data}  unlimited  bytes\nMax address space  {space}  unlimited  bytes\n"
            )
        };
        assert_eq!(left_of_resources(&limits("unlimited", "unlimited"), status), None);
        assert_eq!(left_of_resources(&limits("unlimited", "5120"), status), Some(2048));
        assert_eq!(left_of_resources(&limits("3072", "5120"), status), Some(1024));
        assert_eq!(left_of_resources(&limits("1024", "unlimited"), status), Some(0));
    }

    #[test]
    fn what_is_no_size_is_refused() {
        for text in
            ["lots", "", "-1", "+1", "1e9", "inf", "nan", "8X", "8iB", "8.5.1G", ".", "G", "8 G B", "8G 1M", "8\u{e9}"]
        {
            let shown = parse(text).unwrap_err().to_string();
            assert!(shown.contains(&format!("{LIMIT}=\"{text}\"")) && shown.contains("8.5G"), "{shown}");
        }
    }
}
