//! `[grid]` and `[output]`: how finely, and into which files.

use super::Problem;
use super::primitive::{finite, is_default, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How finely space is sampled.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GridEntry {
    /// Cells along the longest side; 256 unless `voxel` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<u32>,
    /// Side of a cell, mm; instead of `resolution`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voxel: Option<f64>,
    /// Cells along the longest side for `--profile preview`; by default 64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preview: Option<u32>,
    /// Space added round the shapes, as a share of the longest side; by default 0.08.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub padding: Option<f64>,
}

/// Finest grid: the lattice's indices must stay far from overflow.
const FINEST: u32 = 16_384;

impl GridEntry {
    /// Cells along the longest side, when neither `resolution` nor `voxel` is given.
    pub const RESOLUTION: u32 = 256;
    /// Cells along the longest side of a preview.
    pub const PREVIEW: u32 = 64;
    /// Space added round the shapes, as a share of the longest side.
    pub const PADDING: f64 = 0.08;

    pub(super) fn validate(&self) -> Result<(), Problem> {
        if self.resolution.is_some() && self.voxel.is_some() {
            return Err(Problem::new("grid", "both `resolution` and `voxel`; give one of them"));
        }
        for (key, n) in [("resolution", self.resolution), ("preview", self.preview)] {
            if let Some(n) = n.filter(|n| !(4..=FINEST).contains(n)) {
                let why = format!("got {n}; expected 4 to {FINEST} cells");
                return Err(Problem::new(format!("grid.{key}"), why));
            }
        }
        self.voxel.map_or(Ok(()), |v| positive(v, "grid.voxel"))?;
        let padding = self.padding.unwrap_or(Self::PADDING);
        finite(&[padding], "grid.padding")?;
        if (0.0..=4.0).contains(&padding) {
            Ok(())
        } else {
            Err(Problem::new("grid.padding", format!("got {padding}; expected 0 to 4")))
        }
    }
}

/// What is written. `{t}` and `{name}` stand for the time and the hybrid's name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputEntry {
    /// Mesh file: STL, OBJ, PLY or GLB by its extension.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// Picture file, PNG; none unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
    /// Loose pieces with less than this share of the volume are dropped and reported; by default
    /// 0.02 for graft and group, 0 for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crumbs: Option<f64>,
    /// Which mesher; by default `print`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mesher: MesherEntry,
}

/// How samples become triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MesherEntry {
    /// Closed, manifold and free of self-intersections.
    #[default]
    Print,
    /// The same with sharp edges and corners; asks the field two to three times as much.
    Sharp,
    /// Quicker and with half the triangles; not always manifold.
    Preview,
}

impl OutputEntry {
    pub(super) fn validate(&self) -> Result<(), Problem> {
        for (key, name) in [("mesh", &self.mesh), ("picture", &self.picture)] {
            if let Some(name) = name {
                template(name, &format!("output.{key}"))?;
            }
        }
        match self.crumbs {
            Some(c) if !(0.0..1.0).contains(&c) => {
                let why = format!("got {c}; expected a share of the volume, 0 to below 1");
                Err(Problem::new("output.crumbs", why))
            }
            _ => Ok(()),
        }
    }
}

/// Whether a file name holds no placeholder but `{t}` and `{name}`.
fn template(name: &str, at: &str) -> Result<(), Problem> {
    let rest = name.replace("{t}", "").replace("{name}", "");
    if name.trim().is_empty() {
        return Err(Problem::new(at, "a file name is needed"));
    }
    if rest.contains(['{', '}']) {
        let why = format!("got `{name}`; the placeholders are {{t}} and {{name}}");
        return Err(Problem::new(at, why));
    }
    Ok(())
}
