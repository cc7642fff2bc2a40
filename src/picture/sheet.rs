//! Contact sheets: many pictures in rows and columns, with captions.

use super::font::{fitted, width, write, write_centred};
use super::{Image, PictureError};
use glam::Vec2;

/// One place of a sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// The picture; the place stays free without one.
    pub image: Option<Image>,
    /// What stands under it, one line each.
    pub caption: String,
}

/// How a sheet is laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Cells in a row; at least 1.
    pub columns: usize,
    /// What stands above everything.
    pub title: String,
    /// What stands left of each row, from the top.
    pub row_labels: Vec<String>,
    /// What stands above each column, from the left.
    pub column_labels: Vec<String>,
    /// sRGB colour between the pictures.
    pub background: [u8; 3],
    /// sRGB colour of the text.
    pub ink: [u8; 3],
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            columns: 4,
            title: String::new(),
            row_labels: Vec::new(),
            column_labels: Vec::new(),
            background: [255, 255, 255],
            ink: [52, 54, 58],
        }
    }
}

/// Lays out pictures in rows, each in a place as large as the largest of them.
///
/// # Errors
/// [`PictureError::Size`] when the sheet would be larger than a picture can be, or has no cell.
pub fn sheet(cells: &[Cell], layout: &Layout) -> Result<Image, PictureError> {
    let plan = Plan::of(cells, layout);
    let too_large = |n: f32| {
        if n < f32::from(u16::MAX) { n as u32 } else { u32::MAX }
    };
    let (width, height) = (too_large(plan.size.x), too_large(plan.size.y));
    if cells.is_empty() {
        return Err(PictureError::Size { width: 0, height: 0 });
    }
    let mut image = Image::filled(width, height, layout.background)?;
    plan.labels(&mut image, layout);
    for (i, cell) in cells.iter().enumerate() {
        plan.cell(&mut image, cell, i, layout);
    }
    Ok(image)
}

/// Measures of a sheet, in pixels.
struct Plan {
    columns: usize,
    rows: usize,
    /// Width and height of a place for a picture.
    place: Vec2,
    /// Height of a capital.
    letter: f32,
    gap: f32,
    /// Corner of the first place.
    first: Vec2,
    /// From one place to the next.
    step: Vec2,
    size: Vec2,
}

impl Plan {
    fn of(cells: &[Cell], layout: &Layout) -> Self {
        let columns = layout.columns.clamp(1, cells.len().max(1));
        let rows = cells.len().div_ceil(columns);
        let measure = |i: &Image| Vec2::new(i.width() as f32, i.height() as f32);
        let images = cells.iter().filter_map(|c| c.image.as_ref());
        let place = images.map(measure).fold(Vec2::splat(16.0), Vec2::max);
        let letter = (place.min_element() * 0.034).clamp(7.0, 22.0).round();
        let gap = (place.min_element() * 0.02).clamp(4.0, 16.0).round();
        let lines = cells.iter().map(|c| c.caption.lines().count()).max().unwrap_or(0);
        let band = |show: bool, lines: f32| if show { letter * lines } else { 0.0 };
        let left = layout.row_labels.iter().map(|l| width(l, letter)).fold(0.0, f32::max);
        let left = if left > 0.0 { left.min(place.x) + letter * 2.0 } else { 0.0 };
        let title = band(!layout.title.is_empty(), 4.0);
        let top = title + band(!layout.column_labels.is_empty(), 2.6);
        let first = Vec2::new(left + gap, top + gap).round();
        let captions = if lines > 0 { letter * (1.0 + 1.8 * lines as f32) } else { 0.0 };
        let step = (place + Vec2::new(gap, gap + captions)).round();
        let size = first + step * Vec2::new(columns as f32, rows as f32);
        Self { columns, rows, place, letter, gap, first, step, size }
    }

    fn corner(&self, column: usize, row: usize) -> Vec2 {
        self.first + self.step * Vec2::new(column as f32, row as f32)
    }

    fn labels(&self, image: &mut Image, layout: &Layout) {
        let (letter, ink) = (self.letter, layout.ink);
        let large = letter * 1.4;
        let title = fitted(&layout.title, large, self.size.x - 2.0 * self.gap);
        write(image, &title, Vec2::new(self.gap + large * 0.2, letter * 2.4), large, ink);
        for (i, label) in layout.column_labels.iter().enumerate().take(self.columns) {
            let label = fitted(label, letter, self.place.x);
            let at = self.corner(i, 0) + Vec2::new(self.place.x * 0.5, -letter * 1.2);
            write_centred(image, &label, at, letter, ink);
        }
        for (i, label) in layout.row_labels.iter().enumerate().take(self.rows) {
            let label = fitted(label, letter, self.first.x - letter);
            let at = Vec2::new(letter, self.corner(0, i).y + self.place.y * 0.5);
            write(image, &label, at, letter, ink);
        }
    }

    fn cell(&self, image: &mut Image, cell: &Cell, index: usize, layout: &Layout) {
        let corner = self.corner(index % self.columns, index / self.columns);
        if let Some(picture) = &cell.image {
            let own = Vec2::new(picture.width() as f32, picture.height() as f32);
            let at = (corner + (self.place - own) * 0.5).floor();
            image.paste(picture, at.x as u32, at.y as u32);
        }
        let foot = corner + Vec2::new(self.place.x * 0.5, self.place.y + self.letter * 1.4);
        for (i, line) in cell.caption.lines().enumerate() {
            let line = fitted(line, self.letter, self.place.x);
            let at = foot + Vec2::new(0.0, self.letter * 1.8 * i as f32);
            write_centred(image, &line, at, self.letter, layout.ink);
        }
    }
}
