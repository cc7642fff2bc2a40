//! Samples in rows: `patch,u,v,x,y,z`, u slowest.

use super::out::Stop;
use crate::cli::failure::Failure;
use crate::cli::watch::Watch;
use fieldgraft::job::{self, Job};
use fieldgraft::num::Aabb;
use fieldgraft::scene::surface::Still;
use fieldgraft::surface::SurfaceError;
use fieldgraft::surface::nurbs::Curve;
use glam::{DVec2, DVec3};
use std::io::Write;

/// A sample: place, point, derivatives by u and v.
pub struct Sample {
    /// Patch number, from 0.
    pub patch: usize,
    /// (u, v); v is 0 on a curve.
    pub uv: DVec2,
    /// The point, mm.
    pub s: DVec3,
    /// Derivatives by u and v; zero by v on a curve.
    pub d: [DVec3; 2],
}

/// The `i`-th of `n` equal steps over a domain, both ends exactly.
fn along([from, to]: [f64; 2], i: usize, n: usize) -> f64 {
    let w = i as f64 / (n - 1) as f64;
    from * (1.0 - w) + to * w
}

/// Number of samples.
pub fn count(still: &Still, [nu, nv]: [usize; 2]) -> usize {
    match still {
        Still::Surface(s) => s.patches().saturating_mul(nu).saturating_mul(nv),
        Still::Curve(_) => nu,
    }
}

/// Gives every sample, u slowest.
pub fn each(
    still: &Still,
    [nu, nv]: [usize; 2],
    watch: &Watch,
    mut give: impl FnMut(&Sample) -> Result<(), Stop>,
) -> Result<(), Stop> {
    let patches = match still {
        Still::Surface(s) => s.patches(),
        Still::Curve(_) => 1,
    };
    for patch in 0..patches {
        for i in 0..nu {
            job::check(watch).map_err(Failure::from)?;
            watch.done((patch * nu + i) as f64 / (patches * nu) as f64);
            match still {
                Still::Surface(surface) => {
                    let domain = surface.domain(patch);
                    for j in 0..nv {
                        let uv = DVec2::new(along(domain.u, i, nu), along(domain.v, j, nv));
                        let jet = surface.jet(patch, uv);
                        give(&Sample { patch, uv, s: jet.s, d: [jet.su, jet.sv] })?;
                    }
                }
                Still::Curve(curve) => give(&on(curve.as_ref(), i, nu))?,
            }
        }
    }
    Ok(())
}

fn on(curve: &dyn Curve, i: usize, n: usize) -> Sample {
    let u = along(curve.domain(), i, n);
    let jet = curve.at(u);
    Sample { patch: 0, uv: DVec2::new(u, 0.0), s: jet.c, d: [jet.d1, DVec3::ZERO] }
}

/// Writes the rows with their header and gives the box round them.
pub fn write(
    out: &mut dyn Write,
    still: &Still,
    samples: [usize; 2],
    derivatives: bool,
    wrong: &dyn Fn(SurfaceError) -> Failure,
    watch: &Watch,
) -> Result<Aabb, Stop> {
    let more = if derivatives { ",xu,yu,zu,xv,yv,zv" } else { "" };
    writeln!(out, "patch,u,v,x,y,z{more}")?;
    let mut bounds = Aabb::EMPTY;
    each(still, samples, watch, |sample| {
        let Sample { patch, uv, s, d } = sample;
        let sound = s.is_finite() && (!derivatives || d.iter().all(|d| d.is_finite()));
        if !sound {
            let why = format!("not finite at u = {}, v = {}", uv.x, uv.y);
            return Err(wrong(SurfaceError::new(format!("patches[{patch}]"), why)).into());
        }
        bounds = bounds.with(*s);
        // the shortest decimals that read back as the same number
        write!(out, "{patch},{:?},{:?},{:?},{:?},{:?}", uv.x, uv.y, s.x, s.y, s.z)?;
        if derivatives {
            for x in d.iter().flat_map(|d| d.to_array()) {
                write!(out, ",{x:?}")?;
            }
        }
        Ok(writeln!(out)?)
    })?;
    Ok(bounds)
}

/// Writes polylines as OBJ, Y up as this program's OBJ meshes: (x, y, z) goes out as (x, z, -y).
pub fn write_lines(out: &mut dyn Write, lines: &[Vec<DVec3>]) -> Result<(), Stop> {
    writeln!(out, "# fieldgraft UNITS=mm UP=y")?;
    for p in lines.iter().flatten() {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.z, 0.0 - p.y)?;
    }
    let mut first = 1;
    for line in lines {
        write!(out, "l")?;
        for i in 0..line.len() {
            write!(out, " {}", first + i)?;
        }
        writeln!(out)?;
        first += line.len();
    }
    Ok(())
}
