use super::rounded;
use crate::mesh::TriMesh;
use crate::mesh::weld::distinct_in_f32;
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

/// The unit normal of the rounded corners, zero for a triangle without area.
fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| Vec3::from(p).as_dvec3());
    let n: DVec3 = (b - a).cross(c - a).normalize_or_zero();
    n.as_vec3().to_array().map(|x| x + 0.0)
}
