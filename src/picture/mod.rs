//! Shaded pictures of meshes, drawn on the CPU, sheets of many of them, and moving pictures.
//!
//! Words: a *view* is where the camera stands (Z is up, the front looks to -Y); a *frame* is the
//! box the camera is fitted to, so that meshes drawn with one frame have one scale; a *sample*
//! is one of the points at which a pixel is tested.
//!
//! The light is a studio's: a soft key from the camera's left, a bright sky all round, a dim
//! bounce from below. Each of its many directions has a depth map of its own, so that what the
//! mesh hides from them is dark: recesses, undersides, and the ground where the feet stand.
//!
//! ```
//! use fieldgraft::{mesh::TriMesh, picture};
//! use glam::DVec3;
//!
//! let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let style = picture::Style { size: [64, 48], ..Default::default() };
//! let image = picture::render(&TriMesh { points, faces }, &style)?;
//! assert_eq!(image.get(0, 0), Some(style.background));
//! assert_ne!(image.get(32, 24), Some(style.background));
//! # Ok::<(), picture::PictureError>(())
//! ```

mod alike;
mod animation;
mod camera;
mod caster;
mod depth_map;
mod font;
mod ground;
mod image;
mod lanes;
mod light;
mod normals;
mod patch;
mod raster;
mod scene;
mod shade;
mod sheet;

pub use animation::{Film, is_animation};
pub use camera::View;
pub use image::{Image, save_png};
pub use light::working_memory;
pub use sheet::{Cell, Layout, sheet};

use crate::mesh::TriMesh;
use crate::num::Aabb;
use camera::Camera;
use scene::Scene;
use std::path::PathBuf;

/// What a picture looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Width and height in pixels, 1 to [`LARGEST`].
    pub size: [u32; 2],
    /// Where the camera stands.
    pub view: View,
    /// sRGB colour of the mesh; faces seen from behind are tinted warm.
    pub color: [u8; 3],
    /// sRGB colour behind it, and of the ground.
    pub background: [u8; 3],
    /// What the camera is fitted to, mm; the mesh itself unless given.
    pub frame: Option<Aabb>,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            size: [800, 800],
            view: View::Iso,
            color: [206, 164, 116],
            background: [245, 245, 243],
            frame: None,
        }
    }
}

/// The largest width and height of a picture, in pixels.
pub const LARGEST: u32 = 16384;

/// What can go wrong with a picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// No such size can be drawn.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn; each side must be 1 to {LARGEST}"
    )]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// A film has frames of one size.
    #[error("a frame of {width} x {height} pixels cannot follow frames of {} x {}", film[0], film[1])]
    Frame {
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// Width and height of those before.
        film: [u32; 2],
    },
    /// No such picture can move.
    #[error("{}: moving pictures are gif or webp, and have frames", .0.display())]
    Film(PathBuf),
    /// The file is there already.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// The file cannot be written.
    #[error("{}: cannot write the picture", path.display())]
    Write {
        /// Where to.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
}

/// Draws a mesh. Faces without area, of points that are not finite or not there, are left out;
/// a mesh with nothing to draw gives plain background.
///
/// # Errors
/// [`PictureError::Size`].
pub fn render(mesh: &TriMesh, style: &Style) -> Result<Image, PictureError> {
    let [width, height] = style.size;
    let mut image = Image::filled(width, height, style.background)?;
    let Some(scene) = Scene::new(mesh, style.frame) else {
        return Ok(image);
    };
    let camera = Camera::new(style.view, [width, height], &scene);
    let lights = light::Lights::new(&scene, &camera, width.max(height));
    shade::draw(&mut image, &scene, &camera, &lights, style);
    Ok(image)
}

/// The smallest box round some meshes: a common [`Style::frame`] for pictures of one scale.
pub fn common_frame<'a>(meshes: impl IntoIterator<Item = &'a TriMesh>) -> Aabb {
    meshes.into_iter().fold(Aabb::EMPTY, |frame, mesh| frame.hull(mesh.bounds()))
}

#[cfg(test)]
mod tests;
