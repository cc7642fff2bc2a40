//! Faces that agree with their neighbours.

use super::Tessellation;
use crate::mesh::TriMesh;

/// A directed side of a face.
struct Side {
    ends: [u32; 2],
    face: usize,
    /// Whether the face runs from the higher end to the lower.
    back: bool,
}

/// Turns faces so that neighbours agree and closed pieces have a volume over 0; says what it found.
/// Pieces hang together by edges of exactly two faces.
pub(super) fn finish(mut mesh: TriMesh) -> Tessellation {
    let sides = sides(&mesh);
    let mut closed = true;
    // By face: its neighbours, and whether they run against each other as they should
    let mut near: Vec<Vec<(usize, bool)>> = vec![vec![]; mesh.faces.len()];
    let mut whole = vec![true; mesh.faces.len()];
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        if let [a, b] = edge {
            near[a.face].push((b.face, a.back != b.back));
            near[b.face].push((a.face, a.back != b.back));
        } else {
            closed = false;
            edge.iter().for_each(|s| whole[s.face] = false);
        }
    }
    let mut two_sided = true;
    let mut turn: Vec<Option<bool>> = vec![None; mesh.faces.len()];
    for first in 0..mesh.faces.len() {
        if turn[first].is_some() {
            continue;
        }
        let (piece, agrees) = walk(first, &near, &mut turn);
        if !agrees {
            two_sided = false;
            continue;
        }
        for &f in &piece {
            if turn[f] == Some(true) {
                mesh.faces[f].swap(1, 2);
            }
        }
        if piece.iter().all(|&f| whole[f]) && volume(&mesh, &piece) < 0.0 {
            piece.iter().for_each(|&f| mesh.faces[f].swap(1, 2));
        }
    }
    Tessellation { mesh, closed, two_sided }
}

fn sides(mesh: &TriMesh) -> Vec<Side> {
    let mut out = Vec::with_capacity(3 * mesh.faces.len());
    for (face, f) in mesh.faces.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (f[k], f[(k + 1) % 3]);
            out.push(Side { ends: [a.min(b), a.max(b)], face, back: a > b });
        }
    }
    out.sort_by_key(|s| (s.ends, s.face));
    out
}

/// The faces of a piece, and whether they can all agree; sets which must turn.
fn walk(
    first: usize,
    near: &[Vec<(usize, bool)>],
    turn: &mut [Option<bool>],
) -> (Vec<usize>, bool) {
    let (mut piece, mut agrees) = (vec![first], true);
    turn[first] = Some(false);
    let mut next = 0;
    while let Some(&face) = piece.get(next) {
        next += 1;
        let me = turn[face].unwrap_or(false);
        for &(other, against) in &near[face] {
            let want = me == against;
            match turn[other] {
                Some(is) => agrees &= is == want,
                None => {
                    turn[other] = Some(want);
                    piece.push(other);
                }
            }
        }
    }
    (piece, agrees)
}

fn volume(mesh: &TriMesh, piece: &[usize]) -> f64 {
    let origin = piece.first().map_or_else(Default::default, |&f| mesh.corners(f)[0]);
    let six = |&f: &usize| {
        let [a, b, c] = mesh.corners(f).map(|p| p - origin);
        a.dot(b.cross(c))
    };
    piece.iter().map(six).sum::<f64>() / 6.0
}
