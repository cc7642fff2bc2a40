//! Where samples go, and text files written as they come.

use crate::cli::failure::Failure;
use fieldgraft::mesh::check_output;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where a frame goes.
pub enum Target {
    /// CSV to stdout.
    Stdout,
    /// A CSV file.
    Csv(PathBuf),
    /// Lines in an OBJ file: a curve or a spine.
    Lines(PathBuf),
    /// Triangles.
    Mesh(PathBuf),
}

impl Target {
    /// The target that a name stands for, if it can be written.
    pub fn new(path: Option<&Path>, spine: bool, force: bool) -> Result<Self, Failure> {
        let Some(path) = path else { return Ok(Self::Stdout) };
        let is = |x: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(x));
        if is("csv") {
            check_text(path, force)?;
            return Ok(Self::Csv(path.to_owned()));
        }
        if spine {
            if !is("obj") {
                let why = "a spine is written as .csv or .obj";
                return Err(Failure::usage(format!("{}: {why}", path.display())));
            }
            check_text(path, force)?;
            return Ok(Self::Lines(path.to_owned()));
        }
        if !["stl", "obj", "ply", "glb"].into_iter().any(is) {
            let why = "unknown format; expected .csv, .stl, .obj, .ply or .glb";
            return Err(Failure::usage(format!("{}: {why}", path.display())));
        }
        check_output(path, force)?;
        Ok(Self::Mesh(path.to_owned()))
    }

    /// The file.
    pub fn path(&self) -> Option<&PathBuf> {
        match self {
            Self::Stdout => None,
            Self::Csv(p) | Self::Lines(p) | Self::Mesh(p) => Some(p),
        }
    }
}

fn check_text(path: &Path, force: bool) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::usage(format!("{}: is a folder", path.display())));
    }
    if !force && path.symlink_metadata().is_ok() {
        let why = "exists already; overwrite it with --force";
        return Err(Failure::usage(format!("{}: {why}", path.display())));
    }
    Ok(())
}

/// What stops the writing of text.
pub enum Stop {
    /// The system.
    Io(io::Error),
    /// Something else.
    Failure(Failure),
}

impl From<io::Error> for Stop {
    fn from(e: io::Error) -> Self {
        Self::Io(e)
    }
}

impl From<Failure> for Stop {
    fn from(e: Failure) -> Self {
        Self::Failure(e)
    }
}

/// Text to stdout; a reader that went away ends the program without a word.
pub fn to_stdout(write: impl FnOnce(&mut dyn Write) -> Result<(), Stop>) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out).and_then(|()| Ok(out.flush()?)) {
        Ok(()) => Ok(()),
        Err(Stop::Failure(e)) => Err(e),
        Err(Stop::Io(e)) if e.kind() == ErrorKind::BrokenPipe => Err(Failure::new(0, "")),
        Err(Stop::Io(e)) => {
            Err(Failure::new(Failure::FAILED, format!("stdout: cannot be written: {e}")))
        }
    }
}

/// Text to a file, written beside its place and renamed into it.
pub fn to_file(
    path: &Path,
    force: bool,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Stop>,
) -> Result<(), Failure> {
    let fail = |e: io::Error| {
        let why = format!("{}: cannot be written: {e}", path.display());
        Failure::new(Failure::FAILED, why)
    };
    let mut out = BufWriter::new(fieldgraft::place::beside(path).map_err(fail)?);
    write(&mut out).map_err(|e| match e {
        Stop::Io(e) => fail(e),
        Stop::Failure(e) => e,
    })?;
    let file = out.into_inner().map_err(|e| fail(e.into_error()))?;
    let placed = if force { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map(drop).map_err(|e| fail(e.error))
}
