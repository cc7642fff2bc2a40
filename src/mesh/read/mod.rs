//! Mesh files in.

mod buffers;
mod gltf;
mod gltf_accessor;
mod gltf_document;
mod obj;
mod ply;
mod ply_header;
mod stl;
#[cfg(test)]
mod tests;
mod text;

use super::{
    Assume, TriMesh, Unit, Up,
    error::{Fault, MeshError, Parsed, fault},
    found::{Found, Polygons},
    weld::welded,
};
use crate::memory::available_memory;
use std::{
    fs::{File, FileType, Metadata},
    io::{self, Read},
    path::Path,
};

/// A mesh with the story of its file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// In mm, Z up; welded by exact position, without points that no face uses.
    pub mesh: TriMesh,
    /// What the file held.
    pub found: Found,
    /// The axis taken as up.
    pub up: Up,
    /// The unit taken.
    pub unit: Unit,
}

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Obj,
    Stl,
    Ply,
    Gltf,
}

/// Reads a mesh: OBJ, STL and PLY (binary and ASCII), glTF and GLB, by extension.
///
/// Geometry is never refused for being odd, see [`Found`]. Memory stays within a multiple of the
/// size of the file (and, for glTF, of the buffers beside it).
///
/// # Errors
/// A file that is missing, no regular file, of an unknown format, cut short or malformed; an index
/// out of range; a coordinate that a face uses and that is not finite; no triangle at all.
pub fn read(path: &Path, assume: Assume) -> Result<Loaded, MeshError> {
    let format = Format::of(path)?;
    let bytes = contents(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let loaded = load(&bytes, format, folder, assume)
        .map_err(|Fault { place, why }| MeshError::Bad { path: path.into(), place, why })?;
    if loaded.mesh.faces.is_empty() {
        let why = match loaded.found.degenerate {
            _ if bytes.is_empty() => "the file is empty".into(),
            0 => "no triangles in the file".into(),
            n => format!("no triangles in the file, only {n} faces without area"),
        };
        return Err(MeshError::Empty { path: path.into(), why });
    }
    Ok(loaded)
}

/// Reads from memory; `folder` is where a glTF may have its buffers.
fn load(bytes: &[u8], format: Format, folder: &Path, assume: Assume) -> Parsed<Loaded> {
    let up = assume.up.unwrap_or(format.up());
    let unit = assume.unit.unwrap_or(format.unit());
    let (raw, kinds) = parse(bytes, format, folder, up, unit).map_err(Fault::fit_to_show)?;
    let (mesh, counts) = welded(&raw);
    let found = Found::after(&mesh, raw.points.len(), kinds, counts);
    Ok(Loaded { mesh, found, up, unit })
}

/// The triangles of a file in mm, Z up, with its own points.
pub(super) fn parse(
    bytes: &[u8],
    format: Format,
    folder: &Path,
    up: Up,
    unit: Unit,
) -> Parsed<(TriMesh, Polygons)> {
    let (soup, mm) = match format {
        Format::Obj => (obj::read(bytes)?, unit.mm()),
        Format::Stl => (stl::read(bytes)?, unit.mm()),
        Format::Ply => (ply::read(bytes)?, unit.mm()),
        // The unit goes into the node transforms: a scale of 0.001 and metres cancel exactly.
        Format::Gltf => (gltf::read(bytes, folder, unit.mm())?, 1.0),
    };
    if soup.points.len() > u32::MAX as usize || soup.corners.len() / 3 > u32::MAX as usize {
        return fault("size", format!("{} points are more than 2^32", soup.points.len()));
    }
    soup.check(mm)?;
    Ok(soup.cut(up, mm))
}

impl Format {
    /// The axis that points up, when nobody says.
    pub fn up(self) -> Up {
        match self {
            Self::Obj | Self::Gltf => Up::Y,
            Self::Stl | Self::Ply => Up::Z,
        }
    }

    /// The unit, when nobody says.
    pub fn unit(self) -> Unit {
        if self == Self::Gltf { Unit::M } else { Unit::Mm }
    }

    fn of(path: &Path) -> Result<Self, MeshError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            "ply" => Ok(Self::Ply),
            "glb" | "gltf" => Ok(Self::Gltf),
            _ => Err(MeshError::Format {
                path: path.into(),
                extension,
                known: "readable are obj, stl, ply, glb, gltf",
            }),
        }
    }
}

/// All bytes of a regular file.
fn contents(path: &Path) -> Result<Vec<u8>, MeshError> {
    let failed = |cause| MeshError::Io { path: path.into(), doing: "read", cause };
    // Looked at before it is opened: opening a pipe would wait for its other end.
    let kind = std::fs::metadata(path).map_err(failed)?.file_type();
    if !kind.is_file() {
        return Err(MeshError::NotAFile { path: path.into(), kind: kind_name(kind) });
    }
    let file = File::open(path).map_err(failed)?;
    let size = file.metadata().as_ref().map(Metadata::len).unwrap_or(0);
    if let Some(free) = available_memory().filter(|free| size > free / 2) {
        let why = format!("it has {size} bytes, more than half of the {free} that are free");
        return Err(failed(io::Error::other(why)));
    }
    let mut bytes = Vec::new();
    // A file may claim more than there is memory for; growing a vector by hand would abort.
    let room = usize::try_from(size).unwrap_or(usize::MAX);
    bytes.try_reserve_exact(room).map_err(|e| failed(io::Error::other(e)))?;
    file.take(size).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

/// What stands where a file was expected.
pub(super) fn kind_name(kind: FileType) -> &'static str {
    if kind.is_dir() { "folder" } else { "pipe or device" }
}
