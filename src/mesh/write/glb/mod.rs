//! Binary glTF 2.0, Y up, metres: (x, y, z) goes out as (x, z, -y).
//!
//! Positions stay in mm under a node that scales by 0.001. Rounded to f32 in metres, different
//! points could become one, and with them goes the proof that the mesh is manifold.

mod document;
mod flip_book;
mod motion;
mod normals;
#[cfg(test)]
mod tests;

pub use flip_book::FlipBook;
pub use motion::{Motion, write_motion};

use super::rounded;
use crate::mesh::TriMesh;
use document::{Document, Look};

/// One mesh that keeps still.
pub(super) fn encode(mesh: &TriMesh, note: &str) -> Result<Vec<u8>, String> {
    let mut document = Document::new(note);
    let positions = document.positions(&points(mesh));
    let indices = document.indices(&mesh.faces);
    let primitive = document::primitive(positions, None, indices, None);
    let mesh = document.mesh(primitive, None);
    let node = document.node(document::placed(mesh));
    let [head, body] = document.finish(vec![node])?;
    Ok([head, body].concat())
}

/// The points as the file holds them.
fn points(mesh: &TriMesh) -> Vec<[f32; 3]> {
    let turned = |v| {
        let [x, y, z] = rounded(mesh, v);
        [x, z, 0.0 - y]
    };
    (0..mesh.points.len() as u32).map(turned).collect()
}
