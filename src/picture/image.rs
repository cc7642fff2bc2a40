//! Pixels, and their way into a file.

use super::{LARGEST, PictureError};
use std::io::{self, Write as _};
use std::path::Path;

/// An sRGB picture, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// A picture of one colour.
    ///
    /// # Errors
    /// [`PictureError::Size`] when a side is 0 or over [`LARGEST`].
    pub fn filled(width: u32, height: u32, color: [u8; 3]) -> Result<Self, PictureError> {
        if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
            return Err(PictureError::Size { width, height });
        }
        Ok(Self { width, height, pixels: vec![color; width as usize * height as usize] })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// All pixels, row by row from the top.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 3]] {
        &mut self.pixels
    }

    /// The pixel in that column and row; `None` outside.
    pub fn get(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        let index = y as usize * self.width as usize + x as usize;
        (x < self.width && y < self.height).then(|| self.pixels[index])
    }

    /// Mixes a colour into a pixel; outside, nothing happens.
    pub(super) fn blend(&mut self, x: u32, y: u32, color: [u8; 3], share: f32) {
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[y as usize * self.width as usize + x as usize];
            for (old, new) in pixel.iter_mut().zip(color) {
                let (from, to) = (f32::from(*old), f32::from(new));
                *old = (from + (to - from) * share).round() as u8;
            }
        }
    }

    /// Puts another picture on top, its corner at (x, y); what sticks out is cut off.
    pub fn paste(&mut self, other: &Image, x: u32, y: u32) {
        let columns = other.width.min(self.width.saturating_sub(x)) as usize;
        let rows = other.height.min(self.height.saturating_sub(y)) as usize;
        for row in 0..rows {
            let from = row * other.width as usize;
            let to = (y as usize + row) * self.width as usize + x as usize;
            self.pixels[to..to + columns].copy_from_slice(&other.pixels[from..from + columns]);
        }
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = io::Cursor::new(Vec::new());
        let (flat, format) = (self.pixels.as_flattened(), ::image::ImageFormat::Png);
        let color = ::image::ExtendedColorType::Rgb8;
        ::image::write_buffer_with_format(&mut bytes, flat, self.width, self.height, color, format)
            .map_err(io::Error::other)?;
        Ok(bytes.into_inner())
    }
}

/// Writes a PNG file. It is written beside its place and renamed into it, so that an
/// interrupted run leaves no half file.
///
/// # Errors
/// [`PictureError::Exists`] without `force` when the file is there, [`PictureError::Write`].
pub fn save_png(path: &Path, image: &Image, force: bool) -> Result<(), PictureError> {
    if !force && path.symlink_metadata().is_ok() {
        return Err(PictureError::Exists(path.to_owned()));
    }
    let bytes =
        image.to_png().map_err(|source| PictureError::Write { path: path.to_owned(), source })?;
    place(path, &[&bytes], force)
}

/// Puts a file in place whole.
pub(super) fn place(path: &Path, parts: &[&[u8]], force: bool) -> Result<(), PictureError> {
    write(path, parts, force).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists if !force => PictureError::Exists(path.to_owned()),
        _ => PictureError::Write { path: path.to_owned(), source },
    })
}

fn write(path: &Path, parts: &[&[u8]], force: bool) -> io::Result<()> {
    let mut file = crate::place::beside(path)?;
    for part in parts {
        file.write_all(part)?;
    }
    if force { file.persist(path) } else { file.persist_noclobber(path) }?;
    Ok(())
}
