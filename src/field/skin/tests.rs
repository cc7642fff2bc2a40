use super::*;
use crate::field::sampled::Sampled;
use crate::job::Quiet;
use crate::surface::shapes::{KleinBottle, SeaShell, SuperEllipsoid, SuperToroid};
use crate::surface::{Surface, tessellate::tessellate};
use glam::DVec3;
use std::f64::consts::PI;

fn options(thickness: Option<f64>, skin: Skin) -> SkinOptions {
    SkinOptions { thickness, skin }
}

fn mesh(surface: &dyn Surface, tolerance: f64) -> TriMesh {
    tessellate(surface, tolerance).unwrap().mesh
}

fn volume(mesh: &TriMesh, options: SkinOptions, step: f64) -> f64 {
    let (field, _) = skin(mesh, &options, &Quiet).unwrap();
    Sampled::new(field, step, &Quiet).unwrap().volume()
}

fn ball() -> SuperEllipsoid {
    SuperEllipsoid { alpha: 10.0, beta: 10.0, gamma: 10.0, n1: 1.0, n2: 1.0 }
}

/// A cup: the lower half of the ball of radius 10, as triangles.
fn cup() -> TriMesh {
    let mut mesh = mesh(&ball(), 0.01);
    let low = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z < 1e-9);
    mesh.faces = mesh.faces.iter().filter(|f| low(f)).copied().collect();
    mesh
}

#[test]
fn what_is_closed_is_solid() {
    // of the ball a tolerance e takes a shell of about 2/3 e
    let (e, r) = (0.02, 10.0);
    let v = volume(&mesh(&ball(), e), options(None, Skin::Auto), 0.25);
    let exact = 4.0 / 3.0 * PI * r * r * r;
    assert!((v / exact - 1.0).abs() < 3.0 * e / r + 0.002, "{v} {exact}");
    let ring = SuperToroid { scale: DVec3::ONE, alpha: 3.0, gamma: 8.0, n1: 1.0, n2: 1.0 };
    let v = volume(&mesh(&ring, e), options(None, Skin::Auto), 0.25);
    let exact = 2.0 * PI * PI * 8.0 * 9.0;
    assert!((v / exact - 1.0).abs() < 2.0 * e / 3.0 + 0.004, "{v} {exact}");
}

#[test]
fn shells_have_their_thickness() {
    let mm = 1.0;
    let v = volume(&mesh(&ball(), 0.01), options(Some(mm), Skin::Shell), 0.2);
    let exact = 4.0 / 3.0 * PI * (10.5f64.powi(3) - 9.5f64.powi(3));
    assert!((v / exact - 1.0).abs() < 0.02, "{v} {exact}");
    // area times thickness, and half a round bead along the rim
    let v = volume(&cup(), options(Some(mm), Skin::Auto), 0.2);
    let exact = 2.0 * PI * 100.0 * mm + PI * mm * mm / 8.0 * 2.0 * PI * 10.0;
    assert!((v / exact - 1.0).abs() < 0.03, "{v} {exact}");
}

#[test]
fn sheets_without_a_thickness_are_refused() {
    let e = skin(&cup(), &options(None, Skin::Auto), &Quiet).err().unwrap();
    assert!(matches!(&e, SkinError::Sheet(s) if s.open_edges > 0), "{e}");
    assert!(e.to_string().contains("1 piece, open ("), "{e}");
    let bottle = mesh(&KleinBottle::default(), 0.2);
    let e = skin(&bottle, &options(None, Skin::Auto), &Quiet).err().unwrap();
    assert!(e.to_string().contains("1 piece, closed with one side only"), "{e}");
}

#[test]
fn a_cup_can_be_filled_to_the_rim() {
    let v = volume(&cup(), options(None, Skin::Solid), 0.25);
    let half = 2.0 / 3.0 * PI * 1000.0;
    assert!((v / half - 1.0).abs() < 0.01, "{v} {half}");
    // a tube open at both ends becomes a rod
    let mut tube = TriMesh::default();
    for i in 0..48u32 {
        let (s, c) = (f64::from(i) * PI / 24.0).sin_cos();
        tube.points.extend([DVec3::new(5.0 * c, 5.0 * s, 0.0), DVec3::new(5.0 * c, 5.0 * s, 20.0)]);
        let [a, b] = [2 * i, 2 * ((i + 1) % 48)];
        tube.faces.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
    }
    let v = volume(&tube, options(None, Skin::Solid), 0.25);
    assert!((v / (500.0 * PI) - 1.0).abs() < 0.01, "{v}");
}

#[test]
fn pieces_are_told_apart() {
    let mut all = mesh(&ball(), 0.05);
    let mut cup = cup();
    cup.points.iter_mut().for_each(|p| p.x += 30.0);
    all.append(&cup);
    let (field, sides) = skin(&all, &options(Some(1.0), Skin::Auto), &Quiet).unwrap();
    assert_eq!((sides.pieces, sides.whole, sides.one_sided), (2, 1, 0));
    assert!(sides.story().starts_with("2 pieces, 1 of 2 closed and two-sided, 1 of 2 open ("));
    // the ball is full, the cup hollow
    assert!(field.value(DVec3::ZERO) < -9.0);
    let inside_cup = field.value(DVec3::new(30.0, 0.0, -5.0));
    assert!((inside_cup - 4.5).abs() < 0.1, "{inside_cup}");
}

#[test]
fn a_sheet_that_crosses_itself_is_a_shell_all_over() {
    let bottle = mesh(&KleinBottle::default(), 0.05);
    let (field, sides) = skin(&bottle, &options(Some(1.0), Skin::Auto), &Quiet).unwrap();
    assert_eq!((sides.pieces, sides.one_sided, sides.open_edges), (1, 1, 0));
    for (i, p) in bottle.points.iter().enumerate().step_by(97) {
        assert!(field.value(*p) <= -0.5 + 1e-9, "{i}");
    }
    let sea = mesh(&SeaShell::default(), 0.05);
    assert!(Sides::of(&sea).pieces >= 1);
}

#[test]
fn pieces_that_are_points_are_nothing() {
    // fins that have not begun to grow: closed, and without area
    let mut point = mesh(&ball(), 1.0);
    point.points.iter_mut().for_each(|p| *p = DVec3::splat(3.0));
    let mut both = cup();
    both.append(&point);
    let [alone, with] = [&cup(), &both].map(|m| volume(m, options(Some(1.0), Skin::Auto), 0.4));
    assert_eq!(alone, with);
}
