//! What is read is what the file says.

use super::*;
use crate::mesh::{shells, weld};

#[test]
fn every_format_gives_the_same_tetrahedron() {
    for (i, (extension, bytes)) in samples().iter().enumerate() {
        let loaded = as_is(bytes, extension);
        let name = format!("sample {i}, {extension}");
        // STL numbers its points as its faces meet them.
        let (mesh, want) = (weld(&loaded.mesh), tetrahedron());
        let corners = |m: &TriMesh| (0..4).map(|i| m.corners(i)).collect::<Vec<_>>();
        assert_eq!(corners(&mesh), corners(&want), "{name}");
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15, "{name}");
        let found = &loaded.found;
        assert_eq!((found.triangles, found.faces, found.shells), (4, 4, 1), "{name}");
        assert_eq!((found.open_edges, found.degenerate), (0, 0), "{name}");
        assert_eq!(found.welded, if *extension == "stl" { 8 } else { 0 }, "{name}");
    }
}

#[test]
fn axes_and_units_follow_the_format_unless_told() {
    let top = |extension: &str, bytes: &[u8]| {
        let loaded = parsed(bytes, extension).unwrap();
        (loaded.up, loaded.unit, loaded.mesh.bounds().size())
    };
    let flat = "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n"; // in x and y
    assert_eq!(top("obj", flat.as_bytes()), (Up::Y, Unit::Mm, DVec3::new(2.0, 0.0, 3.0)));
    let told = Assume { up: Some(Up::Z), unit: Some(Unit::Cm) };
    let loaded = load(flat.as_bytes(), Format::Obj, Path::new(""), told).unwrap();
    assert_eq!(loaded.mesh.bounds().size(), DVec3::new(20.0, 30.0, 0.0));
    assert_eq!((loaded.up, loaded.unit), (Up::Z, Unit::Cm));
    for (extension, bytes) in samples() {
        let (up, unit, size) = top(extension, &bytes);
        let gltf = extension.starts_with("gl");
        assert_eq!(unit, if gltf { Unit::M } else { Unit::Mm });
        assert_eq!(up, if gltf || extension == "obj" { Up::Y } else { Up::Z });
        assert_eq!(size, DVec3::splat(if gltf { 1000.0 } else { 1.0 }));
    }
}

#[test]
fn turning_y_up_to_z_up_keeps_the_outside_outside() {
    let loaded = parsed(OBJ.as_bytes(), "obj").unwrap();
    assert!(loaded.mesh.volume() > 0.1);
    let b = loaded.mesh.bounds();
    assert_eq!((b.min, b.max), (DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 0.0, 1.0)));
}

#[test]
fn polygons_are_cut_and_counted() {
    // An L, a convex quad, an arrowhead, two corners, one corner thrice.
    let text = "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nv 9 9 9\n\
        f 1 2 3 4 5 6\nf 1 2 3 4\nf 1 2 4 6\nf 1 2\nf 3 3 3\n";
    let loaded = as_is(text.as_bytes(), "obj");
    let found = &loaded.found;
    assert_eq!((found.larger, found.quads, found.concave), (1, 2, 2));
    assert_eq!((found.triangles, found.degenerate, found.unreferenced), (1, 2, 1));
    // L: 6; trapezoid with sides 4 and 3: 3.5; arrowhead (0,0) (4,0) (1,1) (0,3): 3.5.
    assert!((loaded.mesh.area() - 13.0).abs() < 1e-12, "{}", loaded.mesh.area());
}

#[test]
fn a_binary_stl_may_begin_with_solid() {
    let loaded = as_is(&binary_stl(b"solid but not text"), "stl");
    assert_eq!(loaded.mesh.faces.len(), 4);
}

#[test]
fn names_need_not_be_utf8_and_words_may_be_loud() {
    let obj = [b"o caf\xE9\ng \xFF\xFE\n".as_slice(), OBJ.as_bytes()].concat();
    assert_eq!(as_is(&obj, "obj").mesh.faces.len(), 4);
    let stl = ascii_stl().to_uppercase().replace('\n', "\r\n");
    assert_eq!(as_is(stl.as_bytes(), "stl").mesh.faces.len(), 4);
    let stl = [b"solid caf\xE9\n".as_slice(), &ascii_stl().as_bytes()[24..]].concat();
    assert_eq!(as_is(&stl, "stl").mesh.faces.len(), 4);
}

#[test]
fn a_number_that_no_face_uses_may_be_anything() {
    let text = format!("{OBJ}v nan 0 inf\n");
    let loaded = as_is(text.as_bytes(), "obj");
    assert_eq!((loaded.found.unreferenced, loaded.mesh.points.len()), (1, 4));
}

#[test]
fn node_transforms_are_applied_and_mirrors_keep_the_outside() {
    // Parent moves by 10, child mirrors in x and doubles: corner (1,0,0) comes to (8,0,0).
    let nodes = r#"{"translation":[10,0,0],"children":[1,2]},
        {"mesh":0,"scale":[-2,2,2]},
        {"mesh":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,1,0, 0,0,5,1]}"#;
    let loaded = as_is(&glb_of(nodes), "glb");
    assert_eq!(shells(&loaded.mesh).1, 2);
    let b = loaded.mesh.bounds();
    // The second is turned by 90 degrees about z: x to y, y to -x.
    assert_eq!((b.min, b.max), (DVec3::new(8.0, 0.0, 0.0), DVec3::new(10.0, 2.0, 6.0)));
    assert!((loaded.mesh.volume() - 9.0 / 6.0).abs() < 1e-12);
    let quarter = r#"{"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476]}"#;
    let turned = as_is(&glb_of(quarter), "glb").mesh;
    assert!((turned.points[1] - DVec3::Y).length() < 1e-15);
}

#[test]
fn lists_strips_fans_and_plain_order() {
    // A square of four points in an order that suits a strip.
    let points = [[0f32, 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let mut binary: Vec<u8> = points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    binary.resize(72, 0);
    let area = |primitive: &str, json: &dyn Fn(String) -> String| {
        let json = json(gltf_json("", r#"{"mesh":0}"#, primitive));
        let mesh = as_is(&glb(&json, &binary), "glb").mesh;
        let sum = (0..mesh.faces.len()).map(|i| mesh.area_vector(i).z).sum::<f64>();
        (mesh.faces.len(), sum)
    };
    let whole = |s: String| s;
    assert_eq!(area(r#""attributes":{"POSITION":0},"mode":5"#, &whole), (2, 1.0));
    assert_eq!(area(r#""attributes":{"POSITION":0},"mode":4"#, &whole), (1, 0.5));
    // A fan 0, 1, 2, 3: the second half turns back over the first's far corner.
    assert_eq!(area(r#""attributes":{"POSITION":0},"mode":6"#, &whole), (2, 0.0));
}

#[test]
fn primitives_that_share_a_large_accessor_take_only_their_points() {
    let primitive = r#""attributes":{"POSITION":0},"indices":1"#;
    let json = gltf_json("", r#"{"mesh":0}"#, primitive)
        .replace(r#""byteLength":72"#, r#""byteLength":1224"#)
        .replace(r#""byteLength":48"#, r#""byteLength":1200"#)
        .replace(r#""byteOffset":48"#, r#""byteOffset":1200"#)
        .replace(r#""count":4"#, r#""count":100"#);
    let points = POINTS.iter().cycle().take(100).flatten().flat_map(|x| x.to_le_bytes());
    let indices = FACES.iter().flatten().flat_map(|&v| (96 + v as u16).to_le_bytes());
    let loaded = as_is(&glb(&json, &points.chain(indices).collect::<Vec<_>>()), "glb");
    assert_eq!(loaded.mesh, tetrahedron());
    assert_eq!((loaded.found.points, loaded.found.unreferenced), (4, 0));
}

#[test]
fn points_and_lines_beside_triangles_are_passed_over() {
    let primitive = format!(r#"{PLAIN}}},{{"attributes":{{}},"mode":1"#);
    let json = gltf_json("", r#"{"mesh":0}"#, &primitive);
    assert_eq!(as_is(&glb(&json, &gltf_bytes()), "glb").mesh.faces.len(), 4);
}

#[test]
fn a_gltf_finds_its_buffer_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(folder.path().join("a b.bin"), gltf_bytes()).unwrap();
    let json = gltf_json(r#""uri":"a%20b.bin","#, r#"{"mesh":0}"#, PLAIN);
    std::fs::write(&path, json).unwrap();
    let loaded = crate::mesh::read(&path, Assume::default()).unwrap();
    assert_eq!(loaded.mesh.bounds().size(), DVec3::splat(1000.0));
}
