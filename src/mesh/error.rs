use std::path::PathBuf;

/// What can go wrong with a mesh file. Every message names the file, the place and the cause.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The system refused to open, read or write.
    #[error("{}: cannot {doing}: {cause}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// `read`, `write`.
        doing: &'static str,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A directory, pipe or device stands where a file was expected.
    #[error("{}: is a {kind}, not a regular file", .path.display())]
    NotAFile {
        /// What was given.
        path: PathBuf,
        /// What it is.
        kind: &'static str,
    },
    /// The extension is none of the known ones.
    #[error("{}: unknown mesh format `{extension}`; {known}", .path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Its extension, perhaps empty.
        extension: String,
        /// Which formats can be read or written.
        known: &'static str,
    },
    /// The contents break the format.
    #[error("{}: {place}: {why}", .path.display())]
    Bad {
        /// The file.
        path: PathBuf,
        /// Line, byte, face, or key.
        place: String,
        /// What was got, and what was expected.
        why: String,
    },
    /// There is no triangle to read or to write.
    #[error("{}: {why}", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// What is there instead.
        why: String,
    },
    /// The output is there already.
    #[error("{}: exists already; overwrite it with --force", .path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file would not read back as the mesh it was made from; nothing was written.
    #[error("{}: not written: {why}", .path.display())]
    Unfaithful {
        /// The file.
        path: PathBuf,
        /// Where the two differ.
        why: String,
    },
}

/// What is wrong inside some bytes; the path is added where the file was opened.
#[derive(Debug)]
pub(super) struct Fault {
    pub place: String,
    pub why: String,
}

impl Fault {
    /// Without control characters, and no longer than a person reads: names in it are a file's.
    pub fn fit_to_show(self) -> Self {
        let fit = |text: String| -> String {
            text.chars().take(400).map(|c| if c.is_control() { '?' } else { c }).collect()
        };
        Self { place: fit(self.place), why: fit(self.why) }
    }
}

pub(super) type Parsed<T> = Result<T, Fault>;

/// `Err` with a place and a cause.
pub(super) fn fault<T>(place: impl Into<String>, why: impl Into<String>) -> Parsed<T> {
    Err(Fault { place: place.into(), why: why.into() })
}
