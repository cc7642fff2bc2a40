use super::*;
use crate::mesh::{Assume, Loaded, read, snap, weld};
use glam::{DQuat, DVec3};

/// A closed box whose corners need all their digits, turned so that no axis is special.
fn block() -> TriMesh {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.0, 2.5);
    let corner = |i: i32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    let size = DVec3::new(1234.567, 0.071, 891.3);
    let mut mesh = TriMesh {
        points: (0..8)
            .map(|i| turn * (corner(i) * size) + DVec3::new(0.1, -2000.2, 31.7))
            .collect(),
        faces: vec![
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ],
    };
    snap(&mut mesh);
    mesh
}

fn round_trip(mesh: &TriMesh, extension: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh").with_extension(extension);
    let bytes = write(&path, mesh, "recipe=1f3a", false).unwrap();
    assert_eq!(bytes, fs::metadata(&path).unwrap().len());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was left behind");
    read(&path, Assume::default()).unwrap()
}

/// Faces named by their corners' positions, the first corner first.
fn by_position(mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    (0..mesh.faces.len()).map(|i| mesh.corners(i)).collect()
}

#[test]
fn every_format_gives_the_mesh_back() {
    let mesh = block();
    // Each corner is off by half a step of f32 at 2048 mm at most, along each axis.
    let off = 3f64.sqrt() * 0.5f64.powi(13) * mesh.area();
    assert!((mesh.volume() - 1234.567 * 0.071 * 891.3).abs() < off);
    for extension in ["obj", "ply", "glb", "stl", "STL"] {
        let mut back = round_trip(&mesh, extension);
        if extension == "obj" {
            snap(&mut back.mesh); // decimals in the file, the same f32
        }
        assert_eq!(by_position(&back.mesh), by_position(&mesh), "{extension}");
        assert_eq!((back.found.open_edges, back.found.shells), (0, 1));
        if !extension.eq_ignore_ascii_case("stl") {
            assert_eq!(back.mesh, mesh, "{extension}"); // order of points too
        }
    }
}

#[test]
fn an_stl_has_its_header_and_unit_normals() {
    let mesh = block();
    let bytes = encode(Target::Stl, &mesh, &"n\nö".repeat(99)).unwrap();
    assert!(bytes.starts_with(b"fieldgraft UNITS=mm n"));
    assert_eq!(bytes.len(), 84 + 50 * 12);
    assert_eq!(bytes[80..84], 12u32.to_le_bytes());
    for (i, facet) in bytes[84..].chunks(50).enumerate() {
        let x = |k: usize| f32::from_le_bytes(facet[k * 4..k * 4 + 4].try_into().unwrap());
        let normal = DVec3::new(x(0).into(), x(1).into(), x(2).into());
        assert!((normal.length() - 1.0).abs() < 1e-6);
        assert!(normal.dot(mesh.area_vector(i).normalize()) > 1.0 - 1e-6);
        assert_eq!(facet[48..], [0, 0]);
    }
}

#[test]
fn negative_zero_is_not_written() {
    let mesh = TriMesh {
        points: vec![DVec3::new(-0.0, -0.0, -0.0), DVec3::X, DVec3::Y, DVec3::Z],
        faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    let minus = (-0.0f32).to_le_bytes();
    let stl = encode(Target::Stl, &mesh, "").unwrap();
    for facet in stl[84..].chunks(50) {
        assert!(facet[..48].chunks(4).all(|x| x != minus));
    }
    let ply = encode(Target::Ply, &mesh, "").unwrap();
    assert!(ply[ply.len() - 4 * 13 - 48..].chunks(4).take(12).all(|x| x != minus));
    let obj = String::from_utf8(encode(Target::Obj, &mesh, "").unwrap()).unwrap();
    assert!(!obj.contains("-0\n") && !obj.contains("-0 "), "{obj}");
}

#[test]
fn a_glb_says_what_the_standard_asks_for() {
    let mesh = block();
    let bytes = encode(Target::Glb, &mesh, "recipe=1f3a").unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    assert_eq!(json["asset"]["version"], "2.0");
    assert_eq!(json["asset"]["generator"], "fieldgraft recipe=1f3a");
    assert_eq!(json["nodes"][0]["scale"], serde_json::json!([0.001, 0.001, 0.001]));
    assert_eq!(json["accessors"][1]["componentType"], 5125);
    let targets: Vec<_> =
        json["bufferViews"].as_array().unwrap().iter().map(|v| &v["target"]).collect();
    assert_eq!(targets, [34962, 34963]);
    let bounds = mesh.bounds();
    let position = &json["accessors"][0];
    for (key, want) in [
        ("min", [bounds.min.x, bounds.min.z, -bounds.max.y]),
        ("max", [bounds.max.x, bounds.max.z, -bounds.min.y]),
    ] {
        let got: Vec<f64> =
            position[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_eq!(got, want, "{key}");
    }
}

#[test]
fn an_existing_file_is_kept_without_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    fs::write(&path, b"mine").unwrap();
    let refused = write(&path, &block(), "", false).unwrap_err();
    assert!(matches!(refused, MeshError::Exists { .. }));
    assert!(refused.to_string().contains("a.stl") && refused.to_string().contains("--force"));
    assert!(check_output(&path, false).is_err());
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    check_output(&path, true).unwrap();
    assert_eq!(write(&path, &block(), "", true).unwrap(), 84 + 600);
    assert_eq!(fs::metadata(&path).unwrap().len(), 84 + 600);
}

#[cfg(unix)]
#[test]
fn others_may_read_the_file_as_usual() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("a.stl"), folder.path().join("b"));
    write(&ours, &block(), "", false).unwrap();
    fs::write(&plain, b"").unwrap();
    let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn what_cannot_be_written_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let try_write = |name: &str, mesh: &TriMesh| {
        let text = write(&folder.path().join(name), mesh, "", true).unwrap_err().to_string();
        assert!(text.contains(name), "{text}");
        text
    };
    let good = block();
    assert!(try_write("a.xyz", &good).contains("writable are stl"));
    assert!(try_write("missing/a.stl", &good).contains("cannot write"));
    fs::create_dir(folder.path().join("folder.stl")).unwrap();
    assert!(try_write("folder.stl", &good).contains("is a folder"));
    assert!(try_write("a.stl", &TriMesh::default()).contains("no triangles"));
    let mut wild = good.clone();
    wild.faces[3][1] = 8;
    assert!(try_write("a.obj", &wild).contains("face 3 has point 8"));
    let mut huge = good.clone();
    huge.points[5].y = 1e39;
    assert!(try_write("a.ply", &huge).contains("point 5"));
    huge.points[5].y = f64::NAN;
    assert!(try_write("a.glb", &huge).contains("point 5"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_stl_that_would_not_weld_back_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    // Two blocks at the same place: their corners coincide.
    let mut twice = block();
    twice.append(&block());
    let text = write(&path, &twice, "", false).unwrap_err().to_string();
    assert!(text.contains("points 0 and 8 of the mesh coincide"), "{text}");
    // A point that f32 cannot tell from its neighbour.
    let mut thin = block();
    thin.points[1] = thin.points[0] + DVec3::X * 1e-9;
    let text = write(&path, &thin, "", false).unwrap_err().to_string();
    assert!(text.contains("lose a corner"), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    // Welded first, it is the same file as before; indexed formats hold the points apart.
    write(&path, &weld(&twice), "", false).unwrap();
    for extension in ["obj", "ply", "glb"] {
        write(&path.with_extension(extension), &twice, "", false).unwrap();
    }
    // Points that no face uses are no part of an STL.
    let mut stray = block();
    stray.points.push(DVec3::ONE);
    write(&path, &stray, "", true).unwrap();
}
