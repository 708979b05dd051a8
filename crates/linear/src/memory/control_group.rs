//! What the control groups of the process leave of their memory.

use std::path::Path;

/// Where a version of control groups reports memory.
struct Version {
    /// The directory of the uppermost group.
    root: &'static str,
    limit: &'static str,
    usage: &'static str,
    /// Keys of `memory.stat`: cached files.
    files: [&'static str; 2],
}

const ONE: Version = Version {
    root: "/sys/fs/cgroup/memory",
    limit: "memory.limit_in_bytes",
    usage: "memory.usage_in_bytes",
    files: ["total_inactive_file", "total_active_file"],
};

const TWO: Version = Version {
    root: "/sys/fs/cgroup",
    limit: "memory.max",
    usage: "memory.current",
    files: ["inactive_file", "active_file"],
};

/// Bytes that the groups of the process leave; `None` without a limit.
pub(super) fn left() -> Option<usize> {
    let read = |path: &Path| std::fs::read_to_string(path).ok();
    of_groups(&read(Path::new("/proc/self/cgroup"))?, &read)
}

/// The least of all groups of `groups`, the text of `/proc/self/cgroup`, and of those above them.
fn of_groups(groups: &str, read: &dyn Fn(&Path) -> Option<String>) -> Option<usize> {
    groups.lines().filter_map(group).filter_map(|(version, path)| of_ancestors(version, path, read)).min()
}

/// `0::/path` of version 2, `4:cpu,memory:/path` of version 1.
fn group(line: &str) -> Option<(&'static Version, &str)> {
    let mut parts = line.splitn(3, ':');
    let (number, controllers, path) = (parts.next()?, parts.next()?, parts.next()?);
    match (number, controllers) {
        ("0", "") => Some((&TWO, path)),
        _ if controllers.split(',').any(|name| name == "memory") => Some((&ONE, path)),
        _ => None,
    }
}

/// The least that a group and those above it leave. In a container the path may be that of the machine, of which only the
/// uppermost directory is there.
fn of_ancestors(version: &Version, path: &str, read: &dyn Fn(&Path) -> Option<String>) -> Option<usize> {
    let below = Path::new(path.trim_start_matches('/'));
    let of = |group: &Path| {
        let file = |name: &str| read(&Path::new(version.root).join(group).join(name));
        of_group(&file(version.limit)?, &file(version.usage)?, &file("memory.stat").unwrap_or_default(), version.files)
    };
    below.ancestors().filter_map(of).min()
}

/// The limit less the usage, to which cached files do not count: the system gives them up before it refuses memory.
fn of_group(limit: &str, usage: &str, stat: &str, files: [&str; 2]) -> Option<usize> {
    // `max` is no limit.
    let bytes = |text: &str| text.trim().parse::<usize>().ok();
    let value = |key: &str| stat.lines().find_map(|line| bytes(line.strip_prefix(key)?.strip_prefix(' ')?));
    let cached = files.into_iter().filter_map(value).fold(0, usize::saturating_add);
    Some(bytes(limit)?.saturating_sub(bytes(usage)?.saturating_sub(cached)))
}

#[cfg(test)]
mod tests {
    use super::{ONE, TWO, of_group, of_groups};
    use std::path::Path;

    #[test]
    fn cached_files_are_available() {
        let stat = "anon 300\nfile 500\ninactive_file 400\nactive_file 100\nslab 7\n";
        assert_eq!(of_group("1000\n", "900\n", stat, TWO.files), Some(600));
        assert_eq!(of_group("1000\n", "900\n", "", TWO.files), Some(100));
        assert_eq!(of_group("1000", "1100", "", TWO.files), Some(0));
        assert_eq!(of_group("max\n", "900\n", stat, TWO.files), None);
        // Without the groups below, the keys of version 1 are others.
        let stat = "inactive_file 1\nactive_file 2\ntotal_inactive_file 30\ntotal_active_file 40\n";
        assert_eq!(of_group("1000", "900", stat, ONE.files), Some(170));
    }

    #[test]
    fn the_least_of_the_groups_above_counts() {
        let read = |path: &Path| {
            let text = match path.to_str()? {
                "/sys/fs/cgroup/user/job/memory.max" => "max",
                "/sys/fs/cgroup/user/job/memory.current" => "50",
                "/sys/fs/cgroup/user/memory.max" => "1000",
                "/sys/fs/cgroup/user/memory.current" => "400",
                "/sys/fs/cgroup/user/memory.stat" => "inactive_file 10\nactive_file 20",
                "/sys/fs/cgroup/memory.max" => "2000",
                "/sys/fs/cgroup/memory.current" => "500",
                "/sys/fs/cgroup/memory/memory.limit_in_bytes" => "300",
                "/sys/fs/cgroup/memory/memory.usage_in_bytes" => "120",
                _ => return None,
            };
            Some(text.to_owned())
        };
        assert_eq!(of_groups("0::/user/job\n", &read), Some(630));
        assert_eq!(of_groups("0::/\n", &read), Some(1500));
        assert_eq!(of_groups("0::/elsewhere/of/the/machine\n", &read), Some(1500));
        // Both versions at a time, as version 1 shows them in a container.
        let both = "9:cpu,cpuacct:/a\n4:memory:/docker/0f3a\n1:name=systemd:/b:c\n0::/user\n";
        assert_eq!(of_groups(both, &read), Some(180));
        assert_eq!(of_groups("9:cpu:/a\nnonsense\n", &read), None);
    }
}
