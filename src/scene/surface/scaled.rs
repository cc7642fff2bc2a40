//! Surfaces in units other than millimetres.

use crate::surface::{Domain, Jet, Motion, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A surface times a number.
struct Scaled {
    surface: Arc<dyn Surface>,
    by: f64,
}

/// A motion times a number.
struct ScaledMotion {
    motion: Arc<dyn Motion>,
    by: f64,
}

/// The motion with every length times `by`.
pub fn scaled(motion: Arc<dyn Motion>, by: f64) -> Arc<dyn Motion> {
    if by == 1.0 { motion } else { Arc::new(ScaledMotion { motion, by }) }
}

impl Surface for Scaled {
    fn patches(&self) -> usize {
        self.surface.patches()
    }
    fn domain(&self, patch: usize) -> Domain {
        self.surface.domain(patch)
    }
    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        let Jet { s, su, sv } = self.surface.jet(patch, uv);
        Jet { s: s * self.by, su: su * self.by, sv: sv * self.by }
    }
    fn point(&self, patch: usize, uv: DVec2) -> DVec3 {
        self.surface.point(patch, uv) * self.by
    }
}

impl Motion for ScaledMotion {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(Arc::new(Scaled { surface: self.motion.at(t)?, by: self.by }))
    }
}
