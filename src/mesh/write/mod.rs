//! Mesh files out.

mod glb;
mod obj;
mod ply;
mod stl;
#[cfg(test)]
mod tests;

pub use glb::{FlipBook, Motion, write_motion};

use super::{
    TriMesh,
    error::MeshError,
    read::{Format, kind_name, parse},
};
use crate::place::beside;
use rayon::prelude::*;
use std::{
    fmt::Display,
    fs,
    io::Write,
    path::{Path, PathBuf},
};

/// The formats that can be written.
#[derive(Clone, Copy)]
enum Target {
    Stl,
    Obj,
    Ply,
    Glb,
}

/// Writes a mesh as its extension says (`stl`, `obj`, `ply`, `glb`; the binary forms) and returns
/// the bytes written. `note`, such as `recipe=1f3a`, goes into the header or a comment.
///
/// Positions are rounded to f32. The file is read back before it takes its place: STL must weld by
/// exact position to the same points and faces (points that no face uses do not count), the others
/// must give the very same lists. It is written beside its place and renamed into it.
///
/// # Errors
/// No triangles; a face or position that is not sound; an existing file without `force`; a mesh
/// that does not survive the rounding; what the system refuses. Nothing is written then.
pub fn write(path: &Path, mesh: &TriMesh, note: &str, force: bool) -> Result<u64, MeshError> {
    let target = target(path, force)?;
    let unfaithful = |why: String| MeshError::Unfaithful { path: path.into(), why };
    if mesh.faces.is_empty() {
        return Err(MeshError::Empty { path: path.into(), why: "no triangles to write".into() });
    }
    sound(mesh).map_err(unfaithful)?;
    if matches!(target, Target::Stl) && stl::welds_back(mesh) {
        return write_stl(path, mesh, &plain(note), force);
    }
    let bytes = encode(target, mesh, &plain(note)).map_err(unfaithful)?;
    same(&bytes, target, mesh).map_err(unfaithful)?;
    let size = bytes.len() as u64;
    place(path, std::iter::once(Ok(bytes)), force)?;
    Ok(size)
}

/// Faces of an STL that are made as they will be written, while as many before them are written.
const AT_ONCE: usize = 1 << 17;

/// Part by part, so that the file need not be in memory as a whole; each is compared with the mesh
/// before it is written.
fn write_stl(path: &Path, mesh: &TriMesh, note: &str, force: bool) -> Result<u64, MeshError> {
    let unfaithful = |why: String| MeshError::Unfaithful { path: path.into(), why };
    let head = stl::head(many(mesh.faces.len(), "faces").map_err(unfaithful)?, note);
    let facets = mesh.faces.chunks(AT_ONCE).enumerate().map(|(i, faces)| {
        let facets = stl::facets(mesh, faces);
        if stl::hold(&facets, mesh, faces) {
            return Ok(facets);
        }
        let (first, last) = (i * AT_ONCE, i * AT_ONCE + faces.len() - 1);
        Err(unfaithful(format!("faces {first} to {last} do not come back as they are")))
    });
    place(path, std::iter::once(Ok(head)).chain(facets), force)?;
    Ok((stl::HEAD + stl::FACET * mesh.faces.len()) as u64)
}

/// Whether [`write()`] would take this path: a known extension, a folder that is there, and nothing
/// there already (with `force`, no more than a file). Ask before long work.
pub fn check_output(path: &Path, force: bool) -> Result<(), MeshError> {
    target(path, force).map(|_| ())
}

fn target(path: &Path, force: bool) -> Result<Target, MeshError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let target = match extension.as_str() {
        "stl" => Target::Stl,
        "obj" => Target::Obj,
        "ply" => Target::Ply,
        "glb" => Target::Glb,
        _ => {
            let known = "writable are stl, obj, ply, glb";
            return Err(MeshError::Format { path: path.into(), extension, known });
        }
    };
    if let Ok(m) = fs::metadata(path)
        && !m.is_file()
    {
        return Err(MeshError::NotAFile { path: path.into(), kind: kind_name(m.file_type()) });
    }
    if !force && fs::symlink_metadata(path).is_ok() {
        return Err(MeshError::Exists { path: path.into() });
    }
    let folder = folder(path);
    match fs::metadata(&folder).and_then(|_| folder.read_dir()) {
        Ok(_) => Ok(target),
        Err(cause) => Err(MeshError::Io { path: path.into(), doing: "write", cause }),
    }
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// All indices in range, all used positions within f32.
fn sound(mesh: &TriMesh) -> Result<(), String> {
    let held = |v: u32| mesh.points.get(v as usize).is_some_and(|p| p.as_vec3().is_finite());
    if mesh.faces.par_iter().all(|f| f.iter().all(|&v| held(v))) {
        return Ok(());
    }
    for (i, &v) in mesh.faces.iter().flatten().enumerate() {
        let Some(p) = mesh.points.get(v as usize) else {
            let count = mesh.points.len();
            return Err(format!("face {} has point {v}, but there are {count} points", i / 3));
        };
        if !p.as_vec3().is_finite() {
            return Err(format!("point {v} is {p}, which f32 cannot hold"));
        }
    }
    Ok(())
}

/// A note that no header can trip over: printable ASCII without backslash.
fn plain(note: &str) -> String {
    note.chars().map(|c| if (' '..='~').contains(&c) && c != '\\' { c } else { '?' }).collect()
}

/// A position as the files hold it: f32, no negative zero.
fn rounded(mesh: &TriMesh, v: u32) -> [f32; 3] {
    mesh.points[v as usize].as_vec3().to_array().map(|x| x + 0.0)
}

/// A number that every format can count to.
fn many(n: usize, what: &str) -> Result<u32, String> {
    match u32::try_from(n) {
        Ok(n) if n <= i32::MAX as u32 => Ok(n),
        _ => Err(format!("{n} {what} are more than the format can count")),
    }
}

fn encode(target: Target, mesh: &TriMesh, note: &str) -> Result<Vec<u8>, String> {
    let (points, faces) = (many(mesh.points.len(), "points")?, many(mesh.faces.len(), "faces")?);
    match target {
        Target::Stl => Ok(stl::encode(mesh, faces, note)),
        Target::Obj => Ok(obj::encode(mesh, note)),
        Target::Ply => Ok(ply::encode(mesh, points, faces, note)),
        Target::Glb => glb::encode(mesh, note),
    }
}

/// Reads the bytes again and compares.
fn same(bytes: &[u8], target: Target, mesh: &TriMesh) -> Result<(), String> {
    let format = match target {
        Target::Stl => return stl::same(bytes, mesh),
        Target::Obj => Format::Obj,
        Target::Ply => Format::Ply,
        Target::Glb => Format::Gltf,
    };
    let back = parse(bytes, format, Path::new(""), format.up(), format.unit());
    let (back, _) = back.map_err(|f| format!("{}: {}", f.place, f.why))?;
    same_lists(&back, mesh)
}

fn same_lists(back: &TriMesh, mesh: &TriMesh) -> Result<(), String> {
    differs("points", back.points.len(), mesh.points.len())?;
    differs("faces", back.faces.len(), mesh.faces.len())?;
    if let Some(i) = (0..back.faces.len()).find(|&i| back.faces[i] != mesh.faces[i]) {
        return differs(
            &format!("face {i}"),
            format!("{:?}", back.faces[i]),
            format!("{:?}", mesh.faces[i]),
        );
    }
    let single = |m: &TriMesh, i: usize| m.points[i].as_vec3();
    match (0..back.points.len()).find(|&i| single(back, i) != single(mesh, i)) {
        Some(i) => differs(&format!("point {i}"), single(back, i), single(mesh, i)),
        None => Ok(()),
    }
}

fn differs<T: PartialEq + Display>(what: &str, back: T, mesh: T) -> Result<(), String> {
    if back == mesh {
        return Ok(());
    }
    Err(format!("read back, {what}: {back}, but the mesh has {mesh}"))
}

/// Writes beside the place and renames into it, so that no half file is ever there.
fn place<B: AsRef<[u8]> + Send + Sync>(
    path: &Path,
    mut parts: impl Iterator<Item = Result<B, MeshError>> + Send,
    force: bool,
) -> Result<(), MeshError> {
    let failed = |cause| MeshError::Io { path: path.into(), doing: "write", cause };
    let mut file = beside(path).map_err(failed)?;
    let mut part = parts.next().transpose()?;
    while let Some(ready) = part {
        // the next one is made while the system takes this one
        let (written, next) = rayon::join(|| file.write_all(ready.as_ref()), || parts.next());
        written.map_err(failed)?;
        part = next.transpose()?;
    }
    let kept = if force { file.persist(path) } else { file.persist_noclobber(path) };
    match kept {
        Ok(_) => Ok(()),
        Err(e) if e.error.kind() == std::io::ErrorKind::AlreadyExists => {
            Err(MeshError::Exists { path: path.into() })
        }
        Err(e) => Err(failed(e.error)),
    }
}
