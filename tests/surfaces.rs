use fieldgraft::bvh::Winding;
use fieldgraft::check;
use fieldgraft::mesh::TriMesh;
use fieldgraft::surface::pde::{Options, PdeSurface};
use fieldgraft::surface::{Surface, shapes::dolphin, tessellate::tessellate};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

fn animal() -> PdeSurface {
    PdeSurface::new(&dolphin(), Options::default()).unwrap()
}

#[test]
fn a_dolphin_is_one_solid() {
    let animal = animal();
    let made = tessellate(&animal, 0.5).unwrap();
    assert!(made.closed && made.two_sided);
    // patch by patch: closed solids of their own, and every fin has its root inside the body
    let solid = |patch: usize| -> TriMesh {
        tessellate(&PdeSurface::new(&dolphin()[patch..=patch], Options::default()).unwrap(), 0.5)
            .unwrap()
            .mesh
    };
    let body = solid(0);
    let corners = |m: &TriMesh| (0..m.faces.len()).map(|i| m.corners(i)).collect::<Vec<_>>();
    let inside = Winding::new(&corners(&body));
    for fin in 1..5 {
        let mesh = solid(fin);
        let health = check::inspect(&mesh, &check::Options::default());
        assert!(health.closed && mesh.volume() > 5000.0, "fin {fin}");
        let (within, without): (Vec<&_>, Vec<&_>) =
            mesh.points.iter().partition(|p| inside.exact(**p) > 0.5);
        assert!(within.len() > 8 && without.len() > 8, "fin {fin} stands in the body");
    }
}

#[test]
fn a_dolphin_has_a_beak_and_a_notch() {
    let animal = animal();
    let back = |v: f64| animal.point(0, DVec2::new(0.0, v));
    // the slope of the back: flat on the beak, steep at the forehead, flat on the back
    let slope = |x: f64| {
        let at = (0..2000).map(|i| back(PI * f64::from(i) / 2000.0)).find(|p| p.x > x).unwrap();
        let next = (0..2000).map(|i| back(PI * f64::from(i) / 2000.0)).find(|p| p.x > x + 5.0);
        (next.unwrap().y - at.y) / (next.unwrap().x - at.x)
    };
    assert!(slope(-135.0) < 0.5 && slope(-110.0) > 0.7 && slope(-20.0) < 0.2);
    // the back edge of the flukes lies farther front in the middle than beside it
    let behind = |z: f64| {
        let edge = (0..4000).map(|i| animal.point(1, DVec2::new(0.5, TAU * f64::from(i) / 4000.0)));
        edge.filter(|p| (p.z - z).abs() < 1.0).map(|p| p.x).fold(f64::MIN, f64::max)
    };
    assert!(behind(0.0) + 8.0 < behind(25.0) && (behind(25.0) - behind(-25.0)).abs() < 0.5);
    // left is right
    for (u, v) in [(0.3, 0.4), (0.8, 2.0)] {
        let mirror = DVec3::new(1.0, 1.0, -1.0);
        let [a, b] = [v, -v].map(|v| animal.point(0, DVec2::new(u, v)));
        assert!((a - b * mirror).length() < 1e-12);
        let [a, b] = [3, 4].map(|side| animal.point(side, DVec2::new(u, v)));
        assert!((a - b * mirror).length() < 1e-12);
    }
}
