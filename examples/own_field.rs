//! A field of one's own, morphed with a solid: a gyroid ball becomes a rounded box.
//! `cargo run --release --example own_field -- out.stl`

use fieldgraft::element::Element;
use fieldgraft::field::{Field, sample::sample, solid::Solid};
use fieldgraft::grid::Lattice;
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::write;
use fieldgraft::morph::{Inner, Part, Plan, build};
use fieldgraft::num::{Aabb, Interval};
use glam::{DQuat, DVec3};
use std::path::Path;
use std::sync::Arc;

/// A thick gyroid sheet inside a ball.
struct GyroidBall {
    radius: f64,
    period: f64,
    thickness: f64,
}

impl Field for GyroidBall {
    fn value(&self, p: DVec3) -> f64 {
        let k = std::f64::consts::TAU / self.period;
        let (s, c) = ((p * k).map(f64::sin), (p * k).map(f64::cos));
        // |grad| of the sum is at most √3 k, so dividing makes the field 1-Lipschitz
        let sheet = s.x.mul_add(c.y, s.y.mul_add(c.z, s.z * c.x)) / (k * 3f64.sqrt());
        (sheet.abs() - self.thickness / 2.0).max(p.length() - self.radius)
    }

    /// 1-Lipschitz, so the value at the centre and the radius of the box enclose the rest.
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }

    fn support(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::splat(self.radius))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args().nth(1).ok_or("usage: own_field OUT")?;
    let gyroid = GyroidBall { radius: 40.0, period: 30.0, thickness: 4.0 };
    let block = Element::block(DVec3::ZERO, DVec3::splat(30.0), DQuat::IDENTITY)?;
    let parts = vec![
        Part { name: "gyroid".into(), field: Arc::new(gyroid) },
        Part { name: "box".into(), field: Arc::new(Solid::new(&block, 6.0)) },
    ];
    let morph = build(Plan::whole(parts, Inner::Linear))?;
    let field = morph.at(0.35, &Quiet)?;
    let samples = sample(&*field, Lattice::covering(&morph.domain(), 0.5), &Quiet)?;
    let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet)?;
    write(Path::new(&out), &mesh, "gyroid to box", true)?;
    println!("{} triangles, {:.0} mm3", mesh.faces.len(), mesh.volume());
    Ok(())
}
