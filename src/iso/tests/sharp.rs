use super::shape::Shape;
use super::{covering, extreme, noise};
use crate::field::Field;
use crate::field::sample::sample;
use crate::field::sample::shapes::{Lipschitz, Random, ball, gyroid};
use crate::iso::{Mesher, extract, extract_sharp};
use crate::job::Quiet;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::{DQuat, DVec3, EulerRot};

fn sharp(f: &dyn Field, half: f64, step: f64) -> TriMesh {
    let s = sample(f, covering(half, step), &Quiet).unwrap();
    extract_sharp(&s.bricks, f, &Quiet).unwrap()
}

/// A field without any order: crossings and normals at random.
fn chaos() -> impl Field {
    let value = |p: DVec3| {
        let [x, y, z] = p.to_array().map(f64::to_bits);
        let mut r = Random(x ^ y.rotate_left(21) ^ z.rotate_left(42) | 1);
        (0..3).map(|_| r.next()).sum()
    };
    Lipschitz { value, constant: f64::INFINITY, support: Aabb::ALL }
}

#[test]
fn whatever_the_field_says_the_mesh_is_sound() {
    for (size, seed) in [(16, 1), (17, 2), (20, 3)] {
        for bricks in [noise(size, seed), extreme(size, seed)] {
            let mesh = extract_sharp(&bricks, &chaos(), &Quiet).unwrap();
            let plain = extract(&bricks, Mesher::Cone, &Quiet).unwrap();
            let (shape, plain) = (Shape::of(&mesh), Shape::of(&plain));
            assert!(shape.sound(), "{size}, {seed}: {shape:?}");
            assert_eq!((shape.components, shape.euler), (plain.components, plain.euler));
        }
    }
}

#[test]
fn a_box_keeps_its_corners_and_edges() {
    let half = DVec3::new(8.0, 5.0, 3.0);
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.2);
    let value = move |p: DVec3| {
        let d = (turn * p).abs() - half;
        d.max(DVec3::ZERO).length() + d.max_element().min(0.0)
    };
    let f =
        Lipschitz { value, constant: 1.0, support: Aabb::around(DVec3::ZERO, DVec3::splat(10.0)) };
    let mesh = sharp(&f, 11.0, 0.5);
    assert!(Shape::of(&mesh).sound());
    for corner in Aabb::around(DVec3::ZERO, half).corners() {
        let far = |p: &DVec3| (turn * *p - corner).length();
        // a tip may stand out into a cell that the lattice shows as empty
        assert!(mesh.points.iter().map(far).fold(1.0, f64::min) < 0.25);
    }
    // without the field, bevels take half a per cent off
    assert!((mesh.volume() / 960.0 - 1.0).abs() < 1e-3);
    let off = mesh.points.iter().filter(|&&p| f.value(p).abs() > 0.01).count();
    assert!(off * 50 < mesh.points.len(), "{off} of {}", mesh.points.len());
}

/// The mesh without the field is off by 0.025 and 0.0063.
#[test]
fn a_ball_is_met_closely() {
    let f = ball(0.2, 0.1, -0.3, 10.0);
    for step in [1.0, 0.5] {
        let mesh = sharp(&f, 12.0, step);
        let far = mesh.points.iter().map(|&p| f.value(p).abs()).fold(0.0, f64::max);
        assert!(far < 0.01 * step * step, "{far}");
    }
}

#[test]
fn a_cut_at_the_border_is_flat_and_closed() {
    let f = ball(0.0, 0.0, 0.0, 9.0);
    let mesh = sharp(&f, 5.0, 0.5);
    let shape = Shape::of(&mesh);
    assert!(shape.sound() && shape.components == 1 && shape.euler == 2);
    let size = mesh.bounds().size();
    assert!((mesh.volume() / (size.x * size.y * size.z) - 1.0).abs() < 1e-3);
}

#[test]
fn the_same_on_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sharp(&gyroid(9.0, 12.0), 13.0, 0.7))
    };
    assert_eq!(run(1), run(2));
}
