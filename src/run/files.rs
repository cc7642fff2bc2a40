//! Names of results, and text files put in place whole.

use super::{MOST_FRAMES, RunError, folder};
use crate::place::beside;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Where the results of a run go. `{t}` and `{name}` stand for the time and the hybrid's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// The folder that the others are relative to.
    pub folder: PathBuf,
    /// The mesh.
    pub mesh: String,
    /// The picture, if any.
    pub picture: Option<String>,
    /// Files that play the frames of a hybrid; each has the place of no time.
    pub animations: Vec<String>,
    /// The report.
    pub report: String,
    /// What stands for the name of a hybrid that has none.
    pub unnamed: String,
}

impl Names {
    /// The mesh of a frame.
    pub fn mesh(&self, hybrid: &str, t: f64) -> PathBuf {
        self.fill(&self.mesh, hybrid, t)
    }

    /// The picture of a frame.
    pub fn picture(&self, hybrid: &str, t: f64) -> Option<PathBuf> {
        self.picture.as_ref().map(|p| self.fill(p, hybrid, t))
    }

    /// The animations of a hybrid.
    pub fn animations(&self, hybrid: &str) -> Vec<PathBuf> {
        self.animations.iter().map(|name| self.fill(name, hybrid, 0.0)).collect()
    }

    /// The report.
    pub fn report(&self) -> PathBuf {
        self.folder.join(&self.report)
    }

    fn fill(&self, template: &str, hybrid: &str, t: f64) -> PathBuf {
        let name = if hybrid.is_empty() { &self.unnamed } else { hybrid };
        // a name is one file's, not a path
        let name = name.replace(['/', '\\'], "-");
        self.folder.join(template.replace("{t}", &time_word(t)).replace("{name}", &name))
    }

    /// Whether each frame (hybrid's name, time) has files of its own that may be written.
    ///
    /// # Errors
    /// The first file that several share, or that is there already and not to be overwritten; an
    /// animation of more than [`MOST_FRAMES`] frames.
    pub fn check(&self, frames: &[(String, f64)], force: bool) -> Result<(), RunError> {
        let mut count: BTreeMap<PathBuf, usize> = BTreeMap::new();
        for (hybrid, t) in frames {
            *count.entry(self.mesh(hybrid, *t)).or_default() += 1;
            if let Some(picture) = self.picture(hybrid, *t) {
                *count.entry(picture).or_default() += 1;
            }
        }
        let mut lengths: BTreeMap<&str, usize> = BTreeMap::new();
        frames.iter().for_each(|(hybrid, _)| *lengths.entry(hybrid).or_default() += 1);
        for (hybrid, frames) in lengths {
            for file in self.animations(hybrid) {
                if frames > MOST_FRAMES {
                    return Err(RunError::Frames { file, frames });
                }
                *count.entry(file).or_default() += 1;
            }
        }
        *count.entry(self.report()).or_default() += 1;
        for (file, count) in count {
            if count > 1 {
                let cure = "put {t} (and {name}, for hybrids) into the name".to_owned();
                return Err(RunError::Collision { file, count, cure });
            }
            if file.is_dir() {
                let why = std::io::Error::other("it is a folder");
                return Err(RunError::Place { file, why });
            }
            if !force && file.symlink_metadata().is_ok() {
                return Err(RunError::Exists(file));
            }
        }
        Ok(())
    }
}

/// A time as it stands in file names: `0`, `0.25`, `1`.
pub fn time_word(t: f64) -> String {
    // f64 prints the shortest decimal that reads back; ranges were rounded when they were read
    format!("{t}")
}

/// Makes the folder a file goes into.
pub(super) fn folder_of(path: &Path) -> Result<(), RunError> {
    let folder = folder(path);
    fs::create_dir_all(folder).map_err(|why| RunError::Place { file: folder.to_owned(), why })
}

/// Puts a text file in place whole: written beside, then renamed.
///
/// # Errors
/// The file exists and `force` is false; the system refuses.
pub fn place_text(path: &Path, text: &str, force: bool) -> Result<(), RunError> {
    folder_of(path)?;
    let fail = |why: std::io::Error| match why.kind() {
        std::io::ErrorKind::AlreadyExists if !force => RunError::Exists(path.to_owned()),
        _ => RunError::Place { file: path.to_owned(), why },
    };
    let mut file = beside(path).map_err(fail)?;
    file.write_all(text.as_bytes()).map_err(fail)?;
    let placed = if force { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map(drop).map_err(|e| fail(e.error))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Names {
        Names {
            folder: PathBuf::from("out"),
            mesh: "{name}-{t}.stl".to_owned(),
            picture: Some("{name}.png".to_owned()),
            animations: vec![],
            report: "run.json".to_owned(),
            unnamed: "hybrid".to_owned(),
        }
    }

    #[test]
    fn placeholders_are_filled() {
        let n = names();
        assert_eq!(n.mesh("", 0.25), PathBuf::from("out/hybrid-0.25.stl"));
        assert_eq!(n.mesh("a/../b", 1.0), PathBuf::from("out/a-..-b-1.stl"));
    }

    #[test]
    fn results_that_share_a_file_are_refused() {
        let frames = [("a".to_owned(), 0.0), ("a".to_owned(), 1.0)];
        let e = names().check(&frames, false).unwrap_err().to_string();
        assert!(e.contains("a.png") && e.contains("2 results") && e.contains("{t}"), "{e}");
        assert!(names().check(&frames[..1], false).is_ok());
    }

    #[test]
    fn an_animation_has_a_file_for_each_hybrid_and_not_too_many_frames() {
        let mut n = names();
        n.picture = None;
        n.animations = vec!["{name}.glb".to_owned(), "all.webp".to_owned()];
        assert_eq!(n.animations("a")[0], PathBuf::from("out/a.glb"));
        let frames = |names: &[&str], count: usize| -> Vec<(String, f64)> {
            let of = |name: &&str| (0..count).map(|i| (name.to_string(), i as f64)).collect();
            names.iter().flat_map(|name| -> Vec<_> { of(name) }).collect()
        };
        n.check(&frames(&["a"], 3), false).unwrap();
        let e = n.check(&frames(&["a", "b"], 3), false).unwrap_err().to_string();
        assert!(e.contains("all.webp") && e.contains("2 results"), "{e}");
        n.mesh = "{t}.glb".to_owned();
        n.check(&frames(&["a"], MOST_FRAMES), false).unwrap();
        let e = n.check(&frames(&["a"], MOST_FRAMES + 1), false).unwrap_err().to_string();
        assert!(e.contains("a.glb") && e.contains("1001 frames"), "{e}");
    }

    #[test]
    fn text_is_placed_whole_and_not_over_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/run.json");
        place_text(&path, "one", false).unwrap();
        assert!(matches!(place_text(&path, "two", false), Err(RunError::Exists(_))));
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        place_text(&path, "two", true).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert_eq!(fs::read_dir(folder.path().join("new")).unwrap().count(), 1);
    }
}
