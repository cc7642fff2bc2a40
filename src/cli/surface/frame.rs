//! One time of a surface, made and written.

use super::out::{Stop, Target, to_file, to_stdout};
use super::rows;
use crate::cli::failure::Failure;
use crate::cli::watch::Watch;
use fieldgraft::job::Job;
use fieldgraft::mesh::{snap, weld, write};
use fieldgraft::num::Aabb;
use fieldgraft::scene::surface::{Still, SurfaceFile};
use fieldgraft::surface::nurbs::polyline;
use fieldgraft::surface::tessellate::{MOST_POINTS, Tessellation, net, tessellate};
use fieldgraft::surface::{Surface, SurfaceError};
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::path::Path;

/// Samples where none are asked for.
const SAMPLES: [usize; 2] = [41, 41];
/// The same for a curve.
const CURVE_SAMPLES: usize = 201;
/// The size of a surface over the tolerance, where none is given.
const FINE: f64 = 2000.0;
/// Most rows of one CSV file.
const MOST_ROWS: usize = 100_000_000;

/// What is asked of every frame.
pub struct Wanted {
    /// Points over u and v.
    pub samples: Option<[usize; 2]>,
    /// For triangles, mm.
    pub tolerance: Option<f64>,
    /// Whether derivatives go into the CSV.
    pub derivatives: bool,
    /// Whether the spine is wanted.
    pub spine: bool,
    /// Whether files may be overwritten.
    pub force: bool,
    /// Whether it is held against its exact form.
    pub measure: bool,
}

/// What was made, for the report.
#[derive(Debug, Serialize)]
pub struct Frame {
    t: f64,
    output: Option<String>,
    patches: usize,
    samples: Option<[usize; 2]>,
    tolerance_mm: Option<f64>,
    triangles: Option<usize>,
    closed: Option<bool>,
    two_sided: Option<bool>,
    bbox_mm: Option<[[f64; 3]; 2]>,
    residual_mm: Option<f64>,
}

impl Frame {
    /// Says what was made, on stderr.
    pub fn tell(&self, target: &Target, watch: &Watch) {
        let Some(path) = target.path() else { return };
        let what = match (self.triangles, self.samples) {
            (Some(n), _) => {
                let state = match (self.closed, self.two_sided) {
                    (_, Some(false)) => ", one-sided",
                    (Some(true), _) => ", closed",
                    _ => ", open",
                };
                format!("{n} triangles{state}")
            }
            (None, Some([u, v])) if v > 1 => {
                format!("{} patches of {u} x {v} samples", self.patches)
            }
            (None, Some([u, _])) => format!("{u} samples"),
            (None, None) => "lines".to_owned(),
        };
        watch.say(&format!("{}: {what}", path.display()));
    }
}

/// Makes and writes the frame at `t`, which is `share` of the whole motion.
pub fn make(
    file: &SurfaceFile,
    t: f64,
    share: f64,
    target: &Target,
    wanted: &Wanted,
    watch: &Watch,
) -> Result<Frame, Failure> {
    watch.stage("sample");
    let wrong = |e: SurfaceError| Failure::from(file.locate(e));
    let still = file.object.at(share).map_err(wrong)?;
    let patches = match &still {
        Still::Surface(s) => s.patches(),
        Still::Curve(_) => 1,
    };
    let residual = if wanted.measure { file.residual(share).map_err(wrong)? } else { None };
    let mut frame = Frame {
        t,
        output: target.path().map(|p| p.display().to_string()),
        patches,
        samples: None,
        tolerance_mm: None,
        triangles: None,
        closed: None,
        two_sided: None,
        bbox_mm: None,
        residual_mm: residual,
    };
    if wanted.spine {
        spine(file, share, target, wanted, &mut frame)?;
        return Ok(frame);
    }
    match (target, &still) {
        (Target::Mesh(path), Still::Surface(surface)) => {
            mesh(surface.as_ref(), path, wanted, &mut frame, &wrong)?;
        }
        (Target::Mesh(path) | Target::Lines(path), Still::Curve(_)) => {
            curve(&still, path, wanted, &mut frame, &wrong)?;
        }
        _ => {
            let samples = wanted.samples.unwrap_or(SAMPLES);
            let samples = match &still {
                Still::Curve(_) => [wanted.samples.map_or(CURVE_SAMPLES, |s| s[0]), 1],
                Still::Surface(_) => samples,
            };
            let rows = rows::count(&still, samples);
            if rows > MOST_ROWS {
                let why = format!("--samples: {rows} rows; at most {MOST_ROWS}");
                return Err(Failure::new(Failure::LIMIT, why));
            }
            let mut bounds = Aabb::EMPTY;
            let put = |out: &mut dyn std::io::Write| {
                bounds = rows::write(out, &still, samples, wanted.derivatives, &wrong, watch)?;
                Ok(())
            };
            text(target, wanted.force, put)?;
            (frame.samples, frame.bbox_mm) = (Some(samples), Some(corners(&bounds)));
        }
    }
    Ok(frame)
}

/// Writes text to a file or to stdout.
fn text(
    target: &Target,
    force: bool,
    put: impl FnOnce(&mut dyn std::io::Write) -> Result<(), Stop>,
) -> Result<(), Failure> {
    match target.path() {
        Some(path) => to_file(path, force, put),
        None => to_stdout(put),
    }
}

fn corners(b: &Aabb) -> [[f64; 3]; 2] {
    [b.min.to_array(), b.max.to_array()]
}

/// Writes triangles: the net of the samples, or as fine as the tolerance asks.
fn mesh(
    surface: &dyn Surface,
    path: &Path,
    wanted: &Wanted,
    frame: &mut Frame,
    wrong: &dyn Fn(SurfaceError) -> Failure,
) -> Result<(), Failure> {
    if wanted.derivatives {
        return Err(Failure::usage("--derivatives: only a CSV holds them"));
    }
    let made: Tessellation = match wanted.samples {
        Some(size) => {
            let [u, v] = size;
            let points = u.saturating_mul(v).saturating_mul(surface.patches());
            if points > MOST_POINTS {
                let why = format!("--samples: {points} points; at most {MOST_POINTS}");
                return Err(Failure::new(Failure::LIMIT, why));
            }
            net(surface, size).map_err(wrong)?
        }
        None => {
            let tolerance = wanted.tolerance.unwrap_or_else(|| diagonal(surface) / FINE);
            frame.tolerance_mm = Some(tolerance);
            tessellate(surface, tolerance).map_err(wrong)?
        }
    };
    // a patch that has shrunk to a point has nothing left once its numbers are those of a file
    let mut mesh = made.mesh;
    snap(&mut mesh);
    let mesh = weld(&mesh);
    write(path, &mesh, "", wanted.force)?;
    frame.samples = wanted.samples;
    frame.triangles = Some(mesh.faces.len());
    (frame.closed, frame.two_sided) = (Some(made.closed), Some(made.two_sided));
    frame.bbox_mm = Some(corners(&mesh.bounds()));
    Ok(())
}

/// Diagonal of the box round some points of every patch, mm.
fn diagonal(surface: &dyn Surface) -> f64 {
    let mut bounds = Aabb::EMPTY;
    for patch in 0..surface.patches() {
        let domain = surface.domain(patch);
        for k in 0..33 * 33 {
            let along = |[a, b]: [f64; 2], i: usize| a + (b - a) * i as f64 / 32.0;
            let uv = DVec2::new(along(domain.u, k / 33), along(domain.v, k % 33));
            bounds = bounds.with(surface.point(patch, uv));
        }
    }
    bounds.size().length()
}

/// Writes a curve as a line.
fn curve(
    still: &Still,
    path: &Path,
    wanted: &Wanted,
    frame: &mut Frame,
    wrong: &dyn Fn(SurfaceError) -> Failure,
) -> Result<(), Failure> {
    let Still::Curve(curve) = still else { return Ok(()) };
    if path.extension().is_some_and(|e| !e.eq_ignore_ascii_case("obj")) {
        let why = "a curve has no triangles; write it as .csv or .obj";
        return Err(Failure::usage(format!("{}: {why}", path.display())));
    }
    let [a, b] = curve.domain();
    let points = match wanted.samples {
        Some([n, _]) => {
            (0..n).map(|i| curve.point(a + (b - a) * i as f64 / (n - 1) as f64)).collect()
        }
        None => {
            let rough = Aabb::of((0..=64).map(|i| curve.point(a + (b - a) * f64::from(i) / 64.0)));
            let tolerance = wanted.tolerance.unwrap_or(rough.size().length() / FINE);
            frame.tolerance_mm = Some(tolerance);
            let mut points = polyline(curve.as_ref(), tolerance).map_err(wrong)?;
            if curve.closed() {
                points.extend(points.first().copied());
            }
            points
        }
    };
    frame.samples = wanted.samples.map(|s| [s[0], 1]);
    frame.bbox_mm = Some(corners(&Aabb::of(points.iter().copied())));
    to_file(path, wanted.force, |out| rows::write_lines(out, &[points]))
}

/// Writes the spine.
fn spine(
    file: &SurfaceFile,
    share: f64,
    target: &Target,
    wanted: &Wanted,
    frame: &mut Frame,
) -> Result<(), Failure> {
    let Some(spine) = &file.spine else {
        let why = format!("--spine: only PDE surfaces have one; this is `{}`", file.kind.word());
        return Err(Failure::usage(why));
    };
    let n = wanted.samples.map_or(SAMPLES[0], |s| s[0]);
    if n > MOST_POINTS {
        return Err(Failure::new(Failure::LIMIT, format!("--samples: {n} points a patch")));
    }
    let lines = spine.points(share, n - 1).map_err(|e| Failure::from(file.locate(e)))?;
    frame.samples = Some([n, 1]);
    frame.bbox_mm = Some(corners(&Aabb::of(lines.iter().flatten().copied())));
    text(target, wanted.force, |out| match target {
        Target::Lines(_) => rows::write_lines(out, &lines),
        _ => {
            writeln!(out, "patch,u,v,x,y,z")?;
            for (patch, line) in lines.iter().enumerate() {
                for (i, DVec3 { x, y, z }) in line.iter().enumerate() {
                    let u = i as f64 / (n - 1) as f64;
                    writeln!(out, "{patch},{u:?},0.0,{x:?},{y:?},{z:?}")?;
                }
            }
            Ok(())
        }
    })
}
