//! What was found of a chair, in millimetres, standing as its pose says.

use super::stretchers::Side;
use glam::{DQuat, DVec2, DVec3};

/// How a shape has to be moved to stand as chairs do: on the floor z = 0, its mirror plane x = 0,
/// its front towards -y. `p -> turn(scale p) + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Scale, before the rest.
    pub scale: f64,
    /// Turn about z, radians.
    pub turn: f64,
    /// Shift after the turn, mm.
    pub shift: DVec3,
}

impl Pose {
    /// Where a point of the shape goes.
    pub fn point(&self, p: DVec3) -> DVec3 {
        DQuat::from_rotation_z(self.turn) * (p * self.scale) + self.shift
    }
}

/// The seat: its board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seat {
    /// Height of its upper side at the middle.
    pub top: f64,
    /// Thickness of the board alone.
    pub thickness: f64,
    /// Height down to which aprons or upholstery close it from beneath.
    pub under: f64,
    /// Least x and y of its plan.
    pub low: DVec2,
    /// Greatest x and y of its plan.
    pub high: DVec2,
}

/// A strut from the floor to the seat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Its axis at the floor.
    pub foot: DVec3,
    /// Its axis at the seat's underside.
    pub head: DVec3,
    /// Radius of a section of middle size.
    pub radius: f64,
    /// Radius round the axis that holds nearly all of it.
    pub reach: f64,
}

/// A column under the seat.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its axis in the plan.
    pub axis: DVec2,
    /// Radius.
    pub radius: f64,
    /// Height from which it stands alone.
    pub hub: f64,
    /// Radius of what stands on the floor.
    pub reach: f64,
    /// Tips of its spokes; none for a disc.
    pub spokes: Vec<DVec2>,
}

/// What carries the seat.
#[derive(Clone, Debug, PartialEq)]
pub enum Base {
    /// Legs, clockwise seen from above, from the front left one on.
    Legs(Vec<Leg>),
    /// Legs that cross in side view.
    Crossed(Vec<Leg>),
    /// Uprights on runners.
    Sled(Vec<Leg>),
    /// Uprights on one side only.
    Cantilever(Vec<Leg>),
    /// A column on a disc or on spokes.
    Column(Column),
    /// A body without parts; its plan and its height.
    Solid,
}

/// The back: matter round the plane `y = at + slope z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Back {
    /// y of its plane at the floor.
    pub at: f64,
    /// Lean, mm of y a mm of z.
    pub slope: f64,
    /// Height of its upper end.
    pub top: f64,
    /// Half its width, low and high up.
    pub half: [f64; 2],
    /// How far it reaches in front of the plane, mm.
    pub front: f64,
    /// How far it reaches behind the plane, mm.
    pub rear: f64,
}

/// An arm rest with what carries it: a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Lowest corner.
    pub low: DVec3,
    /// Highest corner.
    pub high: DVec3,
}

/// A bar between legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretcher {
    /// Between which legs.
    pub side: Side,
    /// One end of its axis: left or front.
    pub from: DVec3,
    /// The other end of its axis.
    pub to: DVec3,
    /// Radius.
    pub radius: f64,
}

/// The parts of a chair.
#[derive(Clone, Debug, PartialEq)]
pub struct Chair {
    /// The seat.
    pub seat: Seat,
    /// What carries it.
    pub base: Base,
    /// The back, if there is one.
    pub back: Option<Back>,
    /// Arm rests at -x (left) and +x (right).
    pub arms: [Option<Arm>; 2],
    /// Bars between its legs, the lowest of each side first.
    pub stretchers: Vec<Stretcher>,
    /// How well each part was seen, in [0, 1]: mirror plane, seat, base.
    pub sure: [f64; 3],
}

impl Chair {
    /// How far to trust all of it, in [0, 1].
    pub fn confidence(&self) -> f64 {
        self.sure.iter().product::<f64>().cbrt()
    }

    /// What was found, in words.
    pub fn words(&self) -> String {
        let base = match &self.base {
            Base::Legs(l) => format!("{} legs", number(l.len())),
            Base::Crossed(l) => format!("{} crossed legs", number(l.len())),
            Base::Sled(_) => "a sled base".to_owned(),
            Base::Cantilever(_) => "a cantilever base".to_owned(),
            Base::Column(c) if c.spokes.is_empty() => "a column on a disc".to_owned(),
            Base::Column(c) => format!("a column on {} spokes", number(c.spokes.len())),
            Base::Solid => "a solid base".to_owned(),
        };
        let back = if self.back.is_some() { "a back" } else { "no back" };
        let arms = match self.arms {
            [Some(_), Some(_)] => "two arms",
            [None, None] => "no arms",
            [Some(_), None] => "an arm on the left only",
            [None, Some(_)] => "an arm on the right only",
        };
        let bars = match self.stretchers.len() {
            0 => String::new(),
            1 => ", a stretcher".to_owned(),
            n => format!(", {} stretchers", number(n)),
        };
        format!("seat {:.0} mm high, {base}, {back}, {arms}{bars}", self.seat.top)
    }

    /// Another size of the same chair.
    pub(super) fn scaled(mut self, by: f64) -> Self {
        let s = &mut self.seat;
        for x in [&mut s.top, &mut s.thickness, &mut s.under] {
            *x *= by;
        }
        (s.low, s.high) = (s.low * by, s.high * by);
        match &mut self.base {
            Base::Legs(l) | Base::Crossed(l) | Base::Sled(l) | Base::Cantilever(l) => {
                for l in l {
                    (l.foot, l.head) = (l.foot * by, l.head * by);
                    (l.radius, l.reach) = (l.radius * by, l.reach * by);
                }
            }
            Base::Column(c) => {
                c.axis *= by;
                for x in [&mut c.radius, &mut c.hub, &mut c.reach] {
                    *x *= by;
                }
                c.spokes.iter_mut().for_each(|s| *s *= by);
            }
            Base::Solid => {}
        }
        if let Some(b) = &mut self.back {
            b.half = b.half.map(|h| h * by);
            for x in [&mut b.at, &mut b.top, &mut b.front, &mut b.rear] {
                *x *= by;
            }
        }
        for arm in self.arms.iter_mut().flatten() {
            (arm.low, arm.high) = (arm.low * by, arm.high * by);
        }
        for s in &mut self.stretchers {
            (s.from, s.to, s.radius) = (s.from * by, s.to * by, s.radius * by);
        }
        self
    }
}

fn number(n: usize) -> String {
    const WORDS: [&str; 8] = ["no", "one", "two", "three", "four", "five", "six", "seven"];
    WORDS.get(n).map_or_else(|| n.to_string(), |w| (*w).to_owned())
}
