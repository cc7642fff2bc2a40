//! Faces joined into shells, oriented alike within each, and their rims.

use super::seams;
use super::soup::{Sets, Sides};
use glam::DVec3;
use std::collections::HashMap;

/// Faces that hang together, oriented alike.
#[derive(Clone, Debug, Default)]
pub(super) struct Shell {
    /// Indices of its faces.
    pub faces: Vec<u32>,
    /// Directed edges that its faces do not cancel, with how many are missing: empty when closed.
    pub rim: Vec<([u32; 2], u32)>,
}

/// The shells of a mesh, and how many faces were turned to agree with their neighbours.
pub(super) struct Shells {
    pub shells: Vec<Shell>,
    pub flipped_faces: usize,
}

/// Net direction of the edges in a rim: ends in rising order, positive when running upwards.
type Net = HashMap<(u32, u32), i32>;

fn area(points: &[DVec3], f: &[u32; 3]) -> f64 {
    let [a, b, c] = f.map(|v| points[v as usize]);
    (b - a).cross(c - a).length() * 0.5
}

impl Shells {
    /// Joins faces over edges that exactly two of them share, turns the minority of each shell
    /// (by area) to agree with the rest, and unites open shells that close each other. Rims within
    /// `tolerance` mm of each other count as one.
    pub(super) fn new(points: &[DVec3], faces: &mut [[u32; 3]], tolerance: f64) -> Self {
        let sides = Sides::of(faces);
        let (groups, mut flipped_faces) = orient(points, faces, &sides);
        let mut shell_of = vec![0u32; faces.len()];
        for (i, group) in groups.iter().enumerate() {
            group.iter().for_each(|&f| shell_of[f as usize] = i as u32);
        }
        let mut nets = nets(points, faces, &sides, &shell_of, groups.len(), tolerance);
        drop(sides);
        let (bodies, turned) = unite(points, &mut nets);
        let mut shells = vec![];
        for (i, group) in groups.iter().enumerate().filter(|&(i, _)| turned[i]) {
            flipped_faces += group.len();
            group.iter().for_each(|&f| faces[f as usize].swap(1, 2));
            debug_assert!(!nets[i].is_empty());
        }
        for body in bodies {
            let mut whole = Net::new();
            for &s in &body {
                add(&mut whole, &nets[s as usize]);
            }
            let parts: Vec<Vec<u32>> = if whole.is_empty() {
                vec![body]
            } else {
                body.into_iter().map(|s| vec![s]).collect()
            };
            for part in parts {
                let faces = part.iter().flat_map(|&s| groups[s as usize].iter().copied());
                let rim = if whole.is_empty() { vec![] } else { rim(&nets[part[0] as usize]) };
                shells.push(Shell { faces: faces.collect(), rim });
            }
        }
        Self { shells, flipped_faces }
    }
}

fn add(to: &mut Net, from: &Net) {
    for (&edge, &n) in from {
        let sum = to.entry(edge).or_default();
        *sum += n;
        if *sum == 0 {
            to.remove(&edge);
        }
    }
}

/// A net as directed edges, in order.
pub(super) fn rim(net: &Net) -> Vec<([u32; 2], u32)> {
    let mut out: Vec<_> = net
        .iter()
        .map(|(&(a, b), &n)| (if n > 0 { [a, b] } else { [b, a] }, n.unsigned_abs()))
        .collect();
    out.sort_unstable();
    out
}

/// Groups of faces joined over two-face edges, each turned to one orientation; and how many faces
/// were turned.
fn orient(points: &[DVec3], faces: &mut [[u32; 3]], sides: &Sides) -> (Vec<Vec<u32>>, usize) {
    // neighbours over the three sides, and whether they run along them in the same direction
    let mut next = vec![[None; 3]; faces.len()];
    let mut join = |x: u32, y: u32, clash| {
        let free = next[x as usize].iter_mut().find(|n| n.is_none());
        free.into_iter().for_each(|n| *n = Some((y, clash)));
    };
    for (_, edge) in sides.edges() {
        if let [x, y] = edge {
            let clash = x.forward() == y.forward();
            join(x.face(), y.face(), clash);
            join(y.face(), x.face(), clash);
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; faces.len()];
    let (mut groups, mut count) = (vec![], 0);
    for start in 0..faces.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut group = vec![start as u32];
        let mut done = 0;
        while done < group.len() {
            let (f, me) = (group[done] as usize, turned[group[done] as usize] == Some(true));
            done += 1;
            for (g, clash) in next[f].into_iter().flatten() {
                if turned[g as usize].is_none() {
                    turned[g as usize] = Some(me ^ clash);
                    group.push(g);
                }
            }
        }
        let side = |yes: bool| -> f64 {
            let own = group.iter().filter(|&&f| turned[f as usize] == Some(yes));
            own.map(|&f| area(points, &faces[f as usize])).sum()
        };
        let minority = side(true) <= side(false);
        for &f in group.iter().filter(|&&f| turned[f as usize] == Some(minority)) {
            faces[f as usize].swap(1, 2);
            count += 1;
        }
        groups.push(group);
    }
    (groups, count)
}

/// The net rim of every shell, over common links.
fn nets(
    points: &[DVec3],
    faces: &[[u32; 3]],
    sides: &Sides,
    shell_of: &[u32],
    shells: usize,
    tolerance: f64,
) -> Vec<Net> {
    let mut raw: Vec<(u32, u32, u32, i32)> = vec![];
    for ([a, b], edge) in sides.edges() {
        let start = raw.len();
        for s in edge {
            let shell = shell_of[s.face() as usize];
            // faces may have been turned since
            let f = faces[s.face() as usize];
            let forward = (0..3).any(|i| f[i] == a && f[(i + 1) % 3] == b);
            let n = if forward { 1 } else { -1 };
            match raw[start..].iter_mut().find(|r| r.0 == shell) {
                Some(r) => r.3 += n,
                None => raw.push((shell, a, b, n)),
            }
        }
        let open = raw[start..].iter().filter(|r| r.3 != 0).count();
        if open == 0 {
            raw.truncate(start);
        }
    }
    raw.retain(|r| r.3 != 0);
    let mut rims: Vec<(u32, u32)> = raw.iter().map(|r| (r.1, r.2)).collect();
    rims.dedup();
    let chains = seams::chains(points, &rims, tolerance);
    let links: HashMap<_, _> = rims.iter().zip(&chains).collect();
    let mut nets = vec![Net::new(); shells];
    for (shell, a, b, n) in raw {
        for link in links[&(a, b)].windows(2) {
            let (p, q) = (link[0], link[1]);
            if p != q {
                let one = Net::from([((p.min(q), p.max(q)), if p < q { n } else { -n })]);
                add(&mut nets[shell as usize], &one);
            }
        }
    }
    nets
}

/// Open shells whose rims meet, as one body each, turned to agree where most of the common rim
/// says so; closed shells stay alone. Returns the bodies and which shells are to be turned.
fn unite(points: &[DVec3], nets: &mut [Net]) -> (Vec<Vec<u32>>, Vec<bool>) {
    let mut at: HashMap<(u32, u32), Vec<(u32, i32)>> = HashMap::new();
    for (shell, net) in nets.iter().enumerate() {
        for (&edge, &n) in net {
            at.entry(edge).or_default().push((shell as u32, n));
        }
    }
    // length of common rim that agrees, less that which clashes
    let mut ties: HashMap<(u32, u32), f64> = HashMap::new();
    let mut common: Vec<_> = at.into_iter().collect();
    common.sort_unstable();
    for ((a, b), at) in common {
        let length = points[a as usize].distance(points[b as usize]);
        if let [(x, n), (y, m)] = at[..] {
            let agree = if (n > 0) != (m > 0) { length } else { -length };
            *ties.entry((x.min(y), x.max(y))).or_default() += agree;
        }
    }
    let mut next: Vec<Vec<(u32, bool)>> = vec![vec![]; nets.len()];
    let mut order: Vec<_> = ties.into_iter().collect();
    order.sort_by(|x, y| y.1.abs().total_cmp(&x.1.abs()).then(x.0.cmp(&y.0)));
    let mut sets = Sets::new(nets.len());
    for ((x, y), tie) in order {
        // a spanning tree of the longest ties decides
        if sets.find(x) != sets.find(y) {
            sets.join(x, y);
            next[x as usize].push((y, tie < 0.0));
            next[y as usize].push((x, tie < 0.0));
        }
    }
    let mut turned: Vec<Option<bool>> = vec![None; nets.len()];
    let mut bodies = vec![];
    for start in 0..nets.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut body = vec![start as u32];
        let mut done = 0;
        while done < body.len() {
            let (s, me) = (body[done] as usize, turned[body[done] as usize] == Some(true));
            done += 1;
            for &(o, clash) in &next[s] {
                if turned[o as usize].is_none() {
                    turned[o as usize] = Some(me ^ clash);
                    body.push(o);
                }
            }
        }
        bodies.push(body);
    }
    let turned: Vec<bool> = turned.into_iter().map(|t| t == Some(true)).collect();
    for (net, _) in nets.iter_mut().zip(&turned).filter(|(_, t)| **t) {
        net.values_mut().for_each(|n| *n = -*n);
    }
    (bodies, turned)
}
