use super::{Basis, Falloff, Kind, Nest, PdeMethod, SurfaceEntry, parse_surface, surface_schema};
use crate::recipe::PlainOr;
use std::path::Path;

fn parse(text: &str, file: &str) -> Result<SurfaceEntry, String> {
    parse_surface(text, Path::new(file)).map(|(e, _)| e).map_err(|e| e.to_string())
}

/// The contract's blend, in both formats.
const BLEND: &str = r#"kind = "blend"
beta = 1.0
gamma = 12.1
lambda = 1.0
rho = 1.0
eta = 1.0
terms = 7
collocation = [11, 11]
v = [0.0, 6.283185307179586]
[at-0]
position = ["1.6*exp(t)*sin(v)", "exp(-t)*cos(v)", "2"]
tangent = ["0", "0", "-3"]
[at-1]
position = ["0.8*exp(-t)*sin(v)", "0.6*exp(t)*cos(v)", 0]
tangent = [0, 0, -3.0]
"#;

#[test]
fn toml_and_json_are_the_same() {
    let SurfaceEntry::Blend(e) = parse(BLEND, "b.toml").unwrap() else { panic!("a blend") };
    assert_eq!(e.basis, Basis::Bubble);
    assert_eq!(e.at_1.tangent.as_ref().unwrap()[2].0, "-3");
    let table: toml::Table = BLEND.parse().unwrap();
    let json = serde_json::to_string_pretty(&table).unwrap();
    assert_eq!(parse(&json, "b.json").unwrap(), SurfaceEntry::Blend(e));
}

#[test]
fn curves_are_points_or_terms() {
    let text = "kind = \"pde\"\n[[patches]]\ncurves = [[[1, 2, 3], [4, 5, 6]], { mean = [0, 0, 1] }, \
                { mean = [0, 0, 2], cos = [[1, 0, 0]], sin = [[0, 1, 0]] }, { mean = [0, 0, 3] }]";
    let SurfaceEntry::Pde(e) = parse(text, "p.toml").unwrap() else { panic!("a pde") };
    let [PlainOr::Plain(points), _, PlainOr::Table(terms), _] = &e.patches[0].curves else {
        panic!("points and terms: {:?}", e.patches)
    };
    assert_eq!((points[1], terms.sin[0]), ([4.0, 5.0, 6.0], [0.0, 1.0, 0.0]));
    assert_eq!((e.modes, e.a, e.remainder, e.scale), (5, 1.0, true, 1.0));
}

#[test]
fn designs_hold_tables_of_any_depth_and_areas() {
    let text = "kind = \"nurbs-morph\"\ntargets = [\"a.toml\", \"b.toml\"]\n[[design]]\nt = 0.5\n\
                distance = [[0.1, 1], [0.3, 0.4]]\nimpact = [{ centre = [0.5, 0.5], radius = [1, 2], \
                to = 0.9, falloff = \"t^2\" }]\n[[design]]\nt = 0.7\ndistance = 0.2";
    let SurfaceEntry::NurbsMorph(e) = parse(text, "m.toml").unwrap() else { panic!("a morph") };
    let rows = e.design[0].distance.as_ref().and_then(Nest::rows).unwrap();
    assert_eq!(rows, [[0.1, 1.0], [0.3, 0.4]]);
    assert!(e.design[0].distance.as_ref().and_then(Nest::tables).is_none());
    assert!(matches!(e.design[0].impact[0].falloff, Falloff::Custom(_)));
    assert_eq!(e.design[0].impact[0].target, 1);
    assert_eq!(e.design[1].distance, Some(Nest::Number(0.2)));
}

#[test]
fn errors_tell_file_line_key_and_cause() {
    for (text, expected) in [
        ("kind = \"pdee\"", "s.toml:1: kind: unknown value `pdee`; did you mean `pde`?"),
        ("modes = 3", "s.toml: missing key `kind`"),
        ("kind = \"pde\"\nmods = 3", "s.toml:2: mods: unknown key `mods`; did you mean `modes`?"),
        ("kind = \"pde\"\nmodes = -3", "s.toml:2: modes: "),
        ("kind = \"pde-morph\"\nfrom = \"a\"", "s.toml:1: missing key `to`"),
        (
            "kind = \"pde-morph\"\nfrom = \"a\"\nto = \"b\"\nmethod = \"spin\"",
            "s.toml:4: method: unknown value `spin`; did you mean `spine`?",
        ),
        (
            "kind = \"dynamic\"\ndt = 1\nsteps = 1\nrho = 1\neta = 1\ncontrol = { b = 1, c = 2 }",
            "s.toml:6: control: missing key `d`",
        ),
        (
            "kind = \"nurbs\"\ndegree = [1]\nknots_u = [0, 0, 1, 1]\nnet = [[[0, 0, 0]]]",
            "s.toml:4: net[0][0]: invalid length 3",
        ),
        ("kind = \"solid\"\nparts = []", "s.toml:1: kind: unknown value `solid`"),
    ] {
        let e = parse(text, "s.toml").unwrap_err();
        assert!(e.starts_with(expected), "{text}\n expected: {expected}\n got: {e}");
    }
}

#[test]
fn cut_texts_are_errors_or_entries() {
    for cut in 0..BLEND.len() {
        let _ = parse(&BLEND[..cut], "b.toml");
    }
    let deep = format!(
        "kind = \"nurbs-morph\"\ntargets = []\n[[design]]\nt = 0.5\ndistance = {}",
        "[".repeat(50_000)
    );
    let _ = parse(&deep, "m.toml");
}

#[test]
fn words_and_schema() {
    for kind in
        [Kind::Pde, Kind::PdeMorph, Kind::Blend, Kind::Nurbs, Kind::NurbsMorph, Kind::Dynamic]
    {
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.word());
    }
    assert_eq!(crate::recipe::word::<PdeMethod>("spine"), Ok(PdeMethod::Spine));
    let schema = surface_schema();
    assert_eq!(schema["anyOf"].as_array().unwrap().len(), 6);
    let text = schema.to_string();
    for key in ["at-0", "klein-bottle", "tangents_of", "impact", "knots_v", "pde-morph"] {
        assert!(text.contains(key), "{key}");
    }
}
