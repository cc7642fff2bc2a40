use super::chair::{Base, Chair};
use super::mask::{Mask, line, quantile};
use super::mirror::Mirror;
use super::stretchers::Side;
use super::volume::Volume;
use super::{Note, Suggestion, feet, suggest};
use crate::element::Element;
use crate::field::Field;
use crate::field::csg::Join;
use crate::field::solid::{Assembly, Part, Solid};
use crate::grid::Lattice;
use crate::job::Quiet;
use crate::num::{Aabb, Interval};
use glam::{DQuat, DVec3};

fn block(low: [f64; 3], high: [f64; 3]) -> Element {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    Element::block(0.5 * (low + high), 0.5 * (high - low), DQuat::IDENTITY).unwrap()
}

fn rod(from: [f64; 3], to: [f64; 3], radius: f64) -> Element {
    Element::rod(from.into(), to.into(), radius).unwrap()
}

/// Board from 420 to 450, 440 wide and 400 deep.
fn board() -> Element {
    block([-220.0, -200.0, 420.0], [220.0, 200.0, 450.0])
}

fn four_legs() -> Vec<Element> {
    let at = [(-190.0, -170.0), (190.0, -170.0), (-190.0, 170.0), (190.0, 170.0)];
    at.map(|(x, y)| rod([x * 1.1, y * 1.1, 0.0], [x, y, 422.0], 20.0)).into()
}

/// Upright, 400 wide, up to 900, at the rear of the board.
fn back() -> Element {
    block([-200.0, 170.0, 448.0], [200.0, 195.0, 900.0])
}

fn arms() -> Vec<Element> {
    let one = |x: f64| {
        [
            block([x - 20.0, -160.0, 640.0], [x + 20.0, 190.0, 665.0]),
            rod([x, -150.0, 440.0], [x, -150.0, 645.0], 14.0),
        ]
    };
    [one(-200.0), one(200.0)].concat()
}

/// The union of some elements, scaled, turned about z by degrees and moved.
fn solid(parts: &[Element], scale: f64, turn_deg: f64, shift: [f64; 3]) -> Assembly {
    let turn = DQuat::from_rotation_z(turn_deg.to_radians());
    let moved = |e: &Element| {
        let centre = turn * (e.centre * scale) + DVec3::from(shift);
        let element =
            Element::new(e.shape.clone(), centre, turn * e.rotation, e.half * scale, e.deform);
        Part { element: element.unwrap(), round: 0.0, join: Join::Add }
    };
    Assembly::new(&parts.iter().map(moved).collect::<Vec<_>>()).unwrap()
}

fn chair() -> Vec<Element> {
    [vec![board(), back()], four_legs()].concat()
}

fn look(field: &dyn Field) -> Suggestion {
    suggest(&[("a", field)], &Quiet).unwrap()
}

fn found(field: &dyn Field) -> Chair {
    look(field).shapes[0].chair.clone().expect("a chair")
}

fn names(s: &Suggestion) -> Vec<&str> {
    s.features.iter().map(|f| f.name.as_str()).collect()
}

/// One sample of the finer grid on a chair 900 mm high.
const STEP: f64 = 10.0;

#[test]
fn a_chair_of_known_size() {
    let c = found(&solid(&chair(), 1.0, 0.0, [0.0; 3]));
    assert!((c.seat.top - 450.0).abs() < STEP, "{:?}", c.seat);
    assert!((c.seat.thickness - 30.0).abs() < STEP, "{:?}", c.seat);
    assert!((c.seat.high.x - 220.0).abs() < STEP, "{:?}", c.seat);
    let Base::Legs(legs) = &c.base else { panic!("{:?}", c.base) };
    assert_eq!(legs.len(), 4);
    for (leg, to) in legs.iter().zip([[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]) {
        let foot = DVec3::new(209.0 * to[0], 187.0 * to[1], 0.0);
        assert!(leg.foot.distance(foot) < STEP, "{leg:?}, expected {foot}");
        assert!((leg.radius - 20.0).abs() < 0.5 * STEP, "{leg:?}");
    }
    let b = c.back.expect("a back");
    assert!((b.at + b.slope * 700.0 - 182.5).abs() < STEP && (b.top - 900.0).abs() < STEP, "{b:?}");
    assert_eq!(c.arms, [None, None]);
    assert!(c.stretchers.is_empty() && c.confidence() > 0.9, "{c:?}");
}

/// Turned, moved and seen from anywhere, the same chair has the same parts in its pose.
#[test]
fn the_pose_undoes_turns_and_shifts() {
    let parts = [chair(), arms()].concat();
    for (turn, shift) in
        [(90.0, [0.0; 3]), (180.0, [4000.0, -70.0, 900.0]), (37.0, [5.0, 6.0, -800.0])]
    {
        let s = look(&solid(&parts, 1.0, turn, shift));
        let guess = &s.shapes[0];
        let c = guess.chair.as_ref().expect("a chair");
        assert!((c.seat.top - 450.0).abs() < STEP, "{turn}: {:?}", c.seat);
        assert!(matches!(&c.base, Base::Legs(l) if l.len() == 4), "{turn}: {:?}", c.base);
        assert!(c.arms.iter().all(Option::is_some), "{turn}: {:?}", c.arms);
        // the rear right foot is again the rear right foot
        let there = DQuat::from_rotation_z(turn.to_radians()) * DVec3::new(209.0, 187.0, 0.0);
        let back = guess.pose.point(there + DVec3::from(shift));
        // y is told by the box's middle, which here is that of the feet
        assert!(back.distance(DVec3::new(209.0, 187.0, 0.0)) < 1.5 * STEP, "{turn}: {back}");
    }
}

#[test]
fn other_scales_are_brought_to_a_seat_height() {
    let small = solid(&chair(), 0.01, 0.0, [0.0; 3]);
    let s = look(&small);
    let c = s.shapes[0].chair.as_ref().unwrap();
    assert!((c.seat.top - 450.0).abs() < 0.1, "{:?}", c.seat);
    assert!((s.shapes[0].pose.scale - 100.0).abs() < 5.0, "{:?}", s.shapes[0].pose);
    let normal = solid(&chair(), 1.0, 0.0, [0.0; 3]);
    let s = suggest(&[("small", &small), ("normal", &normal)], &Quiet).unwrap();
    assert_eq!(s.shapes[1].pose.scale, 1.0);
    let tops = s.shapes.iter().map(|g| g.chair.as_ref().unwrap().seat.top);
    assert!(tops.clone().all(|t| (t - 450.0).abs() < STEP));
}

#[test]
fn pairs_have_the_same_features() {
    let plain = solid(&chair(), 1.0, 0.0, [0.0; 3]);
    let armed = solid(&[chair(), arms()].concat(), 1.0, 180.0, [0.0; 3]);
    let s = suggest(&[("plain", &plain), ("armed", &armed)], &Quiet).unwrap();
    let legs = ["leg front left", "leg back left", "leg back right", "leg front right"];
    assert_eq!(names(&s), [&["seat", "back", "arm left", "arm right"], &legs[..]].concat());
    assert!(s.features.iter().all(|f| f.elements.len() == 2));
    let arm = &s.features[2];
    assert_eq!(arm.note, Note::Absent(vec![0]));
    // where the arm would be: at the same place, the chairs being alike
    assert!(arm.elements[0].centre.distance(arm.elements[1].centre) < STEP, "{arm:?}");
    assert!(arm.elements[0].centre.x < 0.0, "left is -x");
}

#[test]
fn stretchers_are_told_by_side() {
    let bars = vec![
        rod([-195.0, -175.0, 150.0], [195.0, -175.0, 150.0], 11.0),
        rod([-195.0, -175.0, 220.0], [-195.0, 175.0, 220.0], 11.0),
        rod([195.0, -175.0, 220.0], [195.0, 175.0, 220.0], 11.0),
    ];
    let c = found(&solid(&[chair(), bars].concat(), 1.0, 0.0, [0.0; 3]));
    let sides: Vec<Side> = c.stretchers.iter().map(|s| s.side).collect();
    assert_eq!(sides, [Side::Front, Side::Left, Side::Right]);
    assert!((c.stretchers[0].from.z - 150.0).abs() < STEP, "{:?}", c.stretchers);
}

#[test]
fn columns_and_their_spokes() {
    let mut tulip = vec![board(), back(), rod([0.0, 0.0, 20.0], [0.0, 0.0, 421.0], 30.0)];
    tulip.push(rod([0.0, 0.0, 0.0], [0.0, 0.0, 25.0], 200.0));
    let tulip = solid(&tulip, 1.0, 0.0, [0.0; 3]);
    let c = found(&tulip);
    assert!(matches!(&c.base, Base::Column(c) if c.spokes.is_empty()), "{:?}", c.base);
    assert_eq!(names(&look(&tulip)), ["seat", "back", "column", "foot"]);
    let four = solid(&chair(), 1.0, 0.0, [0.0; 3]);
    let s = suggest(&[("tulip", &tulip), ("four", &four)], &Quiet).unwrap();
    assert_eq!(names(&s), ["seat", "back", "base"]);
    assert_eq!(s.features[2].note, Note::Whole);
    // the disc reaches 200 mm; the feet stand 209 and 187 mm off the middle and are 40 mm thick
    let half: Vec<DVec3> = s.features[2].elements.iter().map(|e| e.half).collect();
    assert!((half[0].x - 200.0).abs() < STEP, "{half:?}");
    assert!((half[1].x - 229.0).abs() < STEP && (half[1].y - 207.0).abs() < STEP, "{half:?}");
    let star: Vec<Element> = (0..5)
        .map(|i| {
            let a = f64::from(i) * std::f64::consts::TAU / 5.0 + 0.3;
            rod([0.0, 0.0, 40.0], [290.0 * a.cos(), 290.0 * a.sin(), 30.0], 28.0)
        })
        .collect();
    let column = vec![board(), back(), rod([0.0, 0.0, 20.0], [0.0, 0.0, 421.0], 30.0)];
    let c = found(&solid(&[column, star].concat(), 1.0, 0.0, [0.0; 3]));
    assert!(matches!(&c.base, Base::Column(c) if c.spokes.len() == 5), "{:?}", c.base);
}

#[test]
fn stools_and_three_legs() {
    let legs = [(-150.0, -120.0), (150.0, -120.0), (0.0, 160.0)];
    let three = legs.map(|(x, y)| rod([x * 1.2, y * 1.2, 0.0], [x, y, 430.0], 18.0));
    let c = found(&solid(&[vec![board()], three.to_vec()].concat(), 1.0, 0.0, [0.0; 3]));
    assert!(matches!(&c.base, Base::Legs(l) if l.len() == 3), "{:?}", c.base);
    assert!(c.back.is_none());
    let s = suggest(
        &[
            ("three", &solid(&[vec![board()], three.to_vec()].concat(), 1.0, 0.0, [0.0; 3])),
            ("four", &solid(&chair(), 1.0, 0.0, [0.0; 3])),
        ],
        &Quiet,
    )
    .unwrap();
    assert_eq!(s.features.len(), 6);
    assert_eq!(s.features[1].note, Note::Absent(vec![0]));
}

/// A field without a bounded support.
struct Endless;

impl Field for Endless {
    fn value(&self, p: DVec3) -> f64 {
        p.z.sin()
    }
    fn bound(&self, _: &Aabb) -> Interval {
        Interval::ALL
    }
    fn support(&self) -> Aabb {
        Aabb::ALL
    }
}

/// A field that promises a box and has nothing in it.
struct Nothing;

impl Field for Nothing {
    fn value(&self, _: DVec3) -> f64 {
        1e6
    }
    fn bound(&self, _: &Aabb) -> Interval {
        Interval::point(1e6)
    }
    fn support(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::ONE)
    }
}

#[test]
fn what_is_no_chair_is_said_to_be_none() {
    let ball =
        solid(&[Element::capsule(DVec3::ZERO, DVec3::Z, 200.0).unwrap()], 1.0, 0.0, [0.0; 3]);
    let plate = solid(&[block([-300.0, -200.0, 0.0], [300.0, 200.0, 4.0])], 1.0, 0.0, [0.0; 3]);
    let pole = solid(&[rod([0.0; 3], [0.0, 0.0, 900.0], 5.0)], 1.0, 0.0, [0.0; 3]);
    for f in [&ball, &plate, &pole] {
        let s = look(f);
        assert!(!s.features.is_empty(), "{:?}", s.shapes);
        assert!(s.features.iter().all(|f| f.elements.len() == 1));
    }
    for f in [&Endless as &dyn Field, &Nothing] {
        let s = look(f);
        assert_eq!((s.features.len(), s.shapes[0].confidence), (0, 0.0));
    }
    let four = solid(&chair(), 1.0, 0.0, [0.0; 3]);
    let s = suggest(&[("plate", &plate), ("four", &four)], &Quiet).unwrap();
    assert!(s.features.iter().all(|f| f.elements.len() == 2 && f.confidence < 0.5));
    assert!(suggest(&[], &Quiet).unwrap().features.is_empty());
}

#[test]
fn masks_close_fill_and_split() {
    let mut ring = Mask::empty(9, 9);
    for i in 2..7 {
        for [x, y] in [[i, 2], [i, 6], [2, i], [6, i]] {
            ring.set(x, y);
        }
    }
    assert_eq!(ring.count(), 16);
    assert_eq!(ring.filled().count(), 25);
    let regions = ring.regions();
    assert_eq!((regions.len(), regions[0].centre()), (1, glam::DVec2::splat(4.0)));
    let mut two = Mask::empty(9, 9);
    for y in 3..6 {
        two.set(2, y);
        two.set(4, y);
    }
    assert_eq!((two.regions().len(), two.closed(1.0).regions().len()), (2, 1));
}

#[test]
fn lines_withstand_outliers() {
    let mut points: Vec<(f64, f64)> =
        (0..20).map(|i| (f64::from(i), 3.0 + 0.5 * f64::from(i))).collect();
    points[4].1 = 90.0;
    let (a, b) = line(&points);
    assert!((a - 3.0).abs() < 0.1 && (b - 0.5).abs() < 0.01, "{a} {b}");
    assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.75), 2.5);
}

/// A box of 10 x 4 plan samples off the middle mirrors across its own middle planes only.
#[test]
fn mirrors_are_found_off_the_middle() {
    let lattice = Lattice { origin: DVec3::ZERO, step: 1.0, size: [40, 40, 30] };
    let turn = DQuat::from_rotation_z(0.3);
    let own = Solid::new(
        &Element::block(DVec3::new(21.0, 17.0, 14.0), DVec3::new(12.0, 5.0, 9.0), turn).unwrap(),
        0.0,
    );
    let v = Volume::of(lattice, |p| own.value(p) < 0.0);
    let mirror = Mirror::new(&v, 29).unwrap();
    let [a, b] = mirror.best();
    let quarter = std::f64::consts::FRAC_PI_2;
    let off = |yaw: f64| ((yaw - 0.3) / quarter - ((yaw - 0.3) / quarter).round()).abs() * quarter;
    assert!(a.score > 0.95 && b.score > 0.95, "{a:?} {b:?}");
    assert!(off(a.yaw) < 0.06 && off(b.yaw) < 0.06, "{a:?} {b:?}");
    assert!((a.yaw - b.yaw).abs() > 1.0);
}

#[test]
fn feet_are_where_the_floor_is_touched() {
    let four = solid(&chair(), 1.0, 0.0, [0.0, 0.0, 30.0]);
    let found = feet(&four, &Quiet).unwrap();
    assert_eq!(found.len(), 4);
    for f in &found {
        assert!(
            (f.at.x.abs() - 209.0).abs() < STEP && (f.at.y.abs() - 187.0).abs() < STEP,
            "{f:?}"
        );
        // legs that lean stand on an edge
        assert!((f.at.z - 30.0).abs() < 2.0 && (f.reach - 20.0).abs() < 2.0 * STEP, "{f:?}");
    }
    let disc = solid(&[rod([0.0; 3], [0.0, 0.0, 25.0], 200.0)], 1.0, 0.0, [0.0; 3]);
    assert_eq!(feet(&disc, &Quiet).unwrap().len(), 1);
    for f in [&Endless as &dyn Field, &Nothing] {
        assert!(feet(f, &Quiet).unwrap().is_empty());
    }
}
