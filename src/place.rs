//! Files that are put in place whole: written beside it, then renamed.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::NamedTempFile;

const PREFIX: &str = ".fieldgraft-";
const SUFFIX: &str = ".part";

/// Folders that something was written to.
static FOLDERS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Whether nothing more may be written.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// A file beside `path`, to be filled and then renamed into it; dropped before that, it goes away.
///
/// What runs that were killed have left in the folder is cleared away first.
///
/// # Errors
/// What the system refuses.
pub fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    sweep(folder);
    if let Ok(mut folders) = FOLDERS.lock() {
        folders.insert(folder.to_owned());
    }
    if CLOSED.load(Ordering::SeqCst) {
        return Err(io::ErrorKind::Interrupted.into());
    }
    let prefix = format!("{PREFIX}{}-", std::process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    // readable by others, as any file a program makes; the umask still has its say
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Removes what this process has begun to write and lets it begin nothing more: for a process that is
/// to end at once. What is in place stays.
pub fn abandon() {
    CLOSED.store(true, Ordering::SeqCst);
    let folders = FOLDERS.lock().map(|f| f.clone()).unwrap_or_default();
    for folder in folders {
        clear(&folder, |id| id == std::process::id());
    }
}

/// Removes what processes that are no more have left. Where it cannot be known whether a process
/// is there, and for what cannot be removed, nothing happens.
fn sweep(folder: &Path) {
    let processes = Path::new("/proc");
    if !processes.join("self").exists() {
        return;
    }
    clear(folder, |id| !processes.join(id.to_string()).exists());
}

/// Removes the hidden files of processes with such numbers.
fn clear(folder: &Path, of: impl Fn(u32) -> bool) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let writer = name
            .to_str()
            .and_then(|n| n.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.split_once('-'))
            .and_then(|(id, _)| id.parse::<u32>().ok());
        if writer.is_some_and(&of) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_dead_left_is_cleared_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| fs::write(folder.path().join(name), b"x").unwrap();
        // no process has a number as large (PID_MAX_LIMIT is 2^22)
        let names = [".fieldgraft-4000000000-a.part", ".fieldgraft-x-a.part", "mine.part"];
        names.iter().for_each(|n| put(n));
        let own = beside(&folder.path().join("out.stl")).unwrap();
        let other = beside(&folder.path().join("two.stl")).unwrap();
        let there = |name: &str| folder.path().join(name).exists();
        assert_eq!(names.map(there), [!Path::new("/proc/self").exists(), true, true]);
        assert!(own.path().exists() && other.path().exists(), "a living process keeps its own");
        drop((own, other));
        let left = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, if there(names[0]) { 3 } else { 2 });
    }
}
