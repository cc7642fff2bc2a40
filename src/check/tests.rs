use super::*;
use glam::DAffine3;
use std::f64::consts::{PI, TAU};

/// A box from its corners.
pub(super) fn block(min: [f64; 3], max: [f64; 3]) -> TriMesh {
    let corners = Aabb::new(min.into(), max.into()).corners();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: corners.to_vec(), faces }
}

/// A grid of `n` by `m` quads, both ways round, over a map of [0, 1)².
fn wrapped(n: u32, m: u32, map: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    TriMesh {
        points: cells()
            .map(|(i, j)| map(f64::from(i) / f64::from(n), f64::from(j) / f64::from(m)))
            .collect(),
        faces: cells()
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect(),
    }
}

pub(super) fn torus(n: u32) -> TriMesh {
    wrapped(n, n / 2, |u, v| {
        let (ring, tube) = (u * TAU, v * TAU);
        let r = 10.0 + 3.0 * tube.cos();
        DVec3::new(r * ring.cos(), r * ring.sin(), 3.0 * tube.sin())
    })
}

/// An octahedron, split `n` times and blown up to a sphere.
pub(super) fn sphere(n: u32) -> TriMesh {
    let mut mesh = TriMesh {
        points: vec![DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z],
        faces: (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect(),
    };
    for _ in 0..n {
        let mut split = TriMesh::default();
        for i in 0..mesh.faces.len() {
            let [a, b, c] = mesh.corners(i);
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            for t in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                let first = split.points.len() as u32;
                split.points.extend(t);
                split.faces.push([first, first + 1, first + 2]);
            }
        }
        mesh = split;
    }
    mesh
}

fn both(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let mut sum = a.clone();
    sum.append(b);
    sum
}

fn flipped(mut mesh: TriMesh) -> TriMesh {
    mesh.flip();
    mesh
}

fn look(mesh: &TriMesh) -> Health {
    inspect(mesh, &Options::default())
}

#[track_caller]
fn near(got: Option<f64>, want: f64, within: f64) {
    let got = got.expect("the figure can be had");
    assert!((got - want).abs() <= within, "got {got}, want {want} within {within}");
}

#[test]
fn a_block() {
    let h = look(&block([1.0, 2.0, 3.0], [3.0, 5.0, 7.0]));
    assert!(h.closed && h.manifold_edges && h.manifold_vertices && h.oriented && h.printable);
    assert_eq!((h.triangles, h.vertices, h.components, h.genus), (12, 8, 1, Some(0)));
    assert_eq!((h.self_intersections, h.floating_parts, h.cavities), (Some(0), Some(0), Some(0)));
    near(h.volume_mm3, 24.0, 1e-12);
    near(Some(h.area_mm2), 52.0, 1e-12);
    assert_eq!(h.bbox_mm, [[1.0, 2.0, 3.0], [3.0, 5.0, 7.0]]);
}

#[test]
fn sphere_and_torus_are_clean() {
    // Every triangle of the sphere brings its own three points, as in an STL.
    let h = look(&sphere(4));
    assert_eq!((h.triangles, h.vertices, h.genus), (2048, 1026, Some(0)));
    assert_eq!((h.self_intersections, h.printable), (Some(0), true));
    // Facets of side h < 0.13 lie up to h²/6 below the sphere.
    near(h.volume_mm3, 4.0 / 3.0 * PI, 4.0 * PI * 0.13 * 0.13 / 6.0);

    let h = look(&torus(64));
    assert_eq!((h.genus, h.self_intersections, h.printable), (Some(1), Some(0), true));
    near(h.volume_mm3, 2.0 * PI * PI * 10.0 * 9.0, 20.0);
}

#[test]
fn genus_sums_over_components() {
    let mut far = torus(32);
    far.transform(&DAffine3::from_translation(DVec3::X * 100.0));
    let h = look(&both(&torus(32), &far));
    assert_eq!((h.components, h.genus, h.floating_parts), (2, Some(2), Some(1)));
}

#[test]
fn crossing_blocks_cut_each_other() {
    let mesh = both(&block([0.0; 3], [2.0; 3]), &block([1.0; 3], [3.0; 3]));
    let h = look(&mesh);
    assert!(h.closed && h.manifold_edges && !h.printable);
    // The corner of each block pierces three sides of the other.
    let met = intersecting_faces(&mesh).unwrap();
    assert_eq!(h.self_intersections, Some(met.len() as u64));
    let of_first = met.iter().filter(|&&i| i < 12).count();
    assert!((3..=6).contains(&of_first) && met.len() == 2 * of_first, "{met:?}");
    assert!(h.reasons[0].contains("cut or touch"), "{:?}", h.reasons);
}

#[test]
fn blocks_stacked_flush_touch() {
    let mesh = both(&block([0.0; 3], [3.0; 3]), &block([1.0, 1.0, 3.0], [2.0, 2.0, 4.0]));
    let met = intersecting_faces(&mesh).unwrap();
    assert!(met.iter().all(|&i| mesh.area_vector(i as usize).normalize().z.abs() > -1.0));
    assert!(met.contains(&2) && met.contains(&3) && met.contains(&12) && met.contains(&13));
}

#[test]
fn blocks_at_one_corner_split_its_vertex() {
    let h = look(&both(&block([0.0; 3], [1.0; 3]), &block([1.0; 3], [2.0; 3])));
    assert!(h.closed && h.manifold_edges && h.oriented && !h.manifold_vertices);
    assert_eq!((h.vertices, h.components, h.genus), (15, 2, None));
    assert_eq!(h.self_intersections, Some(0));
    assert_eq!(h.reasons, ["1 vertex joins fans that share no edge"]);
}

#[test]
fn blocks_at_one_edge_crowd_it() {
    let h = look(&both(&block([0.0; 3], [1.0; 3]), &block([1.0, 1.0, 0.0], [2.0, 2.0, 1.0])));
    assert!(h.closed && !h.manifold_edges && !h.manifold_vertices && h.oriented);
    assert_eq!((h.components, h.genus), (1, None));
    assert_eq!(h.reasons, ["1 edge has more than two triangles"]);
}

#[test]
fn inside_out_is_not_printable() {
    let h = look(&flipped(torus(32)));
    assert!(h.closed && h.manifold_edges && h.oriented && !h.printable);
    assert!(h.volume_mm3.unwrap() < 0.0);
    assert_eq!(h.reasons, ["its volume is negative: it is inside out"]);
}

#[test]
fn open_and_torn() {
    let mut mesh = block([0.0; 3], [1.0; 3]);
    mesh.faces.pop();
    let h = look(&mesh);
    assert!(!h.closed && !h.manifold_edges && h.manifold_vertices && h.oriented);
    assert_eq!((h.open_edges, h.volume_mm3, h.genus, h.floating_parts), (3, None, None, None));
    assert_eq!(h.reasons, ["3 edges are open"]);
}

#[test]
fn one_face_turned_over() {
    let mut mesh = block([0.0; 3], [1.0; 3]);
    mesh.faces[0].swap(0, 1);
    let h = look(&mesh);
    assert!(!h.closed && h.manifold_edges && h.manifold_vertices && !h.oriented);
    assert_eq!(h.reasons, ["3 edges have two triangles that disagree on the outside"]);
}

#[test]
fn a_fold_through_itself() {
    // A torus whose tube is wider than its ring: it cuts itself round the axis.
    let mesh = wrapped(24, 16, |u, v| {
        let (ring, tube) = (u * TAU, (v + 0.03) * TAU);
        let r = 2.0 + 3.0 * tube.cos();
        DVec3::new(r * ring.cos(), r * ring.sin(), 3.0 * tube.sin())
    });
    let h = look(&mesh);
    assert!(h.closed && h.manifold_edges && h.manifold_vertices && h.genus == Some(1));
    assert!(h.self_intersections.unwrap() > 24, "{:?}", h.self_intersections);

    // A corner of a block pushed through the far side.
    let mut mesh = block([0.0; 3], [1.0; 3]);
    mesh.points[7] = DVec3::new(0.5, 0.5, -1.0);
    assert!(look(&mesh).self_intersections.unwrap() >= 4);
}

#[test]
fn degenerate_and_duplicate_triangles_are_named() {
    let mut mesh = block([0.0; 3], [1.0; 3]);
    mesh.faces.push(mesh.faces[3]);
    mesh.faces.push([0, 0, 1]);
    mesh.points.push(DVec3::new(0.5, 0.0, 0.0));
    mesh.faces.push([0, 8, 1]);
    let h = look(&mesh);
    assert_eq!((h.degenerate_triangles, h.duplicate_triangles, h.vertices), (2, 1, 9));
    assert!(h.reasons.contains(&"2 triangles have no area".to_owned()), "{:?}", h.reasons);
    assert!(h.reasons.contains(&"1 triangle is a duplicate".to_owned()), "{:?}", h.reasons);
    assert_eq!(h.self_intersections, Some(2));
}

#[test]
fn nothing_and_nonsense() {
    let h = look(&TriMesh::default());
    assert!(!h.closed && !h.manifold_edges && !h.manifold_vertices && !h.oriented);
    assert_eq!((h.reasons.len(), h.bbox_mm), (1, [[0.0; 3]; 2]));

    let mut mesh = block([0.0; 3], [1.0; 3]);
    mesh.faces.push([0, 1, 99]);
    assert!(look(&mesh).reasons[0].contains("not there"));
    assert_eq!(drop_crumbs(&mesh, 0.5).0, mesh);
    assert!(!look(&TriMesh { points: vec![], faces: vec![[0, 1, 2]] }).printable);

    for wild in [f64::NAN, f64::INFINITY, 1e300] {
        let mut mesh = block([0.0; 3], [1.0; 3]);
        mesh.points[3].x = wild;
        assert_eq!(look(&mesh).self_intersections, None);
    }
}

#[test]
fn cavities_and_crumbs() {
    let inner = |min: f64, max: f64| block([min; 3], [max; 3]);
    let moved = |mut mesh: TriMesh, x: f64| {
        mesh.transform(&DAffine3::from_translation(DVec3::X * x));
        mesh
    };
    // A large hollow block, with a grain in its hollow; a small hollow block; a grain.
    let large = both(&inner(0.0, 10.0), &flipped(inner(2.0, 6.0)));
    let small = both(&inner(0.0, 2.0), &flipped(inner(0.5, 1.5)));
    let mut mesh = both(&moved(small, 20.0), &large);
    mesh.append(&inner(3.0, 3.5));
    mesh.append(&moved(inner(0.0, 0.5), 40.0));
    let h = look(&mesh);
    assert_eq!((h.components, h.floating_parts, h.cavities), (6, Some(3), Some(2)));
    assert_eq!(solid_pieces(&mesh), Pieces { solids: 4, cavities: 2 });
    let (labels, all) = parts(&mesh);
    assert_eq!((labels.len(), labels[0], labels[12], all.len()), (72, 0, 1, 6));
    near(Some(all[1].volume_mm3), -1.0, 1e-12);
    assert_eq!(all[2].bounds, Aabb::new(DVec3::ZERO, DVec3::splat(10.0)));

    let whole = 7.0 + (1000.0 - 64.0) + 0.125 + 0.125;
    let (kept, crumbs) = drop_crumbs(&mesh, 0.02);
    assert_eq!((kept.faces.len(), kept.points.len(), crumbs.count), (24, 16, 3));
    near(Some(crumbs.volume_mm3), 7.25, 1e-9);
    near(Some(crumbs.share), 7.25 / whole, 1e-12);
    near(Some(kept.volume()), 936.0, 1e-9);

    let (kept, crumbs) = drop_crumbs(&mesh, 0.001);
    assert_eq!((kept.faces.len(), crumbs.count), (48, 2));
    assert_eq!(drop_crumbs(&mesh, 0.0), (mesh, Crumbs::default()));
    // The largest stays whatever is asked.
    assert_eq!(drop_crumbs(&large, 2.0), (large, Crumbs::default()));
}

/// What is known of a mesh without its crumbs is what is found when it is looked at anew: of a clean one,
/// and of meshes that touch themselves, have holes, copies, or points twice.
#[test]
fn sweeping_tells_what_looking_again_tells() {
    let at = |x: f64| {
        let mut mesh = sphere(1);
        mesh.transform(&DAffine3::from_translation(DVec3::X * x));
        mesh
    };
    let clean = both(&both(&block([9.0; 3], [9.5; 3]), &torus(16)), &both(&at(30.0), &at(40.0)));
    assert_eq!(look(&clean).floating_parts, Some(3));
    let mut joined = clean.clone();
    // two balls with one point
    let (a, b) = (joined.faces[joined.faces.len() - 1][0], joined.faces[12][0]);
    joined.points[a as usize] = joined.points[b as usize];
    let mut holed = clean.clone();
    holed.faces.pop();
    let mut copied = clean.clone();
    copied.faces.extend(clean.faces[..3].to_vec());
    let mut turned = clean.clone();
    turned.faces[20].swap(0, 1);
    let mut unused = clean.clone();
    unused.points.insert(0, DVec3::ZERO);
    unused.faces.iter_mut().flatten().for_each(|v| *v += 1);
    let mut soup = TriMesh::default();
    for i in 0..clean.faces.len() as u32 {
        soup.points.extend(clean.corners(i as usize));
        soup.faces.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let options = Options { self_intersections: false };
    for (n, mesh) in [clean, joined, holed, copied, turned, unused, soup].into_iter().enumerate() {
        for share in [0.0, 1e-9, 1e-3, 0.05, 1.0] {
            let (left, crumbs) = drop_crumbs(&mesh, share);
            let swept = sweep(mesh.clone(), share, &options);
            assert_eq!((&swept.mesh, swept.crumbs), (&left, crumbs), "{n} {share}");
            assert_eq!(swept.health, inspect(&left, &options), "{n} {share}");
            assert_eq!((swept.pieces, swept.parts), (solid_pieces(&left), parts(&left)));
        }
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let mesh = both(&torus(64), &sphere(3));
    let on = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| look(&mesh))
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn json_has_the_agreed_names() {
    let json = serde_json::to_value(look(&block([0.0; 3], [1.0; 3]))).unwrap();
    for name in "triangles vertices closed manifold_edges manifold_vertices oriented \
        self_intersections components genus volume_mm3 area_mm2 bbox_mm min_wall_mm \
        floating_parts balanced printable reasons"
        .split_whitespace()
    {
        assert!(json.get(name).is_some(), "{name}");
    }
}

/// Copies of a ball that differ by rounding: every face meets another, and finding that out does not
/// take looking at all pairs.
#[test]
fn many_copies_within_rounding_all_meet() {
    let one = sphere(3);
    let (mut points, mut faces) = (vec![], vec![]);
    for copy in 0..150_u32 {
        let from = points.len() as u32;
        let off =
            |i: usize, axis: u32| f64::from((i as u32 * 7 + copy * 13 + axis * 5) % 101) * 1e-13;
        let moved = |(i, p): (usize, &DVec3)| *p + DVec3::new(off(i, 0), off(i, 1), off(i, 2));
        points.extend(one.points.iter().enumerate().map(moved));
        faces.extend(one.faces.iter().map(|f| f.map(|v| v + from)));
    }
    let mesh = TriMesh { points, faces };
    let met = intersecting_faces(&mesh).unwrap();
    assert!(met.len() * 100 > mesh.faces.len() * 99, "{} of {}", met.len(), mesh.faces.len());
}

#[test]
fn copies_of_faces_are_dropped_either_way_round() {
    let mut mesh = block([0.0; 3], [1.0, 2.0, 3.0]);
    let few = mesh.faces.len();
    assert_eq!(without_copies(mesh.clone()), mesh);
    let turned: Vec<[u32; 3]> = mesh.faces.iter().map(|f| [f[1], f[0], f[2]]).collect();
    let same = mesh.faces.clone();
    mesh.faces.extend(turned.into_iter().chain(same));
    assert_eq!(without_copies(mesh.clone()).faces, mesh.faces[..few]);
}
