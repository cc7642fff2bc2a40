//! Options that tell how input meshes are to be read: one value for all, or a list in their order.

use super::failure::Failure;
use clap::Args;
use fieldgraft::recipe::{
    LengthUnit, MesherEntry, PlainOr, ShapeEntry, SignEntry, SkinEntry, UpAxis, kind, read_text,
    word,
};
use std::path::Path;

/// How to read the input meshes.
#[derive(Args, Clone, Debug, Default)]
pub struct Reading {
    /// Axis that points up: y or z; by default y for OBJ and glTF, else z
    #[arg(long, value_name = "AXIS", value_delimiter = ',')]
    pub up: Vec<String>,
    /// Unit of length: m, cm, mm or in; by default m for glTF, else mm
    #[arg(long, value_name = "UNIT", value_delimiter = ',')]
    pub unit: Vec<String>,
    /// Scale to this height; 0 keeps it
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    pub height: Vec<f64>,
    /// Give sheets this thickness; 0 gives none
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    pub thicken: Vec<f64>,
    /// How inside is told from outside: winding, or unsigned (all faces are sheets)
    #[arg(long, value_name = "SIGN", value_delimiter = ',')]
    pub sign: Vec<String>,
    /// Give open or one-sided surfaces, and curves, this thickness; 0 gives none
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    pub thickness: Vec<f64>,
    /// How surfaces become solid: auto, solid (open rims get lids) or shell
    #[arg(long, value_name = "SKIN", value_delimiter = ',')]
    pub skin: Vec<String>,
    /// Hold surfaces that move at this time in [0, 1]; auto lets them follow -t
    #[arg(long, value_name = "T", value_delimiter = ',')]
    pub at: Vec<String>,
}

impl Reading {
    /// The shape entries of some files, in their order.
    pub fn shapes(&self, files: &[impl AsRef<Path>]) -> Result<Vec<ShapeEntry>, Failure> {
        let n = files.len();
        let up = each("--up", &self.up, n, words::<UpAxis>)?;
        let unit = each("--unit", &self.unit, n, words::<LengthUnit>)?;
        let sign = each("--sign", &self.sign, n, words::<SignEntry>)?;
        let height = each("--height", &self.height, n, lengths)?;
        let thicken = each("--thicken", &self.thicken, n, lengths)?;
        let thickness = each("--thickness", &self.thickness, n, lengths)?;
        let skin = each("--skin", &self.skin, n, words::<SkinEntry>)?;
        let at = each("--at", &self.at, n, moments)?;
        // one value for all is for those inputs that can have it, one each is meant as it is typed
        let meant = |values: usize, fits: bool| fits || n == 1 || values == n;
        let entry = |i: usize, file: &Path| {
            let mut entry = ShapeEntry {
                up: up[i],
                unit: unit[i],
                sign: sign[i].unwrap_or_default(),
                height: height[i],
                ..ShapeEntry::default()
            };
            let is = source(file, &mut entry);
            if meant(self.thicken.len(), is == Is::Mesh) {
                entry.thicken = thicken[i].map(PlainOr::Plain);
            }
            if meant(self.thickness.len(), is == Is::Surface) {
                entry.thickness = thickness[i];
            }
            if meant(self.skin.len(), is == Is::Surface) {
                entry.skin = skin[i].unwrap_or_default();
            }
            if meant(self.at.len(), is == Is::Surface) {
                entry.at = at[i];
            }
            entry
        };
        Ok(files.iter().enumerate().map(|(i, f)| entry(i, f.as_ref())).collect())
    }
}

/// What an input file is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Is {
    /// A mesh.
    Mesh,
    /// A solid built of primitives.
    Solid,
    /// A parametric surface or curve.
    Surface,
}

/// Makes a file the source of a shape. A TOML or JSON text is a solid or, by its `kind`, a surface;
/// everything else is a mesh.
pub fn source(file: &Path, entry: &mut ShapeEntry) -> Is {
    if !is_text(file) {
        entry.mesh = Some(file.to_owned());
        return Is::Mesh;
    }
    let kind = read_text(file).ok().and_then(|text| kind(&text, file));
    if kind.is_some_and(|kind| kind != "solid") {
        entry.surface = Some(file.to_owned());
        return Is::Surface;
    }
    entry.solid = Some(PlainOr::Plain(file.to_owned()));
    Is::Solid
}

/// Whether a file is a text of ours by its name.
pub fn is_text(file: &Path) -> bool {
    file.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml") || e.eq_ignore_ascii_case("json"))
}

/// One value a file from a list of none, one, or as many as there are files.
fn each<T, U: Clone>(
    option: &str,
    list: &[T],
    files: usize,
    read: impl Fn(&T) -> Result<Option<U>, String>,
) -> Result<Vec<Option<U>>, Failure> {
    let read = |x: &T| read(x).map_err(|why| Failure::usage(format!("{option}: {why}")));
    match list {
        [] => Ok(vec![None; files]),
        [one] => Ok(vec![read(one)?; files]),
        many if many.len() == files => many.iter().map(read).collect(),
        many => Err(Failure::usage(format!(
            "{option}: {} values for {files} inputs; give one for all, or one each",
            many.len()
        ))),
    }
}

/// A word of the recipe; `auto` leaves it open.
fn words<T: serde::de::DeserializeOwned>(text: &String) -> Result<Option<T>, String> {
    if text == "auto" { Ok(None) } else { word(text).map(Some) }
}

/// A length in mm; 0 leaves it open.
fn lengths(mm: &f64) -> Result<Option<f64>, String> {
    if *mm == 0.0 {
        Ok(None)
    } else if *mm > 0.0 && mm.is_finite() {
        Ok(Some(*mm))
    } else {
        Err(format!("got {mm}; expected millimetres, more than 0"))
    }
}

/// A time in [0, 1]; `auto` leaves it open.
fn moments(text: &String) -> Result<Option<f64>, String> {
    if text == "auto" {
        return Ok(None);
    }
    let t = text.parse().ok().filter(|t| (0.0..=1.0).contains(t));
    t.map(Some).ok_or_else(|| format!("got `{text}`; expected a time from 0 to 1, or auto"))
}

/// A mesher by name.
pub fn mesher(text: &str) -> Result<MesherEntry, String> {
    word(text)
}

/// How finely to sample.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Fineness {
    /// Cells along the longest side; by default as a recipe says, else 256
    #[arg(long, value_name = "N", conflicts_with = "voxel")]
    pub resolution: Option<u32>,
    /// Side of a cell
    #[arg(long, value_name = "MM")]
    pub voxel: Option<f64>,
}

/// A size in bytes: `800000`, `500M`, `1.5G`, `2GiB`; K, M and G are powers of 1000, KiB of 1024.
pub fn size(text: &str) -> Result<u64, String> {
    let bad = || format!("got `{text}`; expected a size such as 500M, 2G or 2GiB");
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let factor = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err(bad()),
    };
    let number: f64 = number.parse().map_err(|_| bad())?;
    Ok((number * factor) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("500M"), Ok(500_000_000));
        assert_eq!(size("1.5GiB"), Ok(1_610_612_736));
        assert_eq!(size("12"), Ok(12));
        for bad in ["", "G", "-1G", "1X", "1.2.3M"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn one_value_for_all_or_one_each() {
        let files = ["a.obj", "b.toml"];
        let reading = |up: &[&str]| Reading {
            up: up.iter().map(|s| s.to_string()).collect(),
            ..Reading::default()
        };
        let shapes = reading(&["y", "auto"]).shapes(&files).unwrap();
        assert_eq!((shapes[0].up, shapes[1].up), (Some(UpAxis::Y), None));
        assert!(shapes[1].solid.is_some() && shapes[0].mesh.is_some());
        assert_eq!(reading(&["z"]).shapes(&files).unwrap()[1].up, Some(UpAxis::Z));
        let e = reading(&["y", "z", "y"]).shapes(&files).unwrap_err();
        assert!(e.code == Failure::USAGE && e.message.contains("3 values for 2 inputs"));
        assert!(reading(&["x"]).shapes(&files).unwrap_err().message.contains("known: y, z"));
    }
}
