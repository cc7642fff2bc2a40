//! Wrong input gives an error that names the place, never a panic and never a guess.

use super::*;

#[track_caller]
fn refused(bytes: &[u8], extension: &str, parts: &[&str]) {
    let text = parsed(bytes, extension).expect_err("it was read");
    for part in parts {
        assert!(text.contains(part), "`{text}` does not say `{part}`");
    }
}

#[test]
fn only_regular_files_with_triangles_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("folder.obj")).unwrap();
    for name in ["empty.obj", "empty.stl", "empty.ply", "empty.glb", "empty.gltf", "a.xyz"] {
        std::fs::write(at(name), b"").unwrap();
    }
    std::fs::write(at("points.obj"), b"v 0 0 0\n").unwrap();
    std::fs::write(at("flat.obj"), b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n").unwrap();
    let cases = [
        ("missing.obj", "cannot read"),
        ("folder.obj", "is a folder, not a regular file"),
        ("empty.obj", "the file is empty"),
        ("empty.stl", "the file is empty"),
        ("empty.ply", "the file is empty"),
        ("empty.glb", "the file is empty"),
        ("empty.gltf", "the file is empty"),
        ("a.xyz", "unknown mesh format `xyz`; readable are obj"),
        ("points.obj", "no triangles in the file"),
        ("flat.obj", "only 1 faces without area"),
    ];
    for (name, part) in cases {
        let text = read(&at(name), Assume::default()).unwrap_err().to_string();
        assert!(text.contains(name) && text.contains(part), "{text}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/zero", at("zero.stl")).unwrap();
        let text = read(&at("zero.stl"), Assume::default()).unwrap_err().to_string();
        assert!(text.contains("is a pipe or device, not a regular file"), "{text}");
    }
}

#[test]
fn obj_lines_are_named() {
    let with = |line: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{line}\n").into_bytes();
    refused(&with("f 1 2 4"), "obj", &["line 4 (face 1)", "point 4", "3 points"]);
    refused(&with("f 1 2 0"), "obj", &["line 4", "counts from 1"]);
    refused(&with("f 1 2 -4"), "obj", &["line 4", "-4", "3 points"]);
    refused(&with("f 1 2 99999999999"), "obj", &["line 4", "99999999999"]);
    refused(&with("f 1 2 99999999999999999999"), "obj", &["line 4", "not a corner"]);
    refused(&with("f 1 2 x"), "obj", &["line 4", "`x`"]);
    refused(&with("v 1 2"), "obj", &["line 4", "z is missing"]);
    refused(&with("v 1 2,5 3"), "obj", &["line 4", "y is `2,5`"]);
    refused(
        &with("v 1 nan 3\nf 1 2 4"),
        "obj",
        &["line 4 (point 4)", "not finite", "line 5 (face 1)"],
    );
    refused(&with("v 1 1e99 3\nf 1 2 4"), "obj", &["line 4 (point 4)", "beyond the range"]);
    refused(&with("f 1 2 \\\n 9"), "obj", &["line 4", "point 9"]);
}

#[test]
fn stl_counts_are_checked_against_the_bytes() {
    let whole = binary_stl(b"x");
    refused(&whole[..whole.len() - 1], "stl", &["4 triangles", "284 bytes", "has 283"]);
    refused(&whole[..50], "stl", &["50 bytes", "84"]);
    let mut billions = whole.clone();
    billions[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(&billions, "stl", &["4294967295 triangles", "214748364834 bytes"]);
    let mut nan = whole.clone();
    nan[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    refused(&nan, "stl", &["point 3", "not finite", "face 1"]);
    let text = ascii_stl();
    refused(&text.as_bytes()[..text.len() - 40], "stl", &["line"]);
    refused(&text.as_bytes()[..text.rfind("endsolid").unwrap()], "stl", &["cut short"]);
    refused(text.replacen("vertex 0e0", "vertex inf", 1).as_bytes(), "stl", &["line 4 (point 0)"]);
    refused(text.replacen("vertex 0e0", "vertex a", 1).as_bytes(), "stl", &["line 4", "`a`"]);
    refused(text.replacen("outer loop", "", 1).as_bytes(), "stl", &["line 4", "outside a loop"]);
    refused(text.replacen("endloop", "", 1).as_bytes(), "stl", &["line 8", "before endloop"]);
}

#[test]
fn ply_headers_and_rows_are_checked() {
    let ascii = String::from_utf8(ply("ascii")).unwrap();
    let swap = |from: &str, to: &str| ascii.replacen(from, to, 1).into_bytes();
    refused(&swap("ply", "plx"), "ply", &["line 1", "plx"]);
    refused(&swap("format ascii", "format utf8"), "ply", &["line 2", "utf8"]);
    refused(&swap("element vertex 4", "element vertex -4"), "ply", &["line 6", "-4"]);
    refused(
        &swap("element vertex 4", "element vertex 4000000000"),
        "ply",
        &["element vertex", "4000000000 rows"],
    );
    refused(&swap("element face 4", "element face 18446744073709551615"), "ply", &["element face"]);
    refused(&swap("property double x", "property quad x"), "ply", &["line 8", "quad"]);
    refused(&swap("property double x", "property double w"), "ply", &["no properties x, y and z"]);
    refused(&swap("vertex_index", "corners"), "ply", &["vertex_indices"]);
    refused(&swap("end_header", "the_end"), "ply", &["the_end"]);
    let half = &ascii[..ascii.find("element face").unwrap()];
    refused(half.as_bytes(), "ply", &["header", "cut short"]);
    refused(&swap("9 3 0 2 1 ", "9 3 0 2 4 "), "ply", &["line 22 (face 0)", "point 4", "4 points"]);
    refused(&swap("9 3 0 2 1 ", "9 3 0 2 -1 "), "ply", &["line 22", "-1"]);
    refused(&swap("9 3 0 2 1 ", "9 3 0 2 1.5 "), "ply", &["line 22", "1.5"]);
    refused(&swap("9 3 0 2 1 ", "9 1e18 0 2 1 "), "ply", &["line 22", "list of"]);
    refused(&swap("200 1 0 0", "200 1 nan 0"), "ply", &["line 19 (point 1)", "not finite"]);
    refused(&swap("200 1 0 0", "200 1 zero 0"), "ply", &["line 19", "`zero`"]);
    let binary = ply("binary_little_endian");
    refused(&binary[..binary.len() - 3], "ply", &["face 3", "cut short"]);
    let strips = swap("element face 4", "element tristrips 1");
    refused(&strips, "ply", &["tristrips"]);
}

#[test]
fn glb_headers_are_checked() {
    let whole = glb_of(r#"{"mesh":0}"#);
    let patched = |at: usize, word: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    refused(&whole[..11], "glb", &["header", "11 bytes"]);
    refused(&patched(4, 1), "glb", &["version 1"]);
    refused(&patched(8, u32::MAX), "glb", &["length is 4294967295"]);
    refused(&patched(8, 0), "glb", &["no JSON chunk"]);
    refused(&patched(12, u32::MAX), "glb", &["byte 12", "4294967295 bytes"]);
    refused(&whole[..whole.len() - 4], "glb", &["length"]);
    refused(&glb("{", b""), "glb", &["JSON", "line 1"]);
    refused(b"{\"asset\":{\"version\":\"1.0\"}}", "gltf", &["asset.version", "1.0"]);
    refused("[".repeat(100_000).as_bytes(), "gltf", &["JSON"]);
}

/// The tetrahedron with one piece of its JSON replaced.
#[track_caller]
fn gltf_refused(from: &str, to: &str, parts: &[&str]) {
    let json = gltf_json("", r#"{"mesh":0}"#, PLAIN);
    assert!(json.contains(from), "no `{from}`");
    refused(&glb(&json.replacen(from, to, 1), &gltf_bytes()), "glb", parts);
}

#[test]
fn every_gltf_index_and_count_is_checked() {
    gltf_refused(r#""scene":0"#, r#""scene":7"#, &["scene 7"]);
    gltf_refused(r#""nodes":[0]"#, r#""nodes":[7]"#, &["nodes[7]"]);
    gltf_refused(r#"{"mesh":0}"#, r#"{"mesh":7}"#, &["meshes[7]"]);
    gltf_refused(r#""POSITION":0"#, r#""POSITION":7"#, &["accessors[7]"]);
    gltf_refused(r#""POSITION":0"#, r#""POSITION":1"#, &["primitives[0]", "SCALAR", "VEC3 of f32"]);
    gltf_refused(r#""POSITION":0"#, r#""NORMAL":0"#, &["no POSITION"]);
    gltf_refused(r#""indices":1"#, r#""indices":0"#, &["accessors[0]", "indices are VEC3"]);
    gltf_refused(r#""indices":1"#, r#""indices":1,"mode":9"#, &["mode 9"]);
    gltf_refused(r#""bufferView":0"#, r#""bufferView":7"#, &["bufferViews[7]"]);
    gltf_refused(r#""bufferView":0,"#, "", &["accessors[0]", "no bufferView"]);
    gltf_refused(r#""buffer":0"#, r#""buffer":7"#, &["bufferViews[0]", "buffer 7"]);
    gltf_refused(r#""count":4"#, r#""count":5"#, &["accessors[0]", "5 items", "48 bytes"]);
    let most = format!(r#""count":{}"#, u64::MAX);
    gltf_refused(r#""count":4"#, &most, &["accessors[0]"]);
    gltf_refused(r#""count":4"#, r#""count":4,"byteOffset":1"#, &["accessors[0]"]);
    gltf_refused(r#""count":4"#, r#""count":4,"sparse":{}"#, &["accessors[0]", "sparse"]);
    let stride = r#""buffer":0,"byteStride":0,"#;
    gltf_refused(r#""buffer":0,"#, stride, &["byteStride 0"]);
    gltf_refused(r#""byteOffset":48"#, r#""byteOffset":49"#, &["bufferViews[1]", "72 bytes"]);
    let far = format!(r#""byteOffset":{}"#, u64::MAX);
    gltf_refused(r#""byteOffset":48"#, &far, &["bufferViews[1]"]);
    gltf_refused(r#""byteLength":72"#, r#""byteLength":73"#, &["buffers[0]", "73", "72"]);
    gltf_refused("5123", "5126", &["accessors[1]"]);
    gltf_refused("5126", "5123", &["primitives[0]", "type 5123"]);
    let far = gltf_json("", r#"{"mesh":0}"#, PLAIN);
    let mut bytes = gltf_bytes();
    bytes[48] = 9;
    refused(&glb(&far, &bytes), "glb", &["primitives[0]", "index 9", "4 points"]);
    bytes = gltf_bytes();
    bytes[..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    refused(&glb(&far, &bytes), "glb", &["point 0", "not finite"]);
}

#[test]
fn nodes_must_form_a_tree() {
    for nodes in [
        r#"{"children":[0]}"#,
        r#"{"children":[1]},{"children":[0]}"#,
        r#"{"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0}"#,
    ] {
        refused(&glb_of(nodes), "glb", &["reached twice"]);
    }
    // A chain of 100 000 nodes is deep, but a tree.
    let chain: Vec<_> = (1..100_000).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    let nodes = format!("{},{}", chain.join(","), r#"{"mesh":0}"#);
    assert_eq!(as_is(&glb_of(&nodes), "glb").mesh.faces.len(), 4);
}

#[test]
fn instances_are_bounded() {
    // 3000 nodes, each with one mesh of 1000 primitives of the same 4 triangles.
    let ids: Vec<_> = (1..=3000).map(|i| i.to_string()).collect();
    let leaves = vec![r#"{"mesh":0}"#; 3000].join(",");
    let nodes = format!(r#"{{"children":[{}]}},{leaves}"#, ids.join(","));
    let many = vec![PLAIN; 1000].join("},{");
    let json = gltf_json("", &nodes, &many);
    refused(&glb(&json, &gltf_bytes()), "glb", &["instances"]);
}

#[test]
fn packed_geometry_and_outside_buffers_are_refused() {
    let json = gltf_json("", r#"{"mesh":0}"#, PLAIN);
    let needs = |e: &str| json.replacen('{', &format!(r#"{{"extensionsRequired":["{e}"],"#), 1);
    let draco = needs("KHR_draco_mesh_compression");
    refused(draco.as_bytes(), "gltf", &["KHR_draco_mesh_compression", "without compression"]);
    refused(needs("EXT_mesh_gpu_instancing").as_bytes(), "gltf", &["EXT_mesh_gpu_instancing"]);
    let harmless = glb(&needs("KHR_materials_unlit"), &gltf_bytes());
    assert_eq!(as_is(&harmless, "glb").mesh.faces.len(), 4);
    gltf_refused(
        r#""indices":1"#,
        r#""indices":1,"extensions":{"KHR_draco_mesh_compression":{}}},{"attributes":{"POSITION":9}"#,
        &["accessors[9]"],
    );
    for uri in ["../a.bin", "/etc/passwd", "file:///etc/passwd", "%2e%2e/a.bin", "a.bin"] {
        let json = gltf_json(&format!(r#""uri":"{uri}","#), r#"{"mesh":0}"#, PLAIN);
        refused(json.as_bytes(), "gltf", &["buffers[0]"]);
    }
    refused(json.as_bytes(), "gltf", &["buffers[0]", "no uri"]);
}
