//! A folder of its own for each test, the command run in it, and what it did.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder that goes away with the test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn join(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a text file.
    pub fn put(&self, name: &str, text: &str) -> PathBuf {
        let path = self.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    }

    /// Names of all files in the folder, hidden ones too, sorted.
    pub fn names(&self) -> Vec<String> {
        let all = fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> =
            all.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the command in the folder.
    pub fn run(&self, args: &[&str]) -> Ran {
        let output = self.command(args).output().unwrap();
        Ran { line: args.join(" "), folder: self.path().to_owned(), output }
    }

    /// The command, to be run in the folder.
    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fieldgraft"));
        command.args(args).current_dir(self.path());
        command
    }
}

/// A finished command.
pub struct Ran {
    line: String,
    folder: PathBuf,
    output: Output,
}

impl Ran {
    pub fn code(&self) -> i32 {
        self.output.status.code().unwrap_or(-1)
    }
    pub fn stdout(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }
    pub fn stderr(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    /// Fails the test unless it ended with this code.
    #[track_caller]
    pub fn ends(self, code: i32) -> Self {
        assert_eq!(self.code(), code, "{self}");
        self
    }

    /// Fails the test unless it ended with this code and an error that holds all of these.
    #[track_caller]
    pub fn fails(self, code: i32, parts: &[&str]) -> Self {
        let ran = self.ends(code);
        let stderr = ran.stderr();
        assert!(stderr.contains("error: "), "{ran}");
        for part in parts {
            assert!(stderr.contains(part), "missing: {part}\n{ran}");
        }
        ran
    }
}

impl fmt::Display for Ran {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "fieldgraft {}\nin {}\n{}\n--- stdout\n{}\n--- stderr\n{}",
            self.line,
            self.folder.display(),
            self.output.status,
            self.stdout(),
            self.stderr()
        )
    }
}

/// A box of these half sizes round a centre, as OBJ with Z up.
pub fn block(centre: [f64; 3], half: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let side = |axis: usize| {
            if i >> axis & 1 == 1 { half[axis] } else { -half[axis] }
        };
        let p: Vec<String> = (0..3).map(|a| (centre[a] + side(a)).to_string()).collect();
        text += &format!("v {}\n", p.join(" "));
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// Numbers that look random and are the same everywhere (Marsaglia's xorshift, 2003).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// A number in [0, 1).
    pub fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A vector in [-1, 1)³.
    pub fn vector(&mut self) -> glam::DVec3 {
        glam::DVec3::from([0, 1, 2].map(|_| self.share() * 2.0 - 1.0))
    }
}
