//! The methods that do not blend: what a recipe says of them.

use crate::morph::{Anchor, Scheme};
use crate::recipe::{MethodEntry, MorphEntry, Problem, Recipe, TransportEntry};
use glam::DVec3;

/// The scheme of a method for shapes of these names; `step` is the side of a cell, mm.
pub(super) fn scheme(
    entry: &MorphEntry,
    method: MethodEntry,
    names: &[&str],
    step: f64,
    recipe: &Recipe,
) -> Result<Scheme, Problem> {
    Ok(match method {
        MethodEntry::LevelSet => Scheme::LevelSet { step },
        MethodEntry::Transport => {
            let asked = entry.transport.as_ref().and_then(|t| t.samples);
            Scheme::Transport { samples: asked.unwrap_or(TransportEntry::SAMPLES) }
        }
        MethodEntry::Warp => Scheme::Warp { anchors: anchors(names, recipe)? },
        _ => Scheme::Blend,
    })
}

/// Whether a method has no use for features.
pub(super) fn whole(method: MethodEntry) -> bool {
    use MethodEntry::{LevelSet, Linear, SpaceTime, Transport};
    matches!(method, Linear | SpaceTime | LevelSet | Transport)
}

fn anchors(names: &[&str], recipe: &Recipe) -> Result<Vec<Anchor>, Problem> {
    let one = |(i, anchor): (usize, &crate::recipe::AnchorEntry)| {
        let point = |name: &&str| {
            anchor.on.get(*name).copied().map(DVec3::from_array).ok_or_else(|| {
                let why = format!(
                    "anchor `{}` has no point on `{name}`; add on.{name} = [x, y, z]",
                    anchor.name
                );
                Problem::new(format!("anchors[{i}].on"), why)
            })
        };
        let at = names.iter().map(point).collect::<Result<_, _>>()?;
        Ok(Anchor { name: anchor.name.clone(), at })
    };
    recipe.anchors.iter().enumerate().map(one).collect()
}
