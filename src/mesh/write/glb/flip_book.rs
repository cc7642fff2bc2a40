//! Meshes that take turns: from frame to frame everything may change.

use super::{Document, Look, document, points};
use crate::mesh::write::{Target, place, plain, sound, target};
use crate::mesh::{MeshError, TriMesh};
use gltf_json::animation::{Interpolation, Property};
use gltf_json::{Index, Material, Node};
use std::path::{Path, PathBuf};

/// A GLB that is being filled: each frame a node with a mesh of its own, of which the animation
/// shows one at a time. Shown is what has the scale 1; the others have the scale 0, in steps.
///
/// It holds what the file will hold, 12 bytes a point and 12 bytes a face.
pub struct FlipBook {
    path: PathBuf,
    force: bool,
    document: Document,
    material: Index<Material>,
    pages: Vec<Index<Node>>,
}

/// Room for the JSON below the 4 GB that a GLB can have.
const JSON_ROOM: usize = 1 << 28;

impl FlipBook {
    /// An empty one. `note` goes into the file, `color` (sRGB) onto the meshes.
    ///
    /// # Errors
    /// A path that does not end in `glb`, or that cannot be written, as for
    /// [`write()`](crate::mesh::write()).
    pub fn new(path: &Path, note: &str, color: [u8; 3], force: bool) -> Result<Self, MeshError> {
        animated(path, force)?;
        let mut document = Document::new(&plain(note));
        let material = document.material(&Look { color, double_sided: false });
        Ok(Self { path: path.to_owned(), force, document, material, pages: vec![] })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// No triangles; a face or a position that is not sound; more than 4 GB in all. The book
    /// stays as it was.
    pub fn push(&mut self, name: &str, mesh: &TriMesh) -> Result<(), MeshError> {
        let refuse = |why: String| MeshError::Unfaithful { path: self.path.clone(), why };
        if mesh.faces.is_empty() {
            return Err(refuse(format!("frame {name} has no triangles")));
        }
        sound(mesh).map_err(|why| refuse(format!("frame {name}: {why}")))?;
        let bytes = self.document.bytes() + 12 * (mesh.points.len() + mesh.faces.len());
        if bytes > u32::MAX as usize - JSON_ROOM {
            let why = format!("with frame {name} it would be over the 4 GB that a GLB can hold");
            return Err(refuse(why));
        }
        let document = &mut self.document;
        let positions = document.positions(&points(mesh));
        let indices = document.indices(&mesh.faces);
        let primitive = document::primitive(positions, None, indices, Some(self.material));
        let mesh = document.mesh(primitive, None);
        let page = Node { mesh: Some(mesh), name: Some(name.to_owned()), ..Node::default() };
        self.pages.push(document.node(page));
        Ok(())
    }

    /// Writes the file and returns its bytes. `turns` names the frames by their order of arrival
    /// as they are shown, each for `seconds`.
    ///
    /// # Errors
    /// No turns, or one of a frame that is not there; what the system refuses.
    pub fn write(mut self, turns: &[usize], seconds: f64) -> Result<u64, MeshError> {
        let refuse = |why: String| MeshError::Unfaithful { path: self.path.clone(), why };
        let (Some(&first), Some(&last)) = (turns.first(), turns.last()) else {
            return Err(refuse("no frames to show".into()));
        };
        if let Some(turn) = turns.iter().find(|t| **t >= self.pages.len()) {
            let count = self.pages.len();
            return Err(refuse(format!("frame {turn} is to be shown, but there are {count}")));
        }
        // the last frame is held until the end: the last key only says when that is
        let keys: Vec<usize> = turns.iter().copied().chain([last]).collect();
        let times: Vec<f32> = (0..keys.len()).map(|k| (k as f64 * seconds) as f32).collect();
        let document = &mut self.document;
        let mut tracks = Vec::with_capacity(self.pages.len());
        for (i, &page) in self.pages.iter().enumerate() {
            let shown = |&k: &usize| if k == i { [1.0; 3] } else { [0.0; 3] };
            let scales: Vec<[f32; 3]> = keys.iter().map(shown).collect();
            tracks.push((page, document.vectors(&scales)));
            // what a program shows that plays nothing
            document.node_mut(page).scale = (i != first).then_some([0.0; 3]);
        }
        let how = (Property::Scale, Interpolation::Step);
        document.animation("morph", &times, how, &tracks);
        let root = Node { children: Some(self.pages), ..document::metres() };
        let root = self.document.node(root);
        let [head, body] = self.document.finish(vec![root]).map_err(refuse)?;
        place(&self.path, [&head, &body].into_iter().map(Ok), self.force)?;
        Ok((head.len() + body.len()) as u64)
    }
}

/// Whether an animated GLB can go there.
pub(super) fn animated(path: &Path, force: bool) -> Result<(), MeshError> {
    match target(path, force)? {
        Target::Glb => Ok(()),
        _ => {
            let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
            let known = "only glb can hold an animation";
            Err(MeshError::Format { path: path.into(), extension, known })
        }
    }
}
