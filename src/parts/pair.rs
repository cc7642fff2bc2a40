//! The parts of several chairs brought into correspondence.

use super::chair::{Base, Chair, Column, Leg, Stretcher};
use super::fit;
use super::legs;
use super::stretchers::Side;
use super::{Note, Paired};
use crate::element::{Element, ElementError};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// A place round the seat that legs are matched to.
struct Slot {
    name: String,
    /// Unit direction from the seat's centre.
    to: DVec2,
}

/// Elements of the same parts on every chair. A part that no element can be made of is left out.
pub(super) fn pair(chairs: &[&Chair]) -> Vec<Paired> {
    let mut all = Vec::new();
    let sure = |i: usize| chairs.iter().map(|c| c.sure[i]).fold(1.0, f64::min);
    let mut put = |name: String, elements: Result<Vec<Element>, ElementError>, sure, note| {
        if let Ok(elements) = elements {
            all.push(Paired { name, elements, confidence: sure, note });
        }
    };
    put(
        "seat".to_owned(),
        chairs.iter().map(|c| fit::seat(&c.seat)).collect(),
        sure(1),
        Note::Found,
    );
    let backs = |c: &Chair| c.back.map(|b| fit::back(&c.seat, &b));
    if let Some((elements, note)) = shared(chairs, backs) {
        put("back".to_owned(), elements, sure(0), note);
    }
    for (side, name) in ["arm left", "arm right"].into_iter().enumerate() {
        let arms = |c: &Chair| c.arms[side].map(|a| fit::arm(&a));
        if let Some((elements, note)) = shared(chairs, arms) {
            put(name.to_owned(), elements, sure(0), note);
        }
    }
    if !alike(chairs) {
        put("base".to_owned(), chairs.iter().map(|c| fit::base(c)).collect(), sure(2), Note::Whole);
        return all;
    }
    if chairs.iter().all(|c| matches!(c.base, Base::Column(_))) {
        put("column".to_owned(), columns(chairs, fit::column), sure(2), Note::Found);
        put("foot".to_owned(), columns(chairs, |_, col| fit::disc(col)), sure(2), Note::Found);
        return all;
    }
    for slot in slots(chairs) {
        let legs = chairs.iter().map(|c| strut(c, &slot)).collect();
        let note = if mixed(chairs) { Note::Mixed } else { Note::Found };
        put(format!("leg {}", slot.name).trim_end().to_owned(), legs, sure(2), note);
    }
    for (name, elements) in stretchers(chairs) {
        put(name, elements, sure(2), Note::Found);
    }
    all
}

/// Stretchers that all chairs have, side by side, the lowest of each first.
fn stretchers(chairs: &[&Chair]) -> Vec<(String, Result<Vec<Element>, ElementError>)> {
    let mut all = Vec::new();
    for (side, word) in [
        (Side::Front, "front"),
        (Side::Left, "left"),
        (Side::Right, "right"),
        (Side::Back, "back"),
        (Side::Middle, "middle"),
    ] {
        let of = |c: &Chair| -> Vec<Stretcher> {
            c.stretchers.iter().copied().filter(|s| s.side == side).collect()
        };
        let bars: Vec<Vec<Stretcher>> = chairs.iter().map(|c| of(c)).collect();
        let count = bars.iter().map(Vec::len).min().unwrap_or(0);
        for n in 0..count {
            let more = if n > 0 { format!(" {}", n + 1) } else { String::new() };
            let elements = bars.iter().map(|b| fit::stretcher(&b[n])).collect();
            all.push((format!("stretcher {word}{more}"), elements));
        }
    }
    all
}

/// Whether the chairs stand on different numbers of struts.
fn mixed(chairs: &[&Chair]) -> bool {
    let count = |c: &&Chair| fit::struts(&c.base).len();
    chairs.iter().any(|c| count(c) != count(&chairs[0]))
}

/// Elements of a part that some chairs have; where one has it not, the place it would be at.
fn shared(
    chairs: &[&Chair],
    part: impl Fn(&Chair) -> Option<Result<Element, ElementError>>,
) -> Option<(Result<Vec<Element>, ElementError>, Note)> {
    let (model, first) = chairs.iter().enumerate().find_map(|(i, c)| Some((i, part(c)?)))?;
    let first = match first {
        Ok(e) => e,
        Err(e) => return Some((Err(e), Note::Found)),
    };
    let mut without = Vec::new();
    let elements = chairs
        .iter()
        .enumerate()
        .map(|(i, c)| {
            part(c).unwrap_or_else(|| {
                without.push(i);
                fit::transplanted(&first, chairs[model], c)
            })
        })
        .collect();
    let note = if without.is_empty() { Note::Found } else { Note::Absent(without) };
    Some((elements, note))
}

/// Whether the bases are of one kind, so that their members can be paired: crossing legs and legs that
/// do not cross, or legs and a column, have nothing in common but that they carry a seat.
fn alike(chairs: &[&Chair]) -> bool {
    let kind = |c: &Chair| std::mem::discriminant(&c.base);
    let crossed = |c: &Chair| matches!(c.base, Base::Crossed(_));
    // where they cross, and how far they lean, differs too much
    chairs.len() == 1 || chairs.iter().all(|c| kind(c) == kind(chairs[0]) && !crossed(c))
}

/// Elements of a part of columns.
fn columns(
    chairs: &[&Chair],
    part: impl Fn(&Chair, &Column) -> Result<Element, ElementError>,
) -> Result<Vec<Element>, ElementError> {
    let of = |c: &&Chair| match &c.base {
        Base::Column(col) => Some(part(c, col)),
        _ => None,
    };
    chairs.iter().filter_map(of).collect()
}

/// The places legs are matched to: those of the chair with four legs, else with most.
fn slots(chairs: &[&Chair]) -> Vec<Slot> {
    let counts = chairs.iter().map(|c| fit::struts(&c.base).len());
    let four = chairs.iter().any(|c| fit::struts(&c.base).len() == 4);
    let count = if four { 4 } else { counts.max().unwrap_or(0) };
    let d = FRAC_1_SQRT_2;
    let slot = |name: &str, x: f64, y: f64| Slot { name: name.to_owned(), to: DVec2::new(x, y) };
    match count {
        // one body carries each
        0 => vec![slot("", 0.0, 1.0)],
        2 => vec![slot("left", -1.0, 0.0), slot("right", 1.0, 0.0)],
        4 => vec![
            slot("front left", -d, -d),
            slot("back left", -d, d),
            slot("back right", d, d),
            slot("front right", d, -d),
        ],
        n => {
            let model = chairs.iter().find(|c| fit::struts(&c.base).len() == n);
            let legs = model.map_or(&[][..], |c| fit::struts(&c.base));
            let to = |l: &Leg| outward(l, chairs[0]);
            legs.iter()
                .enumerate()
                .map(|(i, l)| Slot { name: (i + 1).to_string(), to: to(l) })
                .collect()
        }
    }
}

/// Direction of a leg's foot from the middle of the seat.
fn outward(leg: &Leg, chair: &Chair) -> DVec2 {
    let centre = 0.5 * (chair.seat.low + chair.seat.high);
    let size = (chair.seat.high - chair.seat.low).max(DVec2::ONE);
    ((leg.foot.truncate() - centre) / size).normalize_or_zero()
}

/// The element of a chair that stands for the leg of a slot.
fn strut(c: &Chair, slot: &Slot) -> Result<Element, ElementError> {
    matched(c, slot).map_or_else(|| fit::base(c), |leg| fit::leg(&leg))
}

/// The leg for a slot; one that has to stand for two is cut in halves.
fn matched(c: &Chair, slot: &Slot) -> Option<Leg> {
    let legs = fit::struts(&c.base);
    let near = |l: &&Leg| outward(l, c).dot(slot.to);
    if legs.len() == 4 {
        // by order, not by angle: legs that cross or splay keep their names
        let feet: Vec<DVec2> = legs.iter().map(|l| l.foot.truncate()).collect();
        let order = legs::quadrants(&feet);
        let i = usize::from(slot.to.x > 0.0) + 2 * usize::from(slot.to.y > 0.0);
        if slot.to.x != 0.0 && slot.to.y != 0.0 {
            return order.map(|o| legs[o[i]]);
        }
    }
    let leg = *legs.iter().max_by(|a, b| near(a).total_cmp(&near(b)))?;
    let alone = legs.len() >= 4 || outward(&leg, c).dot(slot.to) > 0.9;
    if alone {
        return Some(leg);
    }
    let shift = DVec3::X * 0.5 * leg.radius * slot.to.x.signum();
    let half = Leg {
        foot: leg.foot + shift,
        head: leg.head + shift,
        radius: 0.5 * leg.radius,
        reach: leg.reach - 0.5 * leg.radius,
    };
    Some(half)
}
