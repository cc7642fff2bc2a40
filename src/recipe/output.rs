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
    /// Files that play the frames of a hybrid in the order of t, each frame for the same time: a
    /// moving picture (WEBP, with all colours; GIF, with 256) or a GLB of the meshes in turn. A
    /// name or a list; none unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub animation: Option<NameOrNames>,
    /// Frames a second of an animation, 0.1 to 50; by default 8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Whether an animation runs back from the last frame to the first; by default it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ping_pong: Option<bool>,
    /// Loose pieces with less than this share of the volume are dropped and reported; by default
    /// 0.02 for graft and group, 0 for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crumbs: Option<f64>,
    /// Which mesher; by default `print`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub mesher: MesherEntry,
}

/// One file, or several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a file name or a list of file names")]
pub enum NameOrNames {
    /// One.
    One(String),
    /// Several.
    Many(Vec<String>),
}

impl NameOrNames {
    /// All of them.
    pub fn all(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Many(names) => names,
        }
    }
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
        self.validate_animation()?;
        match self.crumbs {
            Some(c) if !(0.0..1.0).contains(&c) => {
                let why = format!("got {c}; expected a share of the volume, 0 to below 1");
                Err(Problem::new("output.crumbs", why))
            }
            _ => Ok(()),
        }
    }
}

/// What an animation's name may end in.
const MOVING: [&str; 3] = ["webp", "gif", "glb"];

impl OutputEntry {
    /// Frames a second, when the recipe says nothing.
    pub const FPS: f64 = 8.0;

    /// The animations' names.
    pub fn animations(&self) -> &[String] {
        self.animation.as_ref().map_or(&[], NameOrNames::all)
    }

    fn validate_animation(&self) -> Result<(), Problem> {
        let mut seen: Vec<String> = vec![];
        for (i, name) in self.animations().iter().enumerate() {
            let at = match &self.animation {
                Some(NameOrNames::Many(_)) => format!("output.animation[{i}]"),
                _ => "output.animation".to_owned(),
            };
            template(name, &at)?;
            if name.contains("{t}") {
                let why = format!("got `{name}`; one file has all times, so no {{t}}");
                return Err(Problem::new(at, why));
            }
            let kind = name.rsplit_once('.').map_or("", |(_, kind)| kind).to_ascii_lowercase();
            if !MOVING.contains(&kind.as_str()) {
                let why = format!("got `{name}`; expected a name that ends in .webp, .gif or .glb");
                return Err(Problem::new(at, why));
            }
            if seen.contains(&kind) {
                let why = format!("got `{name}`; there is another .{kind} already");
                return Err(Problem::new(at, why));
            }
            seen.push(kind);
        }
        match self.fps {
            // a GIF counts hundredths of a second, and viewers slow down what takes fewer than two
            Some(fps) if !(0.1..=50.0).contains(&fps) => {
                let why = format!("got {fps}; expected 0.1 to 50 frames a second");
                Err(Problem::new("output.fps", why))
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
