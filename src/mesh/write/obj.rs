use super::rounded;
use crate::mesh::TriMesh;
use std::fmt::Write;

/// OBJ in mm, Y up as most programs take it: (x, y, z) goes out as (x, z, -y). Numbers are the
/// shortest that read back as the same f32.
pub(super) fn encode(mesh: &TriMesh, note: &str) -> Vec<u8> {
    let mut out = format!("# fieldgraft UNITS=mm UP=y {note}\n");
    for v in 0..mesh.points.len() as u32 {
        let [x, y, z] = rounded(mesh, v);
        let _ = writeln!(out, "v {x} {z} {}", 0.0 - y); // writing to a string cannot fail
    }
    for [a, b, c] in mesh.faces.iter().map(|f| f.map(|v| u64::from(v) + 1)) {
        let _ = writeln!(out, "f {a} {b} {c}");
    }
    out.into_bytes()
}
