//! `pde` and `pde-morph`.

use super::read::{Opened, Reader};
use super::{Parametric, SceneError, Spine, SurfaceFile, check_scale, plain, problem};
use crate::num::near::did_you_mean;
use crate::recipe::surface::{self as entry, Kind, PdeMethod, Shape};
use crate::recipe::{PlainOr, Problem, SurfaceEntry, join};
use crate::surface::pde::{
    Boundary, Curve, Epsilon, Method, MorphOptions, NODES, Options, PdeMorph, PdeSurface,
};
use crate::surface::shapes::{self, KleinBottle, SeaShell, SuperEllipsoid, SuperToroid};
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Points of the curves of a named shape.
const POINTS: usize = 64;

/// A PDE surface and what is known about it.
struct Made {
    surface: Arc<PdeSurface>,
    exact: Option<Parametric>,
    warnings: Vec<String>,
    story: String,
}

pub fn still(e: &entry::Pde) -> Result<SurfaceFile, Problem> {
    let made = make(e)?;
    let object = Parametric::Surface(made.surface.clone());
    Ok(SurfaceFile {
        warnings: made.warnings,
        exact: made.exact,
        spine: Some(Spine::Still(made.surface)),
        ..plain(Kind::Pde, object, made.story)
    })
}

fn make(e: &entry::Pde) -> Result<Made, Problem> {
    check_scale(e.scale)?;
    let (patches, exact, mut warnings) = match e.shape {
        Some(shape) => named(shape, e)?,
        None => (patches(e)?, None, vec![]),
    };
    let options = Options { a: e.a, modes: e.modes, remainder: e.remainder };
    let surface = PdeSurface::new(&patches, options).map_err(|s| {
        // a named shape has no patches in the file
        let at = if e.shape.is_some() && s.at.starts_with("patches") { "points" } else { &s.at };
        Problem::new(at, s.why)
    })?;
    warnings.extend(surface.warnings().iter().cloned());
    let count = patches.len();
    let plural = if count == 1 { "patch" } else { "patches" };
    let of = e.shape.map_or_else(String::new, |s| format!(": {}", s.word()));
    let story = format!("PDE surface of {count} {plural}{of}");
    Ok(Made { surface: Arc::new(surface), exact, warnings, story })
}

/// The patches that the file lists.
fn patches(e: &entry::Pde) -> Result<Vec<Boundary>, Problem> {
    let only = [
        ("parameters", !e.parameters.is_empty()),
        ("divisions", e.divisions.is_some()),
        ("points", e.points.is_some()),
    ];
    if let Some((key, _)) = only.iter().find(|(_, given)| *given) {
        return Err(Problem::new(*key, "only a named `shape` has it"));
    }
    if e.patches.is_empty() {
        return Err(Problem::new("", "no surface: give `patches` or a `shape`"));
    }
    let patch = |(i, p): (usize, &entry::Patch)| {
        let mut curves = [const { vec![] }; 4].map(Curve::Points);
        for (k, (to, from)) in curves.iter_mut().zip(&p.curves).enumerate() {
            *to = curve(from, e.scale, &format!("patches[{i}].curves[{k}]"))?;
        }
        Ok(Boundary { nodes: p.u.unwrap_or(NODES), curves })
    };
    e.patches.iter().enumerate().map(patch).collect()
}

fn curve(entry: &entry::Curve, scale: f64, at: &str) -> Result<Curve, Problem> {
    let size = |&p: &[f64; 3]| DVec3::from(p) * scale;
    match entry {
        PlainOr::Plain(points) => Ok(Curve::Points(points.iter().map(size).collect())),
        PlainOr::Table(t) => {
            let count = t.cos.len().max(t.sin.len());
            let term = |list: &[[f64; 3]], n: usize| list.get(n).map_or(DVec3::ZERO, size);
            let terms = (0..count).map(|n| [term(&t.cos, n), term(&t.sin, n)]).collect();
            let all = t.cos.iter().chain(&t.sin).chain([&t.mean]).flatten();
            match all.copied().find(|x| !x.is_finite()) {
                Some(x) => Err(Problem::new(at, format!("got {x}; expected finite numbers"))),
                None => Ok(Curve::Terms { mean: size(&t.mean), terms }),
            }
        }
    }
}

type Named = (Vec<Boundary>, Option<Parametric>, Vec<String>);

/// The patches of a named shape, and the shape itself.
fn named(shape: Shape, e: &entry::Pde) -> Result<Named, Problem> {
    if !e.patches.is_empty() {
        return Err(Problem::new("shape", "both `shape` and `patches`; keep one"));
    }
    if shape == Shape::Dolphin {
        for (key, given) in [("divisions", e.divisions.is_some()), ("points", e.points.is_some())] {
            if given {
                return Err(Problem::new(key, "the dolphin is made of five patches; remove it"));
            }
        }
        numbers(e, shape, &mut [])?;
        let mut patches = shapes::dolphin();
        patches.iter_mut().flat_map(|p| &mut p.curves).for_each(|c| scale_terms(c, e.scale));
        return Ok((patches, None, vec![]));
    }
    let surface = analytic(shape, e)?;
    let divisions = e.divisions.unwrap_or(if shape == Shape::SeaShell { 9 } else { 8 });
    let points = e.points.unwrap_or(POINTS);
    if !(3..=crate::surface::pde::MOST_POINTS).contains(&points) {
        let most = crate::surface::pde::MOST_POINTS;
        return Err(Problem::new("points", format!("got {points}; expected 3 to {most}")));
    }
    let scaled = Cut { surface, scale: e.scale, divisions: 1 };
    let patches = shapes::cut(&scaled, divisions, points).map_err(problem)?;
    let mut warnings = vec![];
    if shape == Shape::KleinBottle && divisions % 2 == 1 {
        warnings.push(format!(
            "divisions: {divisions} is odd, so the kink of the Klein bottle falls inside a patch, \
             which misses it; an even number is nearer"
        ));
    }
    let exact: Arc<dyn Surface> = Arc::new(Cut { divisions, ..scaled });
    Ok((patches, Some(Parametric::Surface(exact)), warnings))
}

fn scale_terms(curve: &mut Curve, by: f64) {
    match curve {
        Curve::Points(points) => points.iter_mut().for_each(|p| *p *= by),
        Curve::Terms { mean, terms } => {
            *mean *= by;
            terms.iter_mut().flatten().for_each(|p| *p *= by);
        }
    }
}

/// The named shape with the numbers of the file.
fn analytic(shape: Shape, e: &entry::Pde) -> Result<Arc<dyn Surface>, Problem> {
    let bad = |s: SurfaceError| {
        let given = e.parameters.contains_key(&s.at);
        Problem::new(if given { format!("parameters.{}", s.at) } else { s.at }, s.why)
    };
    Ok(match shape {
        Shape::KleinBottle => {
            let mut s = KleinBottle::default();
            let KleinBottle { alpha, beta, width } = &mut s;
            numbers(e, shape, &mut [("alpha", alpha), ("beta", beta), ("width", width)])?;
            s.check().map_err(bad)?;
            Arc::new(s)
        }
        Shape::SuperEllipsoid => {
            let mut s = SuperEllipsoid::default();
            let SuperEllipsoid { alpha, beta, gamma, n1, n2 } = &mut s;
            let mut all =
                [("alpha", alpha), ("beta", beta), ("gamma", gamma), ("n1", n1), ("n2", n2)];
            numbers(e, shape, &mut all)?;
            s.check().map_err(bad)?;
            Arc::new(s)
        }
        Shape::SuperToroid => {
            let mut s = SuperToroid::default();
            let SuperToroid { scale, alpha, gamma, n1, n2 } = &mut s;
            let mut all = [("alpha", alpha), ("gamma", gamma), ("n1", n1), ("n2", n2)];
            let DVec3 { x, y, z } = scale;
            let mut all: Vec<_> = all.iter_mut().map(|(n, x)| (*n, &mut **x)).collect();
            all.extend([("rx", x), ("ry", y), ("rz", z)]);
            numbers(e, shape, &mut all)?;
            s.check().map_err(bad)?;
            Arc::new(s)
        }
        Shape::SeaShell | Shape::Dolphin => {
            let mut s = SeaShell::default();
            let SeaShell { alpha, beta, delta, turns } = &mut s;
            let mut all = [("alpha", alpha), ("beta", beta), ("delta", delta), ("turns", turns)];
            numbers(e, shape, &mut all)?;
            s.check().map_err(bad)?;
            Arc::new(s)
        }
    })
}

/// Puts the file's parameters where they belong.
fn numbers(e: &entry::Pde, shape: Shape, known: &mut [(&str, &mut f64)]) -> Result<(), Problem> {
    for (name, value) in &e.parameters {
        match known.iter_mut().find(|(n, _)| n == name) {
            Some((_, to)) => **to = *value,
            None => {
                let names: Vec<&str> = known.iter().map(|(n, _)| *n).collect();
                let hint = did_you_mean(name, names.iter().copied());
                let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
                let why = format!("{} has no such parameter; known: {has}{hint}", shape.word());
                return Err(Problem::new(join("parameters", name), why));
            }
        }
    }
    Ok(())
}

/// An analytic shape in equal parts of its length, u in [0, 1] each, as its PDE patches are.
#[derive(Clone)]
struct Cut {
    surface: Arc<dyn Surface>,
    scale: f64,
    divisions: usize,
}

impl Surface for Cut {
    fn patches(&self) -> usize {
        self.divisions
    }
    fn domain(&self, _: usize) -> Domain {
        Domain { u: [0.0, 1.0], v: [0.0, TAU], wraps: [false, true] }
    }
    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        let Domain { u: [u0, u1], v: [v0, v1], .. } = self.surface.domain(0);
        let (along, across) = ((u1 - u0) / self.divisions as f64, (v1 - v0) / TAU);
        let u = u0 + (u1 - u0) * ((patch as f64 + uv.x) / self.divisions as f64);
        let jet = self.surface.jet(0, DVec2::new(u, v0 + uv.y * across));
        Jet {
            s: jet.s * self.scale,
            su: jet.su * (self.scale * along),
            sv: jet.sv * (self.scale * across),
        }
    }
}

pub fn morph(
    e: &entry::PdeMorph,
    by: &Opened,
    reader: &mut Reader,
) -> Result<Result<SurfaceFile, Problem>, SceneError> {
    let from = reader.named(by, "from", &e.from, Kind::Pde)?;
    let to = reader.named(by, "to", &e.to, Kind::Pde)?;
    let epsilon = |e: &PlainOr<f64, entry::Epsilon>| match e {
        PlainOr::Plain(gamma) => Epsilon::steady(*gamma),
        PlainOr::Table(e) => Epsilon { gamma: e.gamma, power: e.power },
    };
    let options = MorphOptions {
        method: method(e.method),
        epsilon: Epsilon { gamma: e.gamma, power: e.power },
        curves: e.curves.as_ref().map(|c| c.each_ref().map(epsilon)),
        radial: e.radial.as_ref().map(epsilon),
    };
    Ok(of(&from, &to, options)?.map_err(|s| {
        // the library has one key for both numbers
        let power = s.at == "gamma" && s.why.starts_with("power");
        Problem::new(if power { "power" } else { &s.at }, s.why)
    }))
}

pub fn between(from: &Opened, to: &Opened, by: PdeMethod) -> Result<SurfaceFile, SceneError> {
    let options = MorphOptions { method: method(by), ..MorphOptions::default() };
    of(from, to, options)?.map_err(|s| from.locate(problem(s)).into())
}

fn method(m: PdeMethod) -> Method {
    match m {
        PdeMethod::Boundary => Method::Boundary,
        PdeMethod::Modes => Method::Modes,
        PdeMethod::Combined => Method::Combined,
        PdeMethod::Spine => Method::Spine,
    }
}

fn of(
    from: &Opened,
    to: &Opened,
    options: MorphOptions,
) -> Result<Result<SurfaceFile, SurfaceError>, SceneError> {
    let side = |o: &Opened| match &o.entry {
        SurfaceEntry::Pde(e) => make(e).map_err(|p| o.locate(p)),
        _ => Err(o.locate(Problem::new("kind", "is not `pde`"))),
    };
    let (a, b) = (side(from)?, side(to)?);
    let morph = match PdeMorph::new(&a.surface, &b.surface, options) {
        Ok(morph) => Arc::new(morph),
        Err(e) => return Ok(Err(e)),
    };
    let mut warnings = morph.warnings().to_vec();
    for (name, made) in [("from", &a), ("to", &b)] {
        let own = made.warnings.iter().filter(|w| !made.surface.warnings().contains(w));
        warnings.extend(own.map(|w| format!("{name}.{w}")));
    }
    let counts = [&a, &b].map(|m| m.surface.patches());
    let story = format!("morph of PDE surfaces of {} and {} patches", counts[0], counts[1]);
    Ok(Ok(SurfaceFile {
        warnings,
        spine: Some(Spine::Morph(morph.clone())),
        ..plain(Kind::PdeMorph, Parametric::Motion(morph), story)
    }))
}
