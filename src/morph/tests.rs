use super::*;
use crate::element::{Element, Shape};
use crate::field::Field;
use crate::job::Quiet;
use crate::num::Interval;
use crate::warp::Deform;
use crate::weight::{Ease, Weighting};
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use std::sync::Arc;

/// Exact distance of a box: thin parts, corners, a box-shaped bound.
struct Bar(DVec3, DVec3);

impl Field for Bar {
    fn value(&self, p: DVec3) -> f64 {
        let q = (p - self.0).abs() - self.1;
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }
    fn support(&self) -> Aabb {
        Aabb::around(self.0, self.1)
    }
}

fn bar(centre: [f64; 3], half: [f64; 3]) -> Shared {
    Arc::new(Bar(centre.into(), half.into()))
}

fn block(centre: [f64; 3], half: [f64; 3], turn: f64) -> Element {
    Element {
        shape: Shape::Block,
        centre: centre.into(),
        rotation: DQuat::from_rotation_z(turn),
        half: half.into(),
        deform: Deform::NONE,
    }
}

/// Three tables of one top and one leg, with an element on each part.
pub(super) fn plan(k: usize, inner: Inner, blend: Blend) -> Plan {
    struct Table(Shared, Shared);
    impl Field for Table {
        fn value(&self, p: DVec3) -> f64 {
            self.0.value(p).min(self.1.value(p))
        }
        fn bound(&self, b: &Aabb) -> Interval {
            self.0.bound(b).min(self.1.bound(b))
        }
        fn support(&self) -> Aabb {
            self.0.support().hull(self.1.support())
        }
    }
    let tops = [[0.0, 0.0, 45.0], [5.0, -4.0, 55.0], [-3.0, 0.0, 38.0]];
    let sizes = [[40.0, 30.0, 5.0], [30.0, 35.0, 3.0], [45.0, 25.0, 6.0]];
    let legs = [[-30.0, 0.0, 20.0], [20.0, -10.0, 26.0], [0.0, 10.0, 16.0]];
    let turns = [0.0, 0.3, -0.2];
    let course = |weights: [f64; 3]| match k {
        2 => Course::Pair(Ease::Power(1.0)),
        _ => Course::Fixed(weights.to_vec()),
    };
    let shapes = (0..k)
        .map(|j| {
            let leg = [legs[j][0], legs[j][1], legs[j][2]];
            let field = Arc::new(Table(bar(tops[j], sizes[j]), bar(leg, [4.0, 4.0, leg[2]])));
            Part { name: format!("s{j}"), field }
        })
        .collect();
    let feature = |name: &str, elements: Vec<Element>| Feature {
        name: name.to_owned(),
        elements,
        morph: course([1.0, 2.0, 0.5]),
        deform: course([1.0, 1.0, 1.0]),
        offset: 2.0,
        inner: None,
    };
    Plan {
        scheme: Scheme::Blend,
        shapes,
        features: vec![
            feature("top", (0..k).map(|j| block(tops[j], sizes[j], turns[j])).collect()),
            feature("leg", (0..k).map(|j| block(legs[j], [8.0, 8.0, legs[j][2]], 0.0)).collect()),
        ],
        course: course([1.0, 1.0, 1.0]),
        blend,
        inner,
        weighting: Weighting::Smooth { epsilon: 3.0, power: 2.0 },
        sharp: Weighting::Smooth { epsilon: 1.0, power: 4.0 },
        frames: Frames::Average,
        space_time: SpaceTime::default(),
        cell: 0.0,
        feet: Vec::new(),
    }
}

const INNERS: [Inner; 8] = [
    Inner::Linear,
    Inner::Union,
    Inner::SpaceTime,
    Inner::Grow,
    Inner::Erode,
    Inner::Auto,
    Inner::Mean,
    Inner::Merge,
];

/// Every method on two and on three shapes, with and without features.
fn morphs() -> Vec<(String, Plan)> {
    let mut all = Vec::new();
    for k in [2, 3] {
        for inner in INNERS {
            for blend in [Blend::Maps, Blend::Fields] {
                for form in [Form::L, Form::S, Form::HalfCylinders] {
                    let mut p = plan(k, inner, blend);
                    p.space_time.form = form;
                    if form != Form::L && (inner != Inner::SpaceTime || k == 3 && form != Form::S) {
                        continue;
                    }
                    all.push((format!("{k} {inner:?} {blend:?} {form:?}"), p.clone()));
                    if blend == Blend::Maps {
                        p.features.clear();
                        all.push((format!("{k} {inner:?} {form:?} whole"), p));
                    }
                }
            }
        }
    }
    all.extend(schemes());
    all
}

/// The methods that do not blend.
fn schemes() -> Vec<(String, Plan)> {
    let mut all = Vec::new();
    for k in [2, 3] {
        let anchor = |at: &[[f64; 3]]| Anchor {
            name: "tip".to_owned(),
            at: at[..k].iter().map(|&p| p.into()).collect(),
        };
        let tips = anchor(&[[-34.0, 4.0, 0.0], [24.0, -6.0, 0.0], [4.0, 14.0, 0.0]]);
        for scheme in [
            Scheme::LevelSet { step: 3.0 },
            Scheme::Transport { samples: 16 },
            Scheme::Warp { anchors: vec![tips] },
        ] {
            let mut p = plan(k, Inner::Linear, Blend::Maps);
            p.scheme = scheme;
            match p.scheme {
                Scheme::LevelSet { .. } if k != 2 => continue,
                Scheme::Warp { .. } => {}
                _ => p.features.clear(),
            }
            all.push((format!("{k} {:?}", p.scheme), p));
        }
    }
    all
}

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut x = seed | 1;
    move || {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        (x >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    }
}

#[test]
fn bound_holds_for_every_method() {
    let mut next = random(7);
    for (name, plan) in morphs() {
        let f = build(plan).unwrap().at(0.4, &Quiet).unwrap();
        for _ in 0..120 {
            let c = DVec3::new(next() * 60.0, next() * 50.0, next() * 50.0 + 25.0);
            let half = DVec3::new(next(), next(), next()).abs() * 12.0 * next().abs();
            let b = f.bound(&Aabb::around(c, half));
            for _ in 0..24 {
                let p = c + DVec3::new(next(), next(), next()) * half;
                let v = f.value(p);
                assert!(b.contains(v), "{name}: {v} at {p} not in {b:?}, half {half}");
            }
        }
    }
}

#[test]
fn ends_give_the_inputs_back() {
    let mut next = random(11);
    for (name, mut plan) in morphs() {
        let k = plan.shapes.len();
        // an offset thickens at the ends too, when it is asked for
        plan.features.iter_mut().for_each(|f| f.offset = 0.0);
        for (j, part) in plan.shapes.iter().enumerate() {
            let mut at_end = plan.clone();
            let one = Course::Fixed((0..k).map(|i| f64::from(i == j)).collect());
            at_end.course = one.clone();
            for f in &mut at_end.features {
                (f.morph, f.deform) = (one.clone(), one.clone());
            }
            let f = build(at_end).unwrap().at(0.0, &Quiet).unwrap();
            for _ in 0..200 {
                let p = DVec3::new(next() * 60.0, next() * 50.0, next() * 50.0 + 25.0);
                let (got, want) = (f.value(p), part.field.value(p));
                if name.contains("HalfCylinders") {
                    // the zero set is the input's, the field is not (METHODS B)
                    assert!(
                        (got < 0.0) == (want < 0.0) || want.abs() < 1e-6,
                        "{name} {j}: {got} {want}"
                    );
                } else {
                    assert!((got - want).abs() < 1e-9, "{name} {j}: {got} {want} at {p}");
                }
            }
        }
    }
}

#[test]
fn the_offset_of_a_pair_is_whole_half_way_and_gone_at_the_ends() {
    let p = plan(2, Inner::Linear, Blend::Maps);
    let at = |t| p.features[0].offset_at(t);
    assert_eq!([at(0.0), at(0.5), at(1.0)], [0.0, 2.0, 0.0]);
    let group = plan(3, Inner::Linear, Blend::Maps);
    assert_eq!(group.features[0].offset_at(0.0), 2.0);
}

#[test]
fn pair_is_the_group_of_two() {
    let (mut pair, t) = (plan(2, Inner::Linear, Blend::Maps), 0.3);
    pair.features.iter_mut().for_each(|f| f.offset = 0.0);
    let a = build(pair.clone()).unwrap().at(t, &Quiet).unwrap();
    let fixed = Course::Fixed(vec![7.0, 3.0]);
    pair.course = fixed.clone();
    for f in &mut pair.features {
        (f.morph, f.deform) = (fixed.clone(), fixed.clone());
    }
    let b = build(pair).unwrap().at(0.9, &Quiet).unwrap();
    for i in 0..50 {
        let p = DVec3::new(f64::from(i) - 25.0, f64::from(i * 7 % 31) - 15.0, f64::from(i));
        assert!((a.value(p) - b.value(p)).abs() < 1e-12);
    }
}

#[test]
fn batches_give_what_points_give() {
    let mut next = random(3);
    for (name, plan) in morphs() {
        let f = build(plan).unwrap().at(0.6, &Quiet).unwrap();
        let at: Vec<_> = (0..61).map(|_| DVec3::new(next(), next(), next()) * 50.0).collect();
        let mut out = vec![0.0; at.len()];
        f.values(&at, &mut out);
        for (&p, &v) in at.iter().zip(&out) {
            assert_eq!(v, f.value(p), "{name} at {p}");
        }
        let half = |next: &mut dyn FnMut() -> f64| DVec3::new(next(), next(), next()).abs() * 9.0;
        let boxes: Vec<_> = at[..21].iter().map(|&p| Aabb::around(p, half(&mut next))).collect();
        let mut bounds = vec![Interval::ALL; boxes.len()];
        f.bounds(&boxes, &mut bounds);
        for (b, bound) in boxes.iter().zip(&bounds) {
            assert_eq!(*bound, f.bound(b), "{name} over {b:?}");
        }
    }
}

/// Two balls apart: the plain mean is empty half way, the volume-locked blend is not.
#[test]
fn space_time_keeps_the_volume_where_the_mean_loses_all() {
    struct Ball(DVec3, f64);
    impl Field for Ball {
        fn value(&self, p: DVec3) -> f64 {
            (p - self.0).length() - self.1
        }
        fn bound(&self, b: &Aabb) -> Interval {
            Interval::ball(self.value(b.centre()), b.radius())
        }
        fn support(&self) -> Aabb {
            Aabb::around(self.0, DVec3::splat(self.1))
        }
    }
    let ball =
        |x: f64| Part { name: String::new(), field: Arc::new(Ball(DVec3::new(x, 0.0, 0.0), 10.0)) };
    let mut p = plan(2, Inner::Linear, Blend::Maps);
    (p.shapes, p.features) = (vec![ball(-15.0), ball(15.0)], Vec::new());
    let count = |f: &Shared| {
        let n = 60;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 100.0 - 50.0;
        let mut inside = 0;
        for k in 0..n {
            for j in 0..n {
                for i in 0..n {
                    inside += i32::from(f.value(DVec3::new(at(i), at(j), at(k))) < 0.0);
                }
            }
        }
        f64::from(inside) * (100.0 / f64::from(n)).powi(3)
    };
    let linear = build(p.clone()).unwrap().at(0.5, &Quiet).unwrap();
    assert_eq!(count(&linear), 0.0);
    let want = 4.0 / 3.0 * std::f64::consts::PI * 1000.0;
    p.inner = Inner::SpaceTime;
    // the S form needs heights without bound towards the ends, so it stops short of the volume there
    for (form, times) in [(Form::L, &[0.3, 0.5, 0.8][..]), (Form::S, &[0.5])] {
        p.space_time.form = form;
        for &t in times {
            let f = build(p.clone()).unwrap().at(t, &Quiet).unwrap();
            let share = count(&f) / want;
            assert!((share - 1.0).abs() < 0.1, "{form:?} at {t}: {share}");
        }
    }
}

#[test]
fn bad_plans_are_named() {
    let says = |p: Plan| build(p).err().map(|e| e.to_string()).unwrap_or_default();
    let mut p = plan(2, Inner::Linear, Blend::Maps);
    p.features[1].elements.pop();
    assert_eq!(says(p), "feature `leg` has 1 elements for 2 shapes");
    let mut p = plan(3, Inner::Linear, Blend::Maps);
    p.features[0].morph = Course::Fixed(vec![0.0; 3]);
    assert_eq!(says(p), "top: weights must be 3 numbers, none negative, not all zero");
    let mut p = plan(3, Inner::SpaceTime, Blend::Maps);
    p.space_time.form = Form::HalfCylinders;
    assert!(says(p).contains("takes two shapes, got 3"));
    let mut p = plan(2, Inner::SpaceTime, Blend::Maps);
    p.space_time.a3 = 0.0;
    assert_eq!(says(p), "a3 must be positive, got 0");
}

proptest! {
    /// A shape without any weight leaves no trace (heredity).
    #[test]
    fn a_shape_without_weight_leaves_no_trace(w in (0.1..1.0f64, 0.1..1.0f64), seed in 0..1000u64) {
        let mut next = random(seed);
        for inner in [Inner::Linear, Inner::Grow, Inner::Erode] {
            let mut three = plan(3, inner, Blend::Maps);
            let mut two = plan(2, inner, Blend::Maps);
            three.course = Course::Fixed(vec![w.0, w.1, 0.0]);
            two.course = Course::Fixed(vec![w.0, w.1]);
            for f in &mut three.features {
                (f.morph, f.deform) = (three.course.clone(), three.course.clone());
            }
            for f in &mut two.features {
                (f.morph, f.deform) = (two.course.clone(), two.course.clone());
            }
            let a = build(three).unwrap().at(0.0, &Quiet).unwrap();
            let b = build(two).unwrap().at(0.0, &Quiet).unwrap();
            let p = DVec3::new(next() * 50.0, next() * 50.0, next() * 30.0 + 30.0);
            prop_assert!((a.value(p) - b.value(p)).abs() < 1e-9);
        }
    }
}

#[test]
fn feet_go_where_their_features_go() {
    let mut p = plan(2, Inner::Merge, Blend::Maps);
    // the legs' own: (-30, 0) and (20, -10) in the plan, on the floor
    let foot = |x: f64, y: f64| Foot { at: DVec3::new(x, y, 0.0), reach: 4.0 };
    p.feet = vec![vec![foot(-30.0, 0.0)], vec![foot(20.0, -10.0)]];
    let at = |t: f64| feet(&p, t).unwrap();
    // at either end only that shape's has to stand
    for (t, x, y) in [(0.0, -30.0, 0.0), (1.0, 20.0, -10.0)] {
        let [foot] = at(t)[..] else { panic!("{:?}", at(t)) };
        assert!(foot.at.distance(DVec3::new(x, y, 0.0)) < 1e-9 && (foot.reach - 4.0).abs() < 1e-9);
    }
    // half way both are the leg's
    let half = at(0.5);
    assert_eq!(half.len(), 2);
    for foot in half {
        // lengths are blended by their logarithms, so the leg is 0.4 mm short of the middle one
        assert!(foot.at.distance(DVec3::new(-5.0, -5.0, 0.2)) < 0.01, "{foot:?}");
    }
}
