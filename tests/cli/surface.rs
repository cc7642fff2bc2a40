use super::shipped::{texts, walk};
use crate::util::{Folder, Ran};
use std::f64::consts::PI;
use std::path::Path;

/// A square of one bilinear patch.
const NURBS: &str = "kind = \"nurbs\"
degree = [1, 1]
knots_u = [0, 0, 1, 1]
knots_v = [0, 0, 1, 1]
net = [
  [[0, 0, 0, 1], [1, 0, 0, 1]],
  [[0, 1, 0, 1], [1, 1, 0, 1]],
]
";
const MORPH: &str = "kind = \"nurbs-morph\"\ntargets = [\"n.toml\", \"n2.toml\"]\n";
const PDE_MORPH: &str = "kind = \"pde-morph\"\nfrom = \"p.toml\"\nto = \"p2.toml\"\n";
const BLEND: &str = "kind = \"blend\"
beta = 1
gamma = 12.1
lambda = 1
rho = 1
eta = 1
terms = 7
collocation = [11, 11]
[at-0]
position = [\"1.6*exp(t)*sin(v)\", \"exp(-t)*cos(v)\", 2]
tangent = [0, 0, -3]
[at-1]
position = [\"0.8*exp(-t)*sin(v)\", \"0.6*exp(t)*cos(v)\", 0]
tangent = [0, 0, -3]
";
const SHAPE: &str = "kind = \"pde\"\nshape = \"klein-bottle\"\n";
const DYNAMIC: &str = "kind = \"dynamic\"
grid = [11, 11]
dt = 0.001
steps = 100
rho = 0.1
eta = 1
control = { b = 1, c = 2, d = 1 }
force = [0, 0, 800]
";
const CURVE: &str = "kind = \"nurbs\"\ndegree = [2]\nknots_u = [0, 0, 0, 1, 1, 1]\n\
    net = [[[1, 0, 0, 1], [1, 1, 0, 0.7071067811865476], [0, 1, 0, 1]]]\n";

/// Four rings of `n` points, with one of `other` in third place.
fn pde(n: usize, other: usize) -> String {
    let ring = |z: usize, n: usize| {
        let point = |i: usize| {
            let v = 2.0 * PI * i as f64 / n as f64;
            format!("[{}, {}, {z}]", v.cos(), v.sin())
        };
        format!("[{}]", (0..n).map(point).collect::<Vec<_>>().join(", "))
    };
    let rings: Vec<String> =
        [n, n, other, n].iter().enumerate().map(|(z, n)| ring(z, *n)).collect();
    format!("kind = \"pde\"\n[[patches]]\ncurves = [\n  {}\n]\n", rings.join(",\n  "))
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("n.toml", NURBS);
    folder.put("n2.toml", &NURBS.replace("[1, 1, 0, 1]]", "[1, 1, 2, 3]]"));
    folder.put("p.toml", &pde(11, 11));
    folder.put("p2.toml", &pde(12, 12));
    folder.put("curve.toml", CURVE);
    folder.put("m.toml", MORPH);
    folder.put("b.toml", BLEND);
    folder.put("d.toml", DYNAMIC);
    folder.put("back.toml", "kind = \"pde-morph\"\nfrom = \"x.toml\"\nto = \"p.toml\"\n");
    folder
}

/// The numbers of a CSV without its header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let number = |x: &str| x.parse().unwrap();
    text.lines().skip(1).map(|l| l.split(',').map(number).collect()).collect()
}

fn shipped(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/surfaces");
    root.join(name).to_str().unwrap().to_owned()
}

fn json(ran: &Ran) -> serde_json::Value {
    serde_json::from_str(&ran.stdout()).unwrap()
}

#[test]
fn samples_run_over_the_domain_with_u_slowest() {
    let folder = folder();
    let ran = folder.run(&["surface", "n.toml", "--samples", "3x2", "-q"]).ends(0);
    let expected = "patch,u,v,x,y,z
0,0.0,0.0,0.0,0.0,0.0\n0,0.0,1.0,0.0,1.0,0.0\n0,0.5,0.0,0.5,0.0,0.0\n0,0.5,1.0,0.5,1.0,0.0
0,1.0,0.0,1.0,0.0,0.0\n0,1.0,1.0,1.0,1.0,0.0\n";
    assert_eq!(ran.stdout(), expected);
    assert_eq!(ran.stderr(), "");
    // a curve: a quarter of the unit circle, v stays 0
    let args = ["surface", "curve.toml", "--samples", "9", "--derivatives", "-o", "c.csv"];
    folder.run(&args).ends(0);
    let text = std::fs::read_to_string(folder.join("c.csv")).unwrap();
    assert!(text.starts_with("patch,u,v,x,y,z,xu,yu,zu,xv,yv,zv\n"));
    let all = rows(&text);
    assert_eq!(all.len(), 9);
    for r in &all {
        assert!((r[3].hypot(r[4]) - 1.0).abs() < 1e-15 && r[2] == 0.0);
        assert!((r[3] * r[6] + r[4] * r[7]).abs() < 1e-14, "the tangent of a circle");
    }
    // JSON with the same keys
    let table: toml::Table = NURBS.parse().unwrap();
    folder.put("n.json", &serde_json::to_string(&table).unwrap());
    let ran = folder.run(&["surface", "n.json", "--samples", "3x2", "-q"]).ends(0);
    assert_eq!(ran.stdout(), expected);
}

/// Paper 002's test case: samples of its closed form, worked out apart from this program.
#[test]
fn a_blend_through_the_command_is_its_closed_form() {
    let folder = folder();
    let args = ["surface", "b.toml", "-t", "0", "--samples", "5x13", "--derivatives", "-q"];
    let all = rows(&folder.run(&args).ends(0).stdout());
    let at = |u: f64, v: f64| {
        let near = |r: &&Vec<f64>| (r[1] - u).abs() < 1e-12 && (r[2] - v).abs() < 1e-12;
        all.iter().find(near).unwrap()
    };
    let off = |r: &[f64], p: [f64; 3]| (0..3).map(|k| (r[3 + k] - p[k]).abs()).fold(0.0, f64::max);
    assert!(off(at(0.5, PI / 2.0), [1.1944209320709835, 0.0, 1.0]) < 6.3e-8);
    let quarter = [0.7319936329643956, 0.8073325479436314, 1.40625];
    assert!(off(at(0.25, PI / 6.0), quarter) < 6.3e-8);
    for r in all.iter().filter(|r| r[1] == 0.0) {
        assert!(off(r, [1.6 * r[2].sin(), r[2].cos(), 2.0]) < 1e-12);
        assert!(r[6..9].iter().zip([0.0, 0.0, -3.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    }
    // how far off, by the report
    for (change, most) in [
        ("terms = 5", 2.4e-5),
        ("terms = 10", 1e-11),
        ("terms = 7\nbasis = \"sine\"", 3.1e-3),
        ("terms = 7\nexact = true", 1e-14),
    ] {
        folder.put("x.toml", &BLEND.replace("terms = 7", change));
        let args = ["surface", "x.toml", "--samples", "2x2", "-o", "x.csv", "--json", "--force"];
        let off = json(&folder.run(&args).ends(0))["frames"][0]["residual_mm"].as_f64().unwrap();
        assert!(off <= most, "{change}: {off}");
    }
}

#[test]
fn a_dynamic_surface_is_at_its_time() {
    let folder = folder();
    let middle = |t: &str| {
        let args = ["surface", "d.toml", "-t", t, "--samples", "3x3", "-q"];
        rows(&folder.run(&args).ends(0).stdout())[4][5]
    };
    assert_eq!(middle("0"), 0.0);
    // the clamped plate overshoots to about twice its rest height at t = 0.03
    assert!((1.8..2.3).contains(&middle("0.03")), "{}", middle("0.03"));
    let report = folder.run(&["surface", "d.toml", "-o", "d.csv", "--json"]).ends(0);
    let report = json(&report);
    assert_eq!(report["duration"], 0.1);
    assert_eq!(report["frames"][0]["t"], 0.1);
    folder.run(&["surface", "d.toml", "-t", "0.2"]).fails(3, &["d.toml: -t: got 0.2", "0 to 0.1"]);
}

#[test]
fn meshes_of_samples_and_of_a_tolerance() {
    let folder = folder();
    let args = ["surface", "d.toml", "-t", "0.03", "--samples", "7x9", "-o", "d.stl", "--json"];
    let report = json(&folder.run(&args).ends(0));
    assert_eq!(report["frames"][0]["triangles"], 2 * 6 * 8);
    assert_eq!(report["frames"][0]["closed"], false);
    let vases = shipped("vases.toml");
    let args = ["surface", &vases, "-t", "0,0.5", "--tolerance", "1", "-o", "v-{t}.obj", "--json"];
    let report = json(&folder.run(&args).ends(0));
    assert_eq!(report["inputs"].as_array().unwrap().len(), 3);
    for name in ["v-0.obj", "v-0.5.obj"] {
        let ran = folder.run(&["check", name, "--json", "-q"]).ends(0);
        assert_eq!(json(&ran)["printable"], true, "{ran}");
    }
    folder.run(&["surface", "curve.toml", "-o", "c.stl"]).fails(2, &["a curve has no triangles"]);
    folder.run(&["surface", "curve.toml", "-o", "c.obj", "--samples", "5"]).ends(0);
    let text = std::fs::read_to_string(folder.join("c.obj")).unwrap();
    assert!(text.contains("\nv 1.0 0.0 0.0\n") && text.ends_with("\nl 1 2 3 4 5\n"), "{text}");
}

#[test]
fn the_spine_and_two_files_with_a_method() {
    let folder = folder();
    let args = ["surface", "p.toml", "--to", "p2.toml", "--method", "pde-spine", "-t", "0.5"];
    let ran = folder.run(&[&args[..], &["--spine", "--samples", "4", "-q"]].concat()).ends(0);
    // the rings stand at heights 0 to 3 round the z axis
    let all = rows(&ran.stdout());
    assert_eq!(all.len(), 4);
    for (i, r) in all.iter().enumerate() {
        assert!(r[3].hypot(r[4]) < 1e-14 && (r[5] - i as f64).abs() < 1e-14, "{r:?}");
    }
    let method = |m: &str| folder.run(&["surface", "p.toml", "--to", "n.toml", "--method", m]);
    method("pde-spine").fails(3, &["n.toml:1: kind: is of kind `nurbs`"]);
    method("pde-spin").fails(2, &["did you mean `pde-spine`?"]);
    folder.run(&["surface", "n.toml", "--spine"]).fails(2, &["--spine", "`nurbs`"]);
}

#[test]
fn outputs_are_kept_and_named_by_their_time() {
    let folder = folder();
    folder.put("m.csv", "mine");
    let args = ["surface", "m.toml", "-o", "m.csv", "--samples", "2x2"];
    folder.run(&args).fails(2, &["m.csv", "--force"]);
    folder.run(&[&args[..], &["--force"]].concat()).ends(0);
    let several = |out: &[&str]| {
        folder.run(&[&["surface", "m.toml", "-t", "0:1:0.5", "--samples", "2x2"], out].concat())
    };
    several(&[]).fails(2, &["3 times", "{t}"]);
    several(&["-o", "m-{t}.csv"]).ends(0);
    let corner = |name: &str| rows(&std::fs::read_to_string(folder.join(name)).unwrap())[3][5];
    // masses 1 and 3, heights 0 and 2: halfway 3 / 4 of the way
    assert_eq!([corner("m-0.csv"), corner("m-0.5.csv"), corner("m-1.csv")], [0.0, 1.5, 2.0]);
    for (t, code) in [("1.5", 3), ("-0.1", 3), ("nan", 2), ("soon", 2)] {
        folder.run(&["surface", "m.toml", "-t", t]).fails(code, &["-t"]);
    }
    folder.run(&["surface", "m.toml", "--samples", "1x5"]).fails(2, &["--samples"]);
    folder.run(&["surface", "m.toml", "--samples", "99999x99999"]).fails(5, &["--samples"]);
    folder.run(&["surface", "m.toml", "-o", "x.doc"]).fails(2, &["x.doc", ".csv"]);
    folder.run(&["surface", "gone.toml"]).fails(3, &["gone.toml", "cannot be read"]);
}

/// Each change of a sound file, and what is said about it; all end with 3.
#[test]
fn bad_files_are_refused_by_file_line_and_key() {
    let good = pde(11, 11);
    let design = |text: &str| format!("\"n2.toml\"]\n[[design]]\nt = 0.5\n{text}");
    let cases: Vec<(&str, &str, String, &str)> = vec![
        (
            NURBS,
            "knots_u = [0, ",
            "knots_u = [".into(),
            "x.toml:3: knots_u: knot vector has 3 knots",
        ),
        (NURBS, "[1, 1, 0, 1]]", "[1, 1, 0, -1]]".into(), "x.toml:7: net[1][1]: weight is -1"),
        (NURBS, "[1, 0, 0, 1]", "[nan, 0, 0, 1]".into(), "x.toml:6: net[0][1]: coordinate is NaN"),
        (
            NURBS,
            "knots_v = [0, 0, 1, 1]",
            "knots_v = [0, 0, 1, inf]".into(),
            "knots_v[3]: knot is inf",
        ),
        (NURBS, "knots_v = [0, 0, 1, 1]\n", String::new(), "knots_v: missing key"),
        (MORPH, "n2.toml", "gone.toml".into(), "x.toml:2: targets[1]: gone.toml cannot be read"),
        (MORPH, "n2.toml", "curve.toml".into(), "x.toml:2: targets[1]: "),
        (MORPH, "n2.toml", "p.toml".into(), "x.toml:2: targets[1]: p.toml is of kind `pde`"),
        (MORPH, "n2.toml", "x.toml".into(), "x.toml:2: targets[1]: x.toml is this file"),
        (MORPH, "\"n2.toml\"", "\"n2.toml\", \"n.toml\"".into(), "weights: missing; 3 targets"),
        (
            MORPH,
            "\"n2.toml\"]",
            "\"n2.toml\"]\nmasses = [[[1, 1], [1, 1]], [[1, 1], [-1, 1]]]".into(),
            "x.toml:3: masses[1][1][0]: mass is -1",
        ),
        (
            MORPH,
            "\"n2.toml\"]",
            "\"n2.toml\"]\nmasses = [[[1, 1], [1, 1]], [[1, 1, 1], [1, 1, 1]]]".into(),
            "masses[1][0]: row has 3 numbers; the common net has 2 columns",
        ),
        (
            MORPH,
            "\"n2.toml\"]",
            "\"n2.toml\"]\n[[design]]\nt = 1.5".into(),
            "x.toml:4: design[0].t: ",
        ),
        (
            MORPH,
            "\"n2.toml\"]",
            design("distance = [[0.1, 0.2], [0.3, 1.2]]"),
            "x.toml:5: design[0].distance[1][1]: distance is 1.2",
        ),
        (MORPH, "\"n2.toml\"]", design("distnace = 0.5"), "did you mean `distance`?"),
        (
            MORPH,
            "\"n2.toml\"]",
            design("impact = [{ centre = [0, 0], radius = [1, 0], to = 0.9 }]"),
            "design[0].impact[0].radius[1]: radius is 0",
        ),
        (
            BLEND,
            "1.6*exp(t)*sin(v)",
            "1/(v - pi)".into(),
            "x.toml:10: at-0.position[0]: division by zero",
        ),
        (
            BLEND,
            "1.6*exp",
            "1.6*epx".into(),
            "x.toml:10: at-0.position[0]: character 5: unknown function `epx`; did you mean `exp`?",
        ),
        (BLEND, "sin(v)", "sin(w)".into(), "unknown variable `w`"),
        (
            BLEND,
            "terms = 7",
            "terms = 10\nbasis = \"sine\"".into(),
            "x.toml:9: collocation: 10 sine terms need at least 12 points over u, got 11",
        ),
        (BLEND, "rho = 1", "rho = nan".into(), "x.toml:5: rho: got NaN"),
        (BLEND, "rho = 1\n", String::new(), "x.toml:1: missing key `rho`"),
        (
            BLEND,
            "position = [\"1.6*exp(t)*sin(v)\", \"exp(-t)*cos(v)\", 2]\ntangent = [0, 0, -3]",
            "surface = [\"cos(v)\", \"sin(v)\", \"1/(u-0.5)\"]\nfrom = 0\ncut = 0.5".into(),
            "x.toml:10: at-0.surface[2]: division by zero",
        ),
        (&good, "curves", "u = [0, 0.5, 0.4, 1]\ncurves".into(), "x.toml:3: patches[0].u: "),
        (&good, "[[patches]]", "a = inf\n[[patches]]".into(), "x.toml:2: a: inf"),
        (&good, "[[patches]]", "modes = 6\n[[patches]]".into(), "patches[0].curves[0]: 11 points"),
        (
            &good,
            "\"pde\"",
            "\"pdee\"".into(),
            "x.toml:1: kind: unknown value `pdee`; did you mean `pde`?",
        ),
        (SHAPE, "bottle", "botle".into(), "x.toml:2: shape: unknown value `klein-botle`"),
        (
            SHAPE,
            "bottle\"",
            "bottle\"\ndivisions = 0".into(),
            "x.toml:3: divisions: 0; from 1 to 50",
        ),
        (
            SHAPE,
            "bottle\"",
            "bottle\"\n[parameters]\nalpha = -1".into(),
            "x.toml:4: parameters.alpha: -1",
        ),
        (SHAPE, "bottle\"", "bottle\"\n[parameters]\nalhpa = 1".into(), "did you mean `alpha`?"),
        (SHAPE, "bottle\"", "bottle\"\nmodes = 30".into(), "remainder: with a (modes + 1) = 31"),
        (PDE_MORPH, "p2.toml", "n.toml".into(), "x.toml:3: to: n.toml is of kind `nurbs`"),
        (PDE_MORPH, "p2.toml", "back.toml".into(), "it names this file again: a cycle"),
        (PDE_MORPH, "p2.toml", "./x.toml".into(), "x.toml:3: to: ./x.toml is this file"),
        (PDE_MORPH, "p2.toml\"", "p2.toml\"\ngamma = -1".into(), "x.toml:4: gamma: "),
        (DYNAMIC, "d = 1", "d = nan".into(), "x.toml:7: control.d: NaN"),
        (DYNAMIC, "rho = 0.1", "rho = -1".into(), "x.toml:5: rho: -1"),
        (DYNAMIC, "800", "\"1/(u - 0.5)\"".into(), "x.toml:8: force[2]: division by zero"),
        (DYNAMIC, "steps = 100", "steps = 100000000000".into(), "x.toml:4: steps: "),
        (
            DYNAMIC,
            "force",
            "boundary = { curves = { u0 = [0, \"v\", 0] } }\nforce".into(),
            "boundary.curves: missing key `u1`",
        ),
    ];
    let folder = folder();
    for (good, from, to, expected) in cases {
        let text = good.replacen(from, &to, 1);
        assert_ne!(text, good, "{from}");
        folder.put("x.toml", &text);
        folder.run(&["surface", "x.toml", "--samples", "3x3"]).fails(3, &[expected]);
    }
    folder.put("x.toml", &pde(11, 12));
    let why = "x.toml:6: patches[0].curves[2]: 12 points; curves[0] has 11";
    folder.run(&["surface", "x.toml"]).fails(3, &[why]);
    let ill = DYNAMIC.replace("[11, 11]", "[81, 81]").replace("d = 1", "d = -0.001");
    folder.put("x.toml", &ill);
    let why = "x.toml:7: control.d: -0.001 is ill-posed on this grid";
    folder.run(&["surface", "x.toml"]).fails(3, &[why, "25 negative eigenvalues"]);
    // and what an error leaves behind is nothing
    assert!(!folder.names().iter().any(|n| n.ends_with(".csv") || n.contains("part")));
}

/// Every file that ships is read, says what it shows, and holds no key that the schema lacks.
#[test]
fn shipped_files_are_read() {
    let folder = Folder::new();
    let schema = json(&folder.run(&["schema", "--surface"]).ends(0));
    let all = texts("surfaces");
    assert!(all.len() > 30, "{}", all.len());
    for (path, text) in all {
        assert!(text.starts_with('#'), "{} says nothing about itself", path.display());
        let name = path.to_str().unwrap();
        let args = ["surface", name, "-t", "0", "--samples", "3x3", "-q", "--derivatives"];
        let csv = folder.run(&args).ends(0).stdout();
        assert!(rows(&csv).iter().flatten().all(|x| x.is_finite()), "{name}");
        let tree: toml::Table = text.parse().unwrap();
        let (tree, mut wrong) = (serde_json::to_value(tree).unwrap(), Vec::new());
        walk(&tree, &schema, &schema, "", &mut wrong);
        assert!(wrong.is_empty(), "{name}: {wrong:?}");
    }
}
