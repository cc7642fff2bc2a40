//! What is measured of a frame, beyond its health.

use super::row::Row;
use crate::check::distance::{Apart, OneWay};
use crate::check::{Shell, inspect, parts, thinnest_wall};
use crate::field::{Field, sample::sample};
use crate::grid::Lattice;
use crate::iso::{Mesher, extract};
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;
use crate::run::FrameReport;
use crate::scene::LiveShape;
use glam::DVec3;
use serde::Serialize;
use std::sync::OnceLock;

/// A parent on the lattice of the frames.
pub(super) struct Parent {
    pub shell: Shell,
    pub about: ParentReport,
    /// Its own measures, once a frame was this parent again.
    own: OnceLock<Row>,
}

/// What is known of a parent.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ParentReport {
    /// Its name in the recipe.
    pub name: String,
    /// Triangles.
    pub triangles: u64,
    /// Solids.
    pub pieces: u64,
    /// Handles.
    pub genus: Option<i64>,
    /// Volume, mm³.
    pub volume_mm3: Option<f64>,
    /// Area, mm².
    pub area_mm2: f64,
    /// Thinnest wall, mm.
    pub min_wall_mm: Option<f64>,
}

impl Parent {
    /// Samples and meshes a shape as the frames are.
    pub fn new(shape: &LiveShape, lattice: Lattice, job: &dyn Job) -> Result<Self, Cancelled> {
        let samples = sample(&*shape.field, lattice, job)?;
        let mesh = extract(&samples.bricks, Mesher::Cone, job)?;
        let health = inspect(&mesh, &crate::check::Options { self_intersections: false });
        let shell = Shell::new(mesh);
        let about = ParentReport {
            name: shape.name.clone(),
            triangles: health.triangles,
            pieces: health.components - health.cavities.unwrap_or(0).min(health.components),
            genus: health.genus,
            volume_mm3: health.volume_mm3,
            area_mm2: health.area_mm2,
            min_wall_mm: thinnest_wall(&shell, job)?,
        };
        Ok(Self { shell, about, own: OnceLock::new() })
    }
}

/// Fills in what the check found.
pub(super) fn health(row: &mut Row, report: &FrameReport) {
    row.error = report.error.clone();
    row.active_bricks = Some(report.active_bricks);
    row.border_clipped = Some(report.border_clipped);
    row.crumbs = Some(report.crumbs.count as u64);
    row.volume_kept = report.volume_kept;
    row.pieces = report.pieces;
    if let Some(h) = &report.health {
        row.triangles = Some(h.triangles);
        row.closed = Some(h.closed);
        row.manifold = Some(h.manifold_edges && h.manifold_vertices);
        row.self_intersections = h.self_intersections;
        row.components = Some(h.components);
        row.genus = h.genus;
        row.volume_mm3 = h.volume_mm3;
        row.area_mm2 = Some(h.area_mm2);
    }
}

/// Fills in the measures of a mesh; `before` is the frame before in t.
pub(super) fn mesh(
    row: &mut Row,
    shell: &Shell,
    parents: &[Parent],
    before: Option<&Shell>,
    job: &dyn Job,
) -> Result<(), Cancelled> {
    job.stage("measure");
    pieces(row, shell.mesh());
    // at its ends a morph is a parent, often to the last bit: those are measured once
    let same = parents.iter().find(|p| p.shell.mesh() == shell.mesh());
    match same.and_then(|p| p.own.get()) {
        Some(known) => row.take(known),
        None => alone(row, shell, parents, job)?,
    }
    if let Some(parent) = same {
        parent.own.get_or_init(|| row.clone());
    }
    // from here on the frame before counts
    if let Some(before) = before {
        let apart = known(&shell.to(before, job)?.0, &before.to(shell, job)?.0);
        let error = row.hausdorff_error_mm.unwrap_or(0.0);
        row.hausdorff_error_mm = Some(error.max(apart.map_or(0.0, |a| a.over)));
        (row.step_mm, row.mean_step_mm) = pair(apart);
    }
    Ok(())
}

/// The measures that do not depend on the frame before.
fn alone(row: &mut Row, shell: &Shell, parents: &[Parent], job: &dyn Job) -> Result<(), Cancelled> {
    row.min_wall_mm = thinnest_wall(shell, job)?;
    let mut error: f64 = 0.0;
    let mut nearer: Option<Vec<f64>> = None;
    for (i, parent) in parents.iter().enumerate() {
        let (there, points) = shell.to(&parent.shell, job)?;
        let (back, _) = parent.shell.to(shell, job)?;
        let apart = known(&there, &back);
        error = error.max(apart.map_or(0.0, |a| a.over));
        match i {
            0 => (row.hausdorff_to_a_mm, row.mean_to_a_mm) = pair(apart),
            1 => (row.hausdorff_to_b_mm, row.mean_to_b_mm) = pair(apart),
            _ => {}
        }
        nearer = Some(match nearer {
            None => points,
            Some(old) => old.iter().zip(&points).map(|(a, b)| a.min(*b)).collect(),
        });
    }
    row.stray_mm = nearer.map(|d| d.into_iter().fold(0.0, f64::max)).filter(|d| d.is_finite());
    row.hausdorff_error_mm = Some(error);
    Ok(())
}

/// Distances of surfaces that are there.
fn known(there: &OneWay, back: &OneWay) -> Option<Apart> {
    Some(Apart::of(there, back)).filter(|a| a.hausdorff.is_finite())
}

fn pair(apart: Option<Apart>) -> (Option<f64>, Option<f64>) {
    (apart.map(|a| a.hausdorff), apart.map(|a| a.mean))
}

/// The sizes of the pieces.
fn pieces(row: &mut Row, mesh: &TriMesh) {
    let (_, all) = parts(mesh);
    let solids = || all.iter().map(|p| p.volume_mm3).filter(|v| *v > 0.0);
    let large = |whole: f64| solids().filter(|v| *v >= Row::LARGE * whole).count() as u64;
    row.large_pieces = row.volume_mm3.map(large);
    row.smallest_piece_mm3 = solids().reduce(f64::min);
    row.smallest_piece_share =
        row.smallest_piece_mm3.zip(row.volume_mm3).filter(|(_, v)| *v > 0.0).map(|(s, v)| s / v);
}

/// Vertices at which the gradient is looked at.
const PROBES: usize = 2000;

/// Mean of | |grad f| - 1 | at the vertices, by central differences over a cell.
pub(super) fn gradient_error(field: &dyn Field, mesh: &TriMesh, step: f64) -> Option<f64> {
    let stride = mesh.points.len().div_ceil(PROBES).max(1);
    let h = 0.5 * step;
    let errors = mesh.points.iter().step_by(stride).map(|&p| {
        let d = |axis: DVec3| (field.value(p + axis * h) - field.value(p - axis * h)) / step;
        (DVec3::new(d(DVec3::X), d(DVec3::Y), d(DVec3::Z)).length() - 1.0).abs()
    });
    let (sum, n) = errors.fold((0.0, 0), |(sum, n), e| (sum + e, n + 1));
    (n > 0).then(|| sum / f64::from(n))
}
