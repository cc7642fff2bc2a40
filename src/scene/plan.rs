//! `[morph]` and its features -> the plan of a method.

use super::elements;
use super::live::LiveShape;
use super::rows::{Rows, mean_rows};
use super::{draft, scheme};
use crate::element::{Element, align};
use crate::morph::{Blend, Form, Frames, Inner, Part, Plan, SpaceTime};
use crate::num::Aabb;
use crate::recipe::{
    BlendEntry, ElementShape, FeatureEntry, FormEntry, InnerEntry, MethodEntry, MorphEntry,
    OneOrMany, PlainOr, Problem, Recipe, SpaceTimeEntry, SurfaceMethod, WeightingEntry,
    WeightingKind,
};
use crate::warp::Deform;
use crate::weight::Weighting;
use std::collections::BTreeMap;

/// Which shapes an entry morphs, in order; the recipe's only one where it names none.
pub(super) fn shape_names(
    entry: &MorphEntry,
    recipe: &Recipe,
    at: &str,
) -> Result<Vec<String>, Problem> {
    let names: Vec<String> = match (&entry.between, &entry.among) {
        (Some(pair), _) => pair.to_vec(),
        (None, Some(all)) => all.clone(),
        (None, None) if recipe.shapes.len() == 1 => recipe.shapes.keys().cloned().collect(),
        (None, None) => {
            let why = "which shapes? give between = [\"a\", \"b\"] or among = [\"a\", \"b\", ...]";
            return Err(Problem::new(at, why));
        }
    };
    let key = if entry.between.is_some() { "between" } else { "among" };
    let at = format!("{at}.{key}");
    if names.is_empty() {
        return Err(Problem::new(
            at,
            "no shape; give one to have it alone, or two or more to morph",
        ));
    }
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(Problem::new(at, format!("`{name}` is there twice")));
        }
    }
    Ok(names)
}

/// The method meant: `auto` decided, and what it needs is there.
pub(super) fn method(
    entry: &MorphEntry,
    names: &[String],
    recipe: &Recipe,
    at: &str,
) -> Result<MethodEntry, Problem> {
    let shapes = names.len();
    let asked = entry.method.unwrap_or_default();
    let featured = !recipe.features.is_empty();
    let needs =
        matches!(asked, MethodEntry::Graft | MethodEntry::Group | MethodEntry::FeatureVolume);
    let at = format!("{at}.method");
    if asked == MethodEntry::Warp && !featured && recipe.anchors.is_empty() {
        let why = "this method needs points that correspond; add [[features]] or [[anchors]]";
        return Err(Problem::new(at, why));
    }
    if shapes == 1 && asked != MethodEntry::Auto {
        let why = "this morph is of one shape, which is made as it is; remove the method";
        return Err(Problem::new(at, why));
    }
    if let Some(method) = asked.surface() {
        return surfaces(names, recipe, method, &at).map(|()| asked);
    }
    if needs && !featured {
        let why = "this method needs features; add [[features]], or use \"space-time\"";
        return Err(Problem::new(at, why));
    }
    match asked {
        MethodEntry::Auto if shapes == 1 => Ok(MethodEntry::Auto),
        MethodEntry::Graft if shapes != 2 => {
            let why = format!("a graft has two shapes, here are {shapes}; use \"group\"");
            Err(Problem::new(at, why))
        }
        MethodEntry::LevelSet if shapes != 2 => {
            let why = format!("a level set has two shapes, here are {shapes}; use \"transport\"");
            Err(Problem::new(at, why))
        }
        MethodEntry::Auto if !featured => Ok(MethodEntry::SpaceTime),
        MethodEntry::Auto if shapes == 2 => Ok(MethodEntry::Graft),
        MethodEntry::Auto => Ok(MethodEntry::Group),
        other => Ok(other),
    }
}

/// Whether a method of two surface files has them.
fn surfaces(
    names: &[String],
    recipe: &Recipe,
    method: SurfaceMethod,
    at: &str,
) -> Result<(), Problem> {
    let (word, kind) = (method.word(), method.of().word());
    let needs = format!("{word} morphs two surface files of kind {kind}");
    if names.len() != 2 {
        return Err(Problem::new(at, format!("{needs}, here are {} shapes", names.len())));
    }
    match names.iter().find(|n| recipe.shapes[*n].surface.is_none()) {
        Some(name) => Err(Problem::new(at, format!("{needs}; `{name}` is no surface file"))),
        None => Ok(()),
    }
}

/// The plan of an entry over its live shapes; `at` is the entry's key.
pub(super) fn plan(
    entry: &MorphEntry,
    method: MethodEntry,
    shapes: &[&LiveShape],
    meshes: &BTreeMap<String, Element>,
    recipe: &Recipe,
    at: &str,
) -> Result<Plan, Problem> {
    let names: Vec<&str> = shapes.iter().map(|s| s.name.as_str()).collect();
    let used: &[FeatureEntry] = if scheme::whole(method) { &[] } else { &recipe.features };
    let rows = Rows { entry, names: &names };
    let mut features = Vec::with_capacity(used.len());
    for (i, f) in used.iter().enumerate() {
        let elements = corresponding(f, method, &names, meshes, &format!("features[{i}]"))?;
        features.push(rows.feature(f, elements));
    }
    let course = rows.whole(&features);
    let frame_rows = mean_rows(&features, names.len());
    for (f, entry) in features.iter_mut().zip(used) {
        f.deform = rows.deform(entry, frame_rows.as_ref());
    }
    let blend = match (method, entry.blend) {
        (MethodEntry::FeatureVolume, _) | (_, Some(BlendEntry::Fields)) => Blend::Fields,
        _ => Blend::Maps,
    };
    let tall = shapes.iter().map(|s| s.bounds.size().z).sum::<f64>() / shapes.len().max(1) as f64;
    let all = shapes.iter().fold(Aabb::EMPTY, |b, s| b.hull(s.bounds));
    let step = draft::step(&recipe.grid, all.size().max_element());
    Ok(Plan {
        scheme: scheme::scheme(entry, method, &names, step, recipe)?,
        shapes: shapes
            .iter()
            .map(|s| Part { name: s.name.clone(), field: s.field.clone() })
            .collect(),
        features,
        course,
        blend,
        inner: inner(method, entry.inner),
        weighting: weighting(method, entry, blend, tall),
        sharp: Weighting::Smooth { epsilon: 0.01 * tall, power: 4.0 },
        frames: frames(entry, &names, at)?,
        space_time: space_time(entry.space_time.as_ref(), names.len(), at)?,
        cell: step,
        feet: shapes.iter().map(|s| s.feet.clone()).collect(),
    })
}

/// The elements of a feature, one a shape, with axes that correspond.
fn corresponding(
    f: &FeatureEntry,
    method: MethodEntry,
    names: &[&str],
    meshes: &BTreeMap<String, Element>,
    at: &str,
) -> Result<Vec<Element>, Problem> {
    let mut all = Vec::with_capacity(names.len());
    for &name in names {
        let on = format!("{at}.on");
        let Some(entry) = f.on.get(name) else {
            let why = format!(
                "feature `{}` has no element on `{name}`; add [features.on.{name}]",
                f.name
            );
            return Err(Problem::new(on, why));
        };
        let at = crate::recipe::join(&on, name);
        let deform = match method {
            // the baseline's maps are affine (Lerios 1995)
            MethodEntry::FeatureVolume => Deform::NONE,
            _ => elements::deform(
                entry.twist_deg.or(f.twist_deg).unwrap_or(0.0),
                entry.taper.or(f.taper).unwrap_or(1.0),
                entry.bend_deg.or(f.bend_deg).unwrap_or(0.0),
            ),
        };
        all.push(match entry.shape(&at)? {
            ElementShape::Primitive(p) => {
                elements::element(p, deform, &format!("{at}.{}", p.key()))?
            }
            ElementShape::Mesh(_) => meshes
                .get(&at)
                .cloned()
                .ok_or_else(|| Problem::new(&at, "the element's mesh was not read"))?
                .deformed(deform)
                .map_err(|e| Problem::new(&at, e.to_string()))?,
        });
    }
    if let Some((first, others)) = all.split_first_mut() {
        align(first, others);
    }
    Ok(all)
}

fn inner(method: MethodEntry, asked: Option<InnerEntry>) -> Inner {
    match (method, asked) {
        (MethodEntry::Linear | MethodEntry::FeatureVolume, _) => Inner::Linear,
        (MethodEntry::SpaceTime, _) => Inner::SpaceTime,
        (_, asked) => asked.map_or(Inner::Grow, function),
    }
}

/// The morphing function of that name.
pub(super) fn function(asked: InnerEntry) -> Inner {
    match asked {
        InnerEntry::Linear => Inner::Linear,
        InnerEntry::SpaceTime => Inner::SpaceTime,
        InnerEntry::Grow => Inner::Grow,
        InnerEntry::Erode => Inner::Erode,
        InnerEntry::Auto => Inner::Auto,
        InnerEntry::Mean => Inner::Mean,
        InnerEntry::Merge => Inner::Merge,
        InnerEntry::Union => Inner::Union,
    }
}

/// The weighting asked for, with widths from the mean height (GRAFT, section Weights).
fn weighting(method: MethodEntry, entry: &MorphEntry, blend: Blend, tall: f64) -> Weighting {
    let asked = match &entry.weighting {
        None => WeightingEntry { kind: WeightingKind::Smooth, epsilon: None, power: None },
        Some(PlainOr::Plain(kind)) => WeightingEntry { kind: *kind, epsilon: None, power: None },
        Some(PlainOr::Table(t)) => *t,
    };
    let baseline = method == MethodEntry::FeatureVolume;
    match asked.kind {
        WeightingKind::InverseSquare => {
            Weighting::InverseSquare { epsilon: asked.epsilon.unwrap_or(0.02 * tall) }
        }
        _ if baseline => Weighting::InverseSquare { epsilon: 0.02 * tall },
        WeightingKind::Transfinite => Weighting::Transfinite,
        WeightingKind::Smooth => {
            // leaks of one feature's field into another's erode thin parts; positions may flow
            let (share, power) = if blend == Blend::Fields { (0.01, 4.0) } else { (0.03, 2.0) };
            Weighting::Smooth {
                epsilon: asked.epsilon.unwrap_or(share * tall),
                power: asked.power.unwrap_or(power),
            }
        }
    }
}

/// `dominant` is fixed later, when the time is known.
fn frames(entry: &MorphEntry, names: &[&str], at: &str) -> Result<Frames, Problem> {
    match entry.frames.as_deref() {
        None | Some("average" | "dominant") => Ok(Frames::Average),
        Some(name) => names.iter().position(|&n| n == name).map(Frames::Of).ok_or_else(|| {
            let why =
                format!("`{name}` takes no part in this morph; it is of {}", names.join(", "));
            Problem::new(format!("{at}.frames"), why)
        }),
    }
}

fn space_time(
    entry: Option<&SpaceTimeEntry>,
    shapes: usize,
    at: &str,
) -> Result<SpaceTime, Problem> {
    let Some(entry) = entry else {
        return Ok(SpaceTime::default());
    };
    let a = match entry.a.value() {
        None => None,
        Some(OneOrMany::One(a)) => Some(vec![*a; shapes]),
        Some(OneOrMany::Many(a)) if a.len() == shapes => Some(a.clone()),
        Some(OneOrMany::Many(a)) => {
            let why = format!("{} numbers for {shapes} shapes", a.len());
            return Err(Problem::new(format!("{at}.space-time.a"), why));
        }
    };
    let form = match entry.form {
        None | Some(FormEntry::L) => Form::L,
        Some(FormEntry::S) => Form::S,
        Some(FormEntry::HalfCylinders) => Form::HalfCylinders,
    };
    let a3 = entry.a3.unwrap_or(SpaceTime::default().a3);
    Ok(SpaceTime { form, a0: entry.a0.value().copied(), a, a3 })
}
