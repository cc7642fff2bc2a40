use super::*;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

fn block(min: [f64; 3], max: [f64; 3]) -> TriMesh {
    let corners = Aabb::new(min.into(), max.into()).corners();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: corners.to_vec(), faces }
}

/// A globe of `n` strips of triangles; the poles' triangles have no area.
fn sphere(radius: f64, n: u32) -> TriMesh {
    let at = |i: u32, j: u32| {
        let ((sin, cos), (rise, run)) = (
            (f64::from(i % n) / f64::from(n) * TAU).sin_cos(),
            (f64::from(j) / f64::from(n) * PI).sin_cos(),
        );
        DVec3::new(rise * cos, rise * sin, -run) * radius
    };
    let mut mesh = TriMesh::default();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let first = mesh.points.len() as u32;
        mesh.points.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        mesh.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

fn small(view: View) -> Style {
    Style { size: [96, 96], view, ..Style::default() }
}

/// The mean of red less blue is 0 for the ground and its shadow, not for the mesh.
fn warmth(pixel: &[u8; 3]) -> i32 {
    i32::from(pixel[0]) - i32::from(pixel[2])
}

fn covered(image: &Image) -> usize {
    image.pixels().iter().filter(|p| warmth(p) > 20).count()
}

fn on(threads: usize, draw: impl Fn() -> Image + Send + Sync) -> Image {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(draw)
}

#[test]
fn a_sphere_covers_its_disc() {
    let frame = Some(Aabb::around(DVec3::ZERO, DVec3::splat(20.0)));
    for view in [View::Front, View::Side, View::Top] {
        let style = Style { size: [200, 200], frame, ..small(view) };
        let image = render(&sphere(10.0, 48), &style).unwrap();
        // 40 mm over 84% of 200 pixels.
        let radius = 10.0 * 0.84 * 200.0 / 40.0;
        let (got, want) = (covered(&image) as f64, PI * radius * radius);
        // A ring of pixels half covered, and the chords of 48 sides.
        assert!((got - want).abs() < TAU * radius * 0.5 + want * 0.01, "{view:?}: {got}, {want}");
    }
}

#[test]
fn the_mesh_fills_its_picture() {
    for (_, view) in View::ALL {
        let image =
            render(&block([-300.0, 5.0, 7.0], [-100.0, 80.0, 400.0]), &small(view)).unwrap();
        let rows = image.pixels().chunks(96).map(|row| row.iter().any(|p| warmth(p) > 20));
        let columns = (0..96).map(|x| (0..96).any(|y| warmth(&image.get(x, y).unwrap()) > 20));
        let (high, wide) = (rows.filter(|&r| r).count(), columns.filter(|&c| c).count());
        let want = 96.0 * 0.84;
        assert!((high.max(wide) as f64 - want).abs() <= 2.0, "{view:?}: {wide} x {high}");
    }
}

#[test]
fn front_is_seen_from_the_front() {
    // Low steps go up to the right (+X) and to the back (+Y).
    let mut mesh = block([0.0, 0.0, 0.0], [10.0, 10.0, 10.0]);
    mesh.append(&block([10.0, 0.0, 0.0], [20.0, 10.0, 30.0]));
    let image = render(&mesh, &small(View::Front)).unwrap();
    let reached = |x: u32| (0..96).filter(|&y| warmth(&image.get(x, y).unwrap()) > 20).count();
    assert!(reached(60) > 2 * reached(36), "{} {}", reached(60), reached(36));
    let image = render(&mesh, &small(View::Side)).unwrap();
    assert!(covered(&image) > 0);
}

#[test]
fn faces_seen_from_behind_are_warmer() {
    let mut mesh = block([0.0; 3], [10.0; 3]);
    let front = render(&mesh, &small(View::Iso)).unwrap();
    mesh.flip();
    let back = render(&mesh, &small(View::Iso)).unwrap();
    let mean = |i: &Image| i.pixels().iter().map(warmth).sum::<i32>() / covered(i) as i32;
    assert!(covered(&back).abs_diff(covered(&front)) < 60);
    assert!(mean(&back) > mean(&front) + 10, "{} {}", mean(&back), mean(&front));
    // Where a face lies twice, once each way round, the proper side is shown.
    mesh.append(&block([0.0; 3], [10.0; 3]));
    let both = render(&mesh, &small(View::Iso)).unwrap();
    assert!((mean(&both) - mean(&front)).abs() < 3, "{} {}", mean(&both), mean(&front));
}

#[test]
fn the_ground_is_dark_under_the_mesh_and_plain_far_off() {
    let mesh = block([0.0, 0.0, 40.0], [40.0, 40.0, 50.0]);
    let mut standing = block([0.0; 3], [1.0, 1.0, 40.0]);
    standing.append(&mesh);
    let image = render(&standing, &small(View::Iso)).unwrap();
    let plain = Style::default().background;
    assert_eq!(image.get(0, 0), Some(plain));
    let darkest = image.pixels().iter().filter(|p| warmth(p).abs() < 8).map(|p| p[1]).min();
    assert!(darkest.unwrap() < plain[1] - 25, "{darkest:?}");
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    // Fine enough that a coarser copy casts the shadows.
    let mesh = sphere(10.0, 240);
    let draw = || render(&mesh, &small(View::Iso)).unwrap();
    assert!(on(1, draw) == on(2, draw));
}

#[test]
fn nothing_to_draw_is_background() {
    let plain = Image::filled(96, 96, Style::default().background).unwrap();
    let point = DVec3::new(3.0, 4.0, 5.0);
    let meshes = [
        TriMesh::default(),
        TriMesh { points: vec![point; 3], faces: vec![[0, 1, 2]] },
        TriMesh {
            points: vec![DVec3::ZERO, point, point * 2.0],
            faces: vec![[0, 1, 2], [1, 1, 1]],
        },
        TriMesh { points: vec![DVec3::ZERO, DVec3::X, DVec3::NAN], faces: vec![[0, 1, 2]] },
        TriMesh { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y * 1e308], faces: vec![[0, 1, 2]] },
        TriMesh { points: vec![point], faces: vec![[0, 1, 2]] },
    ];
    for mesh in meshes {
        assert!(render(&mesh, &small(View::Iso)).unwrap() == plain, "{mesh:?}");
    }
}

#[test]
fn odd_meshes_do_no_harm() {
    let mut mesh = block([0.0; 3], [10.0; 3]);
    let whole = covered(&render(&mesh, &small(View::Iso)).unwrap());
    mesh.points.push(DVec3::splat(f64::NAN));
    mesh.points.push(DVec3::splat(1e30));
    mesh.faces.extend([[0, 1, 8], [0, 1, 99], [3, 3, 3]]);
    assert_eq!(covered(&render(&mesh, &small(View::Iso)).unwrap()), whole);
    // A sheet, edge on; a needle; a mesh far outside and far larger than its frame.
    let sheet = block([0.0, 0.0, 3.0], [10.0, 10.0, 3.0]);
    let needle = block([0.0; 3], [1e-9, 1e-9, 10.0]);
    let frame = Some(Aabb::around(DVec3::splat(5.0), DVec3::splat(1e-3)));
    for (_, view) in View::ALL {
        render(&sheet, &small(view)).unwrap();
        render(&needle, &small(view)).unwrap();
        for frame in [
            frame,
            Some(Aabb::EMPTY),
            Some(Aabb::ALL),
            Some(Aabb::around(DVec3::ZERO, DVec3::ZERO)),
        ] {
            render(&block([0.0; 3], [1e6; 3]), &Style { frame, ..small(view) }).unwrap();
        }
    }
}

#[test]
fn sizes_that_cannot_be() {
    for size in [[0, 5], [5, 0], [LARGEST + 1, 5]] {
        let style = Style { size, ..Style::default() };
        assert!(matches!(render(&TriMesh::default(), &style), Err(PictureError::Size { .. })));
    }
    for size in [[1, 1], [1, 300], [17, 5]] {
        let image = render(&sphere(1.0, 8), &Style { size, ..Style::default() }).unwrap();
        assert_eq!([image.width(), image.height()], size);
    }
}

#[test]
fn views_have_names() {
    for (name, view) in View::ALL {
        assert_eq!(name.parse::<View>(), Ok(view));
    }
    assert!("font".parse::<View>().unwrap_err().contains("front"));
}

#[test]
fn sheets() {
    let red = Image::filled(40, 30, [200, 0, 0]).unwrap();
    let cell =
        |image: Option<&Image>| Cell { image: image.cloned(), caption: "t = 0.5\ntwo".into() };
    let cells = [cell(Some(&red)), cell(None), cell(Some(&red))];
    let labelled = Layout {
        columns: 2,
        title: "a title".into(),
        row_labels: vec!["linear".into(), "graft".into(), "no such row".into()],
        column_labels: vec!["A".into(), "B".into()],
        ..Layout::default()
    };
    for layout in [labelled, Layout { columns: 0, ..Layout::default() }, Layout::default()] {
        let image = sheet(&cells, &layout).unwrap();
        let reds = image.pixels().iter().filter(|p| **p == [200, 0, 0]).count();
        assert_eq!(reds, 2 * 40 * 30, "both pictures whole");
        assert!(image.pixels().contains(&layout.ink), "some text");
    }
    assert!(matches!(sheet(&[], &Layout::default()), Err(PictureError::Size { .. })));
    let many = vec![cell(Some(&red)); 2000];
    let wide = Layout { columns: 2000, ..Layout::default() };
    assert!(matches!(sheet(&many, &wide), Err(PictureError::Size { .. })));
}

#[test]
fn png_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let mut image = Image::filled(3, 2, [1, 2, 3]).unwrap();
    image.pixels_mut()[4] = [250, 0, 128];
    save_png(&path, &image, false).unwrap();
    let read = ::image::open(&path).unwrap().into_rgb8();
    assert_eq!((read.width(), read.height()), (3, 2));
    assert_eq!(read.as_raw(), image.pixels().as_flattened());

    assert!(matches!(save_png(&path, &image, false), Err(PictureError::Exists(_))));
    save_png(&path, &image, true).unwrap();
    let nowhere = folder.path().join("no/such/picture.png");
    let error = save_png(&nowhere, &image, true).unwrap_err();
    assert!(matches!(&error, PictureError::Write { path, .. } if *path == nowhere));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing left beside it");
}
