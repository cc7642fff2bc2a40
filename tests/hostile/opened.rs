//! What the system saw: with `strace`, every file that a command opened for a hostile glTF. Skipped,
//! with a word, where there is no strace or it may not trace.

use super::{Case, gltf, place};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What any program opens: its libraries, and what the system tells of itself.
const SYSTEM: [&str; 11] = [
    "/lib",
    "/usr/lib",
    "/nix/",
    "/etc/ld.so.",
    "/sys/",
    "/dev/null",
    "/proc/meminfo",
    "/proc/self/status",
    "/proc/self/limits",
    "/proc/self/cgroup",
    "/proc/self/maps",
];

/// The paths of a log that were opened, and whether that went well.
fn opened(log: &str) -> Vec<(PathBuf, bool)> {
    let call = |line: &str| {
        let (_, call) = line.split_once("open")?;
        let path = call.split('"').nth(1)?;
        let (_, result) = call.rsplit_once(" = ")?;
        Some((PathBuf::from(path), !result.starts_with('-')))
    };
    log.lines().filter_map(call).collect()
}

/// The files outside the folder that a command opened for this case.
fn strays(case: &Case) -> Option<(usize, Vec<String>)> {
    let root = tempfile::tempdir().unwrap();
    let folder = place(case, &root.path().join("outer")).canonicalize().unwrap();
    let log = root.path().join("trace");
    let done = Command::new("strace")
        .args(["-f", "-s", "4096", "-e", "trace=open,openat,openat2,creat", "-o"])
        .arg(&log)
        .arg(env!("CARGO_BIN_EXE_fieldgraft"))
        .args(["convert", "--threads", "1", "--resolution", "8", &case.file, "out.stl"])
        .current_dir(&folder)
        // else the system looks for its libraries where the compiler keeps some
        .env_remove("LD_LIBRARY_PATH")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    done.ok()?;
    let text = String::from_utf8_lossy(&fs::read(&log).ok()?).into_owned();
    let all = opened(&text);
    // a tracer that may not trace leaves an empty log
    let seen = all.iter().any(|(p, _)| *p == Path::new(&case.file));
    let stray = |(path, worked): &(PathBuf, bool)| {
        let at = folder.join(path);
        let real = at.canonicalize().unwrap_or_else(|_| at.clone());
        let system =
            SYSTEM.iter().any(|s| real.starts_with(s) || at.to_string_lossy().starts_with(s));
        // what failed was tried all the same, unless it is of the folder by its name and by its links
        let inside = real.starts_with(&folder) && !path.to_string_lossy().contains("..");
        (!inside && !system).then(|| format!("{}: {} ({worked})", case.what, path.display()))
    };
    seen.then(|| (all.len(), all.iter().filter_map(stray).collect()))
}

#[test]
fn a_gltf_opens_nothing_outside_its_folder() {
    use rayon::prelude::*;
    let cases = gltf::places();
    let seen: Vec<Option<(usize, Vec<String>)>> = cases.par_iter().map(strays).collect();
    let Some(seen) = seen.into_iter().collect::<Option<Vec<_>>>() else {
        println!("skipped: strace is not there, or may not trace");
        return;
    };
    let wrong: Vec<&String> = seen.iter().flat_map(|(_, stray)| stray).collect();
    let all: usize = seen.iter().map(|(n, _)| n).sum();
    println!("{} addresses, {all} files opened, none outside", cases.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_log_is_read_as_it_is_written() {
    let log = "12 openat(AT_FDCWD, \"/etc/passwd\", O_RDONLY|O_CLOEXEC) = 3\n\
               12 openat(AT_FDCWD, \"a.bin\", O_RDONLY) = -1 ENOENT (No such file or directory)\n\
               12 +++ exited with 0 +++\n";
    let want = vec![(PathBuf::from("/etc/passwd"), true), (PathBuf::from("a.bin"), false)];
    assert_eq!(opened(log), want);
}
