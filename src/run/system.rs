//! What the machine says about memory.

use serde::Serialize;
use std::fs;

/// The machine a run was made on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Operating system and its kernel's version, as far as it tells.
    pub os: String,
    /// Kind of processor.
    pub arch: String,
    /// Its name, as far as the system tells.
    pub processor: Option<String>,
    /// Cores that the program may use.
    pub cores: usize,
    /// Threads used.
    pub threads: usize,
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        let told = |file: &str| fs::read_to_string(file).ok();
        let kernel = told("/proc/sys/kernel/osrelease").unwrap_or_default();
        let processor = told("/proc/cpuinfo").and_then(|text| {
            let line = text.lines().find(|l| l.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
        Self {
            os: format!("{} {}", std::env::consts::OS, kernel.trim()).trim_end().to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            processor,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
        }
    }
}

/// Makes [`peak_memory`] count from now on; false where the system cannot.
pub fn reset_peak() -> bool {
    // "5" resets the peak resident set (proc_pid_clear_refs(5))
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Largest resident set of this process so far, bytes; `None` where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    kib(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Memory that can be had without swapping, bytes, within the process's own limit.
pub fn available_memory() -> Option<u64> {
    let free = kib(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    Some(group_limit().map_or(free, |limit| limit.min(free)))
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
    use super::kib;

    #[test]
    fn reads_a_line_of_proc() {
        let text = "VmPeak:\t  100 kB\nVmHWM:\t   12 kB\n";
        assert_eq!(kib(text, "VmHWM:"), Some(12 * 1024));
        assert_eq!(kib(text, "VmRSS:"), None);
    }
}
