use crate::field::Field;
use glam::DVec3;
use rayon::prelude::*;

/// The field's direction of growth at each point, of length 1: the outward normal of its surface.
/// Central differences over `step` mm to either side; zero where they vanish.
pub fn normals(f: &dyn Field, points: &[DVec3], step: f64) -> Vec<DVec3> {
    points.par_chunks(64).flat_map_iter(|chunk| gradients(f, chunk, step)).collect()
}

/// The same, on this thread.
pub(super) fn gradients(f: &dyn Field, points: &[DVec3], step: f64) -> Vec<DVec3> {
    let sides = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let at: Vec<DVec3> = points.iter().flat_map(|&p| sides.map(|side| p + side * step)).collect();
    let mut values = vec![0.0; at.len()];
    f.values(&at, &mut values);
    let normal = |v: &[f64]| DVec3::new(v[0] - v[1], v[2] - v[3], v[4] - v[5]);
    values.chunks_exact(6).map(|v| normal(v).normalize_or_zero()).collect()
}
