//! GLB and glTF with buffers beside it.

use super::{As, Case};

/// The buffer: 48 bytes of points, 24 of indices, of a tetrahedron.
pub fn buffer() -> Vec<u8> {
    let points: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let faces: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let points = points.iter().flatten().flat_map(|x| x.to_le_bytes());
    points.chain(faces.iter().flatten().flat_map(|x| x.to_le_bytes())).collect()
}

const JSON: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"buffers":[{"byteLength":72}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]}"#;

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

pub fn all() -> Vec<Case> {
    [frames(), documents(), places(), bombs()].into_iter().flatten().collect()
}

/// What is wrong with the binary form itself.
fn frames() -> Vec<Case> {
    let whole = glb(JSON, &buffer());
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "m.glb", what, bytes);
    let word = |what: &str, at: usize, word: u32| {
        let mut bytes = glb(JSON, &buffer());
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        new(what, bytes)
    };
    let end = whole.len() - 72 - 8;
    let mut all = vec![
        new("empty", vec![]).says("empty"),
        new("zeros", vec![0; 4096]),
        new("noise", super::meshes::noise(4096, 17)),
        word("another magic", 0, 0x1234_5678),
        word("version 1", 4, 1).says("version 1"),
        word("version 2^32 - 1", 4, u32::MAX).says("version"),
        word("a length of 0", 8, 0),
        word("a length of billions", 8, u32::MAX).says("4294967295"),
        word("a JSON chunk of billions", 12, u32::MAX).says("4294967295"),
        word("a JSON chunk of 3 bytes", 12, 3),
        word("no JSON chunk", 16, 0x1234_5678).says("no JSON"),
        word("a binary chunk of billions", end, u32::MAX).says("4294967295"),
        word("a binary chunk of 8 bytes", end, 8).says("chunk of"),
        word("no binary chunk", end + 4, 0x1234_5678).says("binary chunk"),
        new("a GLB in a GLB", glb(&String::from_utf8_lossy(&whole), &buffer())),
    ];
    for n in [3, 4, 8, 11, 12, 16, 19, 20, 60, end, end + 7, end + 8, whole.len() - 1] {
        all.push(new(&format!("cut at byte {n}"), whole[..n].into()));
    }
    all
}

fn swap(what: &str, from: &str, to: &str) -> Case {
    assert!(JSON.contains(from), "{from}");
    Case::new(As::Mesh, "m.glb", what, glb(&JSON.replacen(from, to, 1), &buffer()))
}

/// What is wrong with the JSON.
fn documents() -> Vec<Case> {
    let new = |what: &str, bytes: &[u8]| Case::new(As::Mesh, "m.gltf", what, bytes);
    let points = r#""componentType":5126,"count":4,"type":"VEC3""#;
    let indices = r#""componentType":5123,"count":12"#;
    let view = r#""buffer":0,"byteLength":48"#;
    let huge = "18446744073709551615";
    let of_points = |what: &str, to: &str| swap(what, points, to).says("accessors[0]");
    let of_view = |what: &str, to: &str| swap(what, view, to).says("bufferViews[0]");
    let of_nodes = |what: &str, to: &str| swap(what, r#"{"mesh":0}"#, to);
    vec![
        new("null", b"null"),
        new("a number", b"1e999"),
        new("an empty list", b"[]"),
        new("not closed", b"{\"asset\":{\"version\":\"2.0\"}"),
        new("100 000 lists in lists", "[".repeat(100_000).as_bytes()),
        new("100 000 objects in objects", "{\"a\":".repeat(100_000).as_bytes()),
        new("not UTF-8", b"{\"asset\":{\"version\":\"\xff\xfe\"}}"),
        new("half a surrogate", br#"{"asset":{"version":"\ud800"}}"#),
        new("version 1", br#"{"asset":{"version":"1.0"}}"#).says("1.0"),
        new("codes for a version", br#"{"asset":{"version":"\u001b[31m\u009b1m\u202e"}}"#),
        new(
            "a version of 1 MB",
            &[br#"{"asset":{"version":""#, &[b'9'; 1 << 20][..], b"\"}}"].concat(),
        ),
        new("no asset", b"{}").says("asset"),
        new("nothing in it", br#"{"asset":{"version":"2.0"}}"#).says("no triangles"),
        new("everything twice", br#"{"asset":{"version":"2.0"},"asset":{"version":"2.0"}}"#),
        swap("scene 7", r#""scene":0"#, r#""scene":7"#).says("scene 7"),
        swap("scene -1", r#""scene":0"#, r#""scene":-1"#),
        swap("node 7", r#""nodes":[0]"#, r#""nodes":[7]"#).says("nodes[7]"),
        swap("node 2^64 - 1", r#""nodes":[0]"#, &format!("\"nodes\":[{huge}]")).says("nodes["),
        of_nodes("mesh 7", r#"{"mesh":7}"#).says("meshes[7]"),
        of_nodes("its own child", r#"{"children":[0]}"#).says("reached twice"),
        of_nodes("a ring of nodes", r#"{"children":[1]},{"children":[2]},{"children":[0]}"#)
            .says("reached twice"),
        of_nodes(
            "two parents",
            r#"{"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0}"#,
        )
        .says("reached twice"),
        of_nodes("a child that is not there", r#"{"children":[9]}"#).says("nodes[9]"),
        of_nodes("a scale beyond f64", r#"{"mesh":0,"scale":[1e999,1,1]}"#),
        of_nodes("a scale of 1e300", r#"{"mesh":0,"scale":[1e300,1e300,1e300]}"#).says("f32"),
        of_nodes(
            "a matrix of 1e308",
            &format!(r#"{{"mesh":0,"matrix":[{}1e308]}}"#, "1e308,".repeat(15)),
        ),
        of_nodes("a matrix of zeros", &format!(r#"{{"mesh":0,"matrix":[{}0]}}"#, "0,".repeat(15))),
        of_nodes("a matrix of three", r#"{"mesh":0,"matrix":[1,2,3]}"#),
        of_nodes("a rotation of nothing", r#"{"mesh":0,"rotation":[0,0,0,0]}"#).harmless(),
        swap("points 7", r#""POSITION":0"#, r#""POSITION":7"#).says("accessors[7]"),
        swap("no points", r#""POSITION":0"#, r#""NORMAL":0"#).says("POSITION"),
        swap("indices 7", r#""indices":1"#, r#""indices":7"#).says("accessors[7]"),
        swap("indices are points", r#""indices":1"#, r#""indices":0"#).says("accessors[0]"),
        swap("points are indices", r#""POSITION":0"#, r#""POSITION":1"#).says("primitives[0]"),
        swap("mode 99", r#""mode":4"#, r#""mode":99"#).says("mode 99"),
        swap("only lines", r#""mode":4"#, r#""mode":1"#).says("no triangles"),
        of_points("no view", &points.replace("\"componentType\"", "\"x\":0,\"componentType\""))
            .harmless(),
        of_points("5 points of 4", r#""componentType":5126,"count":5,"type":"VEC3""#).says("past"),
        of_points("billions of points", r#""componentType":5126,"count":4294967295,"type":"VEC3""#)
            .says("past"),
        of_points(
            "2^64 - 1 points",
            &format!(r#""componentType":5126,"count":{huge},"type":"VEC3""#),
        )
        .says("past"),
        swap("-1 points", points, r#""componentType":5126,"count":-1,"type":"VEC3""#),
        swap("half a point", points, r#""componentType":5126,"count":0.5,"type":"VEC3""#),
        of_points("an offset of 2^64 - 1", &format!(r#""byteOffset":{huge},{points}"#))
            .says("past"),
        of_points("an offset of 2^63", &format!(r#""byteOffset":9223372036854775808,{points}"#)),
        of_points("an unknown type", r#""componentType":5130,"count":4,"type":"VEC3""#),
        of_points("matrices for points", r#""componentType":5126,"count":4,"type":"MAT4""#),
        of_points("codes for a type", r#""componentType":5126,"count":4,"type":"\u001b[31m""#),
        of_points("sparse", &format!(r#"{points},"sparse":{{"count":{huge}}}"#)).says("sparse"),
        swap("billions of indices", indices, r#""componentType":5123,"count":4294967295"#)
            .says("accessors[1]"),
        swap("indices of f32", indices, r#""componentType":5126,"count":6"#).says("accessors[1]"),
        swap("11 indices", indices, r#""componentType":5123,"count":11"#).harmless(),
        swap("no indices", indices, r#""componentType":5123,"count":0"#).says("no triangles"),
        of_view("a view of buffer 7", r#""buffer":7,"byteLength":48"#).says("buffer 7"),
        of_view("a view too long", r#""buffer":0,"byteLength":73"#).says("past"),
        of_view("a view of 2^64 - 1", &format!(r#""buffer":0,"byteLength":{huge}"#)).says("past"),
        of_view(
            "a view from 2^64 - 1",
            &format!(r#""buffer":0,"byteOffset":{huge},"byteLength":48"#),
        ),
        swap("a stride of 0", view, r#""buffer":0,"byteLength":48,"byteStride":0"#)
            .says("byteStride 0"),
        swap("a stride of 1", view, r#""buffer":0,"byteLength":48,"byteStride":1"#)
            .says("byteStride 1"),
        swap("a stride of 252", view, r#""buffer":0,"byteLength":48,"byteStride":252"#)
            .says("past"),
        swap(
            "a stride of 2^64 - 1",
            view,
            &format!(r#""buffer":0,"byteLength":48,"byteStride":{huge}"#),
        )
        .says("past"),
        swap("a view of nothing", view, r#""buffer":0,"byteLength":0"#).says("past"),
        swap("a buffer of billions", r#""byteLength":72"#, r#""byteLength":4294967295"#)
            .says("buffers[0]"),
        swap("a buffer of 2^64 - 1", r#""byteLength":72"#, &format!("\"byteLength\":{huge}"))
            .says("buffers[0]"),
        swap(
            "a packed mesh",
            r#""scene":0"#,
            r#""extensionsRequired":["KHR_draco_mesh_compression"],"scene":0"#,
        )
        .says("without compression"),
        swap(
            "a need in codes",
            r#""scene":0"#,
            r#""extensionsRequired":["\u001b[31m\u009b\u202e"],"scene":0"#,
        )
        .says("extensionsRequired"),
        swap(
            "a need of 1 MB",
            r#""scene":0"#,
            &format!(r#""extensionsRequired":["{}"],"scene":0"#, "x".repeat(1 << 20)),
        )
        .says("extensionsRequired"),
        swap(
            "instances by extension",
            r#""scene":0"#,
            r#""extensionsRequired":["EXT_mesh_gpu_instancing"],"scene":0"#,
        ),
    ]
}

/// Buffers that are not in the folder, or are no files.
pub fn places() -> Vec<Case> {
    let of = |what: &str, uri: &str| {
        let json =
            JSON.replacen(r#""byteLength":72"#, &format!(r#""uri":"{uri}","byteLength":72"#), 1);
        Case::new(As::Mesh, "m.gltf", what, json).says("buffers[0]")
    };
    let mut all = vec![
        of("missing", "missing.bin"),
        of("above", "../trap.bin"),
        of("above by a folder", "sub/../../trap.bin"),
        of("above, coded", "%2e%2e/trap.bin"),
        of("above, all coded", "%2e%2e%2ftrap.bin"),
        of("above, coded twice", "%252e%252e%252ftrap.bin"),
        of("above with a backslash", "..\\\\trap.bin"),
        of("above by a link", "link.bin"),
        of("absolute", "/etc/passwd"),
        of("absolute, coded", "%2fetc%2fpasswd"),
        of("a file: address", "file:///etc/passwd"),
        of("a file: address, coded", "file%3a%2f%2f%2fetc%2fpasswd"),
        of("a web address", "http://127.0.0.1/trap.bin"),
        of("another machine", "//127.0.0.1/share/trap.bin"),
        of("a drive", "c:/trap.bin"),
        of("a query", "trap.bin?x=1"),
        of("a pipe", "pipe.bin"),
        of("a device", "zero.bin"),
        of("a device by name", "/dev/zero"),
        of("what the process itself is", "/proc/self/environ"),
        of("a folder", "sub"),
        of("its own folder", "."),
        of("nothing", ""),
        of("a dangling link", "dangling.bin"),
        of("a link to itself", "loop.bin"),
        of("a zero within", "a\\u0000b.bin"),
        of("codes", "\\u001b[31m\\u009b1m\\u202e.bin"),
        of("coded codes", "%1b%5b31m%c2%9b1m.bin"),
        of("a bad percent", "a%zz.bin"),
        of("not UTF-8 once decoded", "%ff%fe.bin"),
        of("a name of 1 MB", &"n".repeat(1 << 20)),
        of("data that is no base64", "data:text/plain,hello"),
        of("data with broken base64", "data:application/octet-stream;base64,!!!!"),
        of("data that is too short", "data:application/octet-stream;base64,AAAA"),
        of("data without end", "data:"),
    ];
    all.push(of("a buffer cut short", "short.bin").beside("short.bin", &buffer()[..71]));
    let mut itself = of("the file itself", "m.gltf");
    itself.says.clear();
    all.push(itself);
    all
}

/// Small files that would unfold to large ones.
fn bombs() -> Vec<Case> {
    let new = |what: &str, json: &str| Case::new(As::Mesh, "m.glb", what, glb(json, &buffer()));
    let nodes = |n: usize| {
        let ids: Vec<String> = (1..=n).map(|i| i.to_string()).collect();
        let leaves = vec![r#"{"mesh":0}"#; n].join(",");
        JSON.replacen(
            r#"{"mesh":0}"#,
            &format!(r#"{{"children":[{}]}},{leaves}"#, ids.join(",")),
            1,
        )
    };
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1,"mode":4}"#;
    let many = |json: &str, n: usize| json.replacen(primitive, &vec![primitive; n].join(","), 1);
    let copies = |n: usize| {
        let uri = r#"{"uri":"m.bin","byteLength":72},"#.repeat(n);
        JSON.replacen(r#"{"byteLength":72}"#, &format!(r#"{}{{"byteLength":72}}"#, uri), 1)
    };
    let data = format!(r#"{{"uri":"data:;base64,{}","byteLength":72}}"#, "A".repeat(1 << 20));
    let data = vec![data; 8].join(",");
    vec![
        new("3 million instances", &many(&nodes(3000), 1000)).says("instances"),
        new("as many instances as are read", &many(&nodes(700), 700)).harmless(),
        new("100 000 nodes of the same mesh", &nodes(100_000)).harmless(),
        new("100 000 primitives", &many(JSON, 100_000)).harmless(),
        Case::new(As::Mesh, "m.gltf", "a buffer 100 000 times", copies(100_000))
            .beside("m.bin", buffer())
            .says("buffers[100000]"),
        new("1 MB of data eight times", &JSON.replacen(r#"{"byteLength":72}"#, &data, 1))
            .harmless(),
    ]
}
