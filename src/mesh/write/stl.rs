use super::{differs, rounded};
use crate::mesh::TriMesh;
use crate::mesh::weld::{distinct_in_f32, welded};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Facets written by one thread at a time.
const RUN: usize = 4096;
/// Bytes before the facets, and of each of them.
pub(super) const HEAD: usize = 84;
pub(super) const FACET: usize = 50;

/// Binary STL: 80 bytes of header, the count, and 50 bytes a facet.
pub(super) fn encode(mesh: &TriMesh, faces: u32, note: &str) -> Vec<u8> {
    [head(faces, note), facets(mesh, &mesh.faces)].concat()
}

/// What comes before the facets.
pub(super) fn head(faces: u32, note: &str) -> Vec<u8> {
    // Must not begin with `solid`, by which ASCII files are told.
    let mut out = format!("fieldgraft UNITS=mm {note}").into_bytes();
    out.resize(80, b' ');
    out.extend_from_slice(&faces.to_le_bytes());
    out
}

/// The facets of some of the mesh's faces.
pub(super) fn facets(mesh: &TriMesh, faces: &[[u32; 3]]) -> Vec<u8> {
    let mut out = vec![0; FACET * faces.len()];
    let facets = out.par_chunks_mut(FACET * RUN).zip(faces.par_chunks(RUN));
    facets.for_each(|(out, faces)| {
        for (out, face) in out.chunks_exact_mut(FACET).zip(faces) {
            let corners = face.map(|v| rounded(mesh, v));
            fill(out, normal(corners).into_iter().chain(corners.into_iter().flatten()));
        }
    });
    out
}

fn fill(out: &mut [u8], numbers: impl Iterator<Item = f32>) {
    for (out, x) in out.chunks_exact_mut(4).zip(numbers) {
        out.copy_from_slice(&x.to_le_bytes());
    }
}

/// Whether the corners of the faces stand in their facets to the bit.
pub(super) fn hold(facets: &[u8], mesh: &TriMesh, faces: &[[u32; 3]]) -> bool {
    let as_written = |(facet, face): (&[u8], &[u32; 3])| {
        let mut corners = [0; 36];
        fill(&mut corners, face.map(|v| rounded(mesh, v)).into_iter().flatten());
        facet.get(12..48) == Some(&corners[..])
    };
    facets.len() == FACET * faces.len()
        && facets
            .par_chunks(FACET * RUN)
            .zip(faces.par_chunks(RUN))
            .all(|(facets, faces)| facets.chunks_exact(FACET).zip(faces).all(as_written))
}

/// Whether welding the corners by position gives the points and faces of the mesh again, as far as
/// faces use them. Quicker than doing it, for a twelfth of the memory.
pub(super) fn welds_back(mesh: &TriMesh) -> bool {
    let whole = |f: &[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
    mesh.faces.par_iter().all(whole) && distinct_in_f32(mesh)
}

/// What [`welds_back`] found wrong, in words: whether the file has each face's corners, and welding them gives
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
