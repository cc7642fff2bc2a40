//! A sheet of meshes with their elements laid over them.

use super::super::failure::Failure;
use fieldgraft::element::tessellate;
use fieldgraft::mesh::TriMesh;
use fieldgraft::num::Aabb;
use fieldgraft::parts::{Guess, Suggestion};
use fieldgraft::picture::{
    Cell, Image, Layout, PictureError, Style, View, render, save_png, sheet,
};
use glam::{DAffine3, DQuat, DVec3};
use std::path::Path;

/// Pixels along a side of each picture.
const SIDE: u32 = 420;
/// Share of the elements' colour in a pixel.
const VEIL: f32 = 0.45;
/// Colours of kinds of features, by the word their names begin with.
const COLORS: [(&str, [u8; 3]); 7] = [
    ("seat", [220, 60, 50]),
    ("back", [40, 150, 60]),
    ("arm", [235, 140, 20]),
    ("leg", [40, 90, 220]),
    ("column", [40, 90, 220]),
    ("foot", [150, 60, 200]),
    ("", [20, 160, 170]),
];

/// Draws and saves the sheet: a row a shape, seen at an angle, from the front and from the side.
pub(super) fn save(
    path: &Path,
    shells: &[TriMesh],
    suggestion: &Suggestion,
    force: bool,
) -> Result<(), Failure> {
    let mut all = Vec::new();
    cells(shells, suggestion, &mut all)?;
    let columns = if shells.len() > 3 { 6 } else { 3 };
    let image = sheet(&all, &Layout { columns, ..Layout::default() })?;
    Ok(save_png(path, &image, force)?)
}

/// Three views of each shape.
fn cells(
    shells: &[TriMesh],
    suggestion: &Suggestion,
    cells: &mut Vec<Cell>,
) -> Result<(), PictureError> {
    for (i, (mesh, guess)) in shells.iter().zip(&suggestion.shapes).enumerate() {
        for view in [View::Iso, View::Front, View::Side] {
            let image = draw(mesh, guess, i, suggestion, view)?;
            let caption = if view == View::Iso {
                format!("{}\nconfidence {:.2}", guess.name, guess.confidence)
            } else {
                String::new()
            };
            cells.push(Cell { image: Some(image), caption });
        }
    }
    Ok(())
}

fn draw(
    mesh: &TriMesh,
    guess: &Guess,
    shape: usize,
    suggestion: &Suggestion,
    view: View,
) -> Result<Image, PictureError> {
    let mut mesh = mesh.clone();
    let pose = &guess.pose;
    mesh.transform(&DAffine3::from_scale_rotation_translation(
        DVec3::splat(pose.scale),
        DQuat::from_rotation_z(pose.turn),
        pose.shift,
    ));
    let mut layers: Vec<(TriMesh, [u8; 3])> = COLORS.map(|(_, c)| (TriMesh::default(), c)).into();
    for feature in &suggestion.features {
        let kind = COLORS.iter().position(|(word, _)| feature.name.starts_with(word));
        let shell = feature.elements.get(shape).and_then(|e| tessellate(e, 24));
        if let (Some(kind), Some(shell)) = (kind, shell) {
            layers[kind].0.append(&shell);
        }
    }
    let bounds = layers.iter().fold(mesh.bounds(), |b, (m, _)| b.hull(m.bounds()));
    let frame = Some(bounds).filter(Aabb::is_finite);
    let style = Style { size: [SIDE, SIDE], view, frame, ..Style::default() };
    let mut image = render(&mesh, &style)?;
    for (layer, color) in layers.iter().filter(|(m, _)| !m.faces.is_empty()) {
        let veil = render(layer, &Style { color: *color, ..style })?;
        for (pixel, over) in image.pixels_mut().iter_mut().zip(veil.pixels()) {
            if colored(over) {
                for (p, o) in pixel.iter_mut().zip(over) {
                    *p = (f32::from(*p) * (1.0 - VEIL) + f32::from(*o) * VEIL) as u8;
                }
            }
        }
    }
    Ok(image)
}

/// Whether a pixel is of an element: the ground and its shadows are grey.
fn colored(pixel: &[u8; 3]) -> bool {
    let (low, high) = (pixel.iter().min(), pixel.iter().max());
    low.zip(high).is_some_and(|(l, h)| h - l > 24)
}
