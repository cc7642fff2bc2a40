mod shape;
mod sharp;

use super::{Mesher, extract, normals};
use crate::field::Field;
use crate::field::sample::shapes::{Csg, Random, ball, gyroid, torus};
use crate::field::sample::{sample, sample_dense};
use crate::grid::{Brick, Bricks, Lattice};
use crate::job::{Cancelled, Job, Quiet};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::DVec3;
use shape::{Shape, root};

fn lattice(size: u32, step: f64) -> Lattice {
    let half = f64::from(size - 1) * step * 0.5;
    Lattice { origin: DVec3::new(1000.017, -500.3, 20.0) - half, step, size: [size; 3] }
}

fn bricks_of(lattice: Lattice, mut value: impl FnMut([u32; 3]) -> f32) -> Bricks<f32> {
    let mut bricks = Bricks::outside(lattice);
    for n in 0..bricks.bricks.len() {
        let lo = bricks.place(n).map(|b| 8 * b);
        bricks.bricks[n] = Brick::Band(Box::new(std::array::from_fn(|i| {
            let i = i as u32;
            value([lo[0] + i % 8, lo[1] + i / 8 % 8, lo[2] + i / 64])
        })));
    }
    bricks
}

/// White noise, border included.
fn noise(size: u32, seed: u64) -> Bricks<f32> {
    let mut random = Random(seed);
    bricks_of(lattice(size, 0.7), |_| random.next() as f32)
}

/// Noise of wild scale: most crossings fall on an end of their edge.
fn extreme(size: u32, seed: u64) -> Bricks<f32> {
    let mut random = Random(seed);
    bricks_of(lattice(size, 0.01), |_| {
        let sign = random.next().signum();
        (sign * (random.next() * 60.0).exp()) as f32
    })
}

fn cone(bricks: &Bricks<f32>) -> TriMesh {
    extract(bricks, Mesher::Cone, &Quiet).unwrap()
}

fn meshed(f: &dyn Field, on: Lattice, mesher: Mesher) -> TriMesh {
    extract(&sample(f, on, &Quiet).unwrap().bricks, mesher, &Quiet).unwrap()
}

fn covering(half: f64, step: f64) -> Lattice {
    Lattice::covering(&Aabb::around(DVec3::splat(0.013), DVec3::splat(half)), step)
}

/// Inside samples joined along the axes, outside ones also along diagonals of squares.
fn labels(bricks: &Bricks<f32>) -> [usize; 2] {
    let [x, y, z] = bricks.lattice.size.map(i64::from);
    let border = |i: i64, n: i64| i == 0 || i == n - 1;
    let inside = |[i, j, k]: [i64; 3]| {
        bricks.sample([i, j, k], -1.0, 1.0) < 0.0 && !border(i, x) && !border(j, y) && !border(k, z)
    };
    let at = |[i, j, k]: [i64; 3]| ((k * y + j) * x + i) as usize;
    let mut joined: Vec<usize> = (0..(x * y * z) as usize).collect();
    let all = || (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    for p in all() {
        for n in 0..27 {
            let d = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
            let steps = d.iter().filter(|&&d| d != 0).count();
            let q = [p[0] + d[0], p[1] + d[1], p[2] + d[2]];
            let exists = (0..3).all(|a| (0..[x, y, z][a]).contains(&q[a]));
            if exists && inside(p) == inside(q) && steps <= if inside(p) { 1 } else { 2 } {
                let (a, b) = (root(&mut joined, at(p)), root(&mut joined, at(q)));
                joined[a.max(b)] = a.min(b);
            }
        }
    }
    let mut count = [0; 2];
    for p in all().filter(|&p| root(&mut joined.clone(), at(p)) == at(p)) {
        count[usize::from(!inside(p))] += 1;
    }
    count
}

#[test]
fn noise_gives_a_sound_mesh() {
    for (size, seed) in [(16, 1), (17, 2), (20, 3), (24, 4), (28, 5)] {
        let shape = Shape::of(&cone(&noise(size, seed)));
        assert!(shape.sound(), "{size}, {seed}: {shape:?}");
        let shape = Shape::of(&cone(&extreme(size, seed)));
        assert!(shape.sound(), "extreme {size}, {seed}: {shape:?}");
    }
}

/// Every component of the mesh separates one inside component from one outside component; these
/// touch as a tree, so there is one surface less than there are components.
#[test]
fn components_are_those_of_the_samples() {
    for seed in 1..5 {
        let bricks = noise(9, seed);
        let [inside, outside] = labels(&bricks);
        assert_eq!(Shape::of(&cone(&bricks)).components, inside + outside - 1);
    }
    let on = covering(20.0, 0.8);
    let apart = sample(&Csg(vec![ball(-9.0, 0.0, 0.0, 6.0), ball(9.0, 1.0, 0.0, 7.0)]), on, &Quiet);
    let bricks = apart.unwrap().bricks;
    assert_eq!(Shape::of(&cone(&bricks)).components, 2);
}

#[test]
fn sparse_and_dense_give_the_same_mesh() {
    let on = covering(20.0, 0.7);
    let mut shapes: Vec<Box<dyn Field>> = vec![
        Box::new(ball(1.0, -2.0, 0.5, 14.3)),
        Box::new(ball(1.0, -2.0, 0.5, 25.0)),
        Box::new(torus(13.0, 4.0)),
        Box::new(gyroid(11.0, 19.0)),
    ];
    shapes.extend((1..6).map(|seed| Box::new(Csg::random(seed, 9, 18.0)) as Box<dyn Field>));
    for f in shapes {
        let dense = sample_dense(&*f, on, &Quiet).unwrap().bricks;
        for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
            let mesh = meshed(&*f, on, mesher);
            assert_eq!(mesh, extract(&dense, mesher, &Quiet).unwrap());
            assert!(!mesh.faces.is_empty());
        }
        let shape = Shape::of(&meshed(&*f, on, Mesher::Cone));
        assert!(shape.sound(), "{shape:?}");
    }
}

/// Volume and distance errors of a ball shrink with the square of the step.
#[test]
fn a_ball_converges_with_order_two() {
    let f = ball(0.2, 0.1, -0.3, 10.0);
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 1000.0;
    for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
        let errors = [1.0, 0.5, 0.25].map(|step| {
            let mesh = meshed(&f, covering(12.0, step), mesher);
            let far = mesh.points.iter().map(|&p| f.value(p).abs()).fold(0.0, f64::max);
            assert!(mesh.volume() < exact);
            // the sagitta of a chord over the diagonal of a cell
            assert!(far < 3.0 * step * step / 80.0 * 2.0, "{far}");
            exact - mesh.volume()
        });
        for pair in errors.windows(2) {
            assert!((pair[0] / pair[1]).log2() > 1.85, "{errors:?}");
        }
    }
}

#[test]
fn a_torus_has_one_hole() {
    for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
        let mesh = meshed(&torus(13.0, 4.0), covering(20.0, 0.9), mesher);
        let shape = Shape::of(&mesh);
        assert!(shape.sound());
        assert_eq!((shape.components, shape.euler), (1, 0));
        let exact = 2.0 * std::f64::consts::PI.powi(2) * 13.0 * 16.0;
        assert!((mesh.volume() / exact - 1.0).abs() < 0.02);
    }
}

/// Samples on the border are closed off, whether sampled or handed in.
#[test]
fn the_border_is_closed() {
    let full = |size| bricks_of(lattice(size, 0.7), |_| -1.0);
    let mut one_sign = Bricks::outside(lattice(17, 0.7));
    one_sign.bricks.fill(Brick::Inside);
    for bricks in [full(16), full(17), full(3), one_sign] {
        for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
            let mesh = extract(&bricks, mesher, &Quiet).unwrap();
            let shape = Shape::of(&mesh);
            assert!(shape.sound() && shape.components == 1 && shape.euler == 2, "{shape:?}");
            let b = bricks.lattice.bounds().grow(1e-4);
            assert!(mesh.points.iter().all(|&p| b.contains(p)) && mesh.volume() > 0.0);
        }
    }
}

/// Bricks of one sign beside each other, NaN and infinities: closed all the same.
#[test]
fn odd_bricks_give_a_sound_mesh() {
    let mut random = Random(7);
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, -1.0, 1.0, -1e-40];
    let mut bricks = bricks_of(lattice(20, 0.7), |_| odd[(random.next() * 4.0 + 4.0) as usize]);
    for n in [0, 3, 7, 13, 20] {
        bricks.bricks[n] = if n % 2 == 0 { Brick::Outside } else { Brick::Inside };
    }
    let shape = Shape::of(&cone(&bricks));
    assert!(shape.sound(), "{shape:?}");
    let nets = extract(&bricks, Mesher::SurfaceNets, &Quiet).unwrap();
    assert!(nets.points.iter().all(|p| p.is_finite()));
    bricks.bricks.truncate(9);
    assert!(Shape::of(&cone(&bricks)).sound());
}

#[test]
fn nothing_inside_gives_an_empty_mesh() {
    for size in [0, 1, 2, 9] {
        let mut on = lattice(9, 0.5);
        on.size = [size; 3];
        for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
            let mesh = extract(&Bricks::outside(on), mesher, &Quiet).unwrap();
            assert_eq!(mesh, TriMesh::default());
        }
    }
}

/// A box whose faces lie on samples stays flat, but for the margin.
#[test]
fn faces_on_samples_stay_flat() {
    let bricks = bricks_of(lattice(12, 1.0), |at| {
        at.iter().map(|&i| (f64::from(i) - 5.0).abs() - 3.0).fold(-9.0, f64::max) as f32
    });
    let mesh = cone(&bricks);
    let centre = bricks.lattice.point(5, 5, 5);
    assert!(Shape::of(&mesh).sound());
    assert!(mesh.points.iter().all(|&p| (p - centre).abs().max_element() < 3.0));
    let flat = |p: &&DVec3| ((**p - centre).abs().max_element() - 2.999).abs() < 1e-3;
    // all but the apexes at edges and corners
    let share = mesh.points.iter().filter(flat).count() as f64 / mesh.points.len() as f64;
    assert!(share > 0.8, "{share}");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let f = gyroid(9.0, 19.0);
    let on = covering(20.0, 0.7);
    let run = |threads, mesher| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| meshed(&f, on, mesher))
    };
    for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
        assert_eq!(run(1, mesher), run(2, mesher));
    }
}

#[test]
fn normals_point_outwards() {
    let f = ball(1.0, 2.0, 3.0, 10.0);
    let mesh = meshed(&f, covering(15.0, 1.0), Mesher::Cone);
    let n = normals(&f, &mesh.points, 0.1);
    assert_eq!(n.len(), mesh.points.len());
    for (n, &p) in n.iter().zip(&mesh.points) {
        assert!((*n - (p - f.centre).normalize()).length() < 1e-4);
    }
}

struct Stop;
impl Job for Stop {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn a_cancelled_job_stops() {
    let bricks = noise(16, 1);
    for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
        assert_eq!(extract(&bricks, mesher, &Stop), Err(Cancelled));
    }
}
