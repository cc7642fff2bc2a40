//! Lids on the rims of open surfaces.

use crate::mesh::TriMesh;
use crate::mesh::polygon::{Cut, MOST_CORNERS, triangulate};
use std::collections::BTreeMap;

/// The mesh with a lid on every rim that is a simple loop and can be cut into triangles that do not
/// overlap. Other rims stay open.
pub(super) fn with_lids(mesh: &TriMesh) -> TriMesh {
    let mut out = mesh.clone();
    for rim in rims(mesh) {
        let mut lid = vec![];
        if rim.len() <= MOST_CORNERS && triangulate(&rim, &mesh.points, &mut lid) != Cut::Tangled {
            out.faces.append(&mut lid);
        }
    }
    out
}

/// Loops of points along the edges with one face, against the way their faces run.
fn rims(mesh: &TriMesh) -> Vec<Vec<u32>> {
    // by its ends: how many faces an edge has, and whether the last runs from the lower to the higher
    let mut edges: BTreeMap<[u32; 2], (u32, bool)> = BTreeMap::new();
    for f in &mesh.faces {
        for k in 0..3 {
            let (a, b) = (f[k], f[(k + 1) % 3]);
            let edge = edges.entry([a.min(b), a.max(b)]).or_default();
            *edge = (edge.0 + 1, a < b);
        }
    }
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for ([low, high], (faces, up)) in edges {
        if faces == 1 {
            let (from, to) = if up { (high, low) } else { (low, high) };
            next.entry(from).or_default().push(to);
        }
    }
    let mut loops = vec![];
    while let Some((&first, _)) = next.first_key_value() {
        let mut rim = vec![first];
        let mut at = first;
        // each step takes a point away, so this ends
        let closed = loop {
            match next.remove(&at).as_deref() {
                Some([to]) if *to == first => break true,
                Some([to]) => {
                    at = *to;
                    rim.push(at);
                }
                // rims that touch, or a loop that runs into one already walked
                _ => break false,
            }
        };
        if closed {
            loops.push(rim);
        }
    }
    loops
}
