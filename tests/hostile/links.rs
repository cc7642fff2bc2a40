//! What stands where a file was expected, and names that do harm by themselves.

use super::{As, Case, faults, listing, meshes, run};
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

/// Names times kinds below, and the odd names.
pub const COUNT: usize = 5 * 8 + 7;

pub fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Puts something that is no regular file there.
fn strange(kind: usize, path: &Path) {
    match kind {
        0 => fs::create_dir(path).unwrap(),
        1 => symlink("/dev/zero", path).unwrap(),
        2 => symlink("/dev/null", path).unwrap(),
        3 => fifo(path),
        4 => symlink("nowhere", path).unwrap(),
        5 => symlink(path.file_name().unwrap(), path).unwrap(),
        6 => drop(std::os::unix::net::UnixListener::bind(path).unwrap()),
        _ => {} // missing
    }
}

fn args(file: &OsStr, text: bool) -> Vec<&OsStr> {
    let words: &[&str] = if text { &["run"] } else { &["convert", "--resolution", "8"] };
    let after: &[&str] = if text { &["-o", "out"] } else { &["out.stl"] };
    let all = words.iter().map(OsStr::new).chain([file]);
    all.chain(after.iter().map(OsStr::new)).collect()
}

#[test]
fn what_is_no_regular_file_is_refused() {
    let mut wrong = vec![];
    for name in ["m.obj", "m.stl", "m.ply", "m.glb", "r.toml"] {
        for kind in 0..8 {
            let root = tempfile::tempdir().unwrap();
            let folder = root.path().join("in");
            fs::create_dir(&folder).unwrap();
            strange(kind, &folder.join(name));
            let before = listing(&folder);
            let did = run(&args(OsStr::new(name), name == "r.toml"), &folder, root.path());
            let found = faults(&did, name, &[], 3);
            wrong.extend(found.iter().map(|w| format!("{name}, kind {kind}: {w}")));
            assert_eq!(listing(&folder), before, "{name}, kind {kind}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Names that would move the cursor, break the line or are no text at all, over a good mesh and a
/// bad one.
#[test]
fn names_of_files_are_shown_without_their_codes() {
    let long = [&[b'n'; 200][..], b".obj"].concat();
    let names: [&[u8]; 7] = [
        b"\x1b[2J\x1b[31mred.obj",
        b"two\nerror: lines.obj",
        b"bell\x07\x08\x7f.obj",
        b"\xff\xfe\x80.obj",
        "right\u{202e}jbo.\u{9b}31m.obj".as_bytes(),
        b"-q.obj",
        &long,
    ];
    let mut wrong = vec![];
    for name in names {
        let shown = String::from_utf8_lossy(name).into_owned();
        for (bytes, ends) in [(meshes::OBJ.as_bytes(), 0), (b"v 0 0 0\nf 1 2 9\n", 3)] {
            let root = tempfile::tempdir().unwrap();
            let folder = root.path().join("in");
            fs::create_dir(&folder).unwrap();
            let name = OsStr::from_bytes(name);
            fs::write(folder.join(name), bytes).unwrap();
            let file = Path::new(".").join(name);
            let did = run(&args(file.as_os_str(), false), &folder, root.path());
            let found = faults(&did, "", &[], ends);
            wrong.extend(found.iter().map(|w| format!("{shown:?}: {w}")));
            let did = run(&[OsStr::new("check"), file.as_os_str()], &folder, root.path());
            let found = faults(&did, "", &[], ends);
            wrong.extend(found.iter().map(|w| format!("{shown:?}, check: {w}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Other files that people have: what they are is said, or at least that they are not read.
pub fn others() -> Vec<Case> {
    let zip = b"PK\x03\x04\x14\0\0\0\x08\0../../escape.obj";
    let entities = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/passwd\">\
        <!ENTITY y \"&x;&x;&x;&x;\">]><model>&y;</model>";
    let new = |file: &str, what: &str, bytes: &[u8]| Case::new(As::Mesh, file, what, bytes);
    vec![
        new("a.3mf", "a zip with a name that leads out", zip).says("unknown mesh format"),
        new("b.obj", "a zip under another name", zip),
        new("b.stl", "a zip under another name", zip),
        new("c.xml", "XML entities", entities.as_bytes()).says("unknown mesh format"),
        new("c.ply", "XML entities as PLY", entities.as_bytes()),
        new("c.gltf", "XML entities as glTF", entities.as_bytes()),
        new("noname", "no extension", b"x").says("unknown mesh format"),
    ]
}
