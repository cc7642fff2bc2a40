use super::{Kind, Parametric, Still, SurfaceFile, between, open};
use crate::recipe::SurfaceMethod;
use glam::{DVec2, DVec3};
use std::path::PathBuf;

/// A file that ships with the crate.
fn shipped(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/surfaces").join(name)
}

/// A few points at `t`.
fn points(file: &SurfaceFile, t: f64) -> Vec<DVec3> {
    match file.object.at(t).unwrap() {
        Still::Surface(s) => (0..s.patches())
            .flat_map(|p| (0..20).map(move |k| (p, k)))
            .map(|(p, k)| {
                let d = s.domain(p);
                let w = [0.137, 0.311].map(|f| (f64::from(k) * f).fract());
                let along = |[a, b]: [f64; 2], w: f64| a + (b - a) * w;
                s.point(p, DVec2::new(along(d.u, w[0]), along(d.v, w[1])))
            })
            .collect(),
        Still::Curve(c) => {
            let [a, b] = c.domain();
            (0..40).map(|k| c.point(a + (b - a) * (f64::from(k) * 0.137).fract())).collect()
        }
    }
}

fn far(a: &[DVec3], b: &[DVec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m: f64, (p, q)| m.max(p.distance(*q)))
}

#[test]
fn a_morph_file_and_two_files_with_a_method_are_the_same() {
    let file = open(&shipped("vases.toml")).unwrap();
    let two = [shipped("vase-bellied.toml"), shipped("vase-flared.toml")];
    let weighted = between(&two[0], &two[1], SurfaceMethod::NurbsWeighted).unwrap();
    assert_eq!(far(&points(&file, 0.3), &points(&weighted, 0.3)), 0.0);
    let linear = between(&two[0], &two[1], SurfaceMethod::NurbsLinear).unwrap();
    assert!(far(&points(&file, 0.3), &points(&linear, 0.3)) > 1.0);
    assert_eq!((weighted.kind, weighted.inputs.len()), (Kind::NurbsMorph, 2));
}

#[test]
fn morphs_begin_and_end_with_their_files() {
    use SurfaceMethod::{PdeBoundary, PdeCombined, PdeModes, PdeSpine};
    let [a, b] = [shipped("super-ellipsoid.toml"), shipped("super-toroid.toml")];
    let ends = [&a, &b].map(|p| points(&open(p).unwrap(), 0.0));
    for method in [PdeBoundary, PdeCombined, PdeModes, PdeSpine] {
        let morph = between(&a, &b, method).unwrap();
        for (t, end) in [0.0, 1.0].into_iter().zip(&ends) {
            let gap = far(&points(&morph, t), end);
            assert!(gap < 1e-10, "{method:?} at {t}: {gap}");
        }
    }
    let letters =
        between(&shipped("letter-e.toml"), &shipped("letter-g.toml"), SurfaceMethod::NurbsWeighted);
    let letters = letters.unwrap();
    assert!(matches!(letters.object, Parametric::CurveMotion(_)));
    let g = points(&open(&shipped("letter-g.toml")).unwrap(), 0.0);
    assert!(far(&points(&letters, 1.0), &g) < 1e-10);
}

#[test]
fn files_of_the_wrong_kind_are_refused() {
    let [pde, nurbs] = [shipped("shell.toml"), shipped("vase-flared.toml")];
    let e = between(&pde, &nurbs, SurfaceMethod::PdeSpine).err().unwrap().to_string();
    assert!(e.contains("vase-flared.toml:") && e.contains("kind: is of kind `nurbs`"), "{e}");
    let e = between(&pde, &pde, SurfaceMethod::NurbsLinear).err().unwrap().to_string();
    assert!(e.contains("two files of kind `nurbs`"), "{e}");
    let letter = shipped("letter-e.toml");
    let e = between(&nurbs, &letter, SurfaceMethod::NurbsLinear).err().unwrap().to_string();
    assert!(e.contains("expected one sort"), "{e}");
}

#[test]
fn a_scale_is_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, from: &str, to: &str| {
        let text = std::fs::read_to_string(shipped(name)).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        let path = folder.path().join(name);
        std::fs::write(&path, text.replace(from, to)).unwrap();
        open(&path).unwrap()
    };
    for (name, from, by) in [
        ("blend-cylinders.toml", "scale = 40.0", 40.0),
        ("shell.toml", "scale = 150.0", 150.0),
        ("dolphin.toml", "a = 1.0", 1.0),
    ] {
        let one = points(&read(name, from, "scale = 1.0"), 0.25);
        let large = points(&open(&shipped(name)).unwrap(), 0.25);
        let one: Vec<DVec3> = one.into_iter().map(|p| p * by).collect();
        assert!(far(&one, &large) < 1e-11 * by, "{name}");
    }
    // nine divisions of the unit shell are off it by 1.41e-3 between the joints
    let shell = read("shell.toml", "scale = 150.0", "scale = 1.0").residual(0.0).unwrap().unwrap();
    assert!((shell - 1.407e-3).abs() < 2e-6, "{shell}");
    // the closed form of the blend: 6.3e-8 with seven bubbles (METHODS and paper 002, eqs 25 to 28)
    let blend = read("blend-cylinders.toml", "scale = 40.0", "scale = 1.0").residual(0.0).unwrap();
    assert!((1e-9..6.3e-8).contains(&blend.unwrap()), "{blend:?}");
}

/// With three targets the share of one is pulled and the others keep their proportion.
#[test]
fn areas_of_impact_pull_the_share_of_a_target() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    // three straight lines at heights 0, 1 and 10 with all weights one
    for (name, z) in [("a", 0), ("b", 1), ("c", 10)] {
        let text = format!(
            "kind = \"nurbs\"\ndegree = [1]\nknots_u = [0, 0, 1, 2, 2]\nnet = [[[0, 0, {z}, 1], \
             [1, 0, {z}, 1], [2, 0, {z}, 1]]]"
        );
        put(&format!("{name}.toml"), &text);
    }
    let morph = "kind = \"nurbs-morph\"\ntargets = [\"a.toml\", \"b.toml\", \"c.toml\"]\n\
                 weights = [[1, 1, 2]]\n[[design]]\nt = 0.5\n";
    let height = |design: &str, u: f64| {
        put("m.toml", &format!("{morph}{design}"));
        let file = open(&folder.path().join("m.toml")).unwrap();
        let Still::Curve(c) = file.object.at(0.5).unwrap() else { panic!("a curve") };
        c.point(u).z
    };
    // shares 1/4, 1/4, 1/2 as they are
    assert!((height("", 0.0) - 5.25).abs() < 1e-12);
    // at u = 0 the third gets 0.8, and the others share 0.2 evenly
    let pull = "impact = [{ centre = [0, 0], radius = [1, 1], to = 0.8, target = 2 }]";
    assert!((height(pull, 0.0) - 8.1).abs() < 1e-12);
    assert!((height(pull, 2.0) - 5.25).abs() < 1e-12);
    // the first: then the others keep 1 to 2
    let pull = "impact = [{ centre = [0, 0], radius = [1, 1], to = 0.4, target = 0 }]";
    assert!((height(pull, 0.0) - (0.2 + 4.0)).abs() < 1e-12);
    // a table for each target but the first
    let given = "distance = [[[0.1, 0.1, 0.1]], [[0.5, 0.5, 0.5]]]";
    assert!((height(given, 1.0) - 5.1).abs() < 1e-12);
}

#[test]
fn a_spine_runs_through_the_means() {
    let file = open(&shipped("shell-to-klein.toml")).unwrap();
    let spine = file.spine.as_ref().unwrap().points(0.4, 4).unwrap();
    let Still::Surface(s) = file.object.at(0.4).unwrap() else { panic!("a surface") };
    assert_eq!(spine.len(), s.patches());
    let round = |v: u32| std::f64::consts::TAU * f64::from(v) / 64.0;
    let mean = (0..64).map(|v| s.point(3, DVec2::new(0.25, round(v)))).sum::<DVec3>() / 64.0;
    assert!(mean.distance(spine[3][1]) < 1e-10);
}
