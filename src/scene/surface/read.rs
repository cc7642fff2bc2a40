//! Reading surface files and those they name.

use super::super::{Input, SceneError, sha256};
use crate::recipe::surface::Kind;
use crate::recipe::{Problem, RecipeError, Source, SurfaceEntry, parse_surface, read_text};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most files that one may name.
const MOST: usize = 64;

/// A file as it was read.
pub struct Opened {
    pub entry: SurfaceEntry,
    pub source: Arc<Source>,
    /// As it was named.
    pub path: PathBuf,
    /// Without links and dots, to tell files apart.
    real: Option<PathBuf>,
}

impl Opened {
    /// Adds this file and the line to a problem.
    pub fn locate(&self, p: Problem) -> RecipeError {
        self.source.locate(p)
    }
}

/// Files read so far.
#[derive(Default)]
pub struct Reader {
    pub inputs: Vec<Input>,
}

impl Reader {
    /// Reads a file.
    pub fn open(&mut self, path: &Path) -> Result<Opened, RecipeError> {
        let fail = |why| RecipeError { file: path.to_owned(), line: None, at: String::new(), why };
        let text = read_text(path).map_err(fail)?;
        let (entry, source) = parse_surface(&text, path)?;
        let file = path.display().to_string();
        if !self.inputs.iter().any(|i| i.file == file) {
            self.inputs.push(Input { file, sha256: sha256(text.as_bytes()) });
        }
        let real = fs::canonicalize(path).ok();
        Ok(Opened { entry, source: Arc::new(source), path: path.to_owned(), real })
    }

    /// Reads a file that another names at a key, relative to it; it has to be of that kind.
    pub fn named(
        &mut self,
        by: &Opened,
        key: &str,
        path: &Path,
        kind: Kind,
    ) -> Result<Opened, SceneError> {
        let fail = |why: String| by.locate(Problem::new(key, why));
        if path.as_os_str().is_empty() {
            return Err(fail("an empty name; expected a file".to_owned()).into());
        }
        let path = by.path.parent().unwrap_or(Path::new("")).join(path);
        let shown = path.display();
        if fs::canonicalize(&path).ok().is_some_and(|p| by.real.as_ref() == Some(&p)) {
            return Err(
                fail(format!("{shown} is this file; a morph cannot be made of itself")).into()
            );
        }
        match fs::metadata(&path) {
            Ok(about) if about.is_file() => {}
            Ok(_) => return Err(fail(format!("{shown} is no regular file")).into()),
            Err(why) => return Err(fail(format!("{shown} cannot be read: {why}")).into()),
        }
        let opened = self.open(&path)?;
        let got = opened.entry.kind();
        if got != kind {
            let why = format!(
                "{shown} is of kind `{}`; expected `{}`{}",
                got.word(),
                kind.word(),
                names_back(&opened, by)
            );
            return Err(fail(why).into());
        }
        Ok(opened)
    }
}

/// What to add where a file that was named names the first one again.
fn names_back(opened: &Opened, by: &Opened) -> &'static str {
    let names: Vec<&PathBuf> = match &opened.entry {
        SurfaceEntry::PdeMorph(m) => vec![&m.from, &m.to],
        SurfaceEntry::NurbsMorph(m) => m.targets.iter().take(MOST).collect(),
        _ => vec![],
    };
    let beside = opened.path.parent().unwrap_or(Path::new(""));
    let back = |name: &&PathBuf| {
        fs::canonicalize(beside.join(name)).ok().is_some_and(|p| by.real.as_ref() == Some(&p))
    };
    if names.iter().any(back) { ", and it names this file again: a cycle" } else { "" }
}

/// Refuses a list of too many files.
pub fn check_count(key: &str, count: usize) -> Result<(), Problem> {
    if count <= MOST {
        return Ok(());
    }
    Err(Problem::new(key, format!("{count} files; at most {MOST}")))
}
