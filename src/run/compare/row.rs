//! One method at one time: what was measured.

use serde::Serialize;

/// What was measured of a frame; `None` where it was not or cannot be.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// The method's name.
    pub method: String,
    /// The time.
    pub t: f64,
    /// Why there is no mesh.
    pub error: Option<String>,
    /// Seconds from the fields of the shapes to the mesh.
    pub seconds: Option<f64>,
    /// Largest resident set while the frame was made, megabytes of 10^6 bytes.
    pub peak_mb: Option<f64>,
    /// Side of a cell.
    pub voxel_mm: f64,
    /// Bricks that hold samples.
    pub active_bricks: Option<u64>,
    /// Triangles.
    pub triangles: Option<u64>,
    /// Whether the mesh is closed.
    pub closed: Option<bool>,
    /// Whether every edge has two triangles and every vertex one fan.
    pub manifold: Option<bool>,
    /// Triangles that meet others.
    pub self_intersections: Option<u64>,
    /// Sets of triangles joined through edges.
    pub components: Option<u64>,
    /// Handles over all components.
    pub genus: Option<i64>,
    /// Enclosed volume.
    pub volume_mm3: Option<f64>,
    /// Volume over the weighted mean of the parents' volumes.
    pub volume_kept: Option<f64>,
    /// Area.
    pub area_mm2: Option<f64>,
    /// Thinnest wall.
    pub min_wall_mm: Option<f64>,
    /// Hausdorff distance to the first parent.
    pub hausdorff_to_a_mm: Option<f64>,
    /// Hausdorff distance to the second parent.
    pub hausdorff_to_b_mm: Option<f64>,
    /// Hausdorff distance to the frame before.
    pub step_mm: Option<f64>,
    /// Components of positive volume.
    pub pieces: Option<u64>,
    /// Pieces of at least [`Row::LARGE`] of the volume; the others are specks.
    pub large_pieces: Option<u64>,
    /// Volume of the smallest piece.
    pub smallest_piece_mm3: Option<f64>,
    /// That over the whole volume.
    pub smallest_piece_share: Option<f64>,
    /// Mean distance to the first parent.
    pub mean_to_a_mm: Option<f64>,
    /// Mean distance to the second parent.
    pub mean_to_b_mm: Option<f64>,
    /// Mean distance to the frame before.
    pub mean_step_mm: Option<f64>,
    /// Largest distance of a point of the surface to the nearer parent.
    pub stray_mm: Option<f64>,
    /// What the Hausdorff distances of this row may be short of, at most.
    pub hausdorff_error_mm: Option<f64>,
    /// Mean of | |grad f| - 1 | on the surface.
    pub gradient_error: Option<f64>,
    /// Whether the shape was closed at the border of the grid.
    pub border_clipped: Option<bool>,
    /// Loose pieces that were dropped.
    pub crumbs: Option<u64>,
    /// Seconds that the check, the measures and the picture took.
    pub seconds_measures: Option<f64>,
    /// The mesh's file, when it was written.
    pub file: Option<String>,
}

impl Row {
    /// Share of the volume from which on a piece is no speck.
    pub const LARGE: f64 = 0.005;

    /// Takes over what was measured of the same mesh, whatever the frame before was.
    pub(super) fn take(&mut self, known: &Self) {
        self.min_wall_mm = known.min_wall_mm;
        (self.hausdorff_to_a_mm, self.mean_to_a_mm) = (known.hausdorff_to_a_mm, known.mean_to_a_mm);
        (self.hausdorff_to_b_mm, self.mean_to_b_mm) = (known.hausdorff_to_b_mm, known.mean_to_b_mm);
        (self.stray_mm, self.hausdorff_error_mm) = (known.stray_mm, known.hausdorff_error_mm);
    }

    /// Of a method that does not apply.
    pub(super) fn refused(method: &str, t: f64, why: &str) -> Self {
        Self { method: method.to_owned(), t, error: Some(why.to_owned()), ..Self::default() }
    }
}

/// What is good in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Best {
    /// The least.
    Low,
    /// The most.
    High,
    /// The nearest to one.
    One,
    /// Nothing in particular.
    Neither,
}

/// A column of `metrics.csv`, and what is said of it in the report.
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for numbers and words.
    pub unit: &'static str,
    /// What it is, how it is found, how exact it is.
    pub says: &'static str,
    /// The value as it stands in the file; empty for none.
    pub text: fn(&Row) -> String,
}

/// A word or number, empty for none.
fn word<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |v| v.to_string())
}

/// Quoted when it holds a comma, quote or line end (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

macro_rules! column {
    ($name:ident, $unit:literal, $says:literal) => {
        Column { name: stringify!($name), unit: $unit, says: $says, text: |r| word(r.$name) }
    };
}

/// The columns of `metrics.csv`, in order.
pub const COLUMNS: &[Column] = &[
    Column { name: "method", unit: "", says: "The method's name.", text: |r| quoted(&r.method) },
    Column {
        name: "t",
        unit: "",
        says: "The time, 0 the first shape, 1 the second.",
        text: |r| r.t.to_string(),
    },
    column!(
        seconds,
        "s",
        "Wall time from the sampled parents to the mesh: fixing the time, sampling, extracting. The parents are made once for all methods and do not count; measures do not either."
    ),
    column!(
        peak_mb,
        "MB",
        "Largest resident set of the program while the frame was made, parents included. Empty where the system cannot reset it."
    ),
    Column {
        name: "voxel_mm",
        unit: "mm",
        says: "Side of a cell; one lattice for all methods.",
        text: |r| r.voxel_mm.to_string(),
    },
    column!(active_bricks, "", "Blocks of 8³ samples that were needed."),
    column!(triangles, "", "Triangles of the mesh; one mesher for all methods."),
    column!(closed, "", "Whether the directed edges cancel."),
    column!(manifold, "", "Whether every edge has two triangles and every vertex one fan."),
    column!(
        self_intersections,
        "",
        "Triangles that cut or touch others. Only with --verify: about as long again as all other checks."
    ),
    column!(components, "", "Sets of triangles joined through edges, cavities included; exact."),
    column!(
        genus,
        "",
        "Handles over all components, from V - E + F = 2 (components - genus); exact."
    ),
    column!(
        volume_mm3,
        "mm³",
        "By the divergence theorem over the triangles; exact for the mesh, which is off from the field's surface by second order in the voxel."
    ),
    column!(
        volume_kept,
        "",
        "Volume over the mean of the parents' volumes, weighted by t as the features are."
    ),
    column!(area_mm2, "mm²", "Sum of the triangles; a rough surface has more."),
    column!(
        min_wall_mm,
        "mm",
        "Diameter of the smallest ball between the surface and the opposite side that the inward normal meets, sides that lean by 60° or more left out; the middle one of a triangle's corners counts, and 16 average triangles must be as thin. Exact for plates, rods and balls up to the mesh; rough below two voxels."
    ),
    column!(
        hausdorff_to_a_mm,
        "mm",
        "Hausdorff distance to the first parent, sampled and meshed on the same lattice: the larger of both ways, every vertex to the nearest triangle, and triangles halved where a larger distance may hide. Reached; the true one is at most hausdorff_error_mm more."
    ),
    column!(hausdorff_to_b_mm, "mm", "The same to the second parent."),
    column!(
        step_mm,
        "mm",
        "Hausdorff distance to the frame before in t; empty where either has no mesh."
    ),
    column!(pieces, "", "Components of positive volume: solids; exact."),
    column!(large_pieces, "", "Pieces of at least 0.5% of the volume; the others are specks."),
    column!(smallest_piece_mm3, "mm³", "Volume of the smallest piece."),
    column!(smallest_piece_share, "", "Volume of the smallest piece over the whole."),
    column!(
        mean_to_a_mm,
        "mm",
        "Mean distance to the first parent over the area, both ways averaged, by the values at the vertices; off by less than the longest edge, on smooth surfaces of second order."
    ),
    column!(mean_to_b_mm, "mm", "The same to the second parent."),
    column!(mean_step_mm, "mm", "The same to the frame before."),
    column!(
        stray_mm,
        "mm",
        "Largest distance of a vertex to the nearer parent: what grows where neither parent has anything. Parts that move from one parent's place to the other's stray by up to half their way."
    ),
    column!(hausdorff_error_mm, "mm", "The largest bracket of the row's Hausdorff distances."),
    column!(
        gradient_error,
        "",
        "Mean of | |grad f| - 1 | by central differences of a voxel at up to 2000 vertices: 0 for a signed distance. Offsets and sphere tracing trust the field as far as this is small."
    ),
    column!(
        border_clipped,
        "",
        "Whether the shape reached the border of the lattice and was closed there."
    ),
    column!(
        crumbs,
        "",
        "Loose pieces dropped before anything was measured (--crumbs or output.crumbs; the same for every method)."
    ),
    column!(seconds_measures, "s", "Time of the check, the measures and the picture."),
    Column {
        name: "file",
        unit: "",
        says: "The mesh, relative to the report.",
        text: |r| quoted(r.file.as_deref().unwrap_or_default()),
    },
    Column {
        name: "error",
        unit: "",
        says: "Why there is no mesh.",
        text: |r| quoted(r.error.as_deref().unwrap_or_default()),
    },
];

/// `metrics.csv`.
pub fn csv(rows: &[Row]) -> String {
    let header: Vec<&str> = COLUMNS.iter().map(|c| c.name).collect();
    let mut text = header.join(",") + "\n";
    for row in rows {
        let line: Vec<String> = COLUMNS.iter().map(|c| (c.text)(row)).collect();
        text += &(line.join(",") + "\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_begins_as_promised() {
        let promised = "method,t,seconds,peak_mb,voxel_mm,active_bricks,triangles,closed,manifold,\
                        self_intersections,components,genus,volume_mm3,volume_kept,area_mm2,\
                        min_wall_mm,hausdorff_to_a_mm,hausdorff_to_b_mm,step_mm";
        assert!(csv(&[]).starts_with(promised));
    }

    #[test]
    fn what_is_not_known_is_empty_and_words_are_quoted() {
        let row = Row {
            method: "a".to_owned(),
            t: 0.5,
            genus: Some(-1),
            error: Some("said \"no\", twice".to_owned()),
            ..Row::default()
        };
        let text = csv(&[row]);
        let line = text.lines().nth(1).unwrap();
        assert!(line.starts_with("a,0.5,,,0,,,,,,,-1,"), "{line}");
        assert!(line.ends_with(",\"said \"\"no\"\", twice\""), "{line}");
        assert!(COLUMNS.iter().all(|c| c.says.ends_with('.')));
    }

    /// Every key of a row is a column and the other way round.
    #[test]
    fn columns_are_complete() {
        let row = serde_json::to_value(Row::default()).unwrap();
        let mut keys: Vec<&str> = row.as_object().unwrap().keys().map(String::as_str).collect();
        let mut names: Vec<&str> = COLUMNS.iter().map(|c| c.name).collect();
        keys.sort_unstable();
        names.sort_unstable();
        assert_eq!(keys, names);
    }
}
