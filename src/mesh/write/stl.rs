use super::{differs, rounded};
use crate::mesh::TriMesh;
use crate::mesh::weld::{distinct_in_f32, welded};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Facets written by one thread at a time.
const RUN: usize = 4096;

/// Binary STL: 80 bytes of header, the count, and 50 bytes a facet.
pub(super) fn encode(mesh: &TriMesh, faces: u32, note: &str) -> Vec<u8> {
    let mut out = Vec::with_capacity(84 + 50 * mesh.faces.len());
    // Must not begin with `solid`, by which ASCII files are told.
    out.extend_from_slice(format!("fieldgraft UNITS=mm {note}").as_bytes());
    out.resize(80, b' ');
    out.extend_from_slice(&faces.to_le_bytes());
    out.resize(84 + 50 * mesh.faces.len(), 0);
    let records = out[84..].par_chunks_mut(50 * RUN).zip(mesh.faces.par_chunks(RUN));
    records.for_each(|(out, faces)| {
        for (out, face) in out.chunks_exact_mut(50).zip(faces) {
            let corners = face.map(|v| rounded(mesh, v));
            let numbers = normal(corners).into_iter().chain(corners.into_iter().flatten());
            for (out, x) in out.chunks_exact_mut(4).zip(numbers) {
                out.copy_from_slice(&x.to_le_bytes());
            }
        }
    });
    out
}

/// Whether reading the bytes and welding by position gives the mesh again: the corners stand there
/// to the bit, and no two points of the mesh coincide. Quicker than doing it, for a twelfth of the
/// memory.
pub(super) fn holds(bytes: &[u8], mesh: &TriMesh) -> bool {
    let size = 84 + 50 * mesh.faces.len();
    let count = u32::try_from(mesh.faces.len()).map(u32::to_le_bytes);
    if bytes.len() != size || count.ok().as_ref().map(|n| &n[..]) != bytes.get(80..84) {
        return false;
    }
    let as_written = |(record, f): (&[u8], &[u32; 3])| {
        let corners = f.iter().flat_map(|&v| rounded(mesh, v)).flat_map(f32::to_le_bytes);
        f[0] != f[1] && f[1] != f[2] && f[2] != f[0] && corners.eq(record[12..48].iter().copied())
    };
    bytes[84..].par_chunks_exact(50).zip(&mesh.faces).all(as_written) && distinct_in_f32(mesh)
}

/// What [`holds`] found wrong, in words: whether the file has each face's corners, and welding them gives
/// the points of the mesh again.
/// Compared facet by facet: a soup of points would take more memory than all that made it.
pub(super) fn same(bytes: &[u8], mesh: &TriMesh) -> Result<(), String> {
    let count = bytes.get(80..84).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let facets = bytes.get(84..).unwrap_or_default().chunks_exact(50);
    differs("faces", count.unwrap_or_default() as usize, mesh.faces.len())?;
    differs("facets", facets.len(), mesh.faces.len())?;
    for (i, (facet, face)) in facets.zip(&mesh.faces).enumerate() {
        let floats = facet[12..48].chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
        let wanted = face.map(|v| rounded(mesh, v));
        if !floats.map(f32::from_le_bytes).eq(wanted.into_iter().flatten()) {
            return Err(format!("face {i} does not come back as {wanted:?}"));
        }
    }
    let points = mesh.points.iter().map(|p| p.as_vec3().as_dvec3()).collect();
    let single = TriMesh { points, faces: mesh.faces.clone() };
    let (_, counts) = welded(&single);
    if counts.collapsed > 0 {
        let n = counts.collapsed;
        return Err(format!("{n} faces lose a corner when positions are rounded to f32"));
    }
    if counts.merged > 0 {
        return Err(coinciding(&single));
    }
    Ok(())
}

/// Names two used points at one place.
fn coinciding(mesh: &TriMesh) -> String {
    let mut used: Vec<u32> = mesh.faces.iter().flatten().copied().collect();
    let bits = |v: u32| (mesh.points[v as usize] + 0.0).to_array().map(f64::to_bits);
    used.sort_unstable_by_key(|&v| (bits(v), v));
    used.dedup();
    let pairs = used.windows(2).filter(|w| bits(w[0]) == bits(w[1]));
    let pair = pairs.min_by_key(|w| w[0]);
    let Some(&[a, b]) = pair else { return "points of the mesh coincide in f32".to_owned() };
    let at = mesh.points[a as usize];
    format!("points {a} and {b} of the mesh coincide in f32, at {at}")
}

/// The unit normal of the rounded corners, zero for a triangle without area.
fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| Vec3::from(p).as_dvec3());
    let n: DVec3 = (b - a).cross(c - a).normalize_or_zero();
    n.as_vec3().to_array().map(|x| x + 0.0)
}
