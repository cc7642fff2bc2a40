use super::rounded;
use crate::mesh::TriMesh;

/// Binary little-endian PLY in mm, Z up.
pub(super) fn encode(mesh: &TriMesh, points: u32, faces: u32, note: &str) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\ncomment fieldgraft UNITS=mm UP=z {note}\n\
         element vertex {points}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    out.reserve_exact(12 * mesh.points.len() + 13 * mesh.faces.len());
    for x in (0..points).flat_map(|v| rounded(mesh, v)) {
        out.extend_from_slice(&x.to_le_bytes());
    }
    for face in &mesh.faces {
        out.push(3);
        face.iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
    }
    out
}
