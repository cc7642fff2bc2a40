use crate::job::Quiet;
use crate::num::Aabb;
use crate::recipe::Recipe;
use crate::scene::{Draft, Scene};
use glam::DVec3;
use std::path::Path;

/// A scene over the surface files that ship with the crate.
fn scene(text: &str) -> Result<Scene, String> {
    let surfaces = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/surfaces");
    let text = format!("version = 1\n[grid]\nresolution = 32\n{text}");
    let (recipe, source) = Recipe::parse(&text, Path::new("r.toml")).map_err(|e| e.to_string())?;
    let draft = Draft::open(recipe, source, &surfaces, &Quiet).map_err(|e| e.to_string())?;
    draft.build(&Quiet).map_err(|e| e.to_string())
}

fn near(b: Aabb, min: [f64; 3], max: [f64; 3], slack: f64) -> bool {
    (b.min - DVec3::from(min)).abs().max_element() < slack
        && (b.max - DVec3::from(max)).abs().max_element() < slack
}

fn field(scene: &Scene, t: f64) -> crate::field::Shared {
    scene.variants[0].morph(t, &Quiet).unwrap().at(t, &Quiet).unwrap()
}

#[test]
fn the_height_is_that_of_the_solid() {
    // 180 x 180 x 60 mm lying; one letter upright, 70 x 100, extruded along y
    let s = scene("[shapes.a]\nsurface = \"super-toroid.toml\"\nheight = 30\nplace = \"floor\"");
    let b = s.unwrap().shapes[0].bounds;
    assert!(near(b, [-45.0, -45.0, 0.0], [45.0, 45.0, 30.0], 0.5), "{b:?}");
    let shell = "[shapes.a]\nsurface = \"super-toroid.toml\"\nheight = 30\nplace = \"floor\"\n\
                 skin = \"shell\"\nthickness = 6";
    let s = scene(shell).unwrap();
    assert!((s.shapes[0].bounds.size().z - 30.0).abs() < 1e-9);
    assert!(near(s.shapes[0].field.support(), [-39.0, -39.0, 0.0], [39.0, 39.0, 30.0], 0.5));
    let letter = "[shapes.a]\nsurface = \"letter-e.toml\"\nheight = 50\nthickness = 8";
    let b = scene(letter).unwrap().shapes[0].bounds;
    assert!(near(b, [0.0, 0.0, 0.0], [35.0, 8.0, 50.0], 1e-6), "{b:?}");
    let y = "[shapes.a]\nsurface = \"letter-e.toml\"\nthickness = 8\nup = \"y\"\nunit = \"cm\"";
    let b = scene(y).unwrap().shapes[0].bounds;
    assert!(near(b, [0.0, -1000.0, 0.0], [700.0, 0.0, 8.0], 1e-6), "{b:?}");
    let e = scene("[shapes.a]\nsurface = \"letter-e.toml\"\nheight = 5\nthickness = 8\nup = \"y\"");
    assert!(e.err().unwrap().contains("shapes.a.height: "));
}

#[test]
fn what_encloses_nothing_needs_a_thickness() {
    for (file, why) in [
        ("klein-bottle.toml", "closed with one side only"),
        ("shell.toml", "open ("),
        ("dynamic-plate.toml", "open ("),
        ("letter-e.toml", "a curve encloses nothing"),
    ] {
        let e = scene(&format!("[shapes.a]\nsurface = \"{file}\"")).err().unwrap();
        for part in ["shapes.a.thickness: ", file, why, "`thickness`"] {
            assert!(e.contains(part), "{file}: {part}: {e}");
        }
    }
}

#[test]
fn a_motion_is_placed_once() {
    let text = |t: &str, more: &str| {
        format!(
            "[shapes.a]\nsurface = \"blend-cylinders.toml\"\nthickness = 20\nheight = 100\n\
             place = \"floor\"\n{more}\n[morph]\nt = {t}"
        )
    };
    let all = scene(&text("[0, 0.5, 1]", "")).unwrap();
    let one = scene(&text("[0.5]", "")).unwrap();
    // half way the box is the smaller, the cells finer, and the shape where it was
    assert!(one.lattice.step < all.lattice.step);
    let held = scene(&text("[0.5]", "at = 0.5")).unwrap();
    assert!(!held.shapes[0].moves() && all.shapes[0].moves());
    let (a, b) = (field(&all, 0.5), field(&one, 0.5));
    let (start, end) = (field(&all, 0.0), field(&all, 1.0));
    let (mut most, mut changed) = (0.0f64, 0.0f64);
    for i in 0..1000 {
        let r = |k: f64| (f64::from(i) * k).fract() * 160.0 - 80.0;
        let p = DVec3::new(r(0.618_034), r(0.754_878), r(0.569_84) + 80.0);
        most = most.max((a.value(p) - b.value(p)).abs());
        changed = changed.max((start.value(p) - end.value(p)).abs());
    }
    assert!(most < all.lattice.step * 0.2, "{most}");
    assert!(changed > 10.0, "{changed}");
    // the ends of the ellipses at t = 1 are far outside those at t = 0
    let volume = all.variants[0].mean_volume(0.5);
    assert!(volume.is_nan(), "one shape alone is compared with nothing");
}

#[test]
fn a_shape_that_moves_is_another_at_each_time_of_a_morph() {
    let s = scene(
        "[shapes.a]\nsurface = \"blend-cylinders.toml\"\nthickness = 20\n\
         [shapes.b]\nsurface = \"super-toroid.toml\"\nplace = { like = \"a\" }\n\
         [morph]\nbetween = [\"a\", \"b\"]\nmethod = \"linear\"\nt = [0, 0.25]",
    )
    .unwrap();
    let v = &s.variants[0];
    assert!(s.shapes[0].moves() && !s.shapes[1].moves());
    let (at_0, later) = (v.mean_volume(0.0), v.mean_volume(0.25));
    assert!((at_0 / s.shapes[0].volume - 1.0).abs() < 1e-12);
    let still = 0.75 * at_0 + 0.25 * s.shapes[1].volume;
    assert!((later / still - 1.0).abs() > 0.01, "{later} {still}");
    assert!(s.lattice.bounds().contains(s.shapes[0].bounds.max));
}

#[test]
fn ends_of_surface_methods_are_the_shapes() {
    for (a, b, method, more) in [
        ("super-ellipsoid", "super-toroid", "pde-boundary", ""),
        ("super-ellipsoid", "super-toroid", "pde-modes", ""),
        ("super-ellipsoid", "super-toroid", "pde-combined", ""),
        ("super-ellipsoid", "super-toroid", "pde-spine", ""),
        ("vase-bellied", "vase-flared", "nurbs-linear", ""),
        ("vase-bellied", "vase-flared", "nurbs-weighted", ""),
        ("letter-e", "letter-g", "nurbs-weighted", "thickness = 10"),
    ] {
        let text = format!(
            "[shapes.a]\nsurface = \"{a}.toml\"\nheight = 90\n{more}\n[shapes.b]\nsurface = \
             \"{b}.toml\"\nplace = {{ like = \"a\" }}\n{more}\nmove = [5, 0, 0]\n\
             [morph]\nbetween = [\"a\", \"b\"]\nmethod = \"{method}\"\nt = [0, 1]"
        );
        let s = scene(&text).unwrap_or_else(|e| panic!("{method}: {e}"));
        let step = s.lattice.step;
        for (t, shape) in [(0.0, &s.shapes[0]), (1.0, &s.shapes[1])] {
            let made = field(&s, t);
            // both are signed distances: where one is near its surface so is the other
            let b = shape.bounds.grow(step);
            for i in 0..4000 {
                let r = |k: f64| (f64::from(i) * k).fract();
                let p = b.min + b.size() * DVec3::new(r(0.618_034), r(0.754_878), r(0.569_84));
                let (x, y) = (made.value(p), shape.field.value(p));
                assert!((x - y).abs() < step, "{method} at t = {t}, {p}: {x} and {y}");
            }
        }
    }
}

#[test]
fn surface_methods_take_two_surfaces_of_their_kind_made_alike() {
    let text = |b: &str, method: &str| {
        format!(
            "[shapes.a]\nsurface = \"shell.toml\"\nthickness = 4\n[shapes.b]\n{b}\n\
             [morph]\nbetween = [\"a\", \"b\"]\nmethod = \"{method}\"\nt = [0.5]"
        )
    };
    for (b, method, why) in [
        (
            "surface = \"klein-bottle.toml\"\nthickness = 5",
            "pde-spine",
            "shapes.b.thickness: 5 mm, and shapes.a.thickness is 4 mm",
        ),
        (
            "surface = \"vase-flared.toml\"\nthickness = 4",
            "pde-spine",
            "pde-spine morphs two files of kind `pde`",
        ),
        (
            "mesh = \"../chairs/shell.ply\"",
            "pde-modes",
            "morph.method: pde-modes morphs two surface files of kind pde; `b` is no surface file",
        ),
        ("surface = \"klein-bottle.toml\"\nthickness = 4", "pde-spin", "did you mean `pde-spine`?"),
    ] {
        let e = scene(&text(b, method)).err().unwrap_or_default();
        assert!(e.contains(why), "{why}\n got: {e}");
    }
}

#[test]
fn surface_keys_are_for_surfaces() {
    for (shape, why) in [
        ("mesh = \"x.stl\"\nthickness = 3", "shapes.a.thickness: is for surfaces"),
        ("mesh = \"x.stl\"\nskin = \"shell\"", "shapes.a.skin: is for surfaces"),
        ("surface = \"x.toml\"\nthicken = 3", "shapes.a.thicken: is for meshes; a surface has"),
        ("surface = \"x.toml\"\nsign = \"unsigned\"", "shapes.a.sign: is for meshes"),
        ("surface = \"x.toml\"\nmesh = \"x.stl\"", "both `mesh` and `surface`"),
        ("surface = \"x.toml\"\nskin = \"shell\"", "shapes.a.skin: a shell has a thickness"),
        ("surface = \"x.toml\"\nat = 1.5", "shapes.a.at: got 1.5; expected 0 to 1"),
        ("surface = \"x.toml\"\nthickness = 0", "shapes.a.thickness: got 0"),
        ("surface = \"x.toml\"\nthicknes = 1", "did you mean `thickness`?"),
        ("surface = \"x.toml\"\nskin = \"shel\"", "did you mean `shell`?"),
    ] {
        let e = scene(&format!("[shapes.a]\n{shape}")).err().unwrap();
        assert!(e.contains(why), "{why}\n got: {e}");
    }
}
