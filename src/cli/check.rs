//! `check`: the state of meshes, in words or as JSON.

use super::failure::{Failure, plain};
use super::inputs::Reading;
use super::watch::Watch;
use clap::Args;
use fieldgraft::check::{Health, Options, Shell, inspect, thinnest_wall, without_copies};
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::TriMesh;
use fieldgraft::mesh::{Assume, Loaded, Unit, Up, read};
use fieldgraft::recipe::{LengthUnit, ShapeEntry, UpAxis};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Which meshes to check.
#[derive(Args)]
pub struct Check {
    /// The meshes: OBJ, STL, PLY, GLB or glTF
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    #[command(flatten)]
    reading: CheckReading,
    /// Print one JSON object a file
    #[arg(long)]
    json: bool,
    /// Judge as if scaled to this height
    #[arg(long, value_name = "MM")]
    print_height: Option<f64>,
    /// Width of the printer's nozzle: a thinner wall is not printable
    #[arg(long, value_name = "MM")]
    nozzle: Option<f64>,
    /// Fail (4) when a mesh cannot be printed
    #[arg(long)]
    strict: bool,
}

/// How to read meshes that are only looked at.
#[derive(Args, Clone, Debug, Default)]
pub struct CheckReading {
    /// Axis that points up: y or z; by default y for OBJ and glTF, else z
    #[arg(long, value_name = "AXIS", value_delimiter = ',')]
    up: Vec<String>,
    /// Unit of length: m, cm, mm or in; by default m for glTF, else mm
    #[arg(long, value_name = "UNIT", value_delimiter = ',')]
    unit: Vec<String>,
    /// Scale to this height; 0 keeps it
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    height: Vec<f64>,
}

impl CheckReading {
    /// The meshes, in order, each as soon as it is asked for.
    pub fn entries(&self, files: &[PathBuf]) -> Result<Vec<ShapeEntry>, Failure> {
        let reading = Reading {
            up: self.up.clone(),
            unit: self.unit.clone(),
            height: self.height.clone(),
            ..Reading::default()
        };
        reading.shapes(files)
    }
}

/// Reads a mesh as its entry says, scaled to its height.
pub fn load(file: &Path, entry: &ShapeEntry) -> Result<Loaded, Failure> {
    let up = entry.up.map(|u| match u {
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    });
    let unit = entry.unit.map(|u| match u {
        LengthUnit::M => Unit::M,
        LengthUnit::Cm => Unit::Cm,
        LengthUnit::Mm => Unit::Mm,
        LengthUnit::In => Unit::In,
    });
    let mut loaded = read(file, Assume { up, unit })?;
    let tall = loaded.mesh.bounds().size().z;
    if let Some(h) = entry.height.filter(|_| tall > 0.0) {
        loaded.mesh.points.iter_mut().for_each(|p| *p *= h / tall);
    }
    Ok(loaded)
}

/// What was assumed of a file, and the size that follows.
pub fn assumed(file: &Path, loaded: &Loaded) -> String {
    let size = loaded.mesh.bounds().size();
    format!(
        "{}: {} up, unit {}: {:.1} x {:.1} x {:.1} mm",
        file.display(),
        loaded.up,
        loaded.unit,
        size.x,
        size.y,
        size.z
    )
}

impl Check {
    /// Checks all of them, then fails for the first that is bad.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        for (option, mm) in [("--print-height", self.print_height), ("--nozzle", self.nozzle)] {
            if mm.is_some_and(|mm| !(mm > 0.0 && mm.is_finite())) {
                return Err(Failure::usage(format!("{option}: expected millimetres, more than 0")));
            }
        }
        let mut entries = self.reading.entries(&self.meshes)?;
        for entry in &mut entries {
            entry.height = self.print_height.or(entry.height);
        }
        let mut worst: Option<Failure> = None;
        for (file, entry) in self.meshes.iter().zip(&entries) {
            job::check(watch)?;
            watch.stage("check");
            let judged = self.one(file, entry, watch);
            match judged {
                Ok(true) => {}
                Ok(false) if self.strict => {
                    let why = format!("{}: not printable (--strict)", file.display());
                    worst.get_or_insert(Failure::new(Failure::UNPRINTABLE, why));
                }
                Ok(false) => {}
                // nobody reads the answers any more
                Err(e) if e.message.is_empty() => return Err(e),
                // a file that cannot be read outranks one that cannot be printed
                Err(e) => match &worst {
                    Some(w) if w.code == Failure::INPUT => {
                        watch.say(&format!("error: {}", e.message))
                    }
                    _ => worst = Some(e),
                },
            }
        }
        worst.map_or(Ok(()), Err)
    }

    /// Whether the mesh can be printed.
    fn one(&self, file: &Path, entry: &ShapeEntry, watch: &Watch) -> Result<bool, Failure> {
        let loaded = load(file, entry)?;
        watch.say(&assumed(file, &loaded));
        watch.detail(&format!("  {}", loaded.found.summary().replace('\n', "; ")));
        let mut health = inspect(&loaded.mesh, &Options::default());
        self.walls(loaded.mesh, &mut health, watch)?;
        let told = if self.json { json_line(file, &health) } else { words(file, &health) };
        watch.put(&plain(&told))?;
        Ok(health.printable)
    }
}

/// Where more triangles than this, and most of all, cut others, a mesh is a heap of surfaces: between
/// which of them a wall is cannot be said, and every ray would meet all of them.
const HEAP: u64 = 20_000;

impl Check {
    /// Measures the walls of a closed mesh, and judges them by the nozzle.
    fn walls(&self, mesh: TriMesh, health: &mut Health, job: &dyn Job) -> Result<(), Failure> {
        let cut = health.self_intersections.unwrap_or(0);
        let heap = cut > HEAP && 2 * cut > health.triangles;
        if health.volume_mm3.is_none() || heap {
            return Ok(());
        }
        health.min_wall_mm = thinnest_wall(&Shell::new(without_copies(mesh)), job)?;
        if let (Some(wall), Some(nozzle)) = (health.min_wall_mm, self.nozzle)
            && wall < nozzle
        {
            let why = format!("its thinnest wall has {wall:.2} mm, the nozzle {nozzle} mm");
            health.reasons.push(why);
            health.printable = false;
        }
        Ok(())
    }
}

/// The object of `check --json`, on one line.
fn json_line(file: &Path, health: &Health) -> String {
    let mut object = Map::new();
    object.insert("file".to_owned(), json!(file.display().to_string()));
    if let Ok(Value::Object(rest)) = serde_json::to_value(health) {
        object.extend(rest);
    }
    Value::Object(object).to_string()
}

fn words(file: &Path, h: &Health) -> String {
    let verdict = if h.printable { "printable" } else { "NOT printable" };
    let yes = |b: bool| if b { "yes" } else { "no" };
    let known = |n: Option<u64>| n.map_or_else(|| "unknown".to_owned(), |n| n.to_string());
    let size: Vec<String> =
        (0..3).map(|i| format!("{:.1}", h.bbox_mm[1][i] - h.bbox_mm[0][i])).collect();
    let volume = h.volume_mm3.map_or_else(|| "unknown".to_owned(), |v| format!("{:.1}", v / 1e3));
    let genus = h.genus.map_or_else(|| "unknown".to_owned(), |g| g.to_string());
    let wall = h.min_wall_mm.map_or_else(|| "unknown".to_owned(), |w| format!("{w:.2}"));
    let stands = h.balanced.map_or("unknown", yes);
    let name = file.display().to_string().replace('\n', " ");
    let mut text = format!(
        "{name}: {verdict}\n  triangles {}, vertices {}\n  closed {}, manifold edges {}, manifold \
         vertices {}, oriented {}\n  self-intersections {}\n  components {}, floating parts {}, \
         cavities {}, genus {genus}\n  size {} mm, volume {volume} cm3, area {:.1} cm2\n  thinnest \
         wall {wall} mm, stands by itself {stands}",
        h.triangles,
        h.vertices,
        yes(h.closed),
        yes(h.manifold_edges),
        yes(h.manifold_vertices),
        yes(h.oriented),
        known(h.self_intersections),
        h.components,
        known(h.floating_parts),
        known(h.cavities),
        size.join(" x "),
        h.area_mm2 / 100.0
    );
    for reason in &h.reasons {
        text += &format!("\n  - {reason}");
    }
    text
}
