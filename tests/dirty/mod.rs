//! Dirty meshes made from clean solids of known volume: whatever is wrong with them, the road from
//! mesh to mesh must give the right closed solid, or say in one sentence why there is none.
//!
//! `FIELDGRAFT_DIRTY=FOLDER` keeps the inputs and results as STL, for other judges.

mod classes;
mod solids;

use classes::Dirty;
use fieldgraft::check::{Health, Options, inspect};
use fieldgraft::field::Field;
use fieldgraft::field::mesh::{MeshField, MeshOptions, MeshReport};
use fieldgraft::field::sample::sample;
use fieldgraft::grid::Lattice;
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::{TriMesh, snap, write};
use fieldgraft::num::Aabb;
use glam::DVec3;
use rayon::prelude::*;
use std::path::Path;

/// Cells along the longest side.
const CELLS: f64 = 44.0;

fn used(mesh: &TriMesh) -> Aabb {
    Aabb::of(mesh.faces.iter().flatten().map(|&v| mesh.points[v as usize]))
}

/// The lattice for a mesh; its origin is off every face of a solid that lies straight.
fn lattice(mesh: &TriMesh, size: f64) -> Lattice {
    let b = used(mesh);
    let step = size / CELLS;
    let room = b.grow(step * 2.37);
    let size = (room.size() / step).ceil().to_array().map(|n| n as u32 + 2);
    Lattice { origin: room.min, step, size }
}

fn field(mesh: &TriMesh) -> Result<(MeshField, MeshReport), String> {
    MeshField::new(mesh, &MeshOptions::default(), &Quiet).map_err(|e| e.to_string())
}

/// Mesh to field to mesh.
fn road(d: &Dirty) -> Result<(TriMesh, MeshReport), String> {
    let (field, report) = field(&d.mesh)?;
    let samples = sample(&field, lattice(&d.mesh, d.size), &Quiet).map_err(|e| e.to_string())?;
    let made = extract(&samples.bricks, Mesher::Cone, &Quiet).map_err(|e| e.to_string())?;
    Ok((made, report))
}

/// What is wrong with a result, in words.
fn faults(d: &Dirty, made: &TriMesh, h: &Health) -> Vec<String> {
    let mut wrong = vec![];
    let sound = h.closed && h.manifold_edges && h.manifold_vertices && h.oriented;
    let counts = [h.self_intersections.unwrap_or(1), h.degenerate_triangles, h.duplicate_triangles];
    if !sound || counts != [0; 3] {
        wrong.push(format!("{:?}", h.reasons));
    }
    let off = made.volume() / d.volume - 1.0;
    if off.abs() >= d.within {
        wrong.push(format!("volume off by {:.2}%", off * 100.0));
    }
    wrong
}

/// Writes what other judges look at.
fn keep(folder: &Path, d: &Dirty, made: &TriMesh) {
    let name: String =
        d.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    // as `convert` does, and near the origin, where f32 has digits enough
    let at = made.bounds().centre();
    let mut near = made.clone();
    // judges have lengths of their own below or above which they see nothing; a power of two is exact
    let size = (20.0 / d.size).log2();
    let scale = if size.abs() > 10.0 { size.round().exp2() } else { 1.0 };
    near.points.iter_mut().for_each(|p| *p = (*p - at) * scale);
    snap(&mut near);
    write(&folder.join(format!("{name}.stl")), &near, "", true).unwrap();
}

#[test]
fn every_dirty_mesh_gives_its_solid() {
    let folder = std::env::var_os("FIELDGRAFT_DIRTY").map(std::path::PathBuf::from);
    let all = classes::dirty();
    assert!(all.len() >= 200 && classes::classes() >= 25, "{} meshes", all.len());
    let judged: Vec<(f64, Vec<String>)> = all
        .par_iter()
        .map(|d| match road(d) {
            Ok((made, report)) => {
                let health = inspect(&made, &Options::default());
                if let Some(folder) = &folder {
                    keep(folder, d, &made);
                }
                let told = report.summary().join("; ");
                let off = (made.volume() / d.volume - 1.0).abs();
                let wrong = faults(d, &made, &health);
                (off, wrong.into_iter().map(|w| format!("{}: {w} [{told}]", d.name)).collect())
            }
            Err(why) => (1.0, vec![format!("{}: {why}", d.name)]),
        })
        .collect();
    let wrong: Vec<&String> = judged.iter().flat_map(|(_, w)| w).collect();
    let worst = judged.iter().map(|(off, _)| *off).fold(0.0, f64::max);
    println!(
        "{} meshes of {} classes, volume off by {:.2}% at most",
        all.len(),
        classes::classes(),
        worst * 100.0
    );
    assert!(wrong.is_empty(), "{} of {}:\n{wrong:#?}", wrong.len(), all.len());
}

#[test]
fn what_encloses_nothing_is_named_with_the_cure() {
    let mut wrong = vec![];
    for (name, mesh, part) in classes::hopeless() {
        match field(&mesh) {
            // what is left of it may be something; the first thing said is what is wrong
            Ok((_, report)) if report.summary().first().is_some_and(|s| s.contains(part)) => {}
            Ok((_, report)) => wrong.push(format!("{name}: a field; {:?}", report.summary())),
            Err(why) if !why.contains(part) || why.contains('\n') => {
                wrong.push(format!("{name}: `{why}` does not say `{part}`"));
            }
            Err(_) => {}
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A way to move a mesh: what it does to a point, by what it scales, and what else it does.
type Move = (&'static str, f64, fn(DVec3) -> DVec3, fn(&TriMesh) -> TriMesh);

const MOVES: &[Move] = &[
    ("shifted", 1.0, |p| p + DVec3::new(1234.567, -2345.678, 3456.789), same),
    ("scaled down", 0.037, |p| p * 0.037, same),
    ("scaled up", 1234.5, |p| p * 1234.5, same),
    ("turned about z", 1.0, |p| DVec3::new(-p.y, p.x, p.z), same),
    ("turned about x", 1.0, |p| DVec3::new(p.x, -p.z, p.y), same),
    ("turned about the diagonal", 1.0, |p| DVec3::new(p.z, p.x, p.y), same),
    ("in another order", 1.0, |p| p, shuffled),
];

fn same(m: &TriMesh) -> TriMesh {
    m.clone()
}

/// Points, faces and corners in another order.
fn shuffled(m: &TriMesh) -> TriMesh {
    let mut r = crate::util::Random::new(77);
    let mut order: Vec<u32> = (0..m.points.len() as u32).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, r.below(i + 1));
    }
    let mut points = vec![DVec3::ZERO; m.points.len()];
    for (from, &to) in order.iter().enumerate() {
        points[to as usize] = m.points[from];
    }
    let turned = |f: [u32; 3], by: usize| [f[by % 3], f[(by + 1) % 3], f[(by + 2) % 3]];
    let mut faces: Vec<[u32; 3]> =
        m.faces.iter().map(|f| turned(f.map(|v| order[v as usize]), r.below(3))).collect();
    for i in (1..faces.len()).rev() {
        faces.swap(i, r.below(i + 1));
    }
    TriMesh { points, faces }
}

#[test]
fn results_do_not_depend_on_place_size_turn_or_order() {
    let wrong: Vec<String> = classes::some()
        .par_iter()
        .flat_map_iter(|d| {
            // rounding by the move itself must stay below what is asked of the result
            let far = d.name.starts_with("a million");
            let (f, _) = field(&d.mesh).unwrap();
            let b = used(&d.mesh);
            let voxel = b.size().max_element() / 256.0;
            let mut r = crate::util::Random::new(3);
            let at: Vec<DVec3> =
                (0..400).map(|_| b.centre() + r.vector() * (b.size() * 0.55)).collect();
            // across a crack the surface is as uncertain as the crack is wide, here half a voxel
            let cracked = d.name.starts_with("cracked");
            let moves = MOVES.iter().filter(|m| !far || m.1 == 1.0 && m.0 != "shifted");
            moves
                .filter_map(|(name, scale, to, also)| {
                    let mut mesh = also(&d.mesh);
                    mesh.points.iter_mut().for_each(|p| *p = to(*p));
                    let Ok((g, _)) = field(&mesh) else {
                        return Some(format!("{}, {name}: no field", d.name));
                    };
                    let off = |p: &DVec3| (g.value(to(*p)) / scale - f.value(*p)).abs() / voxel;
                    let worst = at.iter().map(off).fold(0.0, f64::max);
                    let open = cracked && *name == "in another order";
                    let most = if open { 0.5 } else { 1e-3 };
                    let many = at.iter().filter(|p| off(p) > most).count();
                    (many > 0).then(|| {
                        format!("{}, {name}: off by {worst:.4} voxels, {many} points", d.name)
                    })
                })
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
