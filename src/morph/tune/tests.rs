use super::*;
use crate::job::Quiet;
use crate::morph::tests::plan;
use crate::morph::{Blend, build};
use glam::DVec3;

/// Volumes of the tables, counted on the samples of a stage.
fn tuned(k: usize, style: Style) -> (Plan, Tuning) {
    let mut p = plan(k, Inner::Merge, Blend::Maps);
    p.features.iter_mut().for_each(|f| f.offset = 0.0);
    if style == Style::Erode {
        p.inner = Inner::Erode;
    }
    // tops of 40 x 30 x 5 and so on, legs of 4 x 4 (half sizes), mm
    let volumes = [48000.0 + 2560.0, 25200.0 + 3328.0, 54000.0 + 2048.0];
    let t = tune(&p, style, &volumes[..k], &Quiet).unwrap();
    (p, t)
}

fn applied(plan: &Plan, tuning: &Tuning) -> Plan {
    let mut p = plan.clone();
    for (f, c) in p.features.iter_mut().zip(&tuning.choices) {
        (f.inner, f.morph) = (c.inner, c.morph.clone());
    }
    p
}

#[test]
fn the_same_plan_gives_the_same_choice() {
    for style in [Style::Average, Style::Swap, Style::Grow, Style::Erode] {
        for k in [2, 3] {
            let (a, b) = (tuned(k, style).1, tuned(k, style).1);
            assert_eq!(a, b);
            assert_eq!(a.choices.len(), 2);
        }
    }
}

#[test]
fn what_was_tried_is_what_is_made() {
    for style in [Style::Average, Style::Swap, Style::Grow, Style::Erode] {
        let (plan, tuning) = tuned(2, style);
        for seen in &tuning.outlook {
            let made = build(applied(&plan, &tuning)).unwrap().at(seen.t, &Quiet).unwrap();
            let morph = Metamorphosis::new(plan.clone()).unwrap();
            let mut stage = Stage::new(&morph, seen.t, 40.0, &Quiet).unwrap();
            let kins = options::kins(&plan, style, std::slice::from_ref(&stage));
            stage.measure(&kins, &plan, &[1.0, 1.0], &Quiet).unwrap();
            let all = (0..kins[0].options.len())
                .flat_map(|a| (0..kins[1].options.len()).map(move |b| vec![a, b]));
            let same = |c: &Vec<usize>| chosen(&plan, &kins, c) == tuning.choices;
            let candidate = &all.into_iter().find(same).unwrap();
            for (p, v) in stage.field(&kins, candidate) {
                assert!((made.value(p) - v).abs() < 1e-9, "{style:?} {p}: {} {v}", made.value(p));
            }
        }
    }
}

#[test]
fn a_table_between_two_is_one_piece_and_keeps_its_volume() {
    // tops that lie half beside each other, the worst case for a mean
    let (_, tuning) = tuned(2, Style::Average);
    assert_eq!(tuning.outlook.len(), TIMES.len());
    for o in &tuning.outlook {
        assert!(o.largest > 0.99 && (0.8..1.3).contains(&o.volume), "{o:?}");
    }
}

#[test]
fn swapped_parts_change_places_one_after_another() {
    let (_, tuning) = tuned(2, Style::Swap);
    let at = |t: f64| -> Vec<f64> { tuning.choices.iter().map(|c| c.morph.at(t)[1]).collect() };
    assert_eq!((at(0.0), at(1.0)), (vec![0.0; 2], vec![1.0; 2]));
    let half = at(0.5);
    assert!(half.contains(&0.0) && half.contains(&1.0), "{half:?}");
}

#[test]
fn all_weight_on_one_shape_gives_it_back() {
    for style in [Style::Average, Style::Swap, Style::Grow] {
        let mut p = plan(3, Inner::Merge, Blend::Maps);
        let one = Course::Fixed(vec![0.0, 2.0, 0.0]);
        p.course = one.clone();
        for f in &mut p.features {
            (f.morph, f.deform, f.offset) = (one.clone(), one.clone(), 0.0);
        }
        let tuning = tune(&p, style, &[1.0; 3], &Quiet).unwrap();
        let made = build(applied(&p, &tuning)).unwrap().at(0.0, &Quiet).unwrap();
        for i in 0..60 {
            let q = DVec3::new(f64::from(i) - 30.0, f64::from(i * 7 % 31) - 15.0, f64::from(i));
            let want = p.shapes[1].field.value(q);
            assert!((made.value(q) - want).abs() < 1e-9, "{style:?}");
        }
    }
}
