use super::*;
use crate::mesh::{Assume, MeshError, read};
use glam::DVec3;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A corner with edges of this length, mm.
fn corner(edge: f64) -> TriMesh {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * edge).to_vec();
    TriMesh { points, faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
}

/// The JSON of a GLB and its buffer.
fn parts(path: &Path) -> (Value, Vec<u8>) {
    let bytes = fs::read(path).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let end = 20 + word(12);
    assert_eq!(word(end) + end + 8, bytes.len());
    (serde_json::from_slice(&bytes[20..end]).unwrap(), bytes[end + 8..].to_vec())
}

/// The numbers of an accessor, and that it says so itself.
fn numbers(document: &Value, buffer: &[u8], accessor: &Value) -> Vec<f32> {
    let a = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][a["bufferView"].as_u64().unwrap() as usize];
    let at = |key: &str| view[key].as_u64().unwrap() as usize;
    let bytes = &buffer[at("byteOffset")..at("byteOffset") + at("byteLength")];
    assert_eq!(a["componentType"], 5126);
    let x: Vec<f32> = bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let width = if a["type"] == "VEC3" { 3 } else { 1 };
    assert_eq!(x.len(), a["count"].as_u64().unwrap() as usize * width);
    for k in 0..width {
        let all = || x.iter().skip(k).step_by(width).copied();
        let said = |key: &str| a[key][k].as_f64().unwrap() as f32;
        assert_eq!(said("min"), all().fold(f32::INFINITY, f32::min));
        assert_eq!(said("max"), all().fold(f32::NEG_INFINITY, f32::max));
    }
    x
}

fn book(path: &Path, edges: &[f64], turns: &[usize]) -> Result<u64, MeshError> {
    let mut book = FlipBook::new(path, "recipe=1f3a", [206, 164, 116], false)?;
    for edge in edges {
        book.push(&format!("t {edge}"), &corner(*edge))?;
    }
    book.write(turns, 0.125)
}

#[test]
fn each_frame_of_a_flip_book_is_shown_in_its_turn_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let bytes = book(&path, &[1.0, 2.0, 3.0], &[0, 1, 2, 1]).unwrap();
    assert_eq!(bytes, fs::metadata(&path).unwrap().len());
    let (document, buffer) = parts(&path);
    let nodes = document["nodes"].as_array().unwrap();
    assert_eq!(nodes[3]["children"], json!([0, 1, 2]));
    assert_eq!(document["scenes"][0]["nodes"], json!([3]));
    // metres, as of the file of a mesh that keeps still
    assert_eq!(nodes[3]["scale"], json!([0.001, 0.001, 0.001]));
    for (i, name) in ["t 1", "t 2", "t 3"].iter().enumerate() {
        assert_eq!((&nodes[i]["name"], &nodes[i]["mesh"]), (&json!(name), &json!(i)));
        let shown = if i == 0 { Value::Null } else { json!([0.0, 0.0, 0.0]) };
        assert_eq!(nodes[i]["scale"], shown, "without playing, the first frame is seen");
        let position = &document["meshes"][i]["primitives"][0]["attributes"]["POSITION"];
        let edge = (i + 1) as f32;
        let want = [0.0, 0.0, 0.0, edge, 0.0, 0.0, 0.0, 0.0, -edge, 0.0, edge, 0.0];
        assert_eq!(numbers(&document, &buffer, position), want, "Y is up");
    }
    let animation = &document["animations"][0];
    assert_eq!(animation["channels"].as_array().unwrap().len(), 3);
    for (i, channel) in animation["channels"].as_array().unwrap().iter().enumerate() {
        assert_eq!(channel["target"], json!({ "node": i, "path": "scale" }));
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        assert_eq!(sampler["interpolation"], "STEP");
        let times = numbers(&document, &buffer, &sampler["input"]);
        assert_eq!(times, [0.0, 0.125, 0.25, 0.375, 0.5], "the last frame has its time too");
        let scales = numbers(&document, &buffer, &sampler["output"]);
        let shown: Vec<bool> = scales.chunks(3).map(|s| s == [1.0; 3]).collect();
        let want: Vec<bool> = [0, 1, 2, 1, 1].iter().map(|&k| k == i).collect();
        assert_eq!(shown, want, "frame {i}");
        assert!(scales.iter().all(|s| *s == 0.0 || *s == 1.0));
    }
}

#[test]
fn a_flip_book_reads_back_as_its_first_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    // shown first is what the turns begin with, not what came first
    book(&path, &[1.0, 2.0, 3.0], &[1, 2, 0]).unwrap();
    assert_eq!(read(&path, Assume::default()).unwrap().mesh, corner(2.0));
}

#[test]
fn what_cannot_be_a_flip_book_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let says = |e: MeshError, what: &str| assert!(e.to_string().contains(what), "{e}");
    says(book(&at("a.obj"), &[1.0], &[0]).unwrap_err(), "only glb can hold an animation");
    says(book(&at("none/a.glb"), &[1.0], &[0]).unwrap_err(), "cannot write");
    says(book(&at("a.glb"), &[1.0], &[]).unwrap_err(), "no frames");
    says(book(&at("a.glb"), &[1.0, 2.0], &[0, 2]).unwrap_err(), "frame 2");
    let mut new = FlipBook::new(&at("a.glb"), "", [0; 3], false).unwrap();
    says(new.push("t 0", &TriMesh::default()).unwrap_err(), "frame t 0 has no triangles");
    let mut wild = corner(1.0);
    wild.faces[1][2] = 4;
    says(new.push("t 0", &wild).unwrap_err(), "frame t 0: face 1 has point 4");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    new.push("t 0", &corner(1.0)).unwrap();
    fs::write(at("a.glb"), b"mine").unwrap();
    says(new.write(&[0], 0.1).unwrap_err(), "--force");
    assert_eq!(fs::read(at("a.glb")).unwrap(), b"mine");
}

/// A sheet of two triangles in the plane z = 0 that folds up along its diagonal, cut along it: the
/// points 1 and 3, 2 and 4 are at one place.
fn fold(angle: f64) -> Vec<DVec3> {
    let up = DVec3::new(angle.cos(), angle.cos(), angle.sin() * 2f64.sqrt());
    let tip = DVec3::new(1.0, 1.0, 0.0) / 2.0 + up / 2.0;
    vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X, DVec3::Y, tip]
}

const FACES: [[u32; 3]; 2] = [[0, 1, 2], [4, 3, 5]];

fn moving<'a>(poses: &'a [Vec<DVec3>], names: &'a [String], turns: &'a [usize]) -> Motion<'a> {
    Motion { faces: &FACES, poses, names, turns, seconds: 0.5, color: [206, 164, 116] }
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|i| format!("t {i}")).collect()
}

#[test]
fn weights_of_one_give_each_pose_with_its_normals() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    // a right angle is a crease, 40 degrees are not
    let poses = [0.0, 40f64.to_radians(), 90f64.to_radians()].map(fold);
    let names = names(3);
    let bytes = write_motion(&path, &moving(&poses, &names, &[0, 1, 2, 1]), "", false).unwrap();
    assert_eq!(bytes, fs::metadata(&path).unwrap().len());
    let (document, buffer) = parts(&path);
    let mesh = &document["meshes"][0];
    assert_eq!(mesh["weights"], json!([0.0, 0.0]));
    assert_eq!(mesh["extras"]["targetNames"], json!(["t 1", "t 2"]));
    let primitive = &mesh["primitives"][0];
    let read = |accessor: &Value| numbers(&document, &buffer, accessor);
    let base = ["POSITION", "NORMAL"].map(|k| read(&primitive["attributes"][k]));
    let pose = |i: usize, k: usize, key: &str| -> Vec<[f32; 3]> {
        let moved = match i {
            0 => vec![0.0; 18],
            _ => read(&primitive["targets"][i - 1][key]),
        };
        let sum: Vec<f32> = base[k].iter().zip(moved).map(|(a, b)| a + b).collect();
        sum.chunks(3).map(|p| p.try_into().unwrap()).collect()
    };
    let unturned = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), (-z).into(), y.into());
    for (i, want) in poses.iter().enumerate() {
        let points: Vec<DVec3> = pose(i, 0, "POSITION").into_iter().map(unturned).collect();
        let normals: Vec<DVec3> = pose(i, 1, "NORMAL").into_iter().map(unturned).collect();
        for (p, q) in points.iter().zip(want) {
            assert!(p.distance(*q) < 1e-6, "{p} for {q}");
        }
        for n in &normals {
            assert!((n.length() - 1.0).abs() < 1e-6);
        }
        assert!(normals[0].distance(DVec3::Z) < 1e-6, "the first triangle stays where it is");
        let angle = normals[0].angle_between(normals[5]).to_degrees();
        assert!((angle - [0.0, 40.0, 90.0][i]).abs() < 1e-3, "{angle}");
        // the two sides of the seam
        let seam = normals[1].angle_between(normals[3]).to_degrees();
        assert!((seam - [0.0, 0.0, 90.0][i]).abs() < 1e-3, "pose {i}: {seam}");
    }
    let animation = &document["animations"][0];
    assert_eq!(animation["channels"][0]["target"], json!({ "node": 0, "path": "weights" }));
    let sampler = &animation["samplers"][0];
    assert_eq!(sampler["interpolation"].as_str().unwrap_or("LINEAR"), "LINEAR");
    assert_eq!(read(&sampler["input"]), [0.0, 0.5, 1.0, 1.5]);
    assert_eq!(read(&sampler["output"]), [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
}

#[test]
fn a_motion_that_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |poses: &[Vec<DVec3>], turns: &[usize], name: &str| {
        let names = names(poses.len());
        let path = folder.path().join(name);
        write_motion(&path, &moving(poses, &names, turns), "", false).unwrap_err().to_string()
    };
    let good = [0.0, 1.0].map(fold);
    assert!(write(&good, &[0, 1], "a.stl").contains("only glb"));
    assert!(write(&good[..1], &[0, 0], "a.glb").contains("two poses"));
    assert!(write(&good, &[0], "a.glb").contains("two turns"));
    assert!(write(&good, &[0, 2], "a.glb").contains("pose 2"));
    let mut short = good.clone();
    short[1].pop();
    assert!(write(&short, &[0, 1], "a.glb").contains("5 points, the first 6"));
    let mut wild = good.clone();
    wild[1][2].x = f64::NAN;
    assert!(write(&wild, &[0, 1], "a.glb").contains("pose t 1: point 2"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_moving_mesh_reads_back_as_its_first_pose() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let poses = [0.3, 1.0].map(fold);
    write_motion(&path, &moving(&poses, &names(2), &[0, 1]), "", false).unwrap();
    // points at one place are read as one, so faces are compared by where they are
    let mesh = read(&path, Assume::default()).unwrap().mesh;
    let first = TriMesh { points: poses[0].clone(), faces: FACES.to_vec() };
    assert_eq!(mesh.faces.len(), FACES.len());
    for i in 0..FACES.len() {
        for (p, q) in mesh.corners(i).iter().zip(first.corners(i)) {
            assert!(p.distance(q) < 1e-6, "{p} for {q}");
        }
    }
}
