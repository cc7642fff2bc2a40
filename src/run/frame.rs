//! One field to one mesh: sample, extract, drop crumbs, inspect.

use super::report::FrameReport;
use crate::check::{self, Options, Part};
use crate::field::Shared;
use crate::field::sample::{sample, undecided, undecided_at_most};
use crate::grid::Lattice;
use crate::iso::{Mesher, extract, extract_sharp};
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;
use crate::recipe::MesherEntry;
use std::time::Instant;

/// What to make.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    /// The hybrid's name.
    pub variant: &'a str,
    /// The time.
    pub t: f64,
    /// Where to sample.
    pub lattice: Lattice,
    /// Which mesher.
    pub mesher: MesherEntry,
    /// Loose pieces below this share of the volume are dropped.
    pub crumbs: f64,
    /// Whether to count self-intersections and to search undecided cells.
    pub verify: bool,
}

/// A mesh, or why there is none.
#[derive(Clone, Debug)]
pub struct FrameResult {
    /// The mesh; `None` when the report has an error.
    pub mesh: Option<TriMesh>,
    /// What [`check::parts`] tells of the mesh.
    pub parts: (Vec<u32>, Vec<Part>),
    /// What is known about it.
    pub report: FrameReport,
}

impl FrameResult {
    /// A frame without a mesh.
    pub fn failed(work: &Work<'_>, why: String) -> Self {
        let report = FrameReport {
            hybrid: work.variant.to_owned(),
            t: work.t,
            error: Some(why),
            voxel_mm: work.lattice.step,
            ..FrameReport::default()
        };
        Self { mesh: None, parts: Default::default(), report }
    }
}

/// Times one stage.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let made = work();
    *seconds += start.elapsed().as_secs_f64();
    made
}

/// Subdivisions of an undecided cell when asked to verify: to half its side. Each further one
/// costs eight times as much.
const DECIDE_LEVELS: u32 = 1;

/// Makes the mesh of a field.
///
/// # Errors
/// [`Cancelled`]; an empty result is no error here but stands in the report.
pub fn make(
    work: &Work<'_>,
    field: &dyn Fn(&dyn Job) -> Result<Shared, Cancelled>,
    job: &dyn Job,
) -> Result<FrameResult, Cancelled> {
    let mut r = FrameReport {
        hybrid: work.variant.to_owned(),
        t: work.t,
        voxel_mm: work.lattice.step,
        ..FrameReport::default()
    };
    job.stage("morph");
    let field = timed(&mut r.seconds.morph, || field(job))?;
    let sampling = timed(&mut r.seconds.sample, || sample(&*field, work.lattice, job))?;
    r.active_bricks = sampling.stats.active_bricks;
    r.bricks = sampling.stats.bricks;
    r.evaluated = sampling.stats.evaluated;
    r.border_clipped = sampling.stats.border_clipped;
    let mesh = timed(&mut r.seconds.mesh, || match work.mesher {
        MesherEntry::Print => extract(&sampling.bricks, Mesher::Cone, job),
        MesherEntry::Sharp => extract_sharp(&sampling.bricks, &*field, job),
        MesherEntry::Preview => extract(&sampling.bricks, Mesher::SurfaceNets, job),
    })?;
    r.undecided_cells = Some(if work.verify {
        let search = || undecided(&*field, &sampling, DECIDE_LEVELS, job);
        let found = timed(&mut r.seconds.undecided, search)?;
        found.left + found.missed
    } else {
        timed(&mut r.seconds.undecided, || undecided_at_most(&sampling))
    });
    drop(sampling);
    if mesh.faces.is_empty() {
        let why = "nothing is inside: the result is empty at this time; try another method, inner \
                   function or finer cells";
        r.error = Some(why.to_owned());
        return Ok(FrameResult { mesh: None, parts: Default::default(), report: r });
    }
    job.stage("check");
    let options = Options { self_intersections: work.verify };
    let swept = timed(&mut r.seconds.check, || check::sweep(mesh, work.crumbs, &options));
    crate::job::check(job)?;
    r.crumbs = swept.crumbs;
    r.pieces = Some(swept.pieces.solids as u64);
    r.health = Some(swept.health);
    Ok(FrameResult { mesh: Some(swept.mesh), parts: swept.parts, report: r })
}
