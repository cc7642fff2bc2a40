//! Recipes and solids, TOML and JSON.

use super::{As, Case};

const RECIPE: &str = r#"version = 1
[grid]
resolution = 8
[shapes.a]
solid = { parts = [{ box = { center = [0, 0, 5], size = [20, 20, 10] } }] }
[shapes.b]
solid = { parts = [{ ellipsoid = { center = [0, 0, 5], size = [20, 20, 10] } }] }
[[features]]
name = "body"
on.a.box = { center = [0, 0, 5], size = [22, 22, 12], rotate_deg = [0, 0, 0] }
on.b.box = { center = [0, 0, 5], size = [22, 22, 12] }
[morph]
method = "linear"
between = ["a", "b"]
t = [0.5]
[output]
mesh = "m-{t}.stl"
"#;

fn swap(what: &str, from: &str, to: &str) -> Case {
    assert!(RECIPE.contains(from), "{from}");
    Case::new(As::Recipe, "r.toml", what, RECIPE.replacen(from, to, 1))
}

pub fn all() -> Vec<Case> {
    [texts(), json(), numbers(), meanings(), places()].into_iter().flatten().collect()
}

/// So many headings of so many dots each.
fn headings(n: usize, dots: usize) -> Vec<u8> {
    (0..n).map(|i| format!("[t{i}{}]\n", ".a".repeat(dots))).collect::<String>().into()
}

/// A list of one thing over and over.
fn many(what: &str, n: usize) -> Vec<u8> {
    format!("version = [{}]\n", what.repeat(n)).into()
}

/// What is no TOML.
fn texts() -> Vec<Case> {
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Recipe, "r.toml", what, bytes);
    let after = |what: &str, tail: &str| new(what, format!("{RECIPE}{tail}").into_bytes());
    let mut all = vec![
        new("empty", vec![]).says("missing key"),
        new("zeros", vec![0; 4096]),
        new("noise", super::meshes::noise(4096, 19)),
        new("UTF-16", RECIPE.encode_utf16().flat_map(u16::to_le_bytes).collect()),
        new("not UTF-8", b"version = 1\nname = \"\xff\xfe\"\n".to_vec()).says("UTF-8"),
        new("half a surrogate", b"version = 1\nname = \"\\ud800\"\n".to_vec()),
        new("17 MB", vec![b'#'; 17 << 20]).says("at most"),
        new("1 MB of comment", vec![b'#'; 1 << 20]),
        new("50 000 keys", (0..50_000).map(|i| format!("k{i}=1\n")).collect::<String>().into()),
        new("100 000 lists in lists", format!("version = {}", "[".repeat(100_000)).into()),
        new(
            "10 000 closed lists in lists",
            format!("version = {}{}", "[".repeat(10_000), "]".repeat(10_000)).into(),
        ),
        new("100 000 tables in tables", format!("version = {}", "{a=".repeat(100_000)).into()),
        new("a key of 100 000 dots", format!("a{} = 1", ".a".repeat(100_000)).into()),
        new("a table of 100 000 dots", format!("[a{}]", ".a".repeat(100_000)).into()),
        new(
            "60 tables of 60 dots",
            (0..60).map(|i| format!("[t{i}{}]\n", ".a".repeat(60))).collect::<String>().into(),
        ),
        new("300 tables of 60 dots", headings(300, 60)).says("r.toml:"),
        // as many as are read, and too many
        new("24 000 tables", headings(24_000, 1)).says("unknown key"),
        new("40 000 tables of 3 dots", headings(40_000, 3)).says("too many tables"),
        new("tables of 70 dots", headings(1, 70)).says("r.toml:1: nested deeper than 64"),
        new("200 000 tables in a list", many("{a=1},", 200_000)).says("r.toml:1: too many"),
        new("36 000 tables in a list", many("{a=1},", 36_000)).says("r.toml:1: version"),
        new("250 000 numbers in a list", many("1,", 250_000)).says("r.toml:1: version"),
        new("700 000 numbers in a list", many("1,", 700_000)).says("too many"),
        new("400 000 lists in a list", many("[],", 400_000)).says("too many"),
        new("100 000 lists in a list", many("[],", 100_000)).says("r.toml:1: version"),
        new("10 000 lists of 60", many(&format!("{}{},", "[".repeat(60), "]".repeat(60)), 10_000))
            .says("too many"),
        new(
            "a long key over 250 000 numbers",
            format!("{} = [{}]\n", "k".repeat(900), "1,".repeat(250_000)).into(),
        )
        .says("r.toml:1"),
        new(
            "a key of 500 kB over 100 000 keys",
            (0..100_000)
                .fold(format!("[{}]\n", "k".repeat(500_000)), |t, i| t + &format!("k{i}=1\n"))
                .into(),
        )
        .says("r.toml:1"),
        after("a string without end", "name = \"abc").says("r.toml:18"),
        after("a text without end", "name = '''\nabc\n").says("r.toml:"),
        after("a key twice", "mesh = \"x.stl\"\n").says("r.toml:18"),
        after("a table twice", "[grid]\n").says("r.toml:18"),
        after("codes in a key", "\"\\u001b[31m\\u009b1m\\u202e\" = 1\n").says("r.toml:18"),
        after("plain codes", "\x1b[31m = 1\n").says("r.toml:18"),
        after("codes in a value", "mesher = \"\\u001b[2J\\u0007\\u009b\"\n").says("r.toml:18"),
        after("a line break in a value", "mesher = \"a\\nerror: b\\n\\n\\n\"\n").says("r.toml:18"),
        after("a key of 1 MB", &format!("{} = 1\n", "k".repeat(1 << 20))).says("r.toml:18"),
        after("a value of 1 MB", &format!("mesher = \"{}\"\n", "v".repeat(1 << 20))),
        after("a number of 1 MB", &format!("fps = {}\n", "9".repeat(1 << 20))).says("r.toml:18"),
    ];
    for n in [1, 8, 20, 45, 70, 260, 400] {
        all.push(new(&format!("cut at byte {n}"), RECIPE.as_bytes()[..n].into()));
    }
    all
}

fn json() -> Vec<Case> {
    let value: toml::Table = RECIPE.parse().unwrap();
    let text = serde_json::to_string_pretty(&value).unwrap();
    let new = |what: &str, bytes: Vec<u8>| Case::new(As::Recipe, "r.json", what, bytes);
    let swap = |what: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from} in {text}");
        new(what, text.replacen(from, to, 1).into())
    };
    let mut all = vec![
        new("empty", vec![]),
        new("null", b"null".to_vec()),
        new("a list", b"[1,2,3]".to_vec()),
        new("not UTF-8", b"{\"version\":1,\"name\":\"\xff\"}".to_vec()).says("UTF-8"),
        new("100 000 lists", "[".repeat(100_000).into()),
        new("100 000 objects", "{\"a\":".repeat(100_000).into()),
        new("200 000 objects in a list", format!("[{}1]", "{},".repeat(200_000)).into())
            .says("too many"),
        new(
            "a key of 500 kB over 100 000 numbers",
            format!("{{\"{}\": [{}1]}}", "k".repeat(500_000), "1,".repeat(100_000)).into(),
        ),
        new("60 lists, then none", format!("{}{}", "[".repeat(60), "]".repeat(60)).into()),
        new("a mark and nothing", b"\xef\xbb\xbf".to_vec()),
        swap("NaN", "\"version\": 1", "\"version\": NaN").says("r.json:"),
        swap("beyond f64", "\"version\": 1", "\"version\": 1e999").says("r.json:"),
        swap("version -1", "\"version\": 1", "\"version\": -1").says("version"),
        swap("version in words", "\"version\": 1", "\"version\": \"\\u001b[31m\"").says("version"),
        swap("a key twice", "\"version\": 1", "\"version\": 1, \"version\": 1").says("version"),
        swap("codes in a key", "\"version\": 1", "\"version\": 1, \"\\u001b[31m\\u009b\": 1"),
        swap("a comma too many", "\"version\": 1", "\"version\": 1,,"),
        new("something after it", format!("{text} x").into()).says("r.json:"),
    ];
    for n in [1, 10, 100, 300, 600] {
        all.push(new(&format!("cut at byte {n}"), text.as_bytes()[..n].into()));
    }
    all
}

/// Numbers that cannot be.
fn numbers() -> Vec<Case> {
    let mut all = vec![];
    for (key, from, values) in [
        (
            "version",
            "version = 1",
            &["0", "2", "-1", "1.5", "\"1\"", "99999999999999999999", "nan", "[1]"][..],
        ),
        (
            "resolution",
            "resolution = 8",
            &["0", "-1", "3", "16385", "4294967295", "4294967296", "8.5", "inf", "\"8\""],
        ),
        ("voxel", "resolution = 8", &["0", "-1", "nan", "inf", "-inf", "1e999"]),
        ("padding", "resolution = 8", &["-1", "nan", "inf", "1e308"]),
        (
            "size",
            "size = [20, 20, 10]",
            &[
                "[0, 0, 0]",
                "[-1, 1, 1]",
                "[nan, 1, 1]",
                "[inf, 1, 1]",
                "[1, 1]",
                "[1, 1, 1, 1]",
                "1",
                "\"x\"",
            ],
        ),
        (
            "center",
            "center = [0, 0, 5]",
            &["[nan, 0, 0]", "[inf, 0, 0]", "[0]", "[0, 0, 0, 0]", "{}"],
        ),
        (
            "rotate_deg",
            "rotate_deg = [0, 0, 0]",
            &["[nan, 0, 0]", "[0, inf, 0]", "[]", "[0, 0, 0, 0]"],
        ),
        (
            "t",
            "t = [0.5]",
            &[
                "[nan]",
                "[inf]",
                "[-0.1]",
                "[1.1]",
                "[]",
                "\"0:1:0\"",
                "\"0:1:1e-9\"",
                "\"0:1:-1\"",
                "\"0:1:nan\"",
                "\"x\"",
                "\"0:1\"",
            ],
        ),
    ] {
        for value in values {
            let what = format!("{key} = {value}");
            let to = match from.split_once(" = ") {
                Some((was, _)) if was != key => format!("{key} = {value}"),
                _ => format!("{key} = {value}"),
            };
            all.push(swap(&what, from, &to).says(key));
        }
    }
    // far finer than there is memory for, or larger than any number: limits, or all the same
    all.push(swap("voxel = 1e-9", "resolution = 8", "voxel = 1e-9"));
    all.push(swap("size = 1e300", "size = [20, 20, 10]", "size = [1e300, 1, 1]"));
    all.push(swap("size = 1e-300", "size = [20, 20, 10]", "size = [1e-300, 1, 1]").harmless());
    all.push(swap("center = 1e300", "center = [0, 0, 5]", "center = [1e300, 0, 0]"));
    all
}

/// Grammar that is right, and means nothing.
fn meanings() -> Vec<Case> {
    let many = |n: usize| -> String {
        let feature = |i: usize| {
            format!(
                "[[features]]\nname = \"f{i}\"\non.a.box = {{ center = [0, 0, 5], size = [2, 2, 1] }}\n"
            )
        };
        (0..n).map(feature).collect()
    };
    vec![
        swap("no shapes", "[shapes.a]", "[shape.a]").says("r.toml:"),
        swap("an unknown method", "\"linear\"", "\"liner\"").says("did you mean"),
        swap("a method in codes", "\"linear\"", "\"\\u001b[31m\\u009b\"").says("morph.method"),
        swap("a shape that is not there", "[\"a\", \"b\"]", "[\"a\", \"c\"]").says("morph.between"),
        swap("a shape with itself", "[\"a\", \"b\"]", "[\"a\"]").says("morph"),
        swap("a shape in codes", "[\"a\", \"b\"]", "[\"a\", \"\\u001b[2J\"]").says("morph.between"),
        swap("a shape of nothing", "solid = { parts = [{ box = { center = [0, 0, 5], size = [20, 20, 10] } }] }", "up = \"z\"").says("shapes.a"),
        swap("a shape of two things", "[shapes.b]", "mesh = \"x.obj\"\n[shapes.b]").says("shapes.a"),
        swap("like itself", "[shapes.b]", "place = { like = \"a\" }\n[shapes.b]").says("place"),
        swap("no parts", "parts = [{ box = { center = [0, 0, 5], size = [20, 20, 10] } }]", "parts = []").says("shapes.a"),
        swap("a part of nothing", "{ box = { center = [0, 0, 5], size = [20, 20, 10] } }", "{}").says("shapes.a"),
        swap("a name twice", "[morph]", "[[features]]\nname = \"body\"\non.a.box = { center = [0, 0, 5], size = [22, 22, 12] }\n[morph]").says("features[1]"),
        swap("an empty name", "name = \"body\"", "name = \"\"").says("features[0]"),
        swap("1000 features without partners", "[morph]", &format!("{}[morph]", many(1_000))).harmless(),
        swap("weights below 0", "[output]", "[morph.weights]\nbody = { a = -1 }\n[output]").says("morph.weights"),
        swap("weights of NaN", "[output]", "[morph.weights]\nbody = { a = nan }\n[output]").says("morph.weights"),
        swap("hybrids of one name", "[output]", "[[hybrids]]\nname = \"x\"\n[[hybrids]]\nname = \"x\"\n[output]").says("hybrids[1]"),
        swap("hybrids without a name", "[output]", "[[hybrids]]\n[output]").says("hybrids[0]"),
        swap("a function of time that is none", "[morph]", "[features.morph]\nt = \"t^t^t\"\n[morph]").says("features[0]"),
        swap("a function of 1 MB", "[morph]", &format!("[features.morph]\nt = \"t^{}\"\n[morph]", "(".repeat(1 << 20))).says("features[0]"),
        swap("a table that runs back", "[morph]", "[features.morph]\nt = [[0, 0], [1, 1], [0.5, 1]]\n[morph]").says("features[0]"),
    ]
}

/// Files that a recipe names.
fn places() -> Vec<Case> {
    let solid = "solid = { parts = [{ box = { center = [0, 0, 5], size = [20, 20, 10] } }] }";
    let mesh = |what: &str, path: &str| {
        swap(what, solid, &format!("mesh = \"{path}\"")).says("shapes.a.mesh")
    };
    let out = |what: &str, path: &str| {
        swap(what, "mesh = \"m-{t}.stl\"", &format!("mesh = \"{path}\"")).says("output.mesh")
    };
    let file = |what: &str, path: &str| {
        swap(what, solid, &format!("solid = \"{path}\"")).says("shapes.a.solid")
    };
    vec![
        mesh("a missing mesh", "missing.obj"),
        mesh("a mesh of no name", ""),
        mesh("a folder for a mesh", "sub"),
        mesh("a mesh by a pipe", "pipe.obj").beside("x", *b"x"),
        mesh("a device for a mesh", "/dev/zero"),
        mesh("a mesh in codes", "\\u001b[31m\\u009b.obj"),
        mesh("a mesh with a zero in its name", "a\\u0000.obj"),
        mesh("a mesh of 1 MB of name", &"n".repeat(1 << 20)),
        mesh("a recipe for a mesh", "r.toml"),
        out("results above", "../m-{t}.stl"),
        out("results above by a folder", "x/../../m-{t}.stl"),
        out("results anywhere", "/tmp/m-{t}.stl"),
        out("results with a zero in their name", "m\\u0000.stl").may_fail_otherwise(),
        file("a missing solid", "missing.toml"),
        file("a recipe for a solid", "r.toml"),
        file("a pipe for a solid", "pipe.bin"),
        file("a device for a solid", "zero.bin"),
        Case::new(As::Recipe, "s.toml", "a solid of nothing", "kind = \"solid\"\n").says("s.toml"),
        Case::new(
            As::Recipe,
            "s.toml",
            "a solid of an unknown kind",
            "kind = \"sold\"\nparts = []\n",
        )
        .says("kind"),
        Case::new(As::Recipe, "s.toml", "a kind in codes", "kind = \"\\u001b[31m\"\nparts = []\n")
            .says("kind"),
    ]
}

impl Case {
    /// Another key may be named than the one expected.
    fn may_fail_otherwise(mut self) -> Self {
        self.says.clear();
        self
    }
}
