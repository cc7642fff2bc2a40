//! Surface files (`kind = "pde"` and so on) brought to life.

use super::{Input, SceneError};
use crate::surface::nurbs::{Curve, CurveMorph};
use crate::surface::{Motion, Surface, SurfaceError};
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
    /// What it is in a few words, for the user: `PDE surface of 9 patches`.
    pub story: String,
    /// What the user should know, such as that it may overshoot.
    pub warnings: Vec<String>,
    /// The files read: this one and those it names.
    pub inputs: Vec<Input>,
}

/// Reads a surface file and those it names, relative to it.
///
/// # Errors
/// What is wrong with a file, by its key.
pub fn open(path: &Path) -> Result<SurfaceFile, SceneError> {
    let _ = path;
    todo!("readers of surface files")
}
