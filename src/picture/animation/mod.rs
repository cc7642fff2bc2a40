//! Moving pictures.

mod gif;
mod palette;
#[cfg(test)]
mod tests;
mod webp;

use super::image::place;
use super::{Image, PictureError};
use std::io;
use std::path::Path;

/// Frames of a moving picture, kept packed: about a tenth of their pixels.
#[derive(Clone, Debug, Default)]
pub struct Film {
    size: [u32; 2],
    /// Each a whole WebP file, without loss.
    frames: Vec<Vec<u8>>,
}

/// What a film can be written as.
enum Kind {
    Gif,
    Webp,
}

fn kind(path: &Path) -> Option<Kind> {
    let extension = path.extension()?.to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "gif" => Some(Kind::Gif),
        "webp" => Some(Kind::Webp),
        _ => None,
    }
}

/// Whether a name ends as a moving picture's does: `gif` or `webp`.
pub fn is_animation(path: &Path) -> bool {
    kind(path).is_some()
}

/// How long each turn lasts, in units of which one lasts `each`: rounded so that the sum keeps up.
fn durations(turns: usize, each: f64) -> Vec<u32> {
    let end = |k: usize| (k as f64 * each).round() as u32;
    (0..turns).map(|k| end(k + 1) - end(k)).collect()
}

impl Film {
    /// How many frames there are.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`PictureError::Frame`] when it is of another size than the first;
    /// [`PictureError::Size`] when it cannot be packed.
    pub fn push(&mut self, image: &Image) -> Result<(), PictureError> {
        let (width, height) = (image.width(), image.height());
        if !self.is_empty() && self.size != [width, height] {
            return Err(PictureError::Frame { width, height, film: self.size });
        }
        let packed = webp::pack(image).map_err(|_| PictureError::Size { width, height })?;
        self.size = [width, height];
        self.frames.push(packed);
        Ok(())
    }

    /// Writes a GIF or a WebP, as the name says, and returns its bytes. `turns` names the frames by
    /// their order of arrival as they are shown, each for `seconds`, over and over.
    ///
    /// A WebP keeps every pixel; a GIF has 256 colours, the same in all frames, and tells time in
    /// hundredths of a second.
    ///
    /// # Errors
    /// [`PictureError::Film`] for another name, no turns, or a turn of no frame;
    /// [`PictureError::Exists`] without `force` when the file is there, [`PictureError::Write`].
    pub fn save(
        &self,
        path: &Path,
        turns: &[usize],
        seconds: f64,
        force: bool,
    ) -> Result<u64, PictureError> {
        let kind = kind(path)
            .filter(|_| !turns.is_empty() && turns.iter().all(|&t| t < self.frames.len()));
        let kind = kind.ok_or_else(|| PictureError::Film(path.to_owned()))?;
        if !force && path.symlink_metadata().is_ok() {
            return Err(PictureError::Exists(path.to_owned()));
        }
        let failed = |source: io::Error| PictureError::Write { path: path.to_owned(), source };
        let gif;
        let heads;
        let parts: Vec<&[u8]> = match kind {
            Kind::Gif => {
                gif = gif::encode(self.size, &self.frames, turns, seconds).map_err(failed)?;
                vec![&gif]
            }
            Kind::Webp => {
                heads = webp::heads(self.size, &self.frames, turns, seconds).map_err(failed)?;
                webp::parts(&heads, &self.frames, turns)
            }
        };
        place(path, &parts, force)?;
        Ok(parts.iter().map(|p| p.len() as u64).sum())
    }
}
