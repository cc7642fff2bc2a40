//! A judge of meshes that knows nothing of the mesher.

use crate::mesh::TriMesh;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// What a mesh is, found without any of the mesher's own tables.
#[derive(Debug, PartialEq, Default)]
pub struct Shape {
    /// Directed edges whose opposite does not occur exactly once, or that occur twice.
    pub bad_edges: usize,
    /// Points whose triangles do not form one fan.
    pub bad_points: usize,
    /// Points that no triangle uses.
    pub idle_points: usize,
    /// Triangles of no area, and positions that are no f32 numbers or occur twice.
    pub degenerate: usize,
    pub components: usize,
    pub euler: i64,
}

impl Shape {
    pub fn sound(&self) -> bool {
        (self.bad_edges, self.bad_points, self.idle_points, self.degenerate) == (0, 0, 0, 0)
    }

    pub fn of(mesh: &TriMesh) -> Self {
        let mut directed: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        // for every point the edges opposite to it, as the links of its fan
        let mut links: Vec<Vec<[u32; 2]>> = vec![Vec::new(); mesh.points.len()];
        let mut joined: Vec<usize> = (0..mesh.points.len()).collect();
        for f in &mesh.faces {
            for n in 0..3 {
                let [a, b, c] = [f[n], f[(n + 1) % 3], f[(n + 2) % 3]];
                *directed.entry([a, b]).or_default() += 1;
                links[c as usize].push([a, b]);
                let (a, b) = (root(&mut joined, a as usize), root(&mut joined, b as usize));
                joined[a.max(b)] = a.min(b);
            }
        }
        let bad =
            |(e, n): &(&[u32; 2], &usize)| **n != 1 || directed.get(&[e[1], e[0]]) != Some(&1);
        let used = links.iter().filter(|l| !l.is_empty()).count();
        let places: BTreeSet<[u32; 3]> = mesh
            .points
            .iter()
            .filter(|p| p.as_vec3().as_dvec3() == **p)
            .map(|p| (p.as_vec3() + 0.0).to_array().map(f32::to_bits))
            .collect();
        let flat = (0..mesh.faces.len()).filter(|&n| mesh.area_vector(n) == DVec3::ZERO).count();
        Self {
            bad_edges: directed.iter().filter(bad).count(),
            bad_points: links.iter().filter(|l| !l.is_empty() && !one_fan(l)).count(),
            idle_points: links.len() - used,
            degenerate: flat + (mesh.points.len() - places.len()),
            components: (0..joined.len())
                .filter(|&n| !links[n].is_empty() && root(&mut joined, n) == n)
                .count(),
            euler: used as i64 - directed.len() as i64 / 2 + mesh.faces.len() as i64,
        }
    }
}

pub fn root(of: &mut [usize], mut n: usize) -> usize {
    while of[n] != n {
        of[n] = of[of[n]];
        n = of[n];
    }
    n
}

/// Whether the links make one cycle.
fn one_fan(links: &[[u32; 2]]) -> bool {
    let next: BTreeMap<u32, u32> = links.iter().map(|&[a, b]| (a, b)).collect();
    let (start, mut at, mut steps) = (links[0][0], links[0][0], 0);
    while let Some(&to) = next.get(&at) {
        (at, steps) = (to, steps + 1);
        if at == start || steps > links.len() {
            break;
        }
    }
    at == start && steps == links.len() && next.len() == links.len()
}
