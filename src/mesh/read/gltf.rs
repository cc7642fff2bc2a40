//! glTF 2.0, binary and JSON: the triangles of the default scene, node transforms applied. Of an
//! animation, the moment at which nothing plays.
//!
//! Only what carries geometry is deserialised, and every index, count and offset is checked
//! against the bytes there are. The `gltf` crate's own document is not used: its accessors index
//! without checks, its validation panics on an accessor out of range, and it keeps transforms in
//! f32, which a scale of 0.001 does not survive exactly.

use super::{
    buffers::Buffers,
    gltf_accessor::{F32, Source},
    gltf_document::{Document, Primitive, hint},
};
use crate::mesh::{
    error::{Parsed, fault},
    soup::Soup,
};
use glam::{DAffine3, DVec3};
use std::path::Path;

/// Instances may multiply a mesh: at most this many triangles more than the file has bytes.
/// A million takes a hundred megabytes.
const MOST_EXTRA: u64 = 1_000_000;

/// The scene in its own axes (Y up), scaled by `mm`.
pub(super) fn read(bytes: &[u8], folder: &Path, mm: f64) -> Parsed<Soup> {
    if bytes.is_empty() {
        return Ok(Soup::default());
    }
    let (json, chunk) = if bytes.starts_with(b"glTF") { unpack(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let document: Document = match serde_json::from_slice(json) {
        Ok(d) => d,
        Err(e) => return fault("JSON", e.to_string()),
    };
    document.check()?;
    let buffers = Buffers::load(&document.buffers, chunk, folder)?;
    let room = MOST_EXTRA + bytes.len() as u64 + buffers.total();
    let source = Source { document: &document, buffers };
    let mut scene = Reader { source, soup: Soup::default(), room };
    scene.walk(DAffine3::from_scale(DVec3::splat(mm)))?;
    Ok(scene.soup)
}

/// The JSON and binary chunks of a GLB.
fn unpack(bytes: &[u8]) -> Parsed<(&[u8], Option<&[u8]>)> {
    let word = |at: usize| {
        let raw = bytes.get(at..).and_then(|b| b.first_chunk::<4>());
        raw.map(|b| u32::from_le_bytes(*b))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return fault("header", format!("{} bytes; a GLB has at least 20", bytes.len()));
    };
    if version != 2 {
        return fault("header", format!("GLB version {version}, expected 2"));
    }
    let has = bytes.len();
    let Some(all) = bytes.get(..length as usize) else {
        return fault("header", format!("length is {length}, but the file has {has} bytes"));
    };
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        if at + 8 > all.len() {
            break;
        }
        let Some(chunk) = all.get(at + 8..).and_then(|b| b.get(..size as usize)) else {
            let left = all.len().saturating_sub(at + 8);
            return fault(
                format!("byte {at}"),
                format!("a chunk of {size} bytes, {left} are left"),
            );
        };
        match kind {
            0x4E4F_534A if json.is_none() => json = Some(chunk),
            0x004E_4942 if binary.is_none() => binary = Some(chunk),
            _ => {} // unknown chunks are to be passed over
        }
        at += 8 + size as usize;
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => fault("header", "no JSON chunk"),
    }
}

struct Reader<'a> {
    source: Source<'a>,
    soup: Soup,
    /// Triangles that may still come.
    room: u64,
}

impl Reader<'_> {
    /// All nodes once: a node reached again is a cycle, or has two parents. No recursion.
    fn walk(&mut self, root: DAffine3) -> Parsed<()> {
        let nodes = &self.source.document.nodes;
        let mut seen = vec![false; nodes.len()];
        let mut todo: Vec<_> =
            self.source.document.roots()?.into_iter().map(|n| (n, root)).collect();
        todo.reverse();
        while let Some((i, above)) = todo.pop() {
            let Some(node) = nodes.get(i) else {
                return fault(format!("nodes[{i}]"), format!("there are {} nodes", nodes.len()));
            };
            if std::mem::replace(&mut seen[i], true) {
                return fault(format!("nodes[{i}]"), "reached twice: nodes must form a tree");
            }
            if node.hidden() {
                continue;
            }
            let here = above * node.transform();
            if let Some(mesh) = node.mesh {
                self.mesh(mesh, &here)?;
            }
            todo.extend(node.children.iter().rev().map(|&c| (c, here)));
        }
        Ok(())
    }

    fn mesh(&mut self, i: usize, to: &DAffine3) -> Parsed<()> {
        let Some(mesh) = self.source.document.meshes.get(i) else {
            let count = self.source.document.meshes.len();
            return fault(format!("meshes[{i}]"), format!("there are {count} meshes"));
        };
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            self.primitive(primitive, &format!("meshes[{i}].primitives[{k}]"), to)?;
        }
        Ok(())
    }

    fn primitive(&mut self, p: &Primitive, at: &str, to: &DAffine3) -> Parsed<()> {
        let mode = p.mode.unwrap_or(4);
        match mode {
            4..=6 => {}
            0..=3 => return Ok(()), // points and lines
            _ => return fault(at, format!("mode {mode}, expected 0 to 6")),
        }
        let Some(positions) = p.attributes.position else {
            return fault(at, "no POSITION");
        };
        if let Some(e) = p.extensions.keys().find(|e| e.contains("draco"))
            && self
                .source
                .document
                .accessors
                .get(positions)
                .is_some_and(|a| a.buffer_view.is_none())
        {
            return fault(at, format!("`{e}` is not supported{}", hint(e)));
        }
        let order = match p.indices {
            Some(i) => self.source.indices(i)?,
            None => {
                let points = self.source.accessor(positions)?;
                (0..u32::try_from(points.count).unwrap_or(u32::MAX)).collect()
            }
        };
        let faces = triangles(&order, mode);
        // One more for the primitive itself: many empty ones on many nodes cost time too.
        self.room = match self.room.checked_sub(faces.len() as u64 / 3 + 1) {
            Some(room) => room,
            None => return fault(at, "instances add up to more triangles than are read"),
        };
        self.gather(faces, positions, at, to)
    }

    /// Adds triangles over the points of an accessor; only the points they use where they are few,
    /// since primitives may share one large accessor.
    fn gather(&mut self, mut faces: Vec<u32>, id: usize, at: &str, to: &DAffine3) -> Parsed<()> {
        let points = self.source.accessor(id)?;
        if (points.component, points.shape) != (F32, "VEC3") {
            let (component, shape) = (points.component, points.shape);
            let why =
                format!("POSITION is {shape} of type {component}, expected VEC3 of f32 (5126)");
            return fault(at, why);
        }
        if let Some(v) = faces.iter().find(|&&v| v as usize >= points.count) {
            return fault(at, format!("index {v}, but there are {} points", points.count));
        }
        let start = self.soup.points.len();
        let mut take = |i: usize| self.soup.points.push(to.transform_point3(points.point(i)));
        let mut used = Vec::new();
        if points.count > faces.len() * 4 {
            used.clone_from(&faces);
            used.sort_unstable();
            used.dedup();
            used.iter().for_each(|&i| take(i as usize));
            for v in &mut faces {
                *v = used.binary_search(v).unwrap_or_default() as u32;
            }
        } else {
            (0..points.count).for_each(&mut take);
        }
        if self.soup.points.len() > u32::MAX as usize {
            return fault(at, "more than 2^32 points");
        }
        if to.matrix3.determinant() < 0.0 {
            faces.chunks_exact_mut(3).for_each(|f| f.swap(1, 2));
        }
        self.soup.corners.extend(faces.iter().map(|v| v + start as u32));
        Ok(())
    }
}

/// The corners of triangles from a list (4), a strip (5) or a fan (6).
fn triangles(order: &[u32], mode: u32) -> Vec<u32> {
    match mode {
        4 => order[..order.len() / 3 * 3].to_vec(),
        5 => order
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        _ => order
            .iter()
            .skip(1)
            .zip(order.iter().skip(2))
            .flat_map(|(&b, &c)| [order[0], b, c])
            .collect(),
    }
}
