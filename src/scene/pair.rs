//! Two surface files that move into each other by a method of their own kind.

use super::live::LiveShape;
use super::moving::Moving;
use super::skinned::{How, Skinned};
use super::surface;
use super::variant::Parts;
use crate::recipe::{Problem, ShapeEntry, SurfaceMethod, join};
use std::path::Path;

/// The surface that is the first shape at t = 0 and the second at t = 1, and stands where they do; and
/// what was found.
pub(super) fn moving(
    shapes: [&LiveShape; 2],
    method: SurfaceMethod,
    parts: &Parts<'_>,
    at: &str,
) -> Result<(Moving, Vec<String>), Problem> {
    let entries = shapes.map(|s| &parts.recipe.shapes[&s.name]);
    agree(shapes, entries)?;
    let missing = || {
        Problem::new(format!("{at}.method"), format!("{} morphs two surface files", method.word()))
    };
    let [Some(from), Some(to)] = shapes.map(|s| s.surface.as_ref()) else {
        return Err(missing());
    };
    let (skinned, warnings) = between([from, to], entries, method, parts.beside, at)?;
    let name = format!("{} to {}", shapes[0].name, shapes[1].name);
    let told = warnings.iter().map(|w| format!("{name}: {w}"));
    let told = told.collect();
    Ok((Moving::new(&name, skinned, parts.step), told))
}

/// The surface between two that are placed, and what was found.
pub(super) fn between(
    [from, to]: [&Skinned; 2],
    entries: [&ShapeEntry; 2],
    method: SurfaceMethod,
    beside: &Path,
    at: &str,
) -> Result<(Skinned, Vec<String>), Problem> {
    let fail = |why: String| Problem::new(format!("{at}.method"), why);
    let missing = || fail(format!("{} morphs two surface files", method.word()));
    let [Some(a), Some(b)] = entries.map(|e| e.surface.as_ref()) else {
        return Err(missing());
    };
    let file = surface::between(&beside.join(a), &beside.join(b), method)
        .map_err(|e| fail(e.to_string()))?;
    let stands = [from.stands(), to.stands()];
    let skinned = Skinned::between(file.object, How::of(entries[0]), stands, None)
        .map_err(|e| fail(e.to_string()))?;
    Ok((skinned, file.warnings))
}

/// Refuses shapes that are made solid in different ways: what is between them has one.
fn agree(shapes: [&LiveShape; 2], [a, b]: [&ShapeEntry; 2]) -> Result<(), Problem> {
    let mm = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), |mm| format!("{mm} mm"));
    let word = |debug: String| debug.to_lowercase();
    let keys = [
        ("thickness", mm(a.thickness), mm(b.thickness)),
        ("skin", word(format!("{:?}", a.skin)), word(format!("{:?}", b.skin))),
        ("curve", word(format!("{:?}", a.curve)), word(format!("{:?}", b.curve))),
        ("tolerance", mm(a.tolerance), mm(b.tolerance)),
    ];
    let Some((key, first, second)) = keys.into_iter().find(|(_, x, y)| x != y) else {
        return Ok(());
    };
    let [one, other] = shapes.map(|s| format!("{}.{key}", join("shapes", &s.name)));
    let why = format!("{second}, and {one} is {first}; a surface between the two has one of them");
    Err(Problem::new(other, why))
}
