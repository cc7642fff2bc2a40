//! Entries of `[[anchors]]`: points of the shapes that correspond to each other.

use super::primitive::finite;
use super::shapes::ShapeEntry;
use super::source::join;
use super::{Problem, did_you_mean};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A point on every shape that takes part, for `method = "warp"`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnchorEntry {
    /// Its name, for messages.
    pub name: String,
    /// Where it stands on each shape, by the shape's name, mm.
    pub on: BTreeMap<String, [f64; 3]>,
}

/// What is wrong with the anchors beyond the grammar.
pub(super) fn validate(
    anchors: &[AnchorEntry],
    shapes: &BTreeMap<String, ShapeEntry>,
) -> Result<(), Problem> {
    let mut names = BTreeSet::new();
    for (i, anchor) in anchors.iter().enumerate() {
        let at = format!("anchors[{i}]");
        if anchor.name.trim().is_empty() {
            return Err(Problem::new(format!("{at}.name"), "an anchor needs a name"));
        }
        if !names.insert(&anchor.name) {
            let why = format!("`{}` is the name of another anchor already", anchor.name);
            return Err(Problem::new(format!("{at}.name"), why));
        }
        for (shape, point) in &anchor.on {
            let at = join(&format!("{at}.on"), shape);
            if !shapes.contains_key(shape) {
                let hint = did_you_mean(shape, shapes.keys().map(String::as_str));
                return Err(Problem::new(at, format!("no shape is called `{shape}`{hint}")));
            }
            finite(point, &at)?;
        }
    }
    Ok(())
}
