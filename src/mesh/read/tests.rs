use super::*;
use glam::DVec3;

mod bad;
mod geometry;
mod mutations;

/// Reads bytes as a file of that extension, in the format's own axes and unit.
fn parsed(bytes: &[u8], extension: &str) -> Result<Loaded, String> {
    let format = Format::of(&Path::new("mesh").with_extension(extension)).unwrap();
    let loaded = load(bytes, format, Path::new("/nowhere"), Assume::default());
    loaded.map_err(|f| format!("{}: {}", f.place, f.why))
}

/// The same without turning or scaling.
fn as_is(bytes: &[u8], extension: &str) -> Loaded {
    let format = Format::of(&Path::new("mesh").with_extension(extension)).unwrap();
    let assume = Assume { up: Some(Up::Z), unit: Some(Unit::Mm) };
    match load(bytes, format, Path::new("/nowhere"), assume) {
        Ok(loaded) => loaded,
        Err(f) => panic!("{}: {}", f.place, f.why),
    }
}

/// A tetrahedron over the origin and the three axes.
const POINTS: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn tetrahedron() -> TriMesh {
    let points = POINTS.map(|p| DVec3::from(p.map(f64::from))).to_vec();
    TriMesh { points, faces: FACES.to_vec() }
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut out = header.to_vec();
    out.resize(80, 0);
    out.extend(4u32.to_le_bytes());
    for face in FACES {
        out.extend([0; 12]);
        out.extend(face.iter().flat_map(|&v| POINTS[v as usize]).flat_map(f32::to_le_bytes));
        out.extend([7, 7]);
    }
    out
}

fn ascii_stl() -> String {
    let mut out = "solid a name with words\n".to_owned();
    for face in FACES {
        out += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in face.map(|v| POINTS[v as usize]) {
            out += &format!("   vertex {x:e} {y} {z}\n");
        }
        out += "  endloop\n endfacet\n";
    }
    out + "endsolid a name with words\n"
}

/// With more properties and elements than are read.
fn ply(format: &str) -> Vec<u8> {
    let mut out = format!(
        "ply\r\nformat {format} 1.0\r\ncomment made by hand\r\nelement camera 1\r\n\
         property list uchar short view\r\nelement vertex 4\r\nproperty uchar red\r\n\
         property double x\r\nproperty float y\r\nproperty short z\r\nelement face 4\r\n\
         property int id\r\nproperty list uchar uint vertex_index\r\n\
         property list int float uv\r\nelement nothing 4000000000\r\nend_header\r\n"
    )
    .into_bytes();
    let big = format.contains("big");
    let mut put = |le: &[u8]| {
        if format == "ascii" {
            return;
        }
        if big { out.extend(le.iter().rev()) } else { out.extend(le) }
    };
    put(&[2]);
    put(&5i16.to_le_bytes());
    put(&(-6i16).to_le_bytes());
    for [x, y, z] in POINTS {
        put(&[200]);
        put(&f64::from(x).to_le_bytes());
        put(&y.to_le_bytes());
        put(&(z as i16).to_le_bytes());
    }
    for face in FACES {
        put(&9i32.to_le_bytes());
        put(&[3]);
        face.iter().for_each(|v| put(&v.to_le_bytes()));
        put(&1i32.to_le_bytes());
        put(&0.5f32.to_le_bytes());
    }
    if format == "ascii" {
        let mut text = "2 5 -6\n".to_owned();
        POINTS.iter().for_each(|[x, y, z]| text += &format!("200 {x} {y} {z}\n"));
        FACES.iter().for_each(|[a, b, c]| text += &format!("9 3 {a} {b} {c} 1 0.5\n"));
        out.extend(text.into_bytes());
    }
    out
}

const OBJ: &str = "# a comment\nmtllib ../../outside.mtl\no name\nv 0 0 0\nv 1 0 0 1 0.5 0.5 0.5\n\
    v 0 1e0 0\nv 0 \\\n  0 1\nvt 0 0\nvn 0 0 1\ng g\nusemtl m\ns off\nf 1/1/1 3//1 2/1\n\
    f -4 -3 -1\nf 2 3 \\\r\n 4 # tail\nl 1 2\nf 3 1 4\n";

/// A glTF with the tetrahedron in one buffer: 48 bytes of points, 24 of u16 indices.
fn gltf_json(buffer: &str, nodes: &str, primitive: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{{primitive}}}]}}],
        "buffers":[{{{buffer}"byteLength":72}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}]}}"#
    )
}

const PLAIN: &str = r#""attributes":{"POSITION":0},"indices":1"#;

fn gltf_bytes() -> Vec<u8> {
    let points = POINTS.iter().flatten().flat_map(|x| x.to_le_bytes());
    points.chain(FACES.iter().flatten().flat_map(|&v| (v as u16).to_le_bytes())).collect()
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((28 + json.len() + binary.len()) as u32).to_le_bytes());
    for (chunk, kind) in [(json.as_slice(), b"JSON"), (binary, b"BIN\0")] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

fn glb_of(nodes: &str) -> Vec<u8> {
    glb(&gltf_json("", nodes, PLAIN), &gltf_bytes())
}

/// One small valid file of every kind.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let data = "\"uri\":\"data:application/octet-stream;base64,";
    let data = format!("{data}{}\",", base64(&gltf_bytes()));
    vec![
        ("obj", OBJ.into()),
        ("stl", binary_stl(b"binary")),
        ("stl", ascii_stl().into()),
        ("ply", ply("ascii")),
        ("ply", ply("binary_little_endian")),
        ("ply", ply("binary_big_endian")),
        ("glb", glb_of(r#"{"mesh":0}"#)),
        ("gltf", gltf_json(&data, r#"{"mesh":0,"scale":[1,1,1]}"#, PLAIN).into()),
    ]
}

fn base64(bytes: &[u8]) -> String {
    const ABC: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let words = bytes.chunks(3).map(|c| c.iter().fold(0, |w, &b| w << 8 | u32::from(b)));
    words.flat_map(|w| [18, 12, 6, 0].map(|s| char::from(ABC[(w >> s & 63) as usize]))).collect()
}
