//! The parts of a glTF document that carry geometry.

use super::buffers::Declared;
use crate::mesh::error::{Parsed, fault};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde::{Deserialize, de::IgnoredAny};
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    #[serde(default)]
    pub scene: Option<usize>,
    #[serde(default)]
    pub scenes: Vec<Scene>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<Mesh>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<View>,
    #[serde(default)]
    pub buffers: Vec<Declared>,
}

#[derive(Deserialize)]
pub(super) struct Asset {
    pub version: String,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

/// Arrays are boxed: the shortest node is two bytes of JSON, and should not take hundreds.
#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub mesh: Option<usize>,
    #[serde(default)]
    pub children: Vec<usize>,
    #[serde(default)]
    pub matrix: Option<Box<[f64; 16]>>,
    #[serde(default)]
    pub translation: Option<Box<[f64; 3]>>,
    #[serde(default)]
    pub rotation: Option<Box<[f64; 4]>>,
    #[serde(default)]
    pub scale: Option<Box<[f64; 3]>>,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    #[serde(default)]
    pub primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    #[serde(default)]
    pub indices: Option<usize>,
    #[serde(default)]
    pub mode: Option<u32>,
    #[serde(default)]
    pub extensions: BTreeMap<String, IgnoredAny>,
}

/// Only what is read: a map of all of them would take a hundred times the bytes they have in a file.
#[derive(Deserialize)]
pub(super) struct Attributes {
    #[serde(default, rename = "POSITION")]
    pub position: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    #[serde(default)]
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    pub count: u64,
    #[serde(rename = "type")]
    pub shape: String,
    #[serde(default)]
    pub sparse: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    #[serde(default)]
    pub byte_stride: Option<u64>,
}

impl Document {
    pub fn check(&self) -> Parsed<()> {
        let version = &self.asset.version;
        if !version.starts_with("2.") && version != "2" {
            return fault("asset.version", format!("`{version}`, expected 2.0"));
        }
        // Extensions that change how things look or move, not where the triangles are.
        let harmless = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"];
        let bars = |e: &&String| {
            !harmless.iter().any(|h| e.starts_with(h)) && *e != "KHR_mesh_quantization"
        };
        match self.extensions_required.iter().find(bars) {
            Some(e) => fault("extensionsRequired", format!("`{e}` is not supported{}", hint(e))),
            None => Ok(()),
        }
    }

    /// The nodes to start from: those of the default scene, else of the first, else all roots.
    pub fn roots(&self) -> Parsed<Vec<usize>> {
        let scene = self.scene.or(if self.scenes.is_empty() { None } else { Some(0) });
        match scene.map(|i| self.scenes.get(i).ok_or(i)) {
            Some(Ok(scene)) => Ok(scene.nodes.clone()),
            Some(Err(i)) => {
                fault("scene", format!("scene {i}, but there are {}", self.scenes.len()))
            }
            None => {
                let mut root = vec![true; self.nodes.len()];
                for &child in self.nodes.iter().flat_map(|n| &n.children) {
                    root.get_mut(child).into_iter().for_each(|r| *r = false);
                }
                Ok((0..root.len()).filter(|&i| root[i]).collect())
            }
        }
    }
}

/// What to do about an extension.
pub(super) fn hint(extension: &str) -> &'static str {
    let packed = ["draco", "meshopt"].iter().any(|p| extension.contains(p));
    if packed { "; export again without compression" } else { "" }
}

impl Node {
    /// Whether it is scaled to nothing, as animations do to what is not to be seen.
    pub fn hidden(&self) -> bool {
        self.scale.as_deref() == Some(&[0.0; 3])
    }

    pub fn transform(&self) -> DAffine3 {
        if let Some(m) = &self.matrix {
            return DAffine3::from_mat4(DMat4::from_cols_array(m));
        }
        let quat = self.rotation.as_deref().map_or(DQuat::IDENTITY, |&q| DQuat::from_array(q));
        DAffine3::from_scale_rotation_translation(
            self.scale.as_deref().map_or(DVec3::ONE, |&s| s.into()),
            if quat.length_squared() > 0.0 { quat.normalize() } else { DQuat::IDENTITY },
            self.translation.as_deref().map_or(DVec3::ZERO, |&t| t.into()),
        )
    }
}
