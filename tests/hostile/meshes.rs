//! OBJ, STL and PLY.

use super::{As, Case, links};

/// A tetrahedron of 10 mm.
pub const OBJ: &str = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const POINTS: [[f32; 3]; 4] = [[0., 0., 0.], [10., 0., 0.], [0., 10., 0.], [0., 0., 10.]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

pub fn all() -> Vec<Case> {
    [obj(), stl(), ascii_stl(), ply(), binary_ply(), links::others()].concat_all()
}

trait ConcatAll {
    fn concat_all(self) -> Vec<Case>;
}

impl<const N: usize> ConcatAll for [Vec<Case>; N] {
    fn concat_all(self) -> Vec<Case> {
        self.into_iter().flatten().collect()
    }
}

/// Bytes that look like nothing (Marsaglia's xorshift).
pub fn noise(n: usize, seed: u64) -> Vec<u8> {
    let mut x = seed;
    let mut next = || {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        x as u8
    };
    (0..n).map(|_| next()).collect()
}

fn obj() -> Vec<Case> {
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "m.obj", what, bytes);
    let line = |what: &str, line: &str| new(what, format!("{OBJ}{line}\n").into_bytes());
    let mut all = vec![
        new("empty", vec![]).says("empty"),
        new("blanks", b" \n\t\n\r\n".to_vec()).says("no triangles"),
        new("a comment", b"# only".to_vec()).says("no triangles"),
        new("zeros", vec![0; 4096]).says("no triangles"),
        new("noise", noise(4096, 7)),
        new("points only", OBJ[..40].into()),
        new("UTF-16", OBJ.encode_utf16().flat_map(u16::to_le_bytes).collect()),
        new("a page", b"<!DOCTYPE html><html><body>404</body></html>".to_vec()),
        new("gzip", b"\x1f\x8b\x08\0\0\0\0\0".to_vec()),
        new("cut within a point", OBJ.as_bytes()[..13].into()).says("missing"),
        new("corners only", "f 1 2 3\n".repeat(10_000).into_bytes()).says("line 1"),
        new("every face one point", format!("v 0 0 0\n{}", "f 1 1 1\n".repeat(50_000)).into()),
        new("a face in a line", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec()),
        new("one triangle", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec()).says("thicken"),
        new("twice, back to back", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n".to_vec())
            .says("thicken"),
    ];
    for (what, text) in [
        ("point 0", "f 0 1 2"),
        ("a point too far", "f 1 2 5"),
        ("before the first", "f 1 2 -5"),
        ("2^31", "f 1 2 2147483648"),
        ("2^32 - 1", "f 1 2 4294967295"),
        ("2^32 + 1", "f 1 2 4294967297"),
        ("-2^31", "f 1 2 -2147483648"),
        ("-2^63", "f 1 2 -9223372036854775808"),
        ("beyond 2^64", "f 1 2 99999999999999999999"),
        ("a fraction", "f 1 2 1.5"),
        ("letters", "f a b c"),
        ("slashes", "f / / /"),
        ("NaN", "v nan 0 0\nf 1 2 5"),
        ("infinity", "v 0 inf 0\nf 1 2 5"),
        ("-infinity", "v 0 0 -infinity\nf 1 2 5"),
        ("beyond f32", "v 0 0 1e39\nf 1 2 5"),
        ("beyond f64", "v 0 0 1e999\nf 1 2 5"),
        ("hexadecimal", "v 0 0 0x10"),
        ("a comma", "v 0,5 0 0"),
        ("two points in a number", "v 1.2.3 0 0"),
        ("a missing coordinate", "v 1 2"),
        ("escape codes for a number", "v \x1b[2J\x1b[31m 0 0"),
        ("a bell for a corner", "f 1 2 \x07\x08\x7f"),
        ("a C1 code for a corner", "f 1 2 \u{9b}31m"),
        ("text turned round", "f 1 2 \u{202e}3"),
        ("a line that goes on for ever", "f 1 2 99 \\\n\\\n\\"),
    ] {
        all.push(line(what, text).says("line"));
    }
    let ring = |n: usize| (1..=n).map(|i| format!(" {}", 1 + i % 4)).collect::<String>();
    all.push(line("not UTF-8 in a number", "").with(b"v \xff\xfe 0 0\n").says("line 10"));
    all.push(line("a number of 1 MB", &format!("v {} 0 0", "9".repeat(1 << 20))).harmless());
    all.push(line("a word of 1 MB", &format!("f 1 2 {}", "x".repeat(1 << 20))).says("line 9"));
    all.push(line("a face of 100 000 corners", &format!("f{}", ring(100_000))).harmless());
    all.push(line("a spiral of 1200 corners", &spiral(1200)).harmless());
    all.push(line("a spiral of 20 000 corners", &spiral(20_000)).harmless());
    all.push(line("a face too far in 100 000 corners", &format!("f{} 99", ring(100_000))));
    all.push(line("nothing but backslashes", &"\\\n".repeat(20_000)).harmless());
    all.push(line("a material from outside", "mtllib ../../../etc/passwd").harmless());
    all.push(line("a material from a pipe", "mtllib pipe.bin\nusemtl a").harmless());
    all.push(line("a call of another file", "call ../trap.obj 1 2").harmless());
    all.push(line("codes in a name", "o \x1b]0;title\x07\ng \x1b[31m\nusemtl \u{9b}1m").harmless());
    all.push(line("a name that is not UTF-8", "").with(b"o caf\xe9 \xff\xfe\n").harmless());
    all
}

/// A strip wound up in the plane: the worst for a cutter of ears.
fn spiral(corners: usize) -> String {
    let half = corners / 2;
    let at = |i: usize, out: f64| {
        let a = i as f64 * 0.2;
        let r = 1.0 + a * 0.3 + out;
        format!("v {:.4} {:.4} 0\n", r * a.cos(), r * a.sin())
    };
    let there = (0..half).map(|i| at(i, 0.0));
    let back = (0..half).rev().map(|i| at(i, 0.5));
    let points: String = there.chain(back).collect();
    points + "f" + &(0..2 * half).map(|i| format!(" {}", i + 5)).collect::<String>()
}

impl Case {
    /// With these bytes at the end.
    fn with(mut self, tail: &[u8]) -> Self {
        self.bytes.extend(tail);
        self
    }
}

fn stl_bytes() -> Vec<u8> {
    let mut out = vec![b' '; 80];
    out.extend(4u32.to_le_bytes());
    for face in FACES {
        out.extend([0; 12]);
        out.extend(face.iter().flat_map(|&v| POINTS[v as usize]).flat_map(f32::to_le_bytes));
        out.extend([0, 0]);
    }
    out
}

fn stl() -> Vec<Case> {
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "m.stl", what, bytes);
    let whole = stl_bytes();
    let put = |at: usize, bytes: &[u8]| {
        let mut out = stl_bytes();
        out[at..at + bytes.len()].copy_from_slice(bytes);
        out
    };
    let mut all = vec![
        new("empty", vec![]).says("empty"),
        new("zeros", vec![0; 4096]).says("no triangles"),
        new("ones", vec![0xff; 4096]).says("4294967295 triangles"),
        new("noise", noise(4096, 11)).says("triangles would take"),
        new("no triangles claimed", put(80, &0u32.to_le_bytes())).says("no triangles"),
        new("one triangle too many", put(80, &5u32.to_le_bytes())).says("5 triangles"),
        new("billions of triangles", put(80, &u32::MAX.to_le_bytes())).says("4294967295"),
        new("fewer than there are", put(80, &3u32.to_le_bytes())).harmless(),
        new("codes in the header", put(0, b"\x1b[31mred\x1b]0;title\x07")).harmless(),
    ];
    for n in [1, 40, 80, 83, 84, 85, 133, 134, 283] {
        all.push(new(&format!("cut at byte {n}"), whole[..n].into()));
    }
    for (what, x) in [
        ("NaN", f32::NAN),
        ("infinity", f32::INFINITY),
        ("-infinity", f32::NEG_INFINITY),
        ("a NaN with a message", f32::from_bits(0x7fa0_1234)),
    ] {
        all.push(new(what, put(84 + 12, &x.to_le_bytes())).says("not finite"));
    }
    for (what, x) in [("the largest f32", f32::MAX), ("the least f32", f32::from_bits(1))] {
        all.push(new(what, put(84 + 12, &x.to_le_bytes())).harmless());
    }
    let mut tiny = stl_bytes();
    tiny[84..].iter_mut().skip(3).step_by(4).for_each(|b| *b = 0);
    all.push(new("exponents taken away", tiny).harmless());
    all
}

fn ascii_stl() -> Vec<Case> {
    let facet = |face: [u32; 3]| {
        let corners = face.map(|v| {
            let [x, y, z] = POINTS[v as usize];
            format!("vertex {x} {y} {z}\n")
        });
        format!("facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    let text = format!("solid a\n{}endsolid a\n", FACES.map(facet).concat());
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "a.stl", what, bytes);
    let swap = |what: &str, from: &str, to: &str| {
        assert!(text.contains(from));
        new(what, text.replacen(from, to, 1).into_bytes())
    };
    let mut all = vec![
        new("only its first word", b"solid".to_vec()),
        new("a name of 1 MB", format!("solid {}", "n".repeat(1 << 20)).into_bytes()),
        swap("NaN", "vertex 0 0 0", "vertex nan 0 0").says("line 4"),
        swap("infinity", "vertex 0 0 0", "vertex 1e400 0 0").says("line 4"),
        swap("letters", "vertex 0 0 0", "vertex a b c").says("line 4"),
        swap("two coordinates", "vertex 0 0 0", "vertex 0 0").says("line 4"),
        swap("no loop", "outer loop\n", "").says("line 3"),
        swap("a loop in a loop", "outer loop", "outer loop\nfacet").says("line 4"),
        swap("an end too many", "endfacet", "endloop").says("line 8"),
        swap("codes for a word", "endfacet", "\x1b[31m").says("no word"),
        swap("C1 codes for a word", "endfacet", "\u{9b}31m\u{202e}").says("no word"),
        swap("no end", "endsolid a\n", "").says("cut short"),
        swap("zeros within", "vertex 0 0 0", "vertex 0\0 0 0"),
        swap("codes in the name", "solid a", "solid \x1b[2J\u{9b}31m").harmless(),
        swap("a facet of two corners", "vertex 0 0 0\n", "").harmless(),
    ];
    for n in [30, 60, 75, 110, 200, 350] {
        all.push(new(&format!("cut at byte {n}"), text.as_bytes()[..n].into()).says("line"));
    }
    let binary = [b"solid ".as_slice(), &stl_bytes()[6..200]].concat();
    all.push(new("binary, and cut, but says solid", binary));
    all
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

fn ply() -> Vec<Case> {
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "m.ply", what, bytes);
    let swap = |what: &str, from: &str, to: &str| {
        assert!(PLY.contains(from), "{from}");
        new(what, PLY.replacen(from, to, 1).into_bytes())
    };
    let mut all = vec![
        new("empty", vec![]).says("empty"),
        new("noise", noise(4096, 13)).says("line 1"),
        new("only its first word", b"ply".to_vec()).says("cut short"),
        new("a header without end", format!("ply\n{}", "comment x\n".repeat(50_000)).into()),
        swap("no format", "format ascii 1.0\n", "").says("no format"),
        swap("an unknown format", "ascii", "binary_middle_endian").says("line 2"),
        swap("codes for a format", "ascii", "\x1b[31m\u{9b}1m").says("line 2"),
        swap("binary, but text", "ascii", "binary_little_endian"),
        swap("-1 points", "vertex 4", "vertex -1").says("line 3"),
        swap("billions of points", "vertex 4", "vertex 4000000000").says("4000000000 rows"),
        swap("2^64 - 1 points", "vertex 4", "vertex 18446744073709551615").says("rows"),
        swap("more than 2^64 points", "vertex 4", "vertex 99999999999999999999").says("line 3"),
        swap("a count in words", "vertex 4", "vertex four").says("line 3"),
        swap("no count", "vertex 4", "vertex").says("line 3"),
        swap("fewer points than are used", "vertex 4", "vertex 3"),
        swap("more points than there are", "vertex 4", "vertex 5"),
        swap("billions of faces", "face 4", "face 4000000000").says("4000000000 rows"),
        swap("one face too many", "face 4", "face 5").says("cut short"),
        swap("an unknown type", "float x", "quad x").says("line 4"),
        swap("no name", "property float x", "property float").says("line 4"),
        swap("no x", "float x", "float w").says("x, y and z"),
        swap("no corners", "vertex_indices", "names").says("vertex_indices"),
        swap("corners that are no list", "list uchar int", "int").says("vertex_indices"),
        swap("a list of lists", "uchar int", "list uchar").says("line 8"),
        swap("a property of nothing", "element vertex 4\n", "property float a\n").says("line 3"),
        swap("an unknown word", "end_header", "\x1b[2J").says("unknown header word"),
        swap("codes for an element", "element face 4", "element \x1b[31m 9").harmless(),
        swap("no end of the header", "end_header", "").says("line"),
        swap("a corner too far", "3 0 2 1", "3 0 2 4").says("point 4"),
        swap("corner -1", "3 0 2 1", "3 0 2 -1").says("-1"),
        swap("corner 1e30", "3 0 2 1", "3 0 2 1e30").says("no index"),
        swap("corner NaN", "3 0 2 1", "3 0 2 nan").says("no index"),
        swap("a list of 2 billion", "3 0 2 1", "2000000000 0 2 1").says("list of"),
        swap("a list of -3", "3 0 2 1", "-3 0 2 1").says("list of"),
        swap("a list of NaN", "3 0 2 1", "nan 0 2 1").says("list of"),
        swap("NaN", "0 10 0", "0 nan 0").says("not finite"),
        swap("infinity", "0 10 0", "0 1e400 0").says("not finite"),
        swap("letters", "0 10 0", "0 \x1b[31m 0").says("not a number"),
        swap("strips", "element face 4", "element tristrips 4").says("tristrips"),
        swap("rows of no bytes", "element face", "element dust 4000000000\nelement face")
            .harmless(),
        swap("two lists of points", "element face 4", "element vertex 1\nelement face 4"),
        swap(
            "100 000 properties",
            "element face",
            &format!("{}element face", "property float q\n".repeat(100_000)),
        ),
        swap(
            "100 000 elements",
            "element face",
            &format!("{}element face", "element e 0\n".repeat(100_000)),
        )
        .harmless(),
    ];
    for n in [20, 60, 140, 170, 180, 190, 205] {
        all.push(new(&format!("cut at byte {n}"), PLY.as_bytes()[..n].into()));
    }
    all
}

fn binary_ply() -> Vec<Case> {
    let header = |count: &str, index: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n\
             property float y\nproperty float z\nelement face 4\n\
             property list {count} {index} vertex_indices\nend_header\n"
        )
    };
    let body = |first: &[u8]| {
        let points = POINTS.iter().flatten().flat_map(|x| x.to_le_bytes());
        let rest = FACES[1..].iter().flat_map(|f| {
            let corners = f.iter().flat_map(|v| v.to_le_bytes());
            [3u8].into_iter().chain(corners).collect::<Vec<_>>()
        });
        points.chain(first.iter().copied()).chain(rest).collect::<Vec<u8>>()
    };
    let file = |count: &str, index: &str, first: &[u8]| {
        [header(count, index).into_bytes(), body(first)].concat()
    };
    let face = |n: u8, corners: [u32; 3]| {
        [n].into_iter().chain(corners.iter().flat_map(|v| v.to_le_bytes())).collect::<Vec<u8>>()
    };
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Mesh, "b.ply", what, bytes);
    let whole = file("uchar", "int", &face(3, FACES[0]));
    let mut all = vec![
        new("a list of 255", file("uchar", "int", &face(255, FACES[0]))),
        new("a list of -1", file("char", "int", &face(255, FACES[0]))).says("list of -1"),
        new("a list of 4 billion", file("uint", "int", &[0xff; 16])).says("list of 4294967295"),
        new("a list of NaN", file("float", "int", &f32::NAN.to_le_bytes())).says("list of NaN"),
        new("a list of 1e300", file("double", "int", &1e300f64.to_le_bytes())).says("list of"),
        new("a corner of -1", file("uchar", "int", &face(3, [0, 2, u32::MAX]))).says("-1"),
        new("a corner of 2^32 - 1", file("uchar", "uint", &face(3, [0, 2, u32::MAX]))),
        new("a corner of NaN", file("uchar", "float", &face(3, [0, 0, 0x7fc0_0000]))).says("NaN"),
        new("the other byte order", {
            let text = String::from_utf8_lossy(&whole).find("little").unwrap();
            let mut bytes = whole.clone();
            bytes.splice(text..text + 6, *b"big");
            bytes
        }),
    ];
    let start = whole.len() - body(&face(3, FACES[0])).len();
    for n in [start, start + 5, start + 48, start + 49, start + 60, whole.len() - 1] {
        all.push(new(&format!("cut at byte {n}"), whole[..n].into()));
    }
    let mut nan = whole;
    nan[start..start + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    all.push(new("NaN", nan).says("not finite"));
    all
}
