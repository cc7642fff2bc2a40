//! Files made to do harm, written and given to the built command: each must be refused with a few
//! plain words. Every case runs with 256 MB of address space, beside traps that are valid where they
//! must not be opened.

mod gltf;
mod links;
mod meshes;
mod opened;
mod recipes;
mod surfaces;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A hang, not slowness: a file takes milliseconds.
const HANGS: Duration = Duration::from_secs(60);
/// Address space a command may have, KiB. Its memory is part of that.
const SPACE: &str = "262144";

/// How a file is given to the command.
#[derive(Clone, Copy, PartialEq)]
pub enum As {
    Mesh,
    Recipe,
    Surface,
}

/// A hostile file, those beside it, and what must be said.
pub struct Case {
    pub what: String,
    pub file: String,
    pub bytes: Vec<u8>,
    pub beside: Vec<(String, Vec<u8>)>,
    pub says: Vec<String>,
    pub given: As,
    /// The exit code of each command that it is given to.
    pub ends: [i32; 3],
}

impl Case {
    pub fn new(given: As, file: &str, what: &str, bytes: impl Into<Vec<u8>>) -> Self {
        let (what, file, bytes) = (what.to_owned(), file.to_owned(), bytes.into());
        Self { what, file, bytes, beside: vec![], says: vec![], given, ends: [3; 3] }
    }

    pub fn says(mut self, part: &str) -> Self {
        self.says.push(part.to_owned());
        self
    }

    /// Odd rather than wrong: it is read.
    pub fn harmless(self) -> Self {
        self.ends([0; 3])
    }

    /// The exit codes, where they are not 3: of `convert`, `check` and `picture`, or of the command for
    /// the text.
    pub fn ends(mut self, codes: [i32; 3]) -> Self {
        self.ends = codes;
        self
    }

    pub fn beside(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.beside.push((name.to_owned(), bytes.into()));
        self
    }
}

/// What a command did.
pub struct Did {
    pub code: Option<i32>,
    pub signal: Option<i32>,
    pub hung: bool,
    pub stderr: Vec<u8>,
    pub stdout: Vec<u8>,
}

/// Runs the command with little address space and a watch on hanging.
pub fn run(args: &[&std::ffi::OsStr], folder: &Path, logs: &Path) -> Did {
    let log = |name: &str| logs.join(name);
    let to = |name: &str| Stdio::from(fs::File::create(log(name)).unwrap());
    let limited = format!("ulimit -v {SPACE}; exec \"$0\" --threads 2 \"$@\"");
    let mut child = Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_fieldgraft")])
        .args(args)
        .current_dir(folder)
        .env_remove("RUST_BACKTRACE")
        .stdin(Stdio::null())
        .stdout(to("stdout"))
        .stderr(to("stderr"))
        .spawn()
        .unwrap();
    let start = Instant::now();
    let mut hung = false;
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None if start.elapsed() > HANGS => {
                hung = true;
                child.kill().unwrap();
                break child.wait().unwrap();
            }
            None => std::thread::sleep(Duration::from_millis(4)),
        }
    };
    let read = |name: &str| fs::read(log(name)).unwrap();
    let (code, signal) = (status.code(), status.signal());
    Did { code, signal, hung, stderr: read("stderr"), stdout: read("stdout") }
}

/// Everything below a folder, by name, with sizes; links and pipes are not followed.
pub fn listing(folder: &Path) -> Vec<(PathBuf, u64)> {
    let mut all = vec![];
    let mut todo = vec![folder.to_owned()];
    while let Some(at) = todo.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let entry = entry.unwrap();
            let about = entry.metadata().unwrap();
            if about.is_dir() {
                todo.push(entry.path());
            }
            all.push((entry.path(), if about.is_file() { about.len() } else { 0 }));
        }
    }
    all.sort();
    all
}

/// What is wrong with how the command took a bad file; nothing, if all is well.
pub fn faults(did: &Did, shown_name: &str, says: &[String], ends: i32) -> Vec<String> {
    let mut wrong = vec![];
    let text = String::from_utf8_lossy(&did.stderr).into_owned();
    if did.hung {
        wrong.push("it hung".to_owned());
    }
    if did.code != Some(ends) {
        wrong.push(format!("exit {:?}, signal {:?}, not {ends}", did.code, did.signal));
    }
    for (stream, bytes) in [("stderr", &did.stderr), ("stdout", &did.stdout)] {
        let bad = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
        if String::from_utf8_lossy(bytes).chars().any(bad) {
            wrong.push(format!("control codes on {stream}"));
        }
    }
    if ends != 0 {
        let lines = text.lines().count();
        if !(1..=3).contains(&lines) || text.len() > 2000 {
            wrong.push(format!("{lines} lines, {} bytes on stderr", text.len()));
        }
        for part in says.iter().map(String::as_str).chain(["error: ", shown_name]) {
            if !text.contains(part) {
                wrong.push(format!("does not say `{part}`"));
            }
        }
    }
    if !wrong.is_empty() {
        let text: String = text.chars().take(600).collect();
        wrong.push(format!("stderr: {text:?}"));
    }
    wrong
}

/// The commands that a case is given to.
fn commands(case: &Case, nth: usize) -> Vec<Vec<&str>> {
    let file = case.file.as_str();
    let convert = vec!["convert", "--resolution", "8", file, "out.stl"];
    let picture = vec!["picture", file, "-o", "out.png", "--size", "16x16"];
    match case.given {
        As::Mesh if nth.is_multiple_of(5) => vec![convert, vec!["check", file], picture],
        As::Mesh => vec![convert],
        As::Recipe => vec![vec!["run", file, "-o", "out"]],
        As::Surface => vec![vec!["surface", file, "--samples", "5x5", "-o", "out.csv"]],
    }
}

/// Where the file and its traps lie: a folder in a folder.
fn place(case: &Case, outer: &Path) -> PathBuf {
    let folder = outer.join("in");
    fs::create_dir_all(folder.join("sub")).unwrap();
    // a buffer that would do, and a mesh: whoever opens them is content
    fs::write(outer.join("trap.bin"), gltf::buffer()).unwrap();
    fs::write(outer.join("trap.obj"), meshes::OBJ).unwrap();
    fs::write(folder.join(&case.file), &case.bytes).unwrap();
    for (name, bytes) in &case.beside {
        fs::write(folder.join(name), bytes).unwrap();
    }
    std::os::unix::fs::symlink("../trap.bin", folder.join("link.bin")).unwrap();
    std::os::unix::fs::symlink("nowhere", folder.join("dangling.bin")).unwrap();
    std::os::unix::fs::symlink("loop.bin", folder.join("loop.bin")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.join("zero.bin")).unwrap();
    links::fifo(&folder.join("pipe.bin"));
    folder
}

fn judge(cases: &[Case]) {
    use rayon::prelude::*;
    let wrong: Vec<String> = cases
        .par_iter()
        .enumerate()
        .flat_map_iter(|(nth, case)| {
            let root = tempfile::tempdir().unwrap();
            let outer = root.path().join("outer");
            let folder = place(case, &outer);
            let before = listing(&outer);
            let mut wrong = vec![];
            for (at, args) in commands(case, nth).into_iter().enumerate() {
                let args: Vec<&std::ffi::OsStr> = args.iter().map(std::ffi::OsStr::new).collect();
                let did = run(&args, &folder, root.path());
                let mut found = faults(&did, &case.file, &case.says, case.ends[at]);
                if case.ends[at] != 0 && listing(&outer) != before {
                    found.push("something was written".to_owned());
                }
                wrong.extend(found.iter().map(|w| format!("{} ({}): {w}", case.what, case.file)));
                for made in ["out.stl", "out.run.json", "out.png", "out.csv"] {
                    let _ = fs::remove_file(folder.join(made));
                }
            }
            wrong
        })
        .collect();
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn hostile_meshes_are_refused() {
    judge(&meshes::all());
}

#[test]
fn hostile_gltf_is_refused() {
    judge(&gltf::all());
}

#[test]
fn hostile_recipes_are_refused() {
    judge(&recipes::all());
}

#[test]
fn hostile_surfaces_are_refused() {
    judge(&surfaces::all());
}

#[test]
fn there_are_enough_of_them() {
    let counts = [meshes::all(), gltf::all(), recipes::all(), surfaces::all()].map(|c| c.len());
    let all = counts.iter().sum::<usize>() + links::COUNT;
    println!("{all} hostile files, names and places");
    assert!(all >= 300, "{counts:?} and {} links: {all}", links::COUNT);
}
