//! Distances, walls and stances of shapes where the answer is known.

use super::distance::apart;
use super::tests::{block, sphere, torus};
use super::*;
use crate::job::Quiet;
use glam::{DAffine3, DQuat, dvec3};

fn scaled(mut mesh: TriMesh, by: f64, at: DVec3) -> TriMesh {
    mesh.points.iter_mut().for_each(|p| *p = *p * by + at);
    mesh
}

fn wall(mesh: TriMesh) -> Option<f64> {
    thinnest_wall(&Shell::new(mesh), &Quiet).unwrap()
}

fn between(a: TriMesh, b: TriMesh) -> distance::Apart {
    apart(&Shell::new(a), &Shell::new(b), &Quiet).unwrap()
}

/// What a sphere of unit radius loses between the vertices of `sphere(5)`: edges of about 1/20.
const SAGITTA: f64 = 1e-3;

#[test]
fn spheres_are_as_far_apart_as_their_radii_and_centres() {
    let ball = |r: f64, x: f64| scaled(sphere(5), r, dvec3(x, 0.0, 0.0));
    for (other, hausdorff, mean) in [
        (ball(1.25, 0.0), 0.25, 0.25),
        // the mean of |(distance of a point from the other's centre) - r| over a sphere moved by
        // 0.5 is 0.25 + 0.5²/6 outwards and the like inwards: about half the shift
        (ball(1.0, 0.5), 0.5, 0.25),
        (ball(1.0, 0.0), 0.0, 0.0),
    ] {
        let d = between(ball(1.0, 0.0), other);
        assert!((d.hausdorff - hausdorff).abs() < SAGITTA, "{d:?}");
        assert!(d.over < 0.01, "{d:?}");
        assert!((d.mean - mean).abs() < 0.02, "{d:?}");
    }
    let (near, far) = (ball(1.0, 0.0), ball(1.0, 10.0));
    // from the far side of one to the near side of the other
    assert!((between(near, far).hausdorff - 10.0).abs() < SAGITTA);
}

#[test]
fn the_farthest_point_may_lie_within_a_face_or_at_a_corner() {
    let (small, large) = (block([-1.0; 3], [1.0; 3]), block([-2.0; 3], [2.0; 3]));
    let (a, b) = (Shell::new(small), Shell::new(large));
    assert!((a.to(&b, &Quiet).unwrap().0.max - 1.0).abs() < 1e-12);
    assert!((b.to(&a, &Quiet).unwrap().0.max - 3f64.sqrt()).abs() < 1e-12);
    // a box against itself with a pyramid of depth 3 cut into the top of half width 4: no vertex of
    // the box is far, its top's middle is 3 cos(atan(3/4)) = 2.4 away
    let plain = block([-4.0, -4.0, -9.0], [4.0, 4.0, 0.0]);
    let mut dented = plain.clone();
    dented.faces.retain(|f| f.iter().any(|&v| plain.points[v as usize].z < -1.0));
    let peak = dented.points.len() as u32;
    dented.points.push(dvec3(0.0, 0.0, -3.0));
    dented.faces.extend([[4, 5, peak], [5, 7, peak], [7, 6, peak], [6, 4, peak]]);
    assert!(inspect(&dented, &Options::default()).printable);
    let (way, _) = Shell::new(plain).to(&Shell::new(dented), &Quiet).unwrap();
    assert!(way.max <= 2.4 + 1e-12 && way.max + way.over >= 2.4, "{way:?}");
    assert!(way.over < 0.01, "{way:?}");
}

#[test]
fn nothing_is_infinitely_far() {
    let d = between(block([0.0; 3], [1.0; 3]), TriMesh::default());
    assert_eq!(d.hausdorff, f64::INFINITY);
}

#[test]
fn walls_of_known_thickness() {
    let turn = DAffine3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7));
    let turned = |mut mesh: TriMesh| {
        mesh.transform(&turn);
        mesh
    };
    let near = |mesh: TriMesh, want: f64, off: f64| {
        let got = wall(mesh).unwrap_or(f64::NAN);
        assert!((got - want).abs() < off, "{got}, not {want}");
    };
    near(turned(block([0.0; 3], [100.0, 60.0, 3.0])), 3.0, 1e-9);
    near(turned(block([0.0; 3], [100.0, 60.0, 0.01])), 0.01, 1e-9);
    near(scaled(sphere(5), 10.0, DVec3::ZERO), 20.0, 0.1);
    near(torus(128), 6.0, 0.05);
    // a hollow ball
    let mut hollow = scaled(sphere(5), 10.0, DVec3::ZERO);
    let mut hole = scaled(sphere(5), 8.5, DVec3::ZERO);
    hole.flip();
    hollow.append(&hole);
    near(hollow, 1.5, 0.02);
    // sides that lean towards each other by 40°, 4 apart at the narrow end: the ball there touches
    // them 4 / (2 sin 20°) from where they would meet, its diameter is 4 / cos 20°
    let rise = 30.0 * 20f64.to_radians().tan();
    let mut wedge = block([0.0; 3], [30.0, 4.0, 40.0]);
    for p in wedge.points.iter_mut().filter(|p| p.x > 1.0) {
        p.y += if p.y > 1.0 { rise } else { -rise };
    }
    near(wedge, 4.0 / 20f64.to_radians().cos(), 0.05);
    assert_eq!(wall(TriMesh::default()), None);
}

#[test]
fn bodies_stand_when_their_centre_is_over_their_feet() {
    let s = stance(&block([0.0; 3], [10.0, 20.0, 30.0])).unwrap();
    assert!(s.centre.distance(dvec3(5.0, 10.0, 15.0)) < 1e-9 && (s.margin - 5.0).abs() < 1e-9);
    // leaning: the centre of a tetrahedron is the mean of its corners, here over (1, 1)
    let leaning = TriMesh {
        points: vec![DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(3.0, 3.0, 1.0)],
        faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    let margin = stance(&leaning).unwrap().margin;
    assert!((margin + 0.5f64.sqrt()).abs() < 1e-12, "{margin}");
    let balanced = |m: &TriMesh| inspect(m, &Options::default()).balanced;
    assert_eq!(
        (balanced(&leaning), balanced(&block([0.0; 3], [1.0; 3]))),
        (Some(false), Some(true))
    );
    let mut two = block([0.0; 3], [1.0; 3]);
    two.append(&block([3.0; 3], [4.0; 3]));
    assert_eq!(balanced(&two), None);
    assert!(stance(&TriMesh::default()).is_none());
}
