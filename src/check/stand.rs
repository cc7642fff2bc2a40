//! Whether a mesh stands by itself.

use crate::mesh::TriMesh;
use glam::{DVec2, DVec3};

/// Points this share of the height above the lowest one touch the floor: less would find one foot
/// of four on a mesh made of samples, more would count a rounded foot's flank.
const CONTACT: f64 = 0.004;

/// How a body stands on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Centre of mass of the solid, mm, its density the same everywhere.
    pub centre: DVec3,
    /// How far the centre stands inside the hull of what touches the floor, mm; negative outside.
    pub margin: f64,
}

/// Centre of mass over the hull of the points that touch the floor (Prévost et al. 2013); `None`
/// without a positive volume. Meaningful for one closed piece, Z up.
pub fn stance(mesh: &TriMesh) -> Option<Stance> {
    let bounds = mesh.bounds();
    let origin = bounds.centre();
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for i in 0..mesh.faces.len() {
        let [a, b, c] = mesh.corners(i).map(|p| p - origin);
        let v = a.dot(b.cross(c)) / 6.0;
        volume += v;
        moment += v * (a + b + c) * 0.25;
    }
    if volume.is_nan() || volume <= 0.0 {
        return None;
    }
    let centre = origin + moment / volume;
    let floor = bounds.min.z + CONTACT * bounds.size().z;
    let used = mesh.faces.iter().flatten().map(|&v| mesh.points[v as usize]);
    let feet = hull(used.filter(|p| p.z <= floor).map(|p| p.truncate()).collect());
    Some(Stance { centre, margin: margin(&feet, centre.truncate()) })
}

/// Convex hull, counter-clockwise (Andrew 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for &p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter());
    all.extend(half(&mut points.iter().rev()));
    all
}

/// Distance to the hull's sides, positive inside.
fn margin(hull: &[DVec2], p: DVec2) -> f64 {
    let sides = || hull.iter().zip(hull.iter().cycle().skip(1));
    let inner = |(a, b): (&DVec2, &DVec2)| (b - a).normalize_or_zero().perp_dot(p - a);
    let least = sides().map(inner).fold(f64::INFINITY, f64::min);
    if hull.len() >= 3 && least >= 0.0 {
        return least;
    }
    let outer = |(a, b): (&DVec2, &DVec2)| {
        let along = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-300)).clamp(0.0, 1.0);
        p.distance(*a + (b - a) * along)
    };
    -sides().map(outer).fold(f64::INFINITY, f64::min)
}
