//! How the triangles hang together: edges, fans round vertices, components.

use super::buckets::Buckets;
use super::weld::Welded;
use crate::mesh::TriMesh;

/// Counts of everything a clean closed surface has none of, and its components.
pub(super) struct Topology {
    /// Undirected edges.
    pub edges: usize,
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub crowded_edges: usize,
    /// Edges whose two triangles run along them the same way.
    pub opposed_edges: usize,
    /// Whether every edge has exactly two triangles.
    pub manifold_edges: bool,
    /// Whether neighbours agree on which side is outside.
    pub oriented: bool,
    /// Whether the directed edges cancel: also true where four triangles meet at one edge.
    pub closed: bool,
    /// Vertices with several fans of triangles that no edge joins.
    pub split_vertices: usize,
    /// Vertices that a triangle uses.
    pub vertices: usize,
    /// Triangles on the same three vertices as another, all but one of them.
    pub duplicates: usize,
    /// Component of each face, numbered by first face.
    pub labels: Vec<u32>,
    /// Number of components: faces joined through edges.
    pub components: usize,
}

impl Topology {
    /// That of what is left when only some components stay, if nothing is wrong with the mesh: then
    /// they share no vertex.
    pub fn without(&self, stays: &[bool], left: &TriMesh) -> Option<Self> {
        let whole = self.closed && self.manifold_edges && self.oriented && !left.faces.is_empty();
        let wrong = self.split_vertices + self.duplicates + self.opposed_edges;
        if !whole || wrong > 0 {
            return None;
        }
        // components are numbered by their first faces, in this order before and after
        let mut components = 0;
        let number = |&stays: &bool| {
            let own = components;
            components += u32::from(stays);
            own
        };
        let numbers: Vec<u32> = stays.iter().map(number).collect();
        let kept = self.labels.iter().filter(|&&label| stays[label as usize]);
        Some(Self {
            edges: left.faces.len() * 3 / 2,
            vertices: left.points.len(),
            labels: kept.map(|&label| numbers[label as usize]).collect(),
            components: components as usize,
            ..*self
        })
    }

    /// Total genus over the components; `None` unless closed and manifold.
    pub fn genus(&self) -> Option<i64> {
        let whole = self.closed && self.manifold_edges && self.split_vertices == 0;
        let faces = self.labels.len() as i64;
        let euler = self.vertices as i64 - self.edges as i64 + faces;
        whole.then(|| self.components as i64 - euler.div_euclid(2))
    }
}

/// A directed edge: its end of the higher number, and the corner it starts from,
/// `3 * face + side`. It stands in the bucket of its end of the lower number.
type HalfEdge = (u32, u32);

pub(super) fn topology(mesh: &Welded) -> Topology {
    let halves = half_edges(mesh);
    let start = |corner: u32| mesh.faces[corner as usize / 3][corner as usize % 3];
    let end = |corner: u32| start(following(corner));
    let mut t = Topology {
        edges: 0,
        open_edges: 0,
        crowded_edges: 0,
        opposed_edges: 0,
        manifold_edges: !mesh.faces.is_empty(),
        oriented: !mesh.faces.is_empty(),
        closed: !mesh.faces.is_empty(),
        split_vertices: 0,
        vertices: 0,
        duplicates: 0,
        labels: Vec::new(),
        components: 0,
    };
    let mut corners = Forest::new(mesh.faces.len() * 3);
    let mut faces = Forest::new(mesh.faces.len());
    for edge in halves.iter().flat_map(|from| from.chunk_by(|a, b| a.0 == b.0)) {
        let sum: i64 = edge.iter().map(|h| if start(h.1) < end(h.1) { 1 } else { -1 }).sum();
        t.edges += 1;
        t.open_edges += usize::from(edge.len() == 1);
        t.crowded_edges += usize::from(edge.len() > 2);
        t.opposed_edges += usize::from(edge.len() == 2 && sum != 0);
        t.manifold_edges &= edge.len() == 2;
        t.closed &= sum == 0;
        if edge.len() > 1 {
            t.duplicates += duplicates(edge, start);
        }
        t.oriented &= sum.abs() <= 1 && (edge.len() % 2 == 1 || sum == 0);
        for pair in edge.windows(2) {
            let (a, b) = (pair[0].1, pair[1].1);
            let (mut here, mut there) = (b, following(b));
            if start(a) != start(b) {
                std::mem::swap(&mut here, &mut there);
            }
            corners.join(a as usize, here as usize);
            corners.join(following(a) as usize, there as usize);
            faces.join(a as usize / 3, b as usize / 3);
        }
    }
    drop(halves);
    count_fans(mesh, &mut corners, &mut t);
    drop(corners);
    (t.labels, t.components) = faces.labels();
    t
}

/// Of the faces along an edge of which it joins the two lowest vertices: how many have the same third
/// one as another.
fn duplicates(edge: &[HalfEdge], start: impl Fn(u32) -> u32) -> usize {
    let third = |h: &HalfEdge| (start(following(following(h.1))), h.1 / 3);
    if let [a, b] = edge
        && third(a).0 != third(b).0
    {
        return 0;
    }
    let high = edge[0].0;
    let mut thirds: Vec<_> = edge.iter().map(third).filter(|t| t.0 >= high).collect();
    thirds.sort_unstable();
    // a face with a vertex twice runs along the edge twice
    thirds.dedup();
    thirds.windows(2).filter(|pair| pair[0].0 == pair[1].0).count()
}

/// The next corner of the same face.
fn following(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

fn half_edges(mesh: &Welded) -> Buckets<HalfEdge> {
    let sides = |(i, &[a, b, c]): (u32, &[u32; 3])| {
        [(a, b, 0), (b, c, 1), (c, a, 2)].map(|(a, b, k)| (a.min(b), (a.max(b), 3 * i + k)))
    };
    Buckets::new(mesh.points.len(), || (0..).zip(mesh.faces.iter()).flat_map(sides))
}

fn count_fans(mesh: &Welded, corners: &mut Forest, t: &mut Topology) {
    let mut fans = vec![0_u32; mesh.points.len()];
    for (i, f) in mesh.faces.iter().enumerate() {
        for (k, &v) in f.iter().enumerate() {
            let corner = 3 * i + k;
            fans[v as usize] += u32::from(corners.root(corner) == corner);
        }
    }
    t.split_vertices = fans.iter().filter(|&&n| n > 1).count();
    t.vertices = fans.iter().filter(|&&n| n > 0).count();
}

/// Disjoint sets; the root of a set is its lowest member.
struct Forest {
    parent: Vec<u32>,
}

impl Forest {
    fn new(len: usize) -> Self {
        Self { parent: (0..len as u32).collect() }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] as usize != i {
            let up = self.parent[self.parent[i] as usize];
            self.parent[i] = up;
            i = up as usize;
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high] = low as u32;
    }

    /// Set of each member, numbered by first member, and the number of sets.
    fn labels(mut self) -> (Vec<u32>, usize) {
        let mut labels = vec![0; self.parent.len()];
        let mut sets = 0;
        for i in 0..labels.len() {
            let root = self.root(i);
            if root == i {
                labels[i] = sets;
                sets += 1;
            } else {
                labels[i] = labels[root];
            }
        }
        (labels, sets as usize)
    }
}
