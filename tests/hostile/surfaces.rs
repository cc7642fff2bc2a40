//! Surface files of every kind.

use super::{As, Case};

const PDE: &str = "kind = \"pde\"\nmodes = 2\na = 1.0\n[[patches]]\nu = [0.0, 0.3, 0.6, 1.0]\n\
    curves = [[[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[1, 0, 1], [0, 1, 1], [-1, 0, 1], \
    [0, -1, 1]], [[1, 0, 2], [0, 1, 2], [-1, 0, 2], [0, -1, 2]], [[1, 0, 3], [0, 1, 3], [-1, 0, 3], \
    [0, -1, 3]]]\n";
const SHAPE: &str = "kind = \"pde\"\nshape = \"klein-bottle\"\ndivisions = 4\nmodes = 3\na = 1.0\n";
const BLEND: &str = "kind = \"blend\"\nbeta = 1.0\ngamma = 12.1\nlambda = 1.0\nrho = 1.0\neta = 1.0\n\
    terms = 3\ncollocation = [5, 5]\nv = [0.0, 6.0]\n[at-0]\nposition = [\"sin(v)\", \"cos(v)\", \"2\"]\n\
    tangent = [\"0\", \"0\", \"-3\"]\n[at-1]\nposition = [\"sin(v)\", \"cos(v)\", \"0\"]\n\
    tangent = [\"0\", \"0\", \"-3\"]\n";
const NURBS: &str = "kind = \"nurbs\"\ndegree = [1, 1]\nknots_u = [0, 0, 1, 1]\nknots_v = [0, 0, 1, 1]\n\
    net = [[[0, 0, 0, 1], [1, 0, 0, 1]], [[0, 1, 0, 1], [1, 1, 0, 1]]]\n";
const MORPH: &str =
    "kind = \"nurbs-morph\"\ntargets = [\"a.toml\", \"b.toml\"]\naveraging = \"weighted\"\n";
const PDE_MORPH: &str =
    "kind = \"pde-morph\"\nfrom = \"a.toml\"\nto = \"b.toml\"\nmethod = \"spine\"\ngamma = 1.0\n";
const DYNAMIC: &str = "kind = \"dynamic\"\ngrid = [9, 9]\ndt = 0.0001\nsteps = 4\nrho = 0.1\neta = 1.0\n\
    control = { b = 1.0, c = 2.0, d = 1.0 }\nforce = [\"0\", \"0\", \"800\"]\n[boundary]\n\
    curves = \"flat\"\n[boundary.tangents]\nu0 = [\"0\", \"0\", \"0\"]\nu1 = [\"0\", \"0\", \"0\"]\n\
    v0 = [\"0\", \"0\", \"0\"]\nv1 = [\"0\", \"0\", \"0\"]\n";

pub fn all() -> Vec<Case> {
    let mut all: Vec<Case> = [pde(), blend(), nurbs(), dynamic()].into_iter().flatten().collect();
    for (kind, text) in
        [("pde", PDE), ("blend", BLEND), ("nurbs", NURBS), ("dynamic", DYNAMIC), ("morph", MORPH)]
    {
        for part in [1, 3, 5, 7] {
            let n = text.len() * part / 8;
            let what = format!("{kind}, cut at byte {n}");
            all.push(Case::new(As::Surface, "s.toml", &what, &text.as_bytes()[..n]));
        }
    }
    let new = |what: &str, bytes: &[u8]| Case::new(As::Surface, "s.toml", what, bytes);
    all.push(new("no kind", b"modes = 1\n").says("kind"));
    all.push(new("an unknown kind", b"kind = \"pdf\"\n").says("kind"));
    all.push(new("codes for a kind", b"kind = \"\\u001b[31m\\u009b\"\n").says("kind"));
    all.push(new("a recipe", b"version = 1\n[shapes.a]\nmesh = \"a.obj\"\n").says("s.toml"));
    all.push(new("noise", &super::meshes::noise(4096, 23)));
    all
}

/// Every value in turn in the place of another.
fn swaps(text: &str, what: &str, list: &[(&str, &[&str])]) -> Vec<Case> {
    let one = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let what = format!("{what}: {to:.60}");
        Case::new(As::Surface, "s.toml", &what, text.replacen(from, to, 1))
    };
    list.iter().flat_map(|(from, to)| to.iter().map(|to| one(from, to))).collect()
}

fn pde() -> Vec<Case> {
    let mut all = swaps(
        PDE,
        "pde",
        &[
            ("modes = 2", &["modes = -1", "modes = 1000000000", "modes = 2.5", "modes = nan"]),
            ("a = 1.0", &["a = nan", "a = inf", "a = -1", "a = 0"]),
            (
                "u = [0.0, 0.3, 0.6, 1.0]",
                &[
                    "u = [0, 0.6, 0.3, 1]",
                    "u = [0, 0, 0, 0]",
                    "u = [nan, 0, 0, 1]",
                    "u = []",
                    "u = [0, 1]",
                ],
            ),
            ("[1, 0, 0]", &["[nan, 0, 0]", "[inf, 0, 0]", "[1, 0]", "[]", "\"x\""]),
        ],
    );
    all.extend(swaps(
        SHAPE,
        "pde",
        &[
            (
                "divisions = 4",
                &[
                    "divisions = 0",
                    "divisions = -1",
                    "divisions = 1000000000",
                    "divisions = 4294967296",
                ],
            ),
            ("klein-bottle", &["klein-botle", "\\u001b[31m"]),
            ("modes = 3", &["modes = 1000000000"]),
        ],
    ));
    let loops = [
        ("s.toml", "b.toml"),
        ("missing.toml", "b.toml"),
        ("pipe.bin", "b.toml"),
        ("zero.bin", "b.toml"),
        ("\\u001b[31m.toml", "b.toml"),
        ("", "b.toml"),
    ];
    for (from, to) in loops {
        let text = PDE_MORPH.replacen("a.toml", from, 1).replacen("b.toml", to, 1);
        let what = format!("pde-morph from {from:?}");
        all.push(Case::new(As::Surface, "s.toml", &what, text).beside("b.toml", PDE).says("from"));
    }
    all.push(
        Case::new(As::Surface, "s.toml", "two morphs of each other", PDE_MORPH)
            .beside("a.toml", PDE_MORPH.replacen("a.toml", "s.toml", 1))
            .beside("b.toml", PDE)
            .says("from"),
    );
    all
}

fn blend() -> Vec<Case> {
    let deep =
        format!("position = [\"{}v{}\", \"0\", \"2\"]", "(".repeat(100_000), ")".repeat(100_000));
    let signs = format!("position = [\"{}v\", \"0\", \"2\"]", "-".repeat(100_000));
    let long = format!("position = [\"{}v\", \"0\", \"2\"]", "v+".repeat(200_000));
    let power = format!("position = [\"{}v\", \"0\", \"2\"]", "v^".repeat(100_000));
    let calls =
        format!("position = [\"{}v{}\", \"0\", \"2\"]", "sin(".repeat(50_000), ")".repeat(50_000));
    let position = "position = [\"sin(v)\", \"cos(v)\", \"2\"]";
    swaps(
        BLEND,
        "blend",
        &[
            (position, &[&deep, &signs, &power, &calls]),
            (
                position,
                &[
                    "position = [\"system(v)\", \"0\", \"2\"]",
                    "position = [\"v.__class__\", \"0\", \"2\"]",
                    "position = [\"1/0\", \"0\", \"2\"]",
                    "position = [\"\", \"0\", \"2\"]",
                    "position = [\"v v\", \"0\", \"2\"]",
                    "position = [\"\\u001b[31m\", \"0\", \"2\"]",
                    "position = [\"exp(exp(exp(9)))\", \"0\", \"2\"]",
                    "position = [\"w\", \"0\", \"2\"]",
                    "position = []",
                ],
            ),
            ("terms = 3", &["terms = -1", "terms = 1000000000"]),
            (
                "collocation = [5, 5]",
                &[
                    "collocation = [0, 0]",
                    "collocation = [1000000000, 1000000000]",
                    "collocation = [5]",
                ],
            ),
            (
                "v = [0.0, 6.0]",
                &["v = [6.0, 0.0]", "v = [0.0, nan]", "v = [0.0, inf]", "v = [0.0, 0.0]"],
            ),
            ("gamma = 12.1", &["gamma = nan", "gamma = inf"]),
            ("rho = 1.0", &["rho = nan"]),
        ],
    )
    .into_iter()
    .chain(swaps(BLEND, "blend", &[(position, &[&long])]).into_iter().map(Case::harmless))
    .collect()
}

fn nurbs() -> Vec<Case> {
    let mut all = swaps(
        NURBS,
        "nurbs",
        &[
            (
                "degree = [1, 1]",
                &[
                    "degree = [4294967295, 1]",
                    "degree = [0, 1]",
                    "degree = [-1, 1]",
                    "degree = []",
                    "degree = [1, 1, 1]",
                    "degree = [99, 99]",
                ],
            ),
            (
                "knots_u = [0, 0, 1, 1]",
                &[
                    "knots_u = [0, 1, 0, 1]",
                    "knots_u = []",
                    "knots_u = [0, 0, 0, 0]",
                    "knots_u = [nan, 0, 1, 1]",
                    "knots_u = [0, 0, inf, inf]",
                    "knots_u = [0, 0, 1]",
                ],
            ),
            (
                "[0, 0, 0, 1]",
                &["[0, 0, 0, 0]", "[0, 0, 0, -1]", "[nan, 0, 0, 1]", "[0, 0, 0, inf]", "[0, 0]"],
            ),
            ("net = [", &["net = [[], ", "net = [[[0, 0, 0, 1]], "]),
        ],
    );
    let many = format!("[{}]", vec!["\"b.toml\""; 10_000].join(","));
    for (what, to) in [
        ("itself", "[\"s.toml\", \"b.toml\"]"),
        ("what is missing", "[\"missing.toml\", \"b.toml\"]"),
        ("one", "[\"b.toml\"]"),
        ("none", "[]"),
        ("a pipe", "[\"pipe.bin\", \"b.toml\"]"),
        ("10 000", &many),
    ] {
        let text = MORPH.replacen("[\"a.toml\", \"b.toml\"]", to, 1);
        let what = format!("nurbs-morph of {what}");
        all.push(
            Case::new(As::Surface, "s.toml", &what, text).beside("b.toml", NURBS).says("targets"),
        );
    }
    all
}

fn dynamic() -> Vec<Case> {
    swaps(
        DYNAMIC,
        "dynamic",
        &[
            (
                "grid = [9, 9]",
                &[
                    "grid = [0, 0]",
                    "grid = [1000000000, 1000000000]",
                    "grid = [-9, 9]",
                    "grid = [2, 2]",
                    "grid = [4294967295, 3]",
                    "grid = [9]",
                ],
            ),
            ("dt = 0.0001", &["dt = 0", "dt = -1", "dt = nan", "dt = inf"]),
            (
                "steps = 4",
                &[
                    "steps = -1",
                    "steps = 18446744073709551615",
                    "steps = 99999999999999999999",
                    "steps = 1000000000000",
                ],
            ),
            ("rho = 0.1", &["rho = nan", "rho = -1"]),
            ("\"800\"", &["\"1/0\"", "\"exp(exp(exp(9)))\"", "\"w\"", "\"\""]),
            (
                "u0 = [\"0\", \"0\", \"0\"]",
                &["u0 = [\"0\"]", "u0 = 1", "u9 = [\"0\", \"0\", \"0\"]"],
            ),
        ],
    )
}
