//! The health of a mesh, found by our own code: is it closed, manifold, oriented, free of
//! contact with itself, of how many pieces, how large.
//!
//! Words: points with equal coordinates are joined first and are then one *vertex*. An *edge*
//! is manifold when exactly two triangles share it, a *vertex* when the triangles round it make
//! one fan. A *component* is a set of triangles joined through edges; of positive volume it is a
//! *solid*, of negative volume a *cavity*. A mesh is *closed* when its directed edges cancel,
//! which also holds where four triangles meet at one edge.
//!
//! ```
//! use fieldgraft::{check, mesh::TriMesh};
//! use glam::DVec3;
//!
//! let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let health = check::inspect(&TriMesh { points, faces }, &check::Options::default());
//! assert!(health.printable && health.genus == Some(0));
//! assert!(health.volume_mm3.is_some_and(|v| (v - 1.0 / 6.0).abs() < 1e-12));
//! ```

mod buckets;
mod contact;
pub mod distance;
mod parts;
mod stand;
mod topology;
mod triangles;
mod wall;
mod weld;

pub use distance::Shell;
pub use parts::{Crumbs, Part, Pieces, drop_crumbs, parts, solid_pieces};
pub use stand::{Stance, stance};
pub use wall::thinnest_wall;

use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::DVec3;
use parts::Anatomy;
use rayon::prelude::*;
use serde::Serialize;
use topology::Topology;
use weld::Welded;

/// What to look for beyond the cheap questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Whether to count the triangles that meet others: about as long again as all the rest.
    pub self_intersections: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { self_intersections: true }
    }
}

/// The state of a mesh, in the words of `check --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Health {
    /// Triangles.
    pub triangles: u64,
    /// Distinct positions that a triangle uses.
    pub vertices: u64,
    /// Whether the directed edges cancel.
    pub closed: bool,
    /// Whether every edge has exactly two triangles.
    pub manifold_edges: bool,
    /// Whether the triangles round each vertex make one fan, and no edge has more than two.
    pub manifold_vertices: bool,
    /// Whether neighbours agree on which side is outside.
    pub oriented: bool,
    /// Triangles that cut, touch or fold over another beyond what they share; `None` when not
    /// asked for, or not to be had because a point is not finite.
    pub self_intersections: Option<u64>,
    /// Sets of triangles joined through edges.
    pub components: u64,
    /// Handles, over all components; `None` unless closed and manifold.
    pub genus: Option<i64>,
    /// Enclosed volume; `None` unless closed.
    pub volume_mm3: Option<f64>,
    /// Surface area.
    pub area_mm2: f64,
    /// Lowest and highest corner of the box round it.
    pub bbox_mm: [[f64; 3]; 2],
    /// Thinnest wall, see [`thinnest_wall`]; [`inspect`] leaves it open, since it takes longer than
    /// all the rest.
    pub min_wall_mm: Option<f64>,
    /// Solids other than the largest; `None` unless closed.
    pub floating_parts: Option<u64>,
    /// Whether it stands by itself: its centre of mass over the hull of what touches the floor;
    /// `None` unless closed, oriented and of one solid.
    pub balanced: Option<bool>,
    /// Closed cavities inside solids; `None` unless closed.
    pub cavities: Option<u64>,
    /// Edges with one triangle only.
    pub open_edges: u64,
    /// Triangles without area.
    pub degenerate_triangles: u64,
    /// Triangles on the same three vertices as an earlier one.
    pub duplicate_triangles: u64,
    /// Whether a slicer needs no repair: nothing stands in `reasons`.
    pub printable: bool,
    /// Why it is not printable, one plain sentence each.
    pub reasons: Vec<String>,
}

/// Examines a mesh. Any mesh: nothing is taken for granted.
pub fn inspect(mesh: &TriMesh, options: &Options) -> Health {
    health(mesh, &Found::of(mesh), options)
}

/// A mesh without its crumbs, and what it looks like then.
#[derive(Clone, Debug)]
pub struct Swept {
    /// What is left.
    pub mesh: TriMesh,
    /// What was dropped.
    pub crumbs: Crumbs,
    /// The state of what is left.
    pub health: Health,
    /// Its pieces.
    pub pieces: Pieces,
    /// What [`parts`] tells of it.
    pub parts: (Vec<u32>, Vec<Part>),
}

/// [`drop_crumbs`] where the share is above zero, then [`inspect`] and [`solid_pieces`], in less time
/// than one after the other.
pub fn sweep(mut mesh: TriMesh, smallest_share: f64, options: &Options) -> Swept {
    let mut found = Found::of(&mesh);
    let mut crumbs = Crumbs::default();
    if smallest_share > 0.0
        && let Some((dropped, stays)) = parts::crumbs(&found.welded, &found.anatomy, smallest_share)
    {
        let Anatomy { topology, .. } = &found.anatomy;
        let left = parts::left(&mesh, &topology.labels, &stays);
        let known = found.welded.is_whole().then(|| topology.without(&stays, &left)).flatten();
        drop(found);
        (mesh, crumbs) = (left, dropped);
        found = match known {
            Some(topology) => {
                Found::with(&mesh, Welded::whole(&mesh), |mesh| Anatomy::with(mesh, topology))
            }
            None => Found::of(&mesh),
        };
    }
    let pieces = parts::count(&found.anatomy.parts);
    let health = health(&mesh, &found, options);
    let Found { anatomy: Anatomy { topology, parts }, .. } = found;
    let parts = (topology.labels, parts);
    Swept { mesh, crumbs, health, pieces, parts }
}

/// What the state of a mesh is told from.
struct Found<'a> {
    welded: Welded<'a>,
    anatomy: Anatomy,
    sizes: Sizes,
    stance: Option<Stance>,
}

impl<'a> Found<'a> {
    fn of(mesh: &'a TriMesh) -> Self {
        Self::with(mesh, weld::weld(mesh), Anatomy::of)
    }

    fn with(
        mesh: &'a TriMesh,
        welded: Welded<'a>,
        anatomy: impl FnOnce(&Welded) -> Anatomy + Send,
    ) -> Self {
        let stand = || if welded.astray == 0 { stance(mesh) } else { None };
        let (anatomy, (sizes, stance)) =
            rayon::join(|| anatomy(&welded), || rayon::join(|| Sizes::of(&welded), stand));
        Self { welded, anatomy, sizes, stance }
    }
}

fn health(mesh: &TriMesh, found: &Found, options: &Options) -> Health {
    let Found { welded, anatomy: Anatomy { topology, parts }, sizes, stance } = found;
    let pieces = parts::count(parts);
    let when_closed = |n: usize| (topology.closed && sizes.wild == 0).then_some(n as u64);
    let met = if options.self_intersections { contact::contacts(welded) } else { None };
    let mut health = Health {
        triangles: mesh.faces.len() as u64,
        vertices: topology.vertices as u64,
        closed: topology.closed,
        manifold_edges: topology.manifold_edges,
        manifold_vertices: !mesh.faces.is_empty()
            && topology.split_vertices == 0
            && topology.crowded_edges == 0,
        oriented: topology.oriented,
        self_intersections: met.map(|met| met.iter().filter(|&&m| m).count() as u64),
        components: topology.components as u64,
        genus: topology.genus().filter(|_| sizes.collapsed == 0),
        volume_mm3: when_closed(0).map(|_| parts.iter().map(|p| p.volume_mm3).sum()),
        area_mm2: sizes.area,
        bbox_mm: sizes.bounds,
        min_wall_mm: None,
        floating_parts: when_closed(pieces.solids.saturating_sub(1)),
        balanced: None,
        cavities: when_closed(pieces.cavities),
        open_edges: topology.open_edges as u64,
        degenerate_triangles: sizes.flat as u64,
        duplicate_triangles: topology.duplicates as u64,
        printable: false,
        reasons: Vec::new(),
    };
    if health.closed && health.floating_parts == Some(0) && welded.astray == 0 {
        health.balanced = stance.map(|s| s.margin > 0.0);
    }
    health.reasons = reasons(&health, topology, sizes, welded.astray);
    health.printable = health.reasons.is_empty();
    health
}

/// The faces that meet others beyond what they share, in order; `None` when some point is not
/// finite. [`Health::self_intersections`] is their number.
pub fn intersecting_faces(mesh: &TriMesh) -> Option<Vec<u32>> {
    let met = contact::contacts(&weld::weld(mesh))?;
    Some((0..met.len() as u32).filter(|&i| met[i as usize]).collect())
}

/// A mesh without the faces that lie on the corners of an earlier one, either way round: pictures and
/// walls are the same without them. Most meshes have none and are given back as they are.
pub fn without_copies(mut mesh: TriMesh) -> TriMesh {
    let welded = weld::weld(&mesh);
    let piles = contact::piles(&welded);
    if piles.len() < mesh.faces.len() {
        let mut first = vec![false; mesh.faces.len()];
        piles.iter().for_each(|pile| first[pile[0] as usize] = true);
        let mut first = first.into_iter();
        mesh.faces.retain(|_| first.next() == Some(true));
    }
    mesh
}

/// Areas that are held at once.
const AREAS: usize = 1 << 16;

/// What is measured face by face.
struct Sizes {
    area: f64,
    bounds: [[f64; 3]; 2],
    /// Faces without area, collapsed ones among them.
    flat: usize,
    /// Faces with a vertex twice.
    collapsed: usize,
    /// Points that are not finite.
    wild: usize,
}

impl Sizes {
    fn of(mesh: &Welded) -> Self {
        let corners = |f: &[u32; 3]| f.map(|v| mesh.points[v as usize]);
        // Summed in order: the same figure on any number of threads.
        let areas = mesh
            .faces
            .chunks(AREAS)
            .flat_map(|faces| faces.par_iter().map(|f| area(corners(f))).collect::<Vec<f64>>());
        let finite = mesh.points.iter().copied().filter(|p| p.is_finite());
        let bounds = Aabb::of(finite);
        let corner = |p: DVec3| {
            if bounds.is_empty() { [0.0; 3] } else { p.to_array() }
        };
        let repeats = |f: &&[u32; 3]| f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
        Self {
            area: areas.sum(),
            bounds: [corner(bounds.min), corner(bounds.max)],
            flat: mesh.faces.iter().filter(|f| repeats(f) || is_flat(corners(f))).count(),
            collapsed: mesh.faces.iter().filter(repeats).count(),
            wild: mesh.points.iter().filter(|p| !p.is_finite()).count(),
        }
    }
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() * 0.5
}

/// Whether a triangle is, to rounding, a line: its height under 1e-14 of its longest side.
fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - b).length_squared());
    2.0 * area([a, b, c]) <= 1e-30 + 1e-14 * longest.max((a - c).length_squared())
}

fn reasons(health: &Health, topology: &Topology, sizes: &Sizes, astray: usize) -> Vec<String> {
    if health.triangles == 0 {
        return vec!["it has no triangles".into()];
    }
    let contacts = health.self_intersections.unwrap_or(0) as usize;
    let counted = [
        (
            astray,
            "triangle names a point that is not there",
            "triangles name points that are not there",
        ),
        (sizes.wild, "point is not finite", "points are not finite"),
        (topology.open_edges, "edge is open", "edges are open"),
        (
            topology.crowded_edges,
            "edge has more than two triangles",
            "edges have more than two triangles",
        ),
        (
            topology.opposed_edges,
            "edge has two triangles that disagree on the outside",
            "edges have two triangles that disagree on the outside",
        ),
        (
            topology.split_vertices,
            "vertex joins fans that share no edge",
            "vertices join fans that share no edge",
        ),
        (sizes.flat, "triangle has no area", "triangles have no area"),
        (
            health.duplicate_triangles as usize,
            "triangle is a duplicate",
            "triangles are duplicates",
        ),
        (contacts, "triangle cuts or touches another", "triangles cut or touch others"),
    ];
    let mut reasons: Vec<String> = counted
        .into_iter()
        .filter(|(n, ..)| *n > 0)
        .map(|(n, one, many)| format!("{n} {}", if n == 1 { one } else { many }))
        .collect();
    match health.volume_mm3 {
        Some(v) if v < 0.0 => reasons.push("its volume is negative: it is inside out".into()),
        Some(v) if v.is_nan() || v == 0.0 => reasons.push("it encloses no volume".into()),
        _ => {}
    }
    reasons
}

#[cfg(test)]
mod measures;
#[cfg(test)]
mod tests;
