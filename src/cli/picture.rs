//! `picture`: one mesh drawn, or a sheet of many.

use super::check::{CheckReading, assumed, load};
use super::convert::{plain, unnamed};
use super::failure::Failure;
use super::inputs::{self, Is};
use super::watch::Watch;
use clap::Args;
use fieldgraft::check::without_copies;
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::TriMesh;
use fieldgraft::num::Aabb;
use fieldgraft::picture::{
    Cell, Image, LARGEST, Layout, PictureError, Style, View, render, save_png, sheet,
};
use fieldgraft::recipe::{GridEntry, ShapeEntry};
use fieldgraft::scene::Single;
use glam::DVec3;
use std::path::{Path, PathBuf};

/// What to draw.
#[derive(Args)]
pub struct Picture {
    /// The meshes: OBJ, STL, PLY, GLB or glTF, or solids and surfaces (`.toml`); `-` leaves a place on a
    /// sheet free
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The picture: PNG
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// Width and height of each picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "800x800")]
    size: [u32; 2],
    /// Where the camera stands: iso, front, side or top
    #[arg(long, value_parser = view, default_value = "iso")]
    view: View,
    /// Colour of the meshes, such as #cea474: one for all, or a list in their order
    #[arg(long, value_name = "RRGGBB", value_parser = color, value_delimiter = ',')]
    color: Vec<[u8; 3]>,
    /// Pictures in a row of a sheet
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    columns: Option<u16>,
    /// What stands left of the rows of a sheet, such as linear,graft
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    row_labels: Vec<String>,
    /// What stands above the columns of a sheet, such as 0,0.5,1
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    column_labels: Vec<String>,
    /// What stands above a sheet
    #[arg(long, value_name = "TEXT", default_value = "")]
    title: String,
    /// Draw all meshes of a sheet at one scale
    #[arg(long)]
    same_scale: bool,
    /// Thickness of curves
    #[arg(long, value_name = "MM")]
    thickness: Option<f64>,
    /// Draw surfaces that move at this time in [0, 1]; by default 0.5
    #[arg(long, value_name = "T")]
    at: Option<f64>,
    #[command(flatten)]
    reading: CheckReading,
    /// Overwrite what is there
    #[arg(long)]
    force: bool,
}

fn view(text: &str) -> Result<View, String> {
    text.parse()
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides =
        text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides
        .filter(|s: &[u32; 2]| s.iter().all(|n| (1..=LARGEST).contains(n)))
        .ok_or_else(|| format!("got `{text}`; expected WIDTHxHEIGHT in pixels, 1 to {LARGEST}"))
}

fn color(text: &str) -> Result<[u8; 3], String> {
    let hex = text.strip_prefix('#').unwrap_or(text);
    let bad = || format!("got `{text}`; expected six hexadecimal digits, such as #cea474");
    if hex.len() != 6 || !hex.is_ascii() {
        return Err(bad());
    }
    let byte = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).map_err(|_| bad());
    Ok([byte(0)?, byte(2)?, byte(4)?])
}

impl Picture {
    /// Draws.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        if !self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            let why = "pictures are PNG; give a name that ends in .png";
            return Err(Failure::usage(format!("{}: {why}", self.output.display())));
        }
        if !self.force && self.output.symlink_metadata().is_ok() {
            let why = "exists already; overwrite it with --force";
            return Err(Failure::usage(format!("{}: {why}", self.output.display())));
        }
        if !matches!(self.color.len(), 0 | 1) && self.color.len() != self.meshes.len() {
            let (colors, meshes) = (self.color.len(), self.meshes.len());
            let why =
                format!("--color names {colors} colours for {meshes} meshes; give one or all");
            return Err(Failure::usage(why));
        }
        let mut meshes = Vec::with_capacity(self.meshes.len());
        for (file, entry) in self.meshes.iter().zip(self.reading.entries(&self.meshes)?) {
            job::check(watch)?;
            if file == Path::new(FREE) {
                meshes.push(None);
                continue;
            }
            if inputs::is_text(file) {
                meshes.push(Some(self.text(file, entry, watch)?));
                continue;
            }
            let loaded = load(file, &entry)?;
            watch.say(&assumed(file, &loaded));
            meshes.push(Some(without_copies(loaded.mesh)));
        }
        watch.stage("picture");
        let image = match meshes.as_slice() {
            [Some(one)] => render(one, &self.style(0, None))?,
            [None] => {
                return Err(Failure::usage("`-` alone draws nothing; name a mesh".to_owned()));
            }
            many => self.sheet(many)?,
        };
        job::check(watch)?;
        Ok(save_png(&self.output, &image, self.force)?)
    }

    /// The triangles of a solid or surface file; a surface is drawn without its thickness, a curve
    /// with it.
    fn text(&self, file: &Path, entry: ShapeEntry, watch: &Watch) -> Result<TriMesh, Failure> {
        let mut entry = ShapeEntry { mesh: None, ..entry };
        if inputs::source(file, &mut entry) == Is::Surface {
            (entry.thickness, entry.at) = (self.thickness, self.at);
        }
        let single = Single::outline("input", entry, &GridEntry::default(), Path::new(""));
        let single = single.map_err(plain)?;
        single.notes().iter().for_each(|n| watch.say(unnamed(n)));
        single.shells().map_err(plain)
    }

    /// How mesh `i` is drawn.
    fn style(&self, i: usize, frame: Option<Aabb>) -> Style {
        let plain = Style::default();
        let color = self.color.get(i).or(self.color.first()).copied().unwrap_or(plain.color);
        Style { size: self.size, view: self.view, color, frame, ..plain }
    }

    /// All meshes over their names, or between the labels of rows and columns.
    fn sheet(&self, meshes: &[Option<TriMesh>]) -> Result<Image, PictureError> {
        let largest =
            meshes.iter().flatten().fold(DVec3::ZERO, |size, mesh| size.max(mesh.bounds().size()));
        let labelled = !self.row_labels.is_empty() || !self.column_labels.is_empty();
        let mut cells = Vec::with_capacity(meshes.len());
        for (i, (mesh, file)) in meshes.iter().zip(&self.meshes).enumerate() {
            let caption = match mesh {
                Some(_) if !labelled => {
                    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
                }
                _ => String::new(),
            };
            let draw = |mesh: &TriMesh| {
                let frame = self.same_scale.then(|| standing(&mesh.bounds(), largest));
                render(mesh, &self.style(i, frame))
            };
            cells.push(Cell { image: mesh.as_ref().map(draw).transpose()?, caption });
        }
        // unless told, a sheet about as wide as it is high
        let columns = match self.columns {
            Some(n) => usize::from(n),
            None if !self.column_labels.is_empty() => self.column_labels.len(),
            None => (meshes.len() as f64).sqrt().ceil() as usize,
        };
        let layout = Layout {
            columns,
            title: self.title.clone(),
            row_labels: self.row_labels.clone(),
            column_labels: self.column_labels.clone(),
            ..Layout::default()
        };
        sheet(&cells, &layout)
    }
}

/// What leaves a place on a sheet free.
const FREE: &str = "-";

/// A box of that size on the floor of another, round the same axis.
fn standing(b: &Aabb, size: DVec3) -> Aabb {
    let middle = b.centre();
    let floor = DVec3::new(middle.x, middle.y, b.min.z);
    let half = DVec3::new(size.x, size.y, 0.0) * 0.5;
    Aabb::new(floor - half, floor + half + DVec3::Z * size.z)
}
