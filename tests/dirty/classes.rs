//! What goes wrong with meshes: each class makes one of a clean solid, or several.

use super::solids::{all, ball, block, split, union};
use crate::util::Random;
use fieldgraft::mesh::TriMesh;
use glam::{DVec3, dvec3};

/// A dirty mesh, the volume of what it means, and how near the result has to come to that.
pub struct Dirty {
    pub name: String,
    pub mesh: TriMesh,
    pub volume: f64,
    pub within: f64,
    /// Longest side of what is meant, mm.
    pub size: f64,
}

/// One way to spoil a mesh: its name, the tolerance it allows, and how.
type Class = (&'static str, f64, fn(&TriMesh, &mut Random) -> TriMesh);

/// Ways that leave the volume as it was. 2% but where a hole makes the solid itself a guess.
const CLASSES: &[Class] = &[
    ("clean", 0.02, |m, _| m.clone()),
    ("soup", 0.02, |m, _| soup(m)),
    ("seams within rounding", 0.02, |m, r| cracked(m, r, 1e-6)),
    ("cracked seams", 0.02, |m, r| cracked(m, r, 0.02)),
    ("duplicates", 0.02, duplicates),
    ("flipped duplicates", 0.02, flipped_duplicates),
    ("triangles thrice, once flipped", 0.02, thrice),
    ("degenerate triangles", 0.02, degenerate),
    ("T-junctions", 0.02, t_junctions),
    ("small holes", 0.02, small_holes),
    ("a large hole", 0.06, large_hole),
    ("flipped patches", 0.02, flipped_patches),
    ("inside out", 0.02, |m, _| flipped(m)),
    ("every triangle flipped or not", 0.02, random_flips),
    ("flipped soup", 0.02, |m, r| soup(&random_flips(m, r))),
    ("a wall inside", 0.02, wall_inside),
    ("a double sheet beside", 0.02, double_sheet),
    ("far stray points", 0.02, stray),
    ("tiny crumbs", 0.02, crumbs),
    ("needles", 0.02, needles),
    ("caps", 0.02, caps),
    ("as a file of six digits", 0.02, six_digits),
    ("as a file of f32", 0.02, |m, _| moved(m, |p| p.as_vec3().as_dvec3())),
    // positions of results are f32, which have sixteen numbers a mm there, and cells are half a mm
    ("a million mm away", 0.06, |m, _| moved(m, away)),
    ("a million mm away in f32", 0.06, |m, _| moved(m, |p| away(p).as_vec3().as_dvec3())),
    ("a million mm away in decimals, brought back", 0.02, |m, _| moved(m, away_and_back)),
    ("all at once", 0.06, all_at_once),
];

/// Ways that change the scale with it.
const SCALES: [(&str, f64); 2] = [("a millionth", 1e-6), ("a million times", 1e6)];

/// All of them.
pub fn dirty() -> Vec<Dirty> {
    let mut out = vec![];
    for (class, within, spoil) in CLASSES {
        for (n, (solid, mesh)) in all().iter().enumerate() {
            let mesh_dirty = spoil(mesh, &mut Random::new(100 + n as u64));
            let name = format!("{class}: {solid}");
            out.push(Dirty {
                name,
                mesh: mesh_dirty,
                volume: mesh.volume(),
                within: *within,
                size: longest(mesh),
            });
        }
    }
    for (class, scale) in SCALES {
        for (solid, mesh) in all() {
            let name = format!("{class}: {solid}");
            let volume = mesh.volume() * scale * scale * scale;
            out.push(Dirty {
                name,
                mesh: moved(&mesh, |p| p * scale),
                volume,
                within: 0.02,
                size: longest(&mesh) * scale,
            });
        }
    }
    out.extend(shells());
    out.extend(boxes());
    out
}

/// The number of classes.
pub fn classes() -> usize {
    let name = |d: &Dirty| d.name.split(':').next().unwrap_or_default().to_owned();
    dirty().iter().map(name).collect::<std::collections::BTreeSet<_>>().len()
}

/// Longest side, mm.
fn longest(m: &TriMesh) -> f64 {
    m.bounds().size().max_element()
}

fn moved(m: &TriMesh, to: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh { points: m.points.iter().map(|&p| to(p)).collect(), faces: m.faces.clone() }
}

fn away(p: DVec3) -> DVec3 {
    p + dvec3(1e6, -1e6, 1e6)
}

/// As written in a file with all its digits, and stood on the floor.
fn away_and_back(p: DVec3) -> DVec3 {
    let text = away(p).to_array().map(|x| format!("{x}"));
    DVec3::from(text.map(|x| x.parse().unwrap_or(f64::NAN))) - away(DVec3::ZERO)
}

fn flipped(m: &TriMesh) -> TriMesh {
    let mut m = m.clone();
    m.flip();
    m
}

fn together(parts: &[&TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    parts.iter().for_each(|p| all.append(p));
    all
}

fn soup(m: &TriMesh) -> TriMesh {
    let points = m.faces.iter().flatten().map(|&v| m.points[v as usize]).collect();
    TriMesh {
        points,
        faces: (0..m.faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    }
}

/// Every corner moved by up to that many mm.
fn cracked(m: &TriMesh, r: &mut Random, mm: f64) -> TriMesh {
    let mut m = soup(m);
    m.points.iter_mut().for_each(|p| *p += r.vector() * mm);
    m
}

fn duplicates(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for i in 0..m.faces.len() {
        let [a, b, c] = m.faces[i];
        for turned in [[b, c, a], [c, a, b]] {
            if r.below(3) == 0 {
                m.faces.push(turned);
            }
        }
    }
    m
}

fn flipped_duplicates(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for i in 0..m.faces.len() {
        let [a, b, c] = m.faces[i];
        if r.below(10) == 0 {
            m.faces.push([b, a, c]);
        }
    }
    m
}

fn thrice(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for i in 0..m.faces.len() {
        let [a, b, c] = m.faces[i];
        if r.below(5) == 0 {
            m.faces.extend([[b, a, c], [b, c, a]]);
        }
    }
    m
}

fn degenerate(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for i in 0..m.faces.len() {
        let [a, b, _] = m.faces[i];
        let middle = (m.points[a as usize] + m.points[b as usize]) * 0.5;
        match r.below(8) {
            0 => m.faces.push([a, a, b]),
            1 => m.faces.push([a, a, a]),
            2 => {
                m.points.push(middle);
                m.faces.push([a, b, m.points.len() as u32 - 1]);
            }
            3 => {
                m.points.push(m.points[a as usize]);
                m.faces.push([a, b, m.points.len() as u32 - 1]);
            }
            _ => {}
        }
    }
    m
}

/// Faces cut in two over a side; the neighbour there stays whole.
fn t_junctions(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut out = TriMesh { points: m.points.clone(), faces: vec![] };
    for &[a, b, c] in &m.faces {
        if r.below(3) != 0 {
            out.faces.push([a, b, c]);
            continue;
        }
        let x = 0.25 + 0.5 * r.share();
        out.points.push(m.points[a as usize].lerp(m.points[b as usize], x));
        let n = out.points.len() as u32 - 1;
        out.faces.extend([[a, n, c], [n, b, c]]);
    }
    out
}

fn small_holes(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    m.faces.retain(|_| r.below(60) != 0);
    m
}

/// Faces round a face, within a distance.
fn patch(m: &TriMesh, seed: usize, radius: f64) -> Vec<usize> {
    let middle = |i: usize| {
        let [a, b, c] = m.corners(i);
        (a + b + c) / 3.0
    };
    let at = middle(seed);
    (0..m.faces.len()).filter(|&i| middle(i).distance(at) < radius).collect()
}

fn large_hole(m: &TriMesh, r: &mut Random) -> TriMesh {
    let gone = patch(m, r.below(m.faces.len()), 3.5);
    let mut n = 0..;
    let mut m = m.clone();
    m.faces.retain(|_| n.next().is_none_or(|i| !gone.contains(&i)));
    m
}

fn flipped_patches(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for _ in 0..3 {
        for i in patch(&m, r.below(m.faces.len()), 4.0) {
            m.faces[i].swap(0, 1);
        }
    }
    m
}

fn random_flips(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    m.faces.iter_mut().for_each(|f| {
        if r.below(2) == 0 {
            f.swap(0, 1)
        }
    });
    m
}

/// A single sheet right through, cut off at the box.
fn wall_inside(m: &TriMesh, _: &mut Random) -> TriMesh {
    let b = m.bounds();
    let (lo, hi) = (b.centre() - b.size() * 0.1, b.centre() + b.size() * 0.1);
    let wall = TriMesh {
        points: vec![lo, dvec3(hi.x, lo.y, lo.z), hi, dvec3(lo.x, hi.y, hi.z)],
        faces: vec![[0, 1, 2], [0, 2, 3]],
    };
    together(&[m, &wall])
}

fn double_sheet(m: &TriMesh, _: &mut Random) -> TriMesh {
    let b = m.bounds();
    let z = b.max.z + 3.0;
    let at = |x: f64, y: f64| dvec3(x, y, z);
    let points = vec![
        at(b.min.x, b.min.y),
        at(b.max.x, b.min.y),
        at(b.max.x, b.max.y),
        at(b.min.x, b.max.y),
    ];
    let sheet = TriMesh { points, faces: vec![[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]] };
    together(&[m, &sheet])
}

fn stray(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for _ in 0..50 {
        m.points.push(r.vector() * 1e9);
    }
    m.points.push(DVec3::NAN);
    m
}

fn crumbs(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut m = m.clone();
    for _ in 0..40 {
        let at = r.vector() * 12.0;
        m.append(&block(at, at + DVec3::splat(0.02)));
    }
    m
}

/// Faces cut at a point very near a side.
fn needles(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut out = TriMesh { points: m.points.clone(), faces: vec![] };
    for &[a, b, c] in &m.faces {
        let [p, q, s] = [a, b, c].map(|v| m.points[v as usize]);
        let near = 10f64.powf(-3.0 - 5.0 * r.share());
        let x = r.share();
        out.points.push(p.lerp(q, x).lerp(s, near));
        let n = out.points.len() as u32 - 1;
        out.faces.extend([[a, b, n], [b, c, n], [c, a, n]]);
    }
    out
}

/// Faces cut at a point very near a corner, twice.
fn caps(m: &TriMesh, r: &mut Random) -> TriMesh {
    let mut out = TriMesh { points: m.points.clone(), faces: vec![] };
    for &[a, b, c] in &m.faces {
        let [p, q, s] = [a, b, c].map(|v| m.points[v as usize]);
        let near = 10f64.powf(-2.0 - 5.0 * r.share());
        out.points.push(p.lerp((q + s) * 0.5, near));
        let n = out.points.len() as u32 - 1;
        out.faces.extend([[a, b, n], [b, c, n], [c, a, n]]);
    }
    out
}

fn six_digits(m: &TriMesh, _: &mut Random) -> TriMesh {
    moved(&soup(m), |p| DVec3::from(p.to_array().map(|x| format!("{x:.5e}").parse().unwrap_or(x))))
}

fn all_at_once(m: &TriMesh, r: &mut Random) -> TriMesh {
    let m = t_junctions(m, r);
    let m = degenerate(&m, r);
    let m = small_holes(&m, r);
    let m = double_sheet(&duplicates(&m, r), r);
    stray(&cracked(&m, r, 5e-6), r)
}

/// Shells in shells.
fn shells() -> Vec<Dirty> {
    let mut out = vec![];
    for (solid, mesh) in all() {
        let inner = |scale: f64| match solid {
            "ring" => super::solids::torus(8.0, 3.5 * scale * 0.8, 24),
            "chair" => {
                // in its seat
                let seat = block(dvec3(1.0, 1.0, 8.8), dvec3(8.8, 8.8, 10.8));
                let c = seat.bounds().centre();
                moved(&seat, |p| c + (p - c) * scale)
            }
            _ => moved(&mesh, |p| p * scale),
        };
        let (a, b) = (inner(0.8), inner(0.5));
        let v = mesh.volume();
        let mut add = |class: &str, parts: &[&TriMesh], volume: f64| {
            let name = format!("{class}: {solid}");
            out.push(Dirty {
                name,
                mesh: together(parts),
                volume,
                within: 0.02,
                size: longest(&mesh),
            });
        };
        add("a solid in a solid", &[&mesh, &a], v);
        add("a cavity", &[&mesh, &flipped(&a)], v - a.volume());
        add("a solid in a cavity", &[&mesh, &flipped(&a), &b], v - a.volume() + b.volume());
        add("a cavity, inside out", &[&flipped(&mesh), &a], v - a.volume());
        add("the same solid twice", &[&mesh, &mesh], v);
        add("the same solid on both sides", &[&mesh, &flipped(&mesh)], v);
    }
    out
}

/// Boxes that cross, touch over faces, edges and corners, or lie flush.
fn boxes() -> Vec<Dirty> {
    let mut out = vec![];
    let mut add = |class: &str, n: usize, boxes: &[(DVec3, DVec3)], flips: u64| {
        let mut r = Random::new(flips);
        let parts: Vec<TriMesh> = boxes
            .iter()
            .map(|&(lo, hi)| {
                let b = split(&block(lo, hi));
                if flips > 0 && r.below(2) == 0 { flipped(&b) } else { b }
            })
            .collect();
        let mesh = together(&parts.iter().collect::<Vec<_>>());
        let name = format!("{class}: {n}");
        out.push(Dirty { name, size: longest(&mesh), mesh, volume: union(boxes), within: 0.02 });
    };
    for n in 0..6 {
        let mut r = Random::new(700 + n as u64);
        let mut some = vec![(DVec3::splat(-6.0), DVec3::splat(6.0))];
        for _ in 0..4 {
            let (c, h) = (r.vector() * 6.0, (r.vector() + 1.5) * 3.0);
            some.push((c - h, c + h));
        }
        add("crossing boxes", n, &some, 0);
        add("crossing boxes, some inside out", n, &some, 900 + n as u64);
    }
    let s = DVec3::splat;
    let unit = |x: f64, y: f64, z: f64| (dvec3(x, y, z) * 8.0, dvec3(x, y, z) * 8.0 + s(8.0));
    for (n, to) in [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)].into_iter().enumerate() {
        add("face on face", n, &[unit(0.0, 0.0, 0.0), unit(to.0, to.1, to.2)], 0);
        let half = unit(to.0, to.1 + 0.3 * to.0, to.2 + 0.4 * to.1 + 0.2);
        add("part of a face on a face", n, &[unit(0.0, 0.0, 0.0), half], 0);
        let edge = unit(1.0 - to.0, 1.0 - to.1, 1.0 - to.2);
        add("edge on edge", n, &[unit(0.0, 0.0, 0.0), edge], 0);
        let turn = |x: f64| 1.0 - 2.0 * x;
        add(
            "corner on corner",
            n,
            &[unit(0.0, 0.0, 0.0), unit(turn(to.0), turn(to.1), turn(to.2))],
            0,
        );
        let flush = unit(0.5 * to.0, 0.5 * to.1, 0.5 * to.2);
        add("flush and crossing", n, &[unit(0.0, 0.0, 0.0), flush], 0);
    }
    // one mesh with shared points: an edge of four faces, a corner of two fans
    let cells = |list: &[[i32; 3]]| super::solids::cubes(&list.iter().copied().collect(), 8.0);
    for (class, list) in [
        ("an edge of four faces", [[0, 0, 0], [1, 1, 0]]),
        ("an edge of four faces", [[0, 0, 0], [0, 1, 1]]),
        ("a corner of two fans", [[0, 0, 0], [1, 1, 1]]),
        ("a corner of two fans", [[0, 0, 0], [-1, 1, 1]]),
    ] {
        let mesh = split(&cells(&list));
        out.push(Dirty {
            name: format!("{class}: {list:?}"),
            size: longest(&mesh),
            mesh,
            volume: 1024.0,
            within: 0.02,
        });
    }
    out
}

/// Meshes that enclose nothing, and the word that must stand in what is said.
pub fn hopeless() -> Vec<(&'static str, TriMesh, &'static str)> {
    let at = |x: f64, y: f64| dvec3(x, y, 0.0);
    let sheet = TriMesh {
        points: vec![at(0.0, 0.0), at(9.0, 0.0), at(9.0, 9.0), at(0.0, 9.0)],
        faces: vec![[0, 1, 2], [0, 2, 3]],
    };
    let double = together(&[&sheet, &flipped(&sheet)]);
    let mut nan = ball(10.0, 0.0, 1);
    nan.points[3] = dvec3(0.0, f64::NAN, 0.0);
    let mut infinite = ball(10.0, 0.0, 1);
    infinite.points[3].z = f64::INFINITY;
    let mut index = ball(10.0, 0.0, 1);
    index.faces[3][1] = 9999;
    let flat = TriMesh { points: vec![DVec3::ZERO; 3], faces: vec![[0, 1, 2]; 4] };
    let mut shredded = TriMesh::default();
    let mut r = Random::new(5);
    for _ in 0..200 {
        let c = r.vector() * 10.0;
        let corner = |r: &mut Random| c + r.vector() * 0.5;
        let points = vec![corner(&mut r), corner(&mut r), corner(&mut r)];
        shredded.append(&TriMesh { points, faces: vec![[0, 1, 2]] });
    }
    vec![
        ("a sheet", sheet, "thicken"),
        ("a sheet on both sides", double, "thicken"),
        ("a strip of one side", moebius(40), "thicken"),
        ("loose triangles", shredded, "thicken"),
        ("not a number", nan, "not a number"),
        ("infinite", infinite, "beyond 1e60"),
        ("a point that is not there", index, "9999"),
        ("only points", flat, "no triangles with area"),
        ("nothing", TriMesh::default(), "no triangles"),
    ]
}

/// A Möbius strip.
fn moebius(n: u32) -> TriMesh {
    let mut m = TriMesh::default();
    for i in 0..n {
        let a = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let out = dvec3(a.cos(), a.sin(), 0.0);
        let across = out * (a / 2.0).cos() + DVec3::Z * (a / 2.0).sin();
        m.points.extend([out * 10.0 - across * 2.0, out * 10.0 + across * 2.0]);
    }
    for i in 0..n {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
        m.faces.extend([[a, b, c], [c, b, d]]);
    }
    m
}

/// Some of every class, for what takes long.
pub fn some() -> Vec<Dirty> {
    let keep = |d: &Dirty| ["chair", "bumps", "0"].iter().any(|s| d.name.ends_with(s));

    dirty().into_iter().filter(keep).collect()
}
