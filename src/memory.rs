//! What the system says about memory; nothing where it does not tell.

use std::fs;

/// Makes [`peak_memory`] count from now on; false where the system cannot.
pub fn reset_peak() -> bool {
    // "5" resets the peak resident set (proc_pid_clear_refs(5))
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Largest resident set of this process so far, bytes; `None` where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    kib(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Resident set of this process now, bytes; `None` where the system does not tell.
pub fn resident_memory() -> Option<u64> {
    kib(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Memory that can be had without swapping, bytes, within the limits that this process has.
pub fn available_memory() -> Option<u64> {
    let free = kib(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    let space = address_space().map(|limit| {
        let taken = fs::read_to_string("/proc/self/status").ok();
        // what is only reserved, such as the heaps of threads, can still be used
        limit.saturating_sub(taken.and_then(|t| kib(&t, "VmRSS:")).unwrap_or(0))
    });
    Some([group_limit(), space].into_iter().flatten().fold(free, u64::min))
}

/// Most address space that this process may have (`ulimit -v`), bytes; `None` for any.
pub fn address_space() -> Option<u64> {
    soft_limit(&fs::read_to_string("/proc/self/limits").ok()?, "Max address space")
}

/// The soft limit behind a label of `/proc/self/limits`.
fn soft_limit(text: &str, label: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(label))?;
    line.split_whitespace().next()?.parse().ok()
}

/// What a control group leaves of its limit, bytes.
fn group_limit() -> Option<u64> {
    let number = |file: &str| -> Option<u64> {
        fs::read_to_string(format!("/sys/fs/cgroup/{file}")).ok()?.trim().parse().ok()
    };
    Some(number("memory.max")?.saturating_sub(number("memory.current").unwrap_or(0)))
}

/// The number of kibibytes behind a label, in bytes.
fn kib(text: &str, label: &str) -> Option<u64> {
    let line = text.lines().find(|l| l.starts_with(label))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|k| k * 1024)
}

#[cfg(test)]
mod tests {
    use super::{kib, soft_limit};

    #[test]
    fn reads_a_line_of_proc() {
        let text = "VmPeak:\t  100 kB\nVmHWM:\t   12 kB\n";
        assert_eq!(kib(text, "VmHWM:"), Some(12 * 1024));
        assert_eq!(kib(text, "VmRSS:"), None);
        let text = "Max stack size      8388608   unlimited   bytes\n\
                    Max address space   unlimited unlimited   bytes\n";
        assert_eq!(soft_limit(text, "Max stack size"), Some(8_388_608));
        assert_eq!(soft_limit(text, "Max address space"), None);
    }
}
