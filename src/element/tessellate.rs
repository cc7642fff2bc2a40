use super::{Element, Shape};
use crate::mesh::{TriMesh, weld};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Most segments round a section; more only makes files that nobody can open.
const MOST: u32 = 1024;

/// One closed shell round the element, with as few triangles as its form allows: 12 for a straight
/// block. `segments` is the number of sides of a round section (3 to 1024); twisted and bent
/// bodies are cut along z in steps of that angle. Edges are crisp, corners lie on the surface.
///
/// `None` for meshes and mixes, which have no outline of their own.
pub fn tessellate(element: &Element, segments: u32) -> Option<TriMesh> {
    let n = segments.clamp(3, MOST);
    let outline = outline(element, n)?;
    let mut shell = TriMesh::default();
    for p in outline.points() {
        shell.points.push(element.to_world(p / element.half));
    }
    shell.faces = outline.faces();
    Some(shell)
}

/// The middle surface of a block or a prism across its thinnest axis, as one open sheet: what careless
/// modelling leaves of a board. `None` for other shapes.
pub fn middle_sheet(element: &Element, segments: u32) -> Option<TriMesh> {
    let thin = (0..3).min_by(|&a, &b| element.half[a].total_cmp(&element.half[b]))?;
    let flat = matches!(element.shape, Shape::Block) || thin == 2;
    if !(matches!(element.shape, Shape::Block | Shape::Prism(_)) && flat) {
        return None;
    }
    let mut sheet = tessellate(element, segments)?;
    let local: Vec<DVec3> = sheet.points.iter().map(|&p| element.to_local(p)).collect();
    sheet.faces.retain(|f| f.iter().all(|&v| local[v as usize][thin] > 1.0 - 1e-6));
    for (p, mut q) in sheet.points.iter_mut().zip(local) {
        q[thin] = 0.0;
        *p = element.to_world(q);
    }
    // the far side's points are left without a face
    Some(weld(&sheet))
}

/// Rings of equally many points stacked along z; the ends are flat or run into a point.
struct Outline {
    /// Section and height of each ring, mm in element axes.
    rings: Vec<(Vec<DVec2>, f64)>,
    end: End,
}

/// How the first and the last ring are closed.
enum End {
    /// By triangles between its own corners.
    Fan,
    /// By triangles round a point at this |z|.
    Point(f64),
}

fn outline(e: &Element, n: u32) -> Option<Outline> {
    let (half, flat) = (e.half, e.half.truncate());
    let turn = e.deform.twist.abs().max(e.deform.bend.abs());
    let slices = ((turn / TAU * f64::from(n)).ceil() as u32).max(1);
    let round = |scale: DVec2| -> Vec<DVec2> {
        (0..n).map(|i| scale * DVec2::from_angle(TAU * f64::from(i) / f64::from(n))).collect()
    };
    let straight = |section: Vec<DVec2>, long: f64| -> Vec<(Vec<DVec2>, f64)> {
        (0..=slices)
            .map(|i| (section.clone(), long * (2.0 * f64::from(i) / f64::from(slices) - 1.0)))
            .collect()
    };
    let (rings, end) = match &e.shape {
        Shape::Block => {
            let corners =
                [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
            (straight(corners.map(|c| c * flat).to_vec(), half.z), End::Fan)
        }
        Shape::Prism(corners) => {
            (straight(corners.iter().map(|c| *c * flat).collect(), half.z), End::Fan)
        }
        Shape::Cylinder => (straight(round(flat), half.z), End::Point(half.z)),
        Shape::Capsule => {
            let cap = half.min_element();
            let mut rings = Vec::new();
            let ends = latitudes(n);
            let long = half.z - cap;
            rings.extend(ends.iter().rev().map(|a| (round(flat * a.x), -long - cap * a.y)));
            // without a straight part both half balls share one ring
            rings.extend(
                straight(round(flat), long)
                    .into_iter()
                    .skip(usize::from(long <= 0.0) * slices as usize),
            );
            rings.extend(ends.iter().map(|a| (round(flat * a.x), long + cap * a.y)));
            (rings, End::Point(half.z))
        }
        Shape::Ellipsoid => {
            let ends = latitudes(n);
            let mut rings = Vec::new();
            rings.extend(ends.iter().rev().map(|a| (round(flat * a.x), -half.z * a.y)));
            rings.push((round(flat), 0.0));
            rings.extend(ends.iter().map(|a| (round(flat * a.x), half.z * a.y)));
            (rings, End::Point(half.z))
        }
        Shape::Mesh(_) | Shape::Mix(_) => return None,
    };
    Some(Outline { rings, end })
}

/// Cosine and sine of the latitudes between equator and pole, both left out.
fn latitudes(n: u32) -> Vec<DVec2> {
    let rows = (n / 4).max(2);
    (1..rows).map(|i| DVec2::from_angle(0.25 * TAU * f64::from(i) / f64::from(rows))).collect()
}

impl Outline {
    fn points(&self) -> Vec<DVec3> {
        let rings = self.rings.iter();
        let mut points: Vec<DVec3> =
            rings.flat_map(|(ring, z)| ring.iter().map(|p| p.extend(*z))).collect();
        if let End::Point(z) = self.end {
            points.extend([DVec3::new(0.0, 0.0, -z), DVec3::new(0.0, 0.0, z)]);
        }
        points
    }

    fn faces(&self) -> Vec<[u32; 3]> {
        let n = self.rings.first().map_or(0, |r| r.0.len() as u32);
        let levels = self.rings.len() as u32;
        let mut faces = Vec::new();
        for (level, side) in (1..levels).flat_map(|l| (0..n).map(move |s| (l, s))) {
            let (low, high) = ((level - 1) * n, level * n);
            let next = (side + 1) % n;
            faces.push([low + side, low + next, high + next]);
            faces.push([low + side, high + next, high + side]);
        }
        let top = levels.saturating_sub(1) * n;
        match self.end {
            End::Fan => {
                for i in 2..n {
                    faces.push([0, i, i - 1]);
                    faces.push([top, top + i - 1, top + i]);
                }
            }
            End::Point(_) => {
                let (south, north) = (levels * n, levels * n + 1);
                for i in 0..n {
                    let next = (i + 1) % n;
                    faces.push([south, next, i]);
                    faces.push([north, top + i, top + next]);
                }
            }
        }
        faces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::Deform;
    use glam::DQuat;
    use std::collections::HashSet;

    fn shapes() -> Vec<Element> {
        let kite = [DVec2::new(0.0, -1.0), DVec2::new(1.0, 0.2), DVec2::new(-0.7, 0.9)];
        let straight = [
            Shape::Block,
            Shape::Cylinder,
            Shape::Capsule,
            Shape::Ellipsoid,
            Shape::prism(&kite).unwrap(),
        ]
        .map(|shape| Element {
            shape,
            centre: DVec3::new(30.0, -9.0, 200.0),
            rotation: DQuat::from_rotation_x(0.6),
            half: DVec3::new(20.0, 25.0, 150.0),
            deform: Deform::NONE,
        });
        let bent = straight
            .clone()
            .map(|e| Element { deform: Deform { twist: 0.7, taper: 0.6, bend: -1.2 }, ..e });
        let ball = Element { half: DVec3::splat(20.0), ..straight[2].clone() };
        [straight.to_vec(), bent.to_vec(), vec![ball]].concat()
    }

    #[test]
    fn shells_are_closed_and_lie_on_the_surface() {
        for e in shapes() {
            let mesh = tessellate(&e, 16).unwrap();
            let edges: HashSet<(u32, u32)> =
                mesh.faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
            assert_eq!(edges.len(), 3 * mesh.faces.len());
            assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))), "{:?}", e.shape);
            // one sphere: V - E + F = 2
            assert_eq!(mesh.points.len() + mesh.faces.len(), edges.len() / 2 + 2);
            assert!(mesh.volume() > 0.0);
            assert!(mesh.points.iter().all(|&p| e.distance(p).abs() < 1e-9), "{:?}", e.shape);
        }
    }

    #[test]
    fn volumes_known_by_hand() {
        let e = shapes();
        let block = tessellate(&e[0], 16).unwrap();
        assert_eq!(block.faces.len(), 12);
        assert!((block.volume() - 40.0 * 50.0 * 300.0).abs() < 1e-6);
        let rod = tessellate(&e[1], 16).unwrap();
        let polygon = 8.0 * (TAU / 16.0).sin() * 20.0 * 25.0;
        assert!((rod.volume() - polygon * 300.0).abs() < 1e-6);
        let fine = tessellate(&e[3], 400).unwrap();
        let ellipsoid = 4.0 / 3.0 * std::f64::consts::PI * 20.0 * 25.0 * 150.0;
        assert!((fine.volume() / ellipsoid - 1.0).abs() < 2e-4);
    }

    #[test]
    fn outlines_without_a_form_are_none() {
        let mix = Shape::Mix(vec![(Shape::Block, 0.5), (Shape::Cylinder, 0.5)]);
        assert!(tessellate(&Element { shape: mix, ..shapes()[0].clone() }, 16).is_none());
    }
}
