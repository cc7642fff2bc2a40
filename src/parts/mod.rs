//! Finding the parts of a chair in its field, and pairing those of several chairs.
//!
//! A chair is looked at as a small grid of solid samples: how it stands (mirror plane, front), its
//! seat, what carries it, its back and arm rests. Meshes need not be clean, since only the field is
//! asked. [`suggest`] gives the pose of every shape and the feature elements of all of them, paired
//! by name.
//!
//! - A *pose* puts the floor at z = 0, the mirror plane at x = 0 and the front towards -y.
//! - *Left* is -x and *right* is +x, *front* is -y: as seen by who looks at the chair's front.
//! - A *base* is what carries the seat: legs, a column, runners, or a solid body.
//! - *Confidence* is a number in [0, 1]; below [`DOUBTFUL`] the suggestion is a guess.
//!
//! What is no chair gets three slabs from bottom to top, with a low confidence.
//!
//! ```
//! use fieldgraft::{element::Element, field::csg::Join, field::solid::{Assembly, Part}, job::Quiet, parts};
//! let rod = |x: f64, y: f64, top: f64, r| Element::rod([x, y, 0.0].into(), [x, y, top].into(), r);
//! let mut stool = vec![Element::rod([0.0, 0.0, 430.0].into(), [0.0, 0.0, 460.0].into(), 190.0)?];
//! for (x, y) in [(-110.0, -110.0), (110.0, -110.0), (-110.0, 110.0), (110.0, 110.0)] {
//!     stool.push(rod(x, y, 435.0, 18.0)?);
//! }
//! let part = |element| Part { element, round: 0.0, join: Join::Add };
//! let stool = Assembly::new(&stool.into_iter().map(part).collect::<Vec<_>>())?;
//! let found = parts::suggest(&[("stool", &stool)], &Quiet)?;
//! assert!(found.shapes[0].chair.as_ref().is_some_and(|c| (c.seat.top - 460.0).abs() < 10.0));
//! assert_eq!(found.features.len(), 5, "the seat and four legs");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod above;
mod base;
mod chair;
mod feet;
mod find;
mod fit;
mod legs;
mod mask;
mod mirror;
mod pair;
mod seat;
mod slabs;
mod stretchers;
mod volume;

#[cfg(test)]
mod tests;

pub use chair::{Arm, Back, Base, Chair, Column, Leg, Pose, Seat, Stretcher};
pub use feet::{Foot, feet};
pub use stretchers::Side;

use crate::element::Element;
use crate::field::Field;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use find::Look;
use glam::DVec3;

/// Below this confidence a shape is hardly a chair.
pub const DOUBTFUL: f64 = 0.35;

/// What is suggested for some shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// One a shape, in their order.
    pub shapes: Vec<Guess>,
    /// Features of all shapes, in their poses.
    pub features: Vec<Paired>,
}

/// What was found of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// Its name.
    pub name: String,
    /// How it should be stood.
    pub pose: Pose,
    /// The box round it in its pose, mm.
    pub bounds: Aabb,
    /// Its parts in its pose, if it seems to be a chair.
    pub chair: Option<Chair>,
    /// How far to trust this, in [0, 1].
    pub confidence: f64,
    /// What to look at.
    pub warnings: Vec<String>,
}

/// A suggested feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Paired {
    /// Its name, such as `leg front left`.
    pub name: String,
    /// One element a shape, in the order of the shapes, each in its shape's pose.
    pub elements: Vec<Element>,
    /// How far to trust it, in [0, 1].
    pub confidence: f64,
    /// What else is to be said of it.
    pub note: Note,
}

/// Where the elements of a feature come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// Found on every shape.
    Found,
    /// These shapes (by index) have no such part; their element is where it would be.
    Absent(Vec<usize>),
    /// One element round several members, which have no partners one by one: legs and a column.
    Whole,
    /// Different numbers of legs: one may stand for two.
    Mixed,
    /// No part of a chair: a slab of the whole shape.
    Slab,
}

/// Suggests poses and features for some shapes, named and given as fields in mm, z up. Each is looked
/// up some hundred thousand times: a sampled form is much quicker than a mesh.
///
/// # Errors
/// Cancelled.
pub fn suggest(shapes: &[(&str, &dyn Field)], job: &dyn Job) -> Result<Suggestion, Cancelled> {
    let mut guesses = Vec::with_capacity(shapes.len());
    for (name, field) in shapes {
        guesses.push(guess(name, find::look(*field, job)?));
    }
    scale(&mut guesses);
    Ok(Suggestion { features: features(&guesses), shapes: guesses })
}

fn guess(name: &str, look: Option<Look>) -> Guess {
    let Some(look) = look else {
        return Guess {
            name: name.to_owned(),
            pose: Pose { scale: 1.0, turn: 0.0, shift: DVec3::ZERO },
            bounds: Aabb::EMPTY,
            chair: None,
            confidence: 0.0,
            warnings: vec!["nothing solid was found".to_owned()],
        };
    };
    let confidence = look.chair.as_ref().map_or(0.0, Chair::confidence);
    let chair = look.chair.filter(|_| confidence >= DOUBTFUL);
    let mut warnings = look.warnings;
    if chair.is_none() {
        warnings.push("does not look like a chair".to_owned());
    }
    Guess {
        name: name.to_owned(),
        pose: Pose { scale: 1.0, turn: look.stand.turn, shift: look.stand.shift },
        bounds: look.bounds,
        chair,
        confidence,
        warnings,
    }
}

/// Seat heights that chairs have, mm.
const SEATS: std::ops::RangeInclusive<f64> = 150.0..=1000.0;
/// Height given to a seat when no chair tells another, mm.
const SEAT: f64 = 450.0;

/// Sizes are kept where a seat is at a height that chairs have. Others are taken for a wrong unit: they
/// are scaled to the seat height of the first chair of a usual size.
fn scale(guesses: &mut [Guess]) {
    let seat = |g: &Guess| g.chair.as_ref().map(|c| c.seat.top);
    let usual = guesses.iter().filter_map(seat).find(|z| SEATS.contains(z)).unwrap_or(SEAT);
    for g in guesses {
        let Some(top) = seat(g).filter(|z| !SEATS.contains(z) && *z > 0.0) else { continue };
        let by = usual / top;
        g.chair = g.chair.take().map(|c| c.scaled(by));
        g.bounds = Aabb::new(g.bounds.min * by, g.bounds.max * by);
        (g.pose.scale, g.pose.shift) = (by, g.pose.shift * by);
        g.warnings.push(format!(
            "the seat would be {top:.4} mm high; scaled to {usual:.0} mm: is the unit right?"
        ));
    }
}

fn features(guesses: &[Guess]) -> Vec<Paired> {
    let chairs: Option<Vec<&Chair>> = guesses.iter().map(|g| g.chair.as_ref()).collect();
    match chairs {
        Some(chairs) if !chairs.is_empty() => pair::pair(&chairs),
        _ => {
            let boxes: Vec<Aabb> = guesses.iter().map(|g| g.bounds).collect();
            slabs::slabs(&boxes)
        }
    }
}
