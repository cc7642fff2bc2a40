//! One mesh whose points move: the faces stay what they are.

use super::flip_book::animated;
use super::normals::normals;
use super::{Document, Look, document, points};
use crate::mesh::write::{place, plain, sound};
use crate::mesh::{MeshError, TriMesh};
use glam::DVec3;
use gltf_json::animation::{Interpolation, Property};
use std::path::Path;

/// Poses of one mesh, and when it takes them.
pub struct Motion<'a> {
    /// The faces of every pose.
    pub faces: &'a [[u32; 3]],
    /// The points of each pose, mm; as many in every pose. At least two poses.
    pub poses: &'a [Vec<DVec3>],
    /// What the poses are called, such as `t 0.5`.
    pub names: &'a [String],
    /// Poses by number, in the order they are taken. Between two the points run straight.
    pub turns: &'a [usize],
    /// Seconds from one turn to the next.
    pub seconds: f64,
    /// sRGB colour of the mesh, which is seen from both sides.
    pub color: [u8; 3],
}

/// Writes a GLB with one mesh: the first pose, the others as morph targets (positions and normals),
/// and an animation of their weights. Returns the bytes written.
///
/// Points at one place share a normal where theirs agree to 60 degrees, so that seams are smooth.
///
/// # Errors
/// A path that does not end in `glb` or cannot be written; poses that do not fit the faces or each
/// other; what the system refuses. Nothing is written then.
pub fn write_motion(
    path: &Path,
    motion: &Motion<'_>,
    note: &str,
    force: bool,
) -> Result<u64, MeshError> {
    animated(path, force)?;
    let refuse = |why: String| MeshError::Unfaithful { path: path.into(), why };
    fits(motion).map_err(refuse)?;
    let [head, body] = encode(motion, &plain(note)).map_err(refuse)?;
    place(path, [&head, &body].into_iter().map(Ok), force)?;
    Ok((head.len() + body.len()) as u64)
}

fn fits(motion: &Motion<'_>) -> Result<(), String> {
    let count = motion.poses.len();
    if count < 2 || motion.names.len() != count || motion.faces.is_empty() {
        let (names, faces) = (motion.names.len(), motion.faces.len());
        return Err(format!(
            "{count} poses, {names} names, {faces} faces; a motion needs two poses or more, a \
             name each, and faces"
        ));
    }
    let points = motion.poses[0].len();
    let mut mesh = TriMesh { points: vec![], faces: motion.faces.to_vec() };
    for (pose, name) in motion.poses.iter().zip(motion.names) {
        if pose.len() != points {
            return Err(format!("pose {name} has {} points, the first {points}", pose.len()));
        }
        mesh.points.clone_from(pose);
        sound(&mesh).map_err(|why| format!("pose {name}: {why}"))?;
    }
    match motion.turns.iter().find(|t| **t >= count) {
        Some(turn) => Err(format!("pose {turn} is to be taken, but there are {count}")),
        None if motion.turns.len() < 2 => Err("fewer than two turns".into()),
        None => Ok(()),
    }
}

fn encode(motion: &Motion<'_>, note: &str) -> Result<[Vec<u8>; 2], String> {
    let mut document = Document::new(note);
    let look = Look { color: motion.color, double_sided: true };
    let material = document.material(&look);
    let mut mesh = TriMesh { points: vec![], faces: motion.faces.to_vec() };
    let [base, base_normals] = posed(&mut mesh, &motion.poses[0]);
    let positions = document.positions(&base);
    let normals = document.positions(&base_normals);
    let indices = document.indices(motion.faces);
    let mut primitive = document::primitive(positions, Some(normals), indices, Some(material));
    let targets = motion.poses[1..].iter().map(|pose| {
        let [points, normals] = posed(&mut mesh, pose);
        let positions = document.positions(&apart(&points, &base));
        let normals = document.positions(&apart(&normals, &base_normals));
        document::target(positions, normals)
    });
    primitive.targets = Some(targets.collect());
    let others = motion.poses.len() - 1;
    let mesh = document.mesh(primitive, Some(vec![0.0; others]));
    document.target_names(mesh, &motion.names[1..])?;
    let node = document.node(document::placed(mesh));
    let weight = |turn: usize| (1..=others).map(move |i| if i == turn { 1.0f32 } else { 0.0 });
    let weights: Vec<f32> = motion.turns.iter().flat_map(|&turn| weight(turn)).collect();
    let times: Vec<f32> =
        (0..motion.turns.len()).map(|k| (k as f64 * motion.seconds) as f32).collect();
    let weights = document.numbers(&weights);
    let how = (Property::MorphTargetWeights, Interpolation::Linear);
    document.animation("morph", &times, how, &[(node, weights)]);
    document.finish(vec![node])
}

/// Points and normals of a pose as the file holds them.
fn posed(mesh: &mut TriMesh, pose: &[DVec3]) -> [Vec<[f32; 3]>; 2] {
    mesh.points.clear();
    mesh.points.extend_from_slice(pose);
    let turned = |n: DVec3| {
        let n = n.normalize_or(DVec3::Z);
        DVec3::new(n.x, n.z, -n.y).as_vec3().to_array().map(|x| x + 0.0)
    };
    [points(mesh), normals(mesh).into_iter().map(turned).collect()]
}

fn apart(to: &[[f32; 3]], from: &[[f32; 3]]) -> Vec<[f32; 3]> {
    to.iter().zip(from).map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]]).collect()
}
