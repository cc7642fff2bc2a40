//! The seven chairs of `data/chairs` are chairs: one closed piece of real proportions that stands
//! on four feet.

use fieldgraft::check::{Options, inspect};
use fieldgraft::field::{Field, sample::sample};
use fieldgraft::job::Quiet;
use fieldgraft::recipe::{GridEntry, ShapeEntry};
use fieldgraft::scene::Single;
use fieldgraft::{iso, mesh::TriMesh};
use glam::DVec3;
use std::path::Path;

const CHAIRS: [&str; 7] =
    ["bistro", "ladderback", "lounge", "plank", "shell", "tubular", "windsor"];

fn open(name: &str) -> Single {
    let entry: ShapeEntry =
        toml::from_str(&format!("solid = \"data/chairs/{name}.toml\"")).unwrap();
    let grid = GridEntry { resolution: Some(128), ..GridEntry::default() };
    let beside = Path::new(env!("CARGO_MANIFEST_DIR"));
    Single::open(name, entry, &grid, beside).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The lowest point in each quarter of the floor plan.
fn feet(mesh: &TriMesh) -> [f64; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| {
        let quarter = mesh.points.iter().filter(|p| p.x * x > 0.0 && p.y * y > 0.0);
        quarter.map(|p| p.z).fold(f64::INFINITY, f64::min)
    })
}

/// How far above the floor one sits, a little before the middle of the seat.
fn seat_height(f: &dyn Field) -> f64 {
    let steps = (0..600).rev().map(f64::from);
    steps.into_iter().find(|&z| f.value(DVec3::new(0.0, -40.0, z)) < 0.0).unwrap_or(0.0)
}

#[test]
fn they_are_sound_and_stand() {
    for name in CHAIRS {
        let chair = open(name);
        let (lattice, shells) = (chair.lattice, chair.shells().unwrap());
        let (field, _) = chair.field(&Quiet).unwrap();
        let sampling = sample(&*field, lattice, &Quiet).unwrap();
        assert!(!sampling.stats.border_clipped, "{name}");
        let mesh = iso::extract(&sampling.bricks, iso::Mesher::Cone, &Quiet).unwrap();
        let health = inspect(&mesh, &Options { self_intersections: false });
        assert!(health.printable, "{name}: {:?}", health.reasons);
        assert_eq!((health.components, health.floating_parts), (1, Some(0)), "{name}");
        assert_eq!(health.cavities, Some(0), "{name}");

        // a foot is a few cells wide: near its rounded rim samples put it a seventh of a cell high
        assert!(feet(&mesh).iter().all(|z| z.abs() < 1.0), "{name}: {:?}", feet(&mesh));
        assert!(shells.bounds().min.z.abs() < 0.5, "{name}: {}", shells.bounds().min.z);
        let size = mesh.bounds().size();
        assert!((740.0..1020.0).contains(&size.z), "{name}: {size}");
        assert!((400.0..700.0).contains(&size.x), "{name}: {size}");
        let seat = seat_height(&*field);
        assert!((425.0..=470.0).contains(&seat), "{name}: {seat}");
        // a mirror image of itself
        let turned = DVec3::new(-1.0, 1.0, 1.0);
        for p in mesh.points.iter().step_by(97) {
            assert!((field.value(*p) - field.value(*p * turned)).abs() < 1e-6, "{name} at {p}");
        }
    }
}
