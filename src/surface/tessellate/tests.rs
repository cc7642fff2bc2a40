use super::*;
use crate::surface::{
    Domain, Jet,
    pde::{Options, PdeSurface},
    shapes::{KleinBottle, SeaShell, SuperEllipsoid, SuperToroid, cut},
};
use glam::{DVec2, dvec3};
use std::f64::consts::{PI, TAU};

/// Six square patches: the faces of a cube swollen onto the ball of radius 10, some of them inside
/// out.
struct Ball;

impl Surface for Ball {
    fn patches(&self) -> usize {
        6
    }
    fn domain(&self, _: usize) -> Domain {
        Domain { u: [-1.0, 1.0], v: [-1.0, 1.0], wraps: [false, false] }
    }
    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        let side = if patch.is_multiple_of(2) { 1.0 } else { -1.0 };
        let p = match patch / 2 {
            0 => dvec3(side, uv.x, uv.y),
            1 => dvec3(uv.x, side, uv.y),
            _ => dvec3(uv.y, uv.x, side),
        };
        Jet { s: p.normalize() * 10.0, su: DVec3::ZERO, sv: DVec3::ZERO }
    }
}

/// A point function as a patch over [0, 1] x [0, 1].
struct Of<F>(F, [bool; 2]);

impl<F: Fn(f64, f64) -> DVec3 + Send + Sync> Surface for Of<F> {
    fn domain(&self, _: usize) -> Domain {
        Domain { u: [0.0, 1.0], v: [0.0, 1.0], wraps: self.1 }
    }
    fn jet(&self, _: usize, uv: DVec2) -> Jet {
        Jet { s: (self.0)(uv.x, uv.y), su: DVec3::ZERO, sv: DVec3::ZERO }
    }
}

fn euler(mesh: &TriMesh) -> i64 {
    let mut edges: Vec<_> = mesh
        .faces
        .iter()
        .flat_map(|f| (0..3).map(|k| (f[k], f[(k + 1) % 3])))
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut used: Vec<u32> = mesh.faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    used.len() as i64 - edges.len() as i64 + mesh.faces.len() as i64
}

#[test]
fn patches_that_share_borders_make_a_ball() {
    for tolerance in [0.3, 0.01] {
        let ball = tessellate(&Ball, tolerance).unwrap();
        assert!(ball.closed && ball.two_sided);
        assert_eq!(euler(&ball.mesh), 2);
        let missing = 4.0 / 3.0 * PI * 1000.0 - ball.mesh.volume();
        // a mesh inscribed in the ball, nowhere deeper than the tolerance below it
        assert!(missing > 0.0 && missing < 4.0 * PI * 100.0 * tolerance, "{missing}");
        for i in 0..ball.mesh.faces.len() {
            let [a, b, c] = ball.mesh.corners(i);
            assert!(((a + b + c) / 3.0).length() > 10.0 - tolerance, "face {i}");
        }
    }
}

#[test]
fn poles_close() {
    let egg = SuperEllipsoid { n1: 1.0, n2: 1.0, ..SuperEllipsoid::default() };
    let egg = tessellate(&egg, 1e-3).unwrap();
    assert!(egg.closed && egg.two_sided);
    assert_eq!(euler(&egg.mesh), 2);
    assert!((egg.mesh.volume() / (4.0 / 3.0 * PI * 4.0) - 1.0).abs() < 2e-3);
}

#[test]
fn named_shapes_are_what_they_are() {
    let hard = tessellate(&SuperEllipsoid::default(), 0.03).unwrap();
    assert!(hard.closed && hard.two_sided && euler(&hard.mesh) == 2);
    let ring = tessellate(&SuperToroid::default(), 0.03).unwrap();
    assert!(ring.closed && ring.two_sided && euler(&ring.mesh) == 0);
    assert!(ring.mesh.volume() > 0.0);
    let shell = tessellate(&SeaShell::default(), 5e-3).unwrap();
    assert!(!shell.closed && shell.two_sided && euler(&shell.mesh) == 1, "a disc");
    let bottle = tessellate(&KleinBottle::default(), 0.1).unwrap();
    assert!(bottle.closed && !bottle.two_sided && euler(&bottle.mesh) == 0);
}

#[test]
fn pde_patches_close_as_their_shapes_do() {
    let solve = |shape: &dyn Surface, divisions| {
        let patches = cut(shape, divisions, 32).unwrap();
        tessellate(&PdeSurface::new(&patches, Options::default()).unwrap(), 0.1).unwrap()
    };
    let egg = solve(&SuperEllipsoid::default(), 3);
    assert!(egg.closed && egg.two_sided && euler(&egg.mesh) == 2);
    let ring = solve(&SuperToroid::default(), 4);
    assert!(ring.closed && ring.two_sided && euler(&ring.mesh) == 0);
    let bottle = solve(&KleinBottle::default(), 8);
    assert!(bottle.closed && !bottle.two_sided && euler(&bottle.mesh) == 0);
}

#[test]
fn folds_close() {
    // a purse: u = 1 ends in a straight seam, v against 1 - v
    let purse = Of(
        |u: f64, v: f64| {
            let (s, c) = (TAU * v).sin_cos();
            dvec3(u.min(1.0) * c, u * (1.0 - u) * s, u) * 10.0
        },
        [false, true],
    );
    let purse = tessellate(&purse, 0.05).unwrap();
    assert!(purse.closed && purse.two_sided && euler(&purse.mesh) == 2);
}

#[test]
fn a_moebius_band_has_one_side_and_a_border() {
    let band = Of(
        |u: f64, v: f64| {
            let ((s, c), (sh, ch)) = ((TAU * u).sin_cos(), (PI * u).sin_cos());
            let r = 10.0 + (v - 0.5) * 4.0 * ch;
            dvec3(r * c, r * s, (v - 0.5) * 4.0 * sh)
        },
        [false, false],
    );
    let band = tessellate(&band, 0.02).unwrap();
    assert!(!band.closed && !band.two_sided && euler(&band.mesh) == 0);
}

#[test]
fn refuses_what_it_cannot_do() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(tessellate(&Ball, bad).unwrap_err().at, "tolerance");
    }
    let error = tessellate(&Ball, 1e-9).unwrap_err();
    assert!(error.why.contains("more than"), "{error}");
    let hole = Of(|u, v| dvec3(u, v, 1.0 / (u - 0.5)), [false, false]);
    assert_eq!(tessellate(&hole, 0.1).unwrap_err().at, "patches[0]");
}
