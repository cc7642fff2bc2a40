mod shapes;

use super::{MeshField, MeshFieldError, MeshOptions, MeshReport, Sign, Thicken, Which};
use crate::field::Field;
use crate::job::{Cancelled, Job, Quiet};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use shapes::*;

fn field(mesh: &TriMesh) -> (MeshField, MeshReport) {
    MeshField::new(mesh, &MeshOptions::default(), &Quiet).unwrap()
}

fn thickened(mm: f64, which: Which) -> MeshOptions {
    MeshOptions { thicken: Some(Thicken { mm, which }), ..Default::default() }
}

/// Evenly spread points of a box, the same every time.
fn spread(half: f64, n: u32) -> Vec<DVec3> {
    // additive recurrence by the plastic number
    let step = dvec3(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);
    (1..=n).map(|i| ((step * f64::from(i)).fract() * 2.0 - 1.0) * half).collect()
}

fn v(x: f64) -> DVec3 {
    DVec3::splat(x)
}

/// The closed, the open and the dirty ones that bounds and batches are tried on.
fn zoo() -> Vec<(MeshField, f64)> {
    let dirty = dirty();
    let open = open_block(v(-10.0), v(10.0));
    vec![
        (field(&ball(10.0, 0.2, 3)).0, 14.0),
        (field(&open).0, 14.0),
        (field(&dirty).0, 45.0),
        (MeshField::new(&dirty, &thickened(2.0, Which::Open), &Quiet).unwrap().0, 45.0),
        (MeshField::new(&dirty, &thickened(1.0, Which::All), &Quiet).unwrap().0, 45.0),
        (field(&together(&[open_block(v(-9.0), v(3.0)), block(v(-3.0), v(10.0))])).0, 14.0),
    ]
}

#[test]
fn a_box_has_its_exact_distance() {
    let (min, max) = (dvec3(-3.0, -2.0, -1.0), dvec3(4.0, 5.0, 6.0));
    let (f, report) = field(&block(min, max));
    for p in spread(9.0, 2000) {
        assert!((f.value(p) - block_distance(min, max, p)).abs() < 1e-12);
    }
    assert_eq!((report.shells, report.open_shells, report.contact_faces), (1, 0, 0));
    assert_eq!(report.summary(), Vec::<String>::new());
    assert_eq!(f.support(), Aabb::new(min, max));
}

#[test]
fn balls_and_tori_are_within_their_facets() {
    // the sagitta of a side of length s on a radius r is s² / 8r
    let (ball, torus) = (field(&ball(10.0, 0.0, 5)).0, field(&torus(10.0, 4.0, 90)).0);
    for p in spread(16.0, 1000) {
        assert!((ball.value(p) - (p.length() - 10.0)).abs() < 0.02);
        let ring = p.truncate().length() - 10.0;
        assert!((torus.value(p) - (ring.hypot(p.z) - 4.0)).abs() < 0.025);
    }
}

#[test]
fn a_bar_of_two_boxes_is_as_deep_as_the_bar() {
    let two = together(&[
        block(v(0.0), dvec3(60.0, 10.0, 10.0)),
        block(dvec3(40.0, 0.0, 0.0), dvec3(100.0, 10.0, 10.0)),
    ]);
    let (f, report) = field(&two);
    // the ends inside, and the faces of both where they coincide
    assert!(report.buried_area_share > 0.02 && report.lost_area_share == 0.0);
    for p in spread(1.0, 3000) {
        let p = dvec3(50.0, 5.0, 5.0) + p * dvec3(60.0, 9.0, 9.0);
        let bar = block_distance(v(0.0), dvec3(100.0, 10.0, 10.0), p);
        assert!((f.value(p) - bar).abs() < 0.01, "{p}: {} {bar}", f.value(p));
    }
    assert!((f.value(dvec3(60.0, 5.0, 5.0)) + 5.0).abs() < 1e-9);
}

#[test]
fn crossing_boxes_are_cut_at_their_meeting_lines() {
    // a cross of two bars: at its centre the nearest surface is where the bars meet
    let (f, _) = field(&together(&[
        block(dvec3(-50.0, -5.0, -5.0), dvec3(50.0, 5.0, 5.0)),
        block(dvec3(-5.0, -50.0, -6.0), dvec3(5.0, 50.0, 6.0)),
    ]));
    assert!((f.value(v(0.0)) + 6.0).abs() < 0.01);
    assert!((f.value(dvec3(0.0, 0.0, 5.0)) + 1.0).abs() < 0.01);
    assert!((f.value(dvec3(20.0, 0.0, 0.0)) + 5.0).abs() < 0.01);
    // inside, off the axis, the nearest is the inner edge (5, 5, z)
    assert!((f.value(dvec3(4.0, 4.0, 0.0)) + 2f64.sqrt()).abs() < 0.01);
}

#[test]
fn a_leg_flush_under_a_seat_leaves_no_gap() {
    let (f, report) = field(&together(&[
        block(dvec3(-20.0, -20.0, 0.0), dvec3(20.0, 20.0, 10.0)),
        block(dvec3(-5.0, -5.0, -40.0), dvec3(5.0, 5.0, 0.0)),
    ]));
    assert!(report.buried_area_share > 0.0);
    assert!((f.value(v(0.0)) + 5.0).abs() < 0.01);
    assert!((f.value(dvec3(0.0, 0.0, -20.0)) + 5.0).abs() < 0.01);
    assert!((f.value(dvec3(7.0, 0.0, -1.0)) - 1.0).abs() < 0.01);
    assert!((f.value(dvec3(2.0, 0.0, 1.0)) + 10f64.sqrt()).abs() < 0.01);
}

#[test]
fn meeting_lines_inside_a_third_shell_leave_no_dent() {
    let (f, _) = field(&together(&[
        block(v(-10.0), v(10.0)),
        block(dvec3(-4.0, -4.0, -20.0), dvec3(4.0, 4.0, 3.0)),
        block(dvec3(-3.0, -3.0, -3.0), dvec3(20.0, 5.0, 6.0)),
        ball(5.0, 0.0, 3),
    ]));
    for p in spread(5.0, 3000) {
        assert!(f.value(p) <= -3.9, "{p}: {}", f.value(p));
    }
}

#[test]
fn a_cavity_stays_and_a_solid_in_a_solid_goes() {
    let outer = block(v(-10.0), v(10.0));
    let inner = block(v(-4.0), v(4.0));
    let hollow = together(&[outer.clone(), flipped(inner.clone())]);
    for mesh in [hollow.clone(), flipped(hollow)] {
        let (f, _) = field(&mesh);
        assert!((f.value(v(0.0)) - 4.0).abs() < 1e-12);
        assert!((f.value(dvec3(6.0, 0.0, 0.0)) + 2.0).abs() < 1e-12);
        assert!((f.value(dvec3(12.0, 0.0, 0.0)) - 2.0).abs() < 1e-12);
    }
    let (f, report) = field(&together(&[outer, inner]));
    assert!((f.value(v(0.0)) + 10.0).abs() < 1e-12);
    assert_eq!(report.buried_faces, 12);
}

#[test]
fn a_solid_in_a_cavity_stays() {
    let (f, _) = field(&together(&[
        block(v(-10.0), v(10.0)),
        flipped(block(v(-6.0), v(6.0))),
        block(v(-2.0), v(2.0)),
    ]));
    for (x, d) in [(0.0, -2.0), (4.0, 2.0), (8.0, -2.0), (13.0, 3.0)] {
        assert!((f.value(dvec3(x, 0.0, 0.0)) - d).abs() < 1e-12);
    }
}

#[test]
fn shells_that_are_inside_out_are_turned_one_by_one() {
    let (a, b) = (block(v(-10.0), v(-2.0)), block(v(2.0), v(10.0)));
    let right = field(&together(&[a.clone(), b.clone()])).0;
    for (mesh, turned) in
        [(together(&[a.clone(), flipped(b.clone())]), 1), (together(&[flipped(a), flipped(b)]), 2)]
    {
        let (f, report) = field(&mesh);
        assert_eq!(report.flipped_shells, turned);
        for p in spread(14.0, 200) {
            assert_eq!(f.value(p), right.value(p));
        }
    }
}

#[test]
fn turned_faces_are_turned_back() {
    let clean = ball(10.0, 0.1, 3);
    let mut mixed = clean.clone();
    for f in mixed.faces.iter_mut().step_by(3) {
        f.swap(1, 2);
    }
    let (right, (f, report)) = (field(&clean).0, field(&mixed));
    assert_eq!(report.flipped_faces, clean.faces.len().div_ceil(3));
    for p in spread(13.0, 500) {
        assert!((f.value(p) - right.value(p)).abs() < 1e-12);
    }
}

#[test]
fn a_mesh_given_in_both_directions_is_the_solid() {
    let cube = block(v(-5.0), v(5.0));
    let (f, report) = field(&together(&[cube.clone(), flipped(cube)]));
    assert!((f.value(v(0.0)) + 5.0).abs() < 1e-12);
    assert_eq!((report.duplicate_faces, report.double_area_share), (12, 0.0));
}

#[test]
fn sides_that_meet_in_different_corners_close_the_shell() {
    // one side of the box split at the middles of its edges: corners without a partner
    let mut mesh = block(v(0.0), v(8.0));
    mesh.faces.truncate(10);
    let k = mesh.points.len() as u32;
    let at = |y: f64, z: f64| dvec3(8.0, y, z);
    mesh.points.extend([
        at(0.0, 0.0),
        at(8.0, 0.0),
        at(8.0, 8.0),
        at(0.0, 8.0),
        at(4.0, 0.0),
        at(4.0, 8.0),
    ]);
    mesh.faces
        .extend([[0, 4, 5], [0, 5, 3], [4, 1, 2], [4, 2, 5]].map(|f: [u32; 3]| f.map(|i| i + k)));
    let (f, report) = field(&mesh);
    assert_eq!((report.shells, report.open_shells), (1, 0));
    assert!((f.value(v(4.0)) + 4.0).abs() < 1e-9);
}

#[test]
fn a_box_without_its_lid_is_still_full() {
    let (f, report) = field(&open_block(v(-10.0), v(10.0)));
    assert_eq!((report.open_shells, report.rim_length.round()), (1, 80.0));
    // the winding number falls to one half at the plane of the missing side
    for (z, inside) in [(-9.0, true), (0.0, true), (9.5, true), (10.5, false), (-10.5, false)] {
        assert_eq!(f.value(dvec3(0.0, 0.0, z)) < 0.0, inside, "z = {z}");
    }
    assert!((f.value(dvec3(0.0, 0.0, -7.0)) + 3.0).abs() < 1e-12);
    let (f, report) = field(&flipped(open_block(v(-10.0), v(10.0))));
    assert!(f.value(v(0.0)) < 0.0 && report.flipped_shells == 1);
}

#[test]
fn sheets_need_a_thickness() {
    let flat = sheet(10.0, 0.0);
    let double = together(&[flat.clone(), flipped(flat.clone())]);
    for mesh in [&flat, &double] {
        let error = MeshField::new(mesh, &MeshOptions::default(), &Quiet).unwrap_err();
        assert!(matches!(error, MeshFieldError::NoInside { .. }), "{error}");
        assert!(error.to_string().contains("thicken"));
        let (f, report) = MeshField::new(mesh, &thickened(4.0, Which::Open), &Quiet).unwrap();
        for (p, d) in [(v(0.0), -2.0), (dvec3(0.0, 0.0, 5.0), 3.0), (dvec3(14.0, 0.0, 3.0), 3.0)] {
            assert!((f.value(p) - d).abs() < 1e-12);
        }
        assert_eq!((report.thickened_faces, report.solid), (2, false));
        assert_eq!(f.support(), flat.bounds().grow(2.0));
    }
    assert_eq!(
        MeshField::new(&double, &thickened(1.0, Which::Open), &Quiet).unwrap().1.double_area_share,
        1.0
    );
}

#[test]
fn thickening_leaves_closed_shells_alone_unless_told() {
    let mesh = together(&[block(v(-5.0), v(5.0)), sheet(3.0, 20.0)]);
    let open = MeshField::new(&mesh, &thickened(2.0, Which::Open), &Quiet).unwrap().0;
    let all = MeshField::new(&mesh, &thickened(2.0, Which::All), &Quiet).unwrap().0;
    assert!((open.value(dvec3(0.0, 0.0, 8.0)) - 3.0).abs() < 1e-12);
    assert!((all.value(dvec3(0.0, 0.0, 8.0)) - 2.0).abs() < 1e-12);
    assert!((open.value(dvec3(0.0, 0.0, 20.0)) + 1.0).abs() < 1e-12);
    assert!((all.value(v(0.0)) + 5.0).abs() < 1e-12);
}

#[test]
fn without_a_sign_everything_is_a_sheet() {
    let mesh = block(v(-5.0), v(5.0));
    let unsigned = MeshOptions { sign: Sign::Unsigned, ..Default::default() };
    assert_eq!(MeshField::new(&mesh, &unsigned, &Quiet).unwrap_err(), MeshFieldError::Unsigned);
    let options = MeshOptions { sign: Sign::Unsigned, ..thickened(2.0, Which::Open) };
    let (f, _) = MeshField::new(&mesh, &options, &Quiet).unwrap();
    assert!((f.value(v(0.0)) - 4.0).abs() < 1e-12);
    assert!((f.value(dvec3(5.0, 0.0, 0.0)) + 1.0).abs() < 1e-12);
}

#[test]
fn wrong_input_is_an_error_that_names_the_place() {
    let new = |mesh: &TriMesh| MeshField::new(mesh, &MeshOptions::default(), &Quiet).unwrap_err();
    assert_eq!(new(&TriMesh::default()), MeshFieldError::Empty { faces: 0 });
    let mut mesh = block(v(0.0), v(1.0));
    mesh.faces[7][1] = 99;
    assert_eq!(new(&mesh), MeshFieldError::Corner { face: 7, corner: 99, points: 8 });
    mesh = block(v(0.0), v(1.0));
    mesh.points[3].y = f64::NAN;
    assert!(matches!(new(&mesh), MeshFieldError::Coordinate { corner: 3, .. }));
    let flat = TriMesh { points: vec![v(0.0), v(1.0), v(2.0)], faces: vec![[0, 1, 2], [0, 0, 1]] };
    assert_eq!(new(&flat), MeshFieldError::Empty { faces: 2 });
    let wrong = MeshField::new(&mesh, &thickened(-1.0, Which::All), &Quiet).unwrap_err();
    assert_eq!(wrong, MeshFieldError::Thickness(-1.0));
}

#[test]
fn a_cancelled_job_stops() {
    struct Stop;
    impl Job for Stop {
        fn cancelled(&self) -> bool {
            true
        }
    }
    let stopped = MeshField::new(&block(v(0.0), v(1.0)), &MeshOptions::default(), &Stop);
    assert_eq!(stopped.unwrap_err(), MeshFieldError::Cancelled(Cancelled));
}

#[test]
fn an_open_sheet_does_not_hollow_a_solid() {
    let solid = block(v(-10.0), v(10.0));
    for part in [sheet(9.0, 0.0), flipped(sheet(9.0, 0.0)), sheet(40.0, 0.0)] {
        let (f, _) = field(&together(&[solid.clone(), part]));
        for p in spread(9.0, 300) {
            let depth = 10.0 - p.abs().max_element();
            assert!((f.value(p) + depth).abs() < 0.02, "{p}: {} {depth}", f.value(p));
        }
    }
}

#[test]
fn the_same_field_on_any_number_of_threads() {
    let values = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (f, report) = pool.install(|| field(&dirty()));
        let bits: Vec<u64> = spread(40.0, 500).iter().map(|&p| f.value(p).to_bits()).collect();
        (bits, report)
    };
    assert_eq!(values(1), values(2));
}

#[test]
fn triangles_strewn_at_random_take_no_forever() {
    let at = spread(10.0, 1500);
    let soup =
        TriMesh { points: at, faces: (0..500).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() };
    let (f, report) = MeshField::new(&soup, &thickened(0.5, Which::Open), &Quiet).unwrap();
    assert_eq!(report.shells, 500);
    for i in (0..500).filter(|&i| soup.area_vector(i).length() > 1.0) {
        let [a, b, c] = soup.corners(i);
        assert!(f.value((a + b + c) / 3.0) <= -0.25 + 1e-9);
    }
}

#[test]
fn the_dirty_one_is_told_as_it_is() {
    let (_, report) = field(&dirty());
    assert_eq!(report.degenerate_faces, 1);
    assert_eq!(report.duplicate_faces, 3);
    assert_eq!((report.shells, report.open_shells), (7, 2));
    assert_eq!((report.flipped_shells, report.flipped_faces), (1, 1));
    assert!(report.buried_area_share > 0.1 && report.lost_area_share > 0.02);
    assert!(report.summary().len() >= 5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn batches_agree_with_single_values(seed in 0u32..1000, step in 0.02..0.5) {
        for (f, half) in zoo() {
            let corner = spread(half, 1000)[seed as usize];
            let bit = |i: u32, a: u32| (0..4).map(|b| (i >> (3 * b + a) & 1) << b).sum::<u32>();
            // two cubes of 512 side by side: what is known of the one goes on in the other
            let cube = (0..1024).map(|i| corner + step * DVec3::from([0, 1, 2].map(|a| f64::from(bit(i, a)))));
            let at: Vec<DVec3> = cube.chain(spread(half, 200)).collect();
            let mut out = vec![0.0; at.len()];
            f.values(&at, &mut out);
            for (&p, &value) in at.iter().zip(&out) {
                prop_assert_eq!(value, f.value(p), "at {}", p);
            }
        }
    }

    #[test]
    fn bounds_hold(seed in 0u32..1000, size in 0.1..30.0f64) {
        for (f, half) in zoo() {
            let centre = spread(half, 1000)[seed as usize];
            let b = Aabb::around(centre, dvec3(size, size * 0.6, size * 0.8));
            let bound = f.bound(&b);
            for p in spread(1.0, 300) {
                let p = b.centre() + p * b.size() * 0.5;
                let value = f.value(p);
                prop_assert!(bound.contains(value), "{value} at {p} not in {bound:?}");
                prop_assert!(value > 0.0 || f.support().contains(p));
            }
        }
    }

    #[test]
    fn closed_fields_change_no_faster_than_the_way(seed in 0u32..1000, turn in 0.0..3.0f64) {
        let mut mesh = together(&[block(v(-8.0), v(5.0)), block(v(-3.0), v(9.0)), ball(7.0, 0.1, 3)]);
        mesh.transform(&glam::DAffine3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize(), turn));
        let (f, _) = field(&mesh);
        let at: Vec<DVec3> = spread(14.0, 1400).split_off(seed as usize);
        for pair in at.windows(2) {
            let (p, q) = (pair[0], p_near(pair));
            prop_assert!((f.value(p) - f.value(q)).abs() <= p.distance(q) + 1e-2);
        }
    }
}

/// A point near the first of two, towards the second.
fn p_near(pair: &[DVec3]) -> DVec3 {
    pair[0] + (pair[1] - pair[0]) * 0.1
}
