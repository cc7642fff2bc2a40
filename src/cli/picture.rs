//! `picture`: one mesh drawn, or a sheet of many.

use super::check::{CheckReading, assumed, load};
use super::failure::Failure;
use super::watch::Watch;
use clap::Args;
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::TriMesh;
use fieldgraft::picture::{
    Cell, Image, LARGEST, Layout, PictureError, Style, View, render, save_png, sheet,
};
use std::path::PathBuf;

/// What to draw.
#[derive(Args)]
pub struct Picture {
    /// The meshes: OBJ, STL, PLY, GLB or glTF
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
    /// Colour of the meshes, such as #cea474
    #[arg(long, value_name = "RRGGBB", value_parser = color)]
    color: Option<[u8; 3]>,
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
        let mut meshes = Vec::with_capacity(self.meshes.len());
        for (file, entry) in self.meshes.iter().zip(self.reading.entries(&self.meshes)?) {
            job::check(watch)?;
            let loaded = load(file, &entry)?;
            watch.say(&assumed(file, &loaded));
            meshes.push(loaded.mesh);
        }
        watch.stage("picture");
        let mut style = Style { size: self.size, view: self.view, ..Style::default() };
        style.color = self.color.unwrap_or(style.color);
        let image = match meshes.as_slice() {
            [one] => render(one, &style)?,
            many => self.sheet(many, &style)?,
        };
        job::check(watch)?;
        Ok(save_png(&self.output, &image, self.force)?)
    }

    /// All meshes, each in a frame of its own, over their names.
    fn sheet(&self, meshes: &[TriMesh], style: &Style) -> Result<Image, PictureError> {
        let mut cells = Vec::with_capacity(meshes.len());
        for (mesh, file) in meshes.iter().zip(&self.meshes) {
            let caption = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            cells.push(Cell { image: Some(render(mesh, style)?), caption });
        }
        // a sheet about as wide as it is high
        let columns = (meshes.len() as f64).sqrt().ceil() as usize;
        sheet(&cells, &Layout { columns, ..Layout::default() })
    }
}
