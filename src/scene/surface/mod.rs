//! Surface files (`kind = "pde"` and so on) brought to life.

mod blend;
mod dynamic;
mod nurbs;
mod pde;
mod read;
mod scaled;
#[cfg(test)]
mod tests;

use super::{Input, SceneError};
use crate::recipe::surface::{Averaging, Kind, PdeMethod};
use crate::recipe::{Problem, RecipeError, Source, SurfaceEntry, SurfaceMethod};
use crate::surface::nurbs::{Curve, CurveMorph};
use crate::surface::pde::{PdeMorph, PdeSurface};
use crate::surface::{Motion, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use read::{Opened, Reader};
use std::path::Path;
use std::sync::Arc;

/// What a surface file describes.
#[derive(Clone)]
pub enum Parametric {
    /// A surface that keeps still.
    Surface(Arc<dyn Surface>),
    /// A surface for every t.
    Motion(Arc<dyn Motion>),
    /// A curve that keeps still.
    Curve(Arc<dyn Curve>),
    /// A curve for every t.
    CurveMotion(Arc<CurveMorph>),
}

/// A surface or curve at one time.
#[derive(Clone)]
pub enum Still {
    /// A surface.
    Surface(Arc<dyn Surface>),
    /// A curve.
    Curve(Arc<dyn Curve>),
}

impl Parametric {
    /// Whether it depends on t.
    pub fn moves(&self) -> bool {
        matches!(self, Self::Motion(_) | Self::CurveMotion(_))
    }

    /// What it is at `t` in [0, 1].
    ///
    /// # Errors
    /// What the motion says: a time at which it has no value.
    pub fn at(&self, t: f64) -> Result<Still, SurfaceError> {
        Ok(match self {
            Self::Surface(s) => Still::Surface(s.clone()),
            Self::Motion(m) => Still::Surface(m.at(t)?),
            Self::Curve(c) => Still::Curve(c.clone()),
            Self::CurveMotion(m) => Still::Curve(m.at(t)?),
        })
    }
}

/// A surface file, read.
#[derive(Clone)]
pub struct SurfaceFile {
    /// What it describes.
    pub object: Parametric,
    /// What kind of file it is.
    pub kind: Kind,
    /// What it is in a few words, for the user: `PDE surface of 9 patches`.
    pub story: String,
    /// What the user should know, such as that it may overshoot.
    pub warnings: Vec<String>,
    /// The files read: this one and those it names.
    pub inputs: Vec<Input>,
    /// For kind `dynamic`, the time in the equation's units at t = 1.
    pub duration: Option<f64>,
    /// What it would be without approximation, over the same parameters, where that is known: the
    /// shape that was cut into PDE patches, the closed form of a blend.
    pub exact: Option<Parametric>,
    /// Where its spine comes from, for PDE surfaces.
    pub spine: Option<Spine>,
    /// The text of this file.
    pub source: Arc<Source>,
}

/// What has a spine.
#[derive(Clone)]
pub enum Spine {
    /// A PDE surface.
    Still(Arc<PdeSurface>),
    /// A morph of two.
    Morph(Arc<PdeMorph>),
}

impl Spine {
    /// The points of the spine at `t`, by patch, `steps` pieces each, mm.
    ///
    /// # Errors
    /// What the morph says.
    pub fn points(&self, t: f64, steps: usize) -> Result<Vec<Vec<DVec3>>, SurfaceError> {
        let frame = match self {
            Self::Still(s) => s.frame(),
            Self::Morph(m) => m.frame(t)?,
        };
        let steps = steps.max(1);
        let at = |i: usize| i as f64 / steps as f64;
        let line =
            |p: &crate::surface::pde::Solution| (0..=steps).map(|i| p.spine(at(i))).collect();
        Ok(frame.patches.iter().map(line).collect())
    }
}

/// Points a side at which a surface is held against its exact form.
const LOOKS: usize = 65;

impl SurfaceFile {
    /// Adds file and line to what went wrong at some time.
    pub fn locate(&self, e: SurfaceError) -> RecipeError {
        self.source.locate(problem(e))
    }

    /// The largest distance (mm) at `t` between points of the surface and of its exact form with the
    /// same parameters; nothing where no exact form is known.
    ///
    /// # Errors
    /// A time at which either has no value.
    pub fn residual(&self, t: f64) -> Result<Option<f64>, SurfaceError> {
        let Some(exact) = &self.exact else { return Ok(None) };
        let (Still::Surface(a), Still::Surface(b)) = (self.object.at(t)?, exact.at(t)?) else {
            return Ok(None);
        };
        // beside a blend stand the surfaces it meets, which are exact
        let middle = usize::from(a.patches() == 3 && b.patches() == 1);
        let mut most = 0.0f64;
        for patch in 0..b.patches() {
            let domain = b.domain(patch);
            let along = |[from, to]: [f64; 2], i: usize| {
                let w = i as f64 / (LOOKS - 1) as f64;
                from * (1.0 - w) + to * w
            };
            for k in 0..LOOKS * LOOKS {
                let uv = DVec2::new(along(domain.u, k / LOOKS), along(domain.v, k % LOOKS));
                most = most.max(a.point(patch + middle, uv).distance(b.point(patch, uv)));
            }
        }
        Ok(Some(most))
    }
}

/// Reads a surface file and those it names, relative to it.
///
/// # Errors
/// What is wrong with a file, by its key.
pub fn open(path: &Path) -> Result<SurfaceFile, SceneError> {
    let mut reader = Reader::default();
    let opened = reader.open(path)?;
    let file = match &opened.entry {
        SurfaceEntry::Pde(e) => pde::still(e),
        SurfaceEntry::PdeMorph(e) => pde::morph(e, &opened, &mut reader)?,
        SurfaceEntry::Blend(e) => blend::blend(e),
        SurfaceEntry::Nurbs(e) => nurbs::still(e),
        SurfaceEntry::NurbsMorph(e) => nurbs::morph(e, &opened, &mut reader)?,
        SurfaceEntry::Dynamic(e) => dynamic::dynamic(e),
    };
    let mut file = file.map_err(|p| opened.locate(p))?;
    (file.inputs, file.source) = (reader.inputs, opened.source);
    Ok(file)
}

/// The morph of two surface files that no morph file describes.
///
/// # Errors
/// What is wrong with a file, by its key; files that are not of the kind the method morphs.
pub fn between(a: &Path, b: &Path, method: SurfaceMethod) -> Result<SurfaceFile, SceneError> {
    let mut reader = Reader::default();
    let mut read = |path: &Path| -> Result<Opened, SceneError> {
        let opened = reader.open(path)?;
        let kind = opened.entry.kind();
        if kind == method.of() {
            return Ok(opened);
        }
        let (got, word, wanted) = (kind.word(), method.word(), method.of().word());
        let why = format!("is of kind `{got}`; {word} morphs two files of kind `{wanted}`");
        Err(opened.locate(Problem::new("kind", why)).into())
    };
    let (from, to) = (read(a)?, read(b)?);
    let file = match method {
        SurfaceMethod::PdeBoundary => pde::between(&from, &to, PdeMethod::Boundary),
        SurfaceMethod::PdeModes => pde::between(&from, &to, PdeMethod::Modes),
        SurfaceMethod::PdeCombined => pde::between(&from, &to, PdeMethod::Combined),
        SurfaceMethod::PdeSpine => pde::between(&from, &to, PdeMethod::Spine),
        SurfaceMethod::NurbsLinear => nurbs::between(&from, &to, Averaging::Linear),
        SurfaceMethod::NurbsWeighted => nurbs::between(&from, &to, Averaging::Weighted),
    };
    let mut file = file?;
    (file.inputs, file.source) = (reader.inputs, from.source);
    Ok(file)
}

/// A file of one object without anything special to it.
fn plain(kind: Kind, object: Parametric, story: String) -> SurfaceFile {
    let (warnings, inputs) = (vec![], vec![]);
    SurfaceFile {
        object,
        kind,
        story,
        warnings,
        inputs,
        duration: None,
        exact: None,
        spine: None,
        source: Arc::new(Source::unwritten()),
    }
}

/// A failure of the library, by the key of the file.
fn problem(e: SurfaceError) -> Problem {
    Problem::new(e.at, e.why)
}

/// The same below another key.
fn below(above: &str) -> impl Fn(SurfaceError) -> Problem {
    move |e| Problem::new(format!("{above}.{}", e.at), e.why)
}

/// Lengths of a unit that make sense, mm.
fn check_scale(scale: f64) -> Result<(), Problem> {
    if scale.is_finite() && (1e-9..=1e9).contains(&scale) {
        return Ok(());
    }
    Err(Problem::new("scale", format!("got {scale}; expected 1e-9 to 1e9 mm")))
}
