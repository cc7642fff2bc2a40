//! `nurbs` and `nurbs-morph`.

use super::read::{Opened, Reader, check_count};
use super::{Parametric, SceneError, SurfaceFile, below, check_scale, plain, problem};
use crate::recipe::surface::{self as entry, Kind, Nest};
use crate::recipe::{Problem, SurfaceEntry};
use crate::surface::SurfaceError;
use crate::surface::nurbs::{
    Averaging, CurveMorph, Design, Falloff, Impact, MorphOptions, NurbsMorph, RationalCurve,
    RationalSurface, Rows,
};
use std::sync::Arc;

/// One target.
enum Spline {
    Curve(RationalCurve),
    Surface(RationalSurface),
}

pub fn still(e: &entry::Nurbs) -> Result<SurfaceFile, Problem> {
    let (object, story) = match make(e)? {
        Spline::Curve(c) => {
            let count = c.points().len();
            let story =
                format!("rational B-spline curve, degree {}, {count} points", c.knots().degree());
            (Parametric::Curve(Arc::new(c)), story)
        }
        Spline::Surface(s) => {
            let [u, v] = s.knots();
            let story = format!(
                "rational B-spline surface, degree {} x {}, {} x {} points",
                u.degree(),
                v.degree(),
                u.count(),
                v.count()
            );
            (Parametric::Surface(Arc::new(s)), story)
        }
    };
    Ok(plain(Kind::Nurbs, object, story))
}

fn make(e: &entry::Nurbs) -> Result<Spline, Problem> {
    check_scale(e.scale)?;
    let scaled = |&[x, y, z, w]: &[f64; 4]| [x * e.scale, y * e.scale, z * e.scale, w];
    let rows = || -> Vec<Vec<[f64; 4]>> {
        e.net.iter().map(|row| row.iter().map(scaled).collect()).collect()
    };
    match (e.degree.as_slice(), &e.knots_v) {
        (&[degree], None) => match rows().as_slice() {
            [row] => RationalCurve::new(degree, e.knots_u.clone(), row)
                .map(Spline::Curve)
                .map_err(problem),
            [] => Err(Problem::new("net", "the net has no control points")),
            all => {
                let why = format!(
                    "missing key; a net of {} rows is a surface, which has two degrees and knots_v",
                    all.len()
                );
                Err(Problem::new("knots_v", why))
            }
        },
        (&[u, v], Some(knots_v)) => {
            RationalSurface::new([u, v], e.knots_u.clone(), knots_v.clone(), &rows())
                .map(Spline::Surface)
                .map_err(problem)
        }
        (&[_], Some(_)) => Err(Problem::new("degree", "one degree; with knots_v expected two")),
        (&[_, _], None) => Err(Problem::new("knots_v", "missing key; two degrees are a surface's")),
        (all, _) => Err(Problem::new("degree", format!("{} numbers; expected 1 or 2", all.len()))),
    }
}

/// A morph of either sort, while it is made.
enum Morph {
    Curves(CurveMorph),
    Surfaces(NurbsMorph),
}

/// Asks either sort the same.
macro_rules! both {
    ($morph:expr, $m:ident => $do:expr) => {
        match $morph {
            Morph::Curves($m) => $do,
            Morph::Surfaces($m) => $do,
        }
    };
}

pub fn morph(
    e: &entry::NurbsMorph,
    by: &Opened,
    reader: &mut Reader,
) -> Result<Result<SurfaceFile, Problem>, SceneError> {
    check_count("targets", e.targets.len()).map_err(|p| by.locate(p))?;
    let mut targets = vec![];
    for (i, path) in e.targets.iter().enumerate() {
        targets.push(reader.named(by, &format!("targets[{i}]"), path, Kind::Nurbs)?);
    }
    let options = MorphOptions {
        averaging: averaging(e.averaging),
        weights: e.weights.clone(),
        scale: e.scale.clone(),
        masses: e.masses.clone(),
        designs: vec![],
    };
    if !e.design.is_empty() && e.averaging == entry::Averaging::Linear {
        let why = "linear averaging has no masses; use weighted averaging";
        return Ok(Err(Problem::new("design", why)));
    }
    let splines = splines(&targets)?;
    let made = build(splines, &options).map_err(problem).and_then(|mut m| {
        let designs = e.design.iter().enumerate();
        designs.into_iter().try_for_each(|(n, d)| design(&mut m, d, n, targets.len()))?;
        Ok(finish(m, e.averaging, targets.len()))
    });
    Ok(made)
}

pub fn between(
    from: &Opened,
    to: &Opened,
    by: entry::Averaging,
) -> Result<SurfaceFile, SceneError> {
    let splines = [from, to].map(spline);
    let [a, b] = splines;
    let options = MorphOptions { averaging: averaging(by), ..MorphOptions::default() };
    let made = build(vec![a?, b?], &options);
    made.map(|m| finish(m, by, 2)).map_err(|s| to.locate(Problem::new("", s.why)).into())
}

fn averaging(a: entry::Averaging) -> Averaging {
    match a {
        entry::Averaging::Linear => Averaging::Linear,
        entry::Averaging::Weighted => Averaging::Weighted,
    }
}

fn splines(targets: &[Opened]) -> Result<Vec<Spline>, SceneError> {
    targets.iter().map(spline).collect()
}

fn spline(target: &Opened) -> Result<Spline, SceneError> {
    match &target.entry {
        SurfaceEntry::Nurbs(e) => make(e).map_err(|p| target.locate(p).into()),
        _ => Err(target.locate(Problem::new("kind", "is not `nurbs`")).into()),
    }
}

fn build(splines: Vec<Spline>, options: &MorphOptions) -> Result<Morph, SurfaceError> {
    let (mut curves, mut surfaces) = (vec![], vec![]);
    for (i, s) in splines.into_iter().enumerate() {
        match s {
            Spline::Curve(c) => curves.push(c),
            Spline::Surface(s) => surfaces.push(s),
        }
        if !curves.is_empty() && !surfaces.is_empty() {
            let why = "not all targets are curves, not all surfaces; expected one sort";
            return Err(SurfaceError::new(format!("targets[{i}]"), why));
        }
    }
    if surfaces.is_empty() {
        CurveMorph::new(&curves, options).map(Morph::Curves)
    } else {
        NurbsMorph::new(&surfaces, options).map(Morph::Surfaces)
    }
}

fn finish(morph: Morph, by: entry::Averaging, count: usize) -> SurfaceFile {
    let by = match by {
        entry::Averaging::Linear => "linear",
        entry::Averaging::Weighted => "weighted",
    };
    match morph {
        Morph::Curves(m) => {
            let width = m.targets().first().map_or(0, |c| c.points().len());
            let story = format!(
                "{by} morph of {count} rational B-spline curves; the common net is 1 row of {width}"
            );
            plain(Kind::NurbsMorph, Parametric::CurveMotion(Arc::new(m)), story)
        }
        Morph::Surfaces(m) => {
            let [u, v] =
                m.targets().first().map_or([0; 2], |s| s.knots().each_ref().map(|k| k.count()));
            let story = format!(
                "{by} morph of {count} rational B-spline surfaces; the common net is {v} rows of {u}"
            );
            plain(Kind::NurbsMorph, Parametric::Motion(Arc::new(m)), story)
        }
    }
}

/// Adds a design: the distances given, or those there are, with the areas of impact pulled.
fn design(morph: &mut Morph, e: &entry::Design, n: usize, targets: usize) -> Result<(), Problem> {
    let at = format!("design[{n}]");
    let renamed = |s: SurfaceError| {
        let rest = s.at.strip_prefix("design").unwrap_or(&s.at);
        Problem::new(format!("{at}{rest}"), s.why)
    };
    if !(e.t > 0.0 && e.t < 1.0) {
        let why = format!("got {}; expected more than 0 and less than 1", e.t);
        return Err(Problem::new(format!("{at}.t"), why));
    }
    let (shares, _) = both!(&*morph, m => m.controls(e.t)).map_err(renamed)?;
    let mut distance = distances(e.distance.as_ref(), &shares, targets, &at)?;
    for (k, impact) in e.impact.iter().enumerate() {
        pull(morph, &mut distance, impact, &format!("{at}.impact[{k}]"))?;
    }
    let design = Design { t: e.t, distance, weights: e.weights.clone() };
    both!(morph, m => m.design(&design)).map_err(renamed)
}

/// The tables of all targets but the first.
fn distances(
    given: Option<&Nest>,
    now: &[Rows],
    targets: usize,
    at: &str,
) -> Result<Vec<Rows>, Problem> {
    let others = &now[1.min(now.len())..];
    let wrong = |why: &str| Problem::new(format!("{at}.distance"), why);
    match given {
        None => Ok(others.to_vec()),
        Some(Nest::Number(x)) => {
            let same = |rows: &Rows| rows.iter().map(|r| vec![*x; r.len()]).collect();
            Ok(others.iter().map(same).collect())
        }
        Some(list) if targets == 2 => {
            let rows = list.rows().map(|rows| vec![rows]);
            rows.or_else(|| list.tables()).ok_or_else(|| wrong("expected rows of numbers"))
        }
        Some(list) => list.tables().ok_or_else(|| {
            wrong("expected a table of rows for each target but the first, in one list")
        }),
    }
}

/// Pulls the share of one target; the others keep their proportions to each other.
fn pull(morph: &Morph, distance: &mut [Rows], e: &entry::Impact, at: &str) -> Result<(), Problem> {
    let wrong = |key: &str, why: String| Err(Problem::new(format!("{at}.{key}"), why));
    if !(e.to > 0.0 && e.to < 1.0) {
        return wrong("to", format!("got {}; expected more than 0 and less than 1", e.to));
    }
    if let Some(x) = e.centre.iter().find(|x| !x.is_finite()) {
        return wrong("centre", format!("got {x}; expected finite numbers"));
    }
    let count = distance.len() + 1;
    if e.target >= count {
        return wrong("target", format!("got {}; expected 0 to {}", e.target, count - 1));
    }
    let impact = Impact {
        centre: e.centre,
        radius: e.radius,
        falloff: match &e.falloff {
            entry::Falloff::Smooth => Falloff::Smooth,
            entry::Falloff::Linear => Falloff::Linear,
            entry::Falloff::Custom(f) => Falloff::Custom(f.0.clone()),
        },
    };
    let old = match e.target {
        0 => rest(distance),
        i => distance[i - 1].clone(),
    };
    let new = both!(morph, m => m.pull(&old, &impact, e.to)).map_err(below(at))?;
    for (i, rows) in distance.iter_mut().enumerate() {
        if i + 1 == e.target {
            rows.clone_from(&new);
            continue;
        }
        for ((row, old), new) in rows.iter_mut().zip(&old).zip(&new) {
            for ((r, old), new) in row.iter_mut().zip(old).zip(new) {
                *r *= (1.0 - new) / (1.0 - old);
            }
        }
    }
    Ok(())
}

/// What the first target is left.
fn rest(distance: &[Rows]) -> Rows {
    let mut rest: Rows =
        distance.first().map_or(vec![], |r| r.iter().map(|row| vec![1.0; row.len()]).collect());
    for rows in distance {
        for (left, row) in rest.iter_mut().zip(rows) {
            left.iter_mut().zip(row).for_each(|(l, x)| *l -= x);
        }
    }
    rest
}
