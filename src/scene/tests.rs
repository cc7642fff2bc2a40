use super::{Draft, Scene, SceneError};
use crate::job::Quiet;
use crate::recipe::Recipe;
use std::path::Path;

/// Two boxes and a cylinder, with one feature each, and the rest of a recipe.
fn recipe(rest: &str) -> String {
    format!(
        r#"version = 1
[grid]
resolution = 24
[shapes.a]
solid = {{ parts = [{{ box = {{ center = [0, 0, 5], size = [20, 20, 10] }} }}] }}
[shapes.b]
solid = {{ parts = [{{ cylinder = {{ from = [50, 0, 10], to = [50, 0, 40], radius = 10 }} }}] }}
place = {{ like = "a" }}
[shapes.c]
solid = {{ parts = [{{ box = {{ center = [9, 9, 9], size = [10, 20, 40] }} }}] }}
place = "floor"
height = 20
turn_deg = 90
move = [0, 0, 1]
[[features]]
name = "body"
on.a.box = {{ center = [0, 0, 5], size = [22, 22, 12] }}
on.b.box = {{ center = [0, 0, 15], size = [22, 22, 32] }}
on.c.box = {{ center = [0, 0, 11], size = [12, 7, 22] }}
{rest}"#
    )
}

fn scene(rest: &str) -> Result<Scene, String> {
    let text = recipe(rest);
    let (recipe, source) = Recipe::parse(&text, Path::new("r.toml")).map_err(|e| e.to_string())?;
    Draft::open(recipe, source, Path::new(""), &Quiet).and_then(|d| d.build(&Quiet)).map_err(|e| {
        match e {
            SceneError::Bad(e) => e.to_string(),
            SceneError::Cancelled(e) => e.to_string(),
        }
    })
}

#[test]
fn shapes_stand_where_they_are_told() {
    let s = scene("[morph]\namong = [\"a\", \"b\", \"c\"]").unwrap();
    let near = |b: crate::num::Aabb, min: [f64; 3], max: [f64; 3]| {
        let slack = 0.2; // round sections are taken as polygons
        (b.min - glam::DVec3::from(min)).abs().max_element() < slack
            && (b.max - glam::DVec3::from(max)).abs().max_element() < slack
    };
    let of = |name: &str| s.shapes.iter().find(|s| s.name == name).unwrap();
    assert!(near(of("a").bounds, [-10.0, -10.0, 0.0], [10.0, 10.0, 10.0]));
    assert!(near(of("b").bounds, [-10.0, -10.0, 0.0], [10.0, 10.0, 30.0]));
    // half the size, turned by a right angle, on the floor, then up by 1
    assert!(near(of("c").bounds, [-5.0, -2.5, 1.0], [5.0, 2.5, 21.0]));
    assert!((of("a").volume / 4000.0 - 1.0).abs() < 0.05, "{}", of("a").volume);
    assert!(s.lattice.bounds().contains(glam::DVec3::new(10.0, 10.0, 30.0)));
}

#[test]
fn only_shapes_that_take_part_are_made() {
    let s = scene("[morph]\nbetween = [\"b\", \"c\"]").unwrap();
    let names: Vec<&str> = s.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c"], "b stands like a");
    let s = scene("[morph]\nbetween = [\"a\", \"c\"]").unwrap();
    assert_eq!(s.shapes.len(), 2);
}

#[test]
fn mean_volumes_follow_time_and_weights() {
    let s = scene("[morph]\nbetween = [\"a\", \"c\"]\nt = [0, 0.25, 1]").unwrap();
    let v = &s.variants[0];
    let (a, c) = (s.shapes[0].volume, s.shapes[1].volume);
    assert_eq!(v.mean_volume(0.0), a);
    assert!((v.mean_volume(0.25) - (0.75 * a + 0.25 * c)).abs() < 1e-9);
    assert_eq!(v.times, [0.0, 0.25, 1.0]);
    let s = scene("[morph]\namong = [\"a\", \"c\"]\nweights.body = { c = 2 }").unwrap();
    assert_eq!(s.variants[0].mean_volume(0.5), c, "one feature's row is the whole's");
}

/// A row `default` by hand names the shape of most features, not the mean of the hybrid.
#[test]
fn mean_volumes_are_those_of_the_features_unless_auto_chose_them() {
    let more = |rest: &str| {
        let feature = "[[features]]\nname = \"NAME\"\n\
            on.a.box = { center = [0, 0, 5], size = [22, 22, 12] }\n\
            on.c.box = { center = [0, 0, 11], size = [12, 7, 22] }\n";
        let features: String = ["x", "y", "z"].map(|n| feature.replace("NAME", n)).concat();
        let s = scene(&format!(
            "{features}[morph]\nmethod = \"group\"\namong = [\"a\", \"c\"]\n{rest}"
        ))
        .unwrap();
        let v = [s.shapes[0].volume, s.shapes[1].volume];
        (s.variants[0].mean_volume(0.25) - v[0]) / (v[1] - v[0])
    };
    let rows = "weights.x = { c = 1 }\nweights.default = { a = 1 }\n";
    let near = |got: f64, share: f64| assert!((got - share).abs() < 1e-9, "{got} {share}");
    near(more(rows), 0.25);
    near(more(&format!("{rows}deform_weights.default = {{ a = 3, c = 2 }}")), 0.4);
    // half of a pair's parts change early
    let early = "parts.x.t = [[0, 0], [0.25, 1]]\n";
    near(more(early), 0.25);
    near(more(""), 0.25);
}

#[test]
fn methods_are_chosen_by_what_is_there() {
    use crate::recipe::MethodEntry::{Graft, Group};
    assert_eq!(scene("[morph]\nbetween = [\"a\", \"c\"]").unwrap().variants[0].method, Graft);
    assert_eq!(scene("[morph]\namong = [\"a\", \"b\", \"c\"]").unwrap().variants[0].method, Group);
}

#[test]
fn what_cannot_be_is_told_by_its_key() {
    for (rest, expected) in [
        ("", "morph: which shapes?"),
        ("[morph]\namong = []", "morph.among: no shape"),
        (
            "[morph]\namong = [\"a\"]\nmethod = \"linear\"",
            "morph.method: this morph is of one shape",
        ),
        ("[morph]\namong = [\"a\"]\nt = [0, 1]", "morph.t: nothing depends on t: no shape moves"),
        ("[morph]\namong = [\"a\", \"c\", \"a\"]", "morph.among: `a` is there twice"),
        ("[morph]\nmethod = \"graft\"\namong = [\"a\", \"b\", \"c\"]", "here are 3; use \"group\""),
        (
            "[morph]\nbetween = [\"a\", \"c\"]\nweights.body = { a = 1 }\nt = [0, 1]",
            "morph.t: nothing depends on t",
        ),
        ("[morph]\nbetween = [\"a\", \"c\"]\nframes = \"b\"", "morph.frames: `b` takes no part"),
        (
            "[morph]\nbetween = [\"a\", \"c\"]\nspace-time.a = [1, 2, 3]",
            "morph.space-time.a: 3 numbers for 2 shapes",
        ),
        (
            "[[features]]\nname = \"leg\"\non.a.box = { center = [0, 0, 0], size = [1, 1, 1] }\n\
             [morph]\nbetween = [\"a\", \"c\"]",
            "features[1].on: feature `leg` has no element on `c`",
        ),
        (
            "[[features]]\nname = \"leg\"\non.a.box = { center = [0, 0, 0], size = [1, 1, 1] }\n\
             on.c.mesh = { file = \"none.stl\" }\n[morph]\nbetween = [\"a\", \"c\"]",
            "features[1].on.c.mesh: none.stl: cannot read",
        ),
        (
            "[[hybrids]]\nname = \"x\"\nbetween = [\"a\", \"c\"]\nmethod = \"space-time\"\n\
             space-time.form = \"half-cylinders\"\n[[hybrids]]\nname = \"y\"\n\
             among = [\"a\", \"b\", \"c\"]\nmethod = \"space-time\"\n\
             space-time.form = \"half-cylinders\"",
            "hybrids[1]: space-time form `half-cylinders` takes two shapes",
        ),
    ] {
        let e = scene(rest).err().unwrap_or_default();
        assert!(e.contains(expected), "{rest}\n expected: {expected}\n got: {e}");
    }
}

#[test]
fn cells_too_fine_for_a_file_are_refused() {
    let text = recipe("[morph]\nbetween = [\"a\", \"c\"]")
        .replace("resolution = 24", "voxel = 0.0001")
        .replace("move = [0, 0, 1]", "move = [0, 0, 100000]");
    let (recipe, source) = Recipe::parse(&text, Path::new("r.toml")).unwrap();
    let draft = Draft::open(recipe, source, Path::new(""), &Quiet).unwrap();
    let e = draft.build(&Quiet).err().unwrap().to_string();
    assert!(e.contains("grid: cells of 0.0001 mm are too fine"), "{e}");
}

#[test]
fn dominant_frames_are_those_of_the_heavier_shape() {
    let inside = |frames: &str, t: f64, z: f64| {
        let s = scene(&format!("[morph]\nbetween = [\"a\", \"c\"]\nframes = \"{frames}\""));
        let morph = s.unwrap().variants[0].morph(t, &Quiet).unwrap();
        morph.at(t, &Quiet).unwrap().value(glam::DVec3::new(0.0, 0.0, z)) < 0.0
    };
    // a is 10 high in a frame of 12, c reaches 20/22 of its own; in a's frame both end below 10.5,
    // in the mean frame at 0.4 a ends near 13.8
    assert!(inside("dominant", 0.4, 9.0) && !inside("dominant", 0.4, 11.5));
    assert!(inside("average", 0.4, 11.5));
    // c ends at 21 in its own frame
    assert!(inside("dominant", 0.6, 20.0) && inside("c", 0.4, 18.0));
}

#[test]
fn a_turned_mesh_has_the_field_of_the_mesh_turned() {
    use crate::field::Field;
    use crate::field::mesh::{MeshField, MeshOptions};
    use crate::recipe::{GridEntry, ShapeEntry};
    use glam::{DAffine3, DQuat, DVec3};
    let file = Path::new("data/chairs/plank.stl");
    let shift = DVec3::new(12.0, -7.0, 30.0);
    let entry = ShapeEntry {
        mesh: Some(file.to_owned()),
        turn_deg: 33.0,
        shift: shift.to_array(),
        ..ShapeEntry::default()
    };
    let single = super::Single::open("p", entry, &GridEntry::default(), Path::new("")).unwrap();
    let bounds = single.bounds();
    let (field, _) = single.field(&Quiet).unwrap();
    let mut mesh = crate::mesh::read(file, crate::mesh::Assume::default()).unwrap().mesh;
    let turn = DQuat::from_rotation_z(33f64.to_radians());
    mesh.transform(&DAffine3::from_rotation_translation(turn, shift));
    let (expected, _) = MeshField::new(&mesh, &MeshOptions::default(), &Quiet).unwrap();
    for i in 0..200u32 {
        let part = |by: u32| f64::from(i * by % 199) / 199.0;
        let p = bounds.min + bounds.size() * DVec3::new(part(17), part(59), part(101));
        let (a, b) = (field.value(p), expected.value(p));
        assert!((a - b).abs() < 1e-9, "{p}: {a} {b}");
    }
}
