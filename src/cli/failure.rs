//! What ends a command early: an exit code and one short paragraph.

use fieldgraft::job::Cancelled;
use fieldgraft::mesh::MeshError;
use fieldgraft::picture::PictureError;
use fieldgraft::recipe::RecipeError;
use fieldgraft::run::RunError;
use fieldgraft::scene::SceneError;
use std::io::Write;

/// An exit code and its message.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub code: u8,
    /// The message, without `error:`; empty for none.
    pub message: String,
}

impl Failure {
    /// The run failed.
    pub const FAILED: u8 = 1;
    /// The command line asks for what cannot be.
    pub const USAGE: u8 = 2;
    /// A mesh or a recipe is bad.
    pub const INPUT: u8 = 3;
    /// Made, but not printable.
    pub const UNPRINTABLE: u8 = 4;
    /// Over a limit.
    pub const LIMIT: u8 = 5;
    /// Interrupted.
    pub const INTERRUPTED: u8 = 130;

    /// With this code and message.
    pub fn new(code: u8, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    /// A usage error.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(Self::USAGE, message)
    }

    /// A bad input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(Self::INPUT, message)
    }

    /// Prints the message to stderr.
    pub fn tell(&self) {
        if !self.message.is_empty() {
            // nowhere is left to complain to if stderr is gone
            let _ = writeln!(std::io::stderr(), "error: {}", self.message);
        }
    }
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::new(Self::INTERRUPTED, "interrupted; nothing was left half written")
    }
}

impl From<RecipeError> for Failure {
    fn from(e: RecipeError) -> Self {
        Self::input(e.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(e: SceneError) -> Self {
        match e {
            SceneError::Bad(e) => e.into(),
            SceneError::Cancelled(e) => e.into(),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(e: MeshError) -> Self {
        let code = match e {
            MeshError::Exists { .. } => Self::USAGE,
            MeshError::Unfaithful { .. } => Self::FAILED,
            _ => Self::INPUT,
        };
        Self::new(code, e.to_string())
    }
}

impl From<PictureError> for Failure {
    fn from(e: PictureError) -> Self {
        match &e {
            PictureError::Exists(_) => Self::usage(format!("{e}; overwrite it with --force")),
            PictureError::Size { .. } => Self::usage(e.to_string()),
            PictureError::Write { source, .. } => Self::new(Self::FAILED, format!("{e}: {source}")),
            _ => Self::new(Self::FAILED, e.to_string()),
        }
    }
}

impl From<RunError> for Failure {
    fn from(e: RunError) -> Self {
        match e {
            RunError::Cancelled(e) => e.into(),
            RunError::Mesh(e) => e.into(),
            RunError::Picture(e) => e.into(),
            RunError::Frames { .. } => Self::new(Self::LIMIT, e.to_string()),
            RunError::Exists(_) | RunError::Collision { .. } => Self::usage(e.to_string()),
            RunError::Morph(_) | RunError::Place { .. } => Self::new(Self::FAILED, e.to_string()),
        }
    }
}
