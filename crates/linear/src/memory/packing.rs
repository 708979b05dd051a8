//! Buffers of dense products: address space that the products of a factor take beside it.
//!
//! `private-gemm-x86` 0.1, which `faer` multiplies with, keeps two buffers on each thread, each as large as the third cache of one core times the number of cores.
//! They are hardly touched, so that resident memory does not show them, but limits of address space and of data count them: 600 MiB a thread where the cache has 300.

use std::sync::atomic::{AtomicU8, Ordering};

/// Which threads have their buffers: those are in what the process has. Small factors are made on one thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Buffers {
    None,
    OfOneThread,
    OfAll,
}

static MADE: AtomicU8 = AtomicU8::new(Buffers::None as u8);

pub(super) fn made() -> Buffers {
    match MADE.load(Ordering::Relaxed) {
        0 => Buffers::None,
        1 => Buffers::OfOneThread,
        _ => Buffers::OfAll,
    }
}

/// A factor is made that needs them.
pub(super) fn make(buffers: Buffers) {
    MADE.fetch_max(buffers as u8, Ordering::Relaxed);
}

/// Bytes of the buffers on all threads that are still to be made; 0 where the cache is not known.
pub(super) fn buffers() -> usize {
    let threads = rayon::current_num_threads();
    let lacking = match made() {
        Buffers::None => threads,
        Buffers::OfOneThread => threads - 1,
        Buffers::OfAll => return 0,
    };
    let read = |name: &str| std::fs::read_to_string(format!("/sys/devices/system/cpu/cpu0/cache/index3/{name}")).ok();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let of_thread = || of_one_thread(&read("size")?, &read("shared_cpu_list")?, cores);
    of_thread().unwrap_or(0).saturating_mul(lacking)
}

/// `"307200K"` shared by the processors `"0-3,8"`.
fn of_one_thread(size: &str, shared: &str, cores: usize) -> Option<usize> {
    let kilobytes: usize = size.trim().strip_suffix('K')?.parse().ok()?;
    let sharing = shared.trim().split(',').map(|range| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        let (first, last): (usize, usize) = (first.parse().ok()?, last.parse().ok()?);
        last.checked_sub(first).map(|more| more + 1)
    });
    let sharing = sharing.sum::<Option<usize>>().filter(|sharing| *sharing > 0)?;
    Some(2 * kilobytes * 1024 / sharing * cores)
}

#[cfg(test)]
mod tests {
    use super::of_one_thread;

    #[test]
    fn two_buffers_as_large_as_the_cache_of_all_cores() {
        assert_eq!(of_one_thread("307200K\n", "0-1\n", 2), Some(600 << 20));
        assert_eq!(of_one_thread("32768K\n", "0-3,8-11\n", 16), Some(128 << 20));
        assert_eq!(of_one_thread("1024K", "5", 1), Some(2 << 20));
        assert_eq!(of_one_thread("32M", "0-1", 2), None);
        assert_eq!(of_one_thread("1024K", "", 2), None);
    }
}
