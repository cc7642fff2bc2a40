//! What ends a command early: an exit code and one short paragraph.

use fieldgraft::job::Cancelled;
use fieldgraft::mesh::MeshError;
use fieldgraft::picture::PictureError;
use fieldgraft::recipe::RecipeError;
use fieldgraft::run::RunError;
use fieldgraft::scene::SceneError;
use std::borrow::Cow;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

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

    /// With the name of the file that it is about, if that is not in it already.
    pub fn about(mut self, file: &str) -> Self {
        let of_input = matches!(self.code, Self::INPUT | Self::LIMIT);
        if of_input && !self.message.contains(file) {
            self.message = format!("{file}: {}", self.message);
        }
        self
    }

    /// Prints the message to stderr; that of an interruption once.
    pub fn tell(&self) {
        static INTERRUPTED: AtomicBool = AtomicBool::new(false);
        if self.code == Self::INTERRUPTED && INTERRUPTED.swap(true, Ordering::SeqCst) {
            return;
        }
        if !self.message.is_empty() {
            // nowhere is left to complain to if stderr is gone
            let _ = writeln!(std::io::stderr(), "error: {}", paragraph(&self.message));
        }
    }
}

/// Longest message, characters: names and values in it come from files.
const LONGEST: usize = 600;

/// A message in one paragraph: no line breaks, no codes, not longer than a person reads.
fn paragraph(message: &str) -> String {
    let one_line = message.replace('\n', " ");
    let mut text: String = plain(&one_line).chars().take(LONGEST).collect();
    if text.len() < one_line.len() && one_line.chars().nth(LONGEST).is_some() {
        text.push_str("...");
    }
    text
}

/// Text as it can be shown on a terminal: codes that move the cursor, colour it or turn the text
/// round become `?`. Line breaks stay.
pub fn plain(text: &str) -> Cow<'_, str> {
    let harms = |c: char| {
        let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        (c.is_control() && c != '\n') || turns
    };
    if text.contains(harms) { text.replace(harms, "?").into() } else { text.into() }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_not_passed_on() {
        assert_eq!(plain("a\x1b[31m\u{9b}1m\u{202e}\tb\nc"), "a?[31m?1m??b\nc");
        assert_eq!(plain("plain ø"), "plain ø");
        assert_eq!(paragraph("two\nlines"), "two lines");
        let long = paragraph(&"x".repeat(1000));
        assert!(long.len() == LONGEST + 3 && long.ends_with("..."));
    }
}
