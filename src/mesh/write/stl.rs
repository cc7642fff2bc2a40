use super::rounded;
use crate::mesh::TriMesh;
use glam::{DVec3, Vec3};

/// Binary STL: 80 bytes of header, the count, and 50 bytes a facet.
pub(super) fn encode(mesh: &TriMesh, faces: u32, note: &str) -> Vec<u8> {
    let mut out = Vec::with_capacity(84 + 50 * mesh.faces.len());
    // Must not begin with `solid`, by which ASCII files are told.
    out.extend_from_slice(format!("fieldgraft UNITS=mm {note}").as_bytes());
    out.resize(80, b' ');
    out.extend_from_slice(&faces.to_le_bytes());
    for face in &mesh.faces {
        let corners = face.map(|v| rounded(mesh, v));
        for x in normal(corners).iter().chain(corners.iter().flatten()) {
            out.extend_from_slice(&x.to_le_bytes());
        }
        out.extend_from_slice(&[0, 0]);
    }
    out
}

/// The unit normal of the rounded corners, zero for a triangle without area.
fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| Vec3::from(p).as_dvec3());
    let n: DVec3 = (b - a).cross(c - a).normalize_or_zero();
    n.as_vec3().to_array().map(|x| x + 0.0)
}
