//! Surfaces made solid: what is closed encloses something, what is open becomes a shell.
//!
//! A *piece* is what hangs together by edges. A piece is *whole* when it is closed and has two
//! sides: every edge is run through as often in one direction as in the other. What is whole is
//! solid, by the winding number; the rest are *sheets*, to which the unsigned distance is taken, less
//! half the thickness. A Klein bottle is closed and yet a sheet: it has one side.

use super::Shared;
use super::csg::{Join, Joined};
use super::mesh::{MeshField, MeshFieldError, MeshOptions, Sign, Thicken, Which};
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;
use std::sync::Arc;

/// Which pieces become solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Skin {
    /// Those that are whole.
    #[default]
    Auto,
    /// All: whatever the winding number says is inside.
    Solid,
    /// None: everything is a shell.
    Shell,
}

/// How a surface becomes a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinOptions {
    /// Full thickness of sheets, mm: half of it on either side.
    pub thickness: Option<f64>,
    /// Which pieces become solid.
    pub skin: Skin,
}

/// What a surface is, as far as its triangles tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sides {
    /// Pieces.
    pub pieces: usize,
    /// Pieces that are closed and two-sided.
    pub whole: usize,
    /// Pieces without open edges that have one side only.
    pub one_sided: usize,
    /// Edges with one face.
    pub open_edges: usize,
}

/// Why a surface cannot become a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkinError {
    /// Sheets without a thickness.
    #[error(
        "the surface encloses nothing: {}; give it a thickness{}",
        .0.story(),
        if .0.open_edges > 0 { ", or skin = \"solid\" to close its holes by winding number" } else { "" }
    )]
    Sheet(Sides),
    /// What the field of its triangles says.
    #[error(transparent)]
    Field(MeshFieldError),
    /// The job was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<MeshFieldError> for SkinError {
    fn from(e: MeshFieldError) -> Self {
        match e {
            MeshFieldError::Cancelled(c) => Self::Cancelled(c),
            other => Self::Field(other),
        }
    }
}

impl Sides {
    /// What a surface of these triangles is.
    pub fn of(mesh: &TriMesh) -> Self {
        Pieces::of(mesh).sides
    }

    /// Whether nothing but solids comes of it.
    pub fn whole(&self) -> bool {
        self.whole == self.pieces
    }

    /// In words: `1 piece, closed and two-sided`.
    pub fn story(&self) -> String {
        let Self { pieces, whole, one_sided, open_edges } = *self;
        let mut all = vec![];
        let mut say = |n: usize, what: String| {
            if n > 0 {
                let of = if n == pieces { String::new() } else { format!("{n} of {pieces} ") };
                all.push(format!("{of}{what}"));
            }
        };
        say(whole, "closed and two-sided".to_owned());
        say(one_sided, "closed with one side only".to_owned());
        say(pieces - whole - one_sided, format!("open ({open_edges} open edges)"));
        let count = if pieces == 1 { "1 piece".to_owned() } else { format!("{pieces} pieces") };
        format!("{count}, {}", all.join(", "))
    }
}

/// The solid of a surface's triangles (mm), and what the surface is.
///
/// # Errors
/// Sheets without a thickness; a mesh that encloses nothing; cancelled.
pub fn skin(
    mesh: &TriMesh,
    options: &SkinOptions,
    job: &dyn Job,
) -> Result<(Shared, Sides), SkinError> {
    let pieces = Pieces::of(mesh);
    let sides = pieces.sides;
    let mut whole = TriMesh { points: mesh.points.clone(), faces: vec![] };
    let mut sheets = whole.clone();
    for (face, piece) in mesh.faces.iter().zip(&pieces.of_face) {
        let solid = match options.skin {
            Skin::Auto => pieces.whole[*piece as usize],
            Skin::Solid => true,
            Skin::Shell => false,
        };
        if solid { &mut whole } else { &mut sheets }.faces.push(*face);
    }
    let mut fields: Vec<Shared> = vec![];
    if !whole.faces.is_empty() {
        match MeshField::new(&whole, &MeshOptions::default(), job) {
            Ok((field, _)) => fields.push(Arc::new(field)),
            // closed, but folded flat onto itself
            Err(MeshFieldError::NoInside { .. }) if options.thickness.is_some() => {
                sheets.faces.append(&mut whole.faces);
            }
            Err(MeshFieldError::NoInside { .. }) => return Err(SkinError::Sheet(sides)),
            // fins that are still points
            Err(MeshFieldError::Empty { .. }) if !sheets.faces.is_empty() => {}
            Err(e) => return Err(e.into()),
        }
    }
    if !sheets.faces.is_empty() {
        let mm = options.thickness.ok_or(SkinError::Sheet(sides))?;
        let thicken = Some(Thicken { mm, which: Which::All });
        let options = MeshOptions { thicken, sign: Sign::Unsigned, floor: None };
        match MeshField::new(&sheets, &options, job) {
            Ok((field, _)) => fields.push(Arc::new(field)),
            Err(MeshFieldError::Empty { .. }) if !fields.is_empty() => {}
            Err(e) => return Err(e.into()),
        }
    }
    let join = |a, b| -> Shared { Arc::new(Joined { a, b, join: Join::Add }) };
    match fields.into_iter().reduce(join) {
        Some(field) => Ok((field, sides)),
        None => Err(MeshFieldError::Empty { faces: mesh.faces.len() }.into()),
    }
}

/// The pieces of a mesh.
struct Pieces {
    of_face: Vec<u32>,
    whole: Vec<bool>,
    sides: Sides,
}

impl Pieces {
    fn of(mesh: &TriMesh) -> Self {
        let (of_face, count) = crate::mesh::shells(mesh);
        let (mut whole, mut open) = (vec![true; count], vec![false; count]);
        let mut open_edges = 0;
        let mut sides: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(3 * mesh.faces.len());
        for (f, &piece) in mesh.faces.iter().zip(&of_face) {
            for k in 0..3 {
                let (a, b) = (f[k], f[(k + 1) % 3]);
                sides.push(([a.min(b), a.max(b)], piece, a < b));
            }
        }
        sides.sort_unstable();
        for edge in sides.chunk_by(|a, b| a.0 == b.0) {
            let piece = edge[0].1 as usize;
            let along = edge.iter().filter(|s| s.2).count();
            whole[piece] &= 2 * along == edge.len();
            if edge.len() == 1 {
                open[piece] = true;
                open_edges += 1;
            }
        }
        let sides = Sides {
            pieces: count,
            whole: whole.iter().filter(|w| **w).count(),
            one_sided: whole.iter().zip(&open).filter(|(w, o)| !**w && !**o).count(),
            open_edges,
        };
        Self { of_face, whole, sides }
    }
}

#[cfg(test)]
mod tests;
