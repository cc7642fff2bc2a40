//! What the machine is.

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
