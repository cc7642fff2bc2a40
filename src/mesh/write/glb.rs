use super::rounded;
use crate::mesh::TriMesh;
use gltf_json::{
    Accessor, Asset, Buffer, Index, Mesh, Node, Root, Scene,
    accessor::{ComponentType, GenericComponentType, Type},
    buffer::{Target, View},
    mesh::{Mode, Primitive, Semantic},
    validation::{Checked::Valid, USize64},
};

/// Binary glTF 2.0, Y up, metres: (x, y, z) goes out as (x, z, -y).
///
/// Positions stay in mm under a node that scales by 0.001. Rounded to f32 in metres, different
/// points could become one, and with them goes the proof that the mesh is manifold.
pub(super) fn encode(mesh: &TriMesh, note: &str) -> Result<Vec<u8>, String> {
    let points: Vec<[f32; 3]> = (0..mesh.points.len() as u32)
        .map(|v| rounded(mesh, v))
        .map(|[x, y, z]| [x, z, 0.0 - y])
        .collect();
    let mut binary = Vec::with_capacity(12 * (points.len() + mesh.faces.len()));
    points.iter().flatten().for_each(|x| binary.extend_from_slice(&x.to_le_bytes()));
    mesh.faces.iter().flatten().for_each(|v| binary.extend_from_slice(&v.to_le_bytes()));
    let json = document(&points, mesh.faces.len() * 3, binary.len(), note);
    let json = json.to_string().map_err(|e| e.to_string())?;
    pack(json.into_bytes(), binary)
}

fn document(points: &[[f32; 3]], corners: usize, bytes: usize, note: &str) -> Root {
    let mut root = Root {
        asset: Asset {
            generator: Some(format!("fieldgraft {note}").trim_end().into()),
            ..Asset::default()
        },
        ..Root::default()
    };
    let buffer = root.push(Buffer {
        byte_length: USize64::from(bytes),
        name: None,
        uri: None,
        extensions: None,
        extras: Default::default(),
    });
    let split = points.len() * 12;
    let mut view = |start: usize, end: usize, target| {
        root.push(View {
            buffer,
            byte_length: USize64::from(end - start),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: Default::default(),
        })
    };
    let position_view = view(0, split, Target::ArrayBuffer);
    let index_view = view(split, bytes, Target::ElementArrayBuffer);
    let mut positions = accessor(position_view, points.len(), ComponentType::F32, Type::Vec3);
    positions.min = Some(extreme(points, f32::min));
    positions.max = Some(extreme(points, f32::max));
    let positions = root.push(positions);
    let indices = root.push(accessor(index_view, corners, ComponentType::U32, Type::Scalar));
    let mesh = root.push(Mesh {
        primitives: vec![Primitive {
            attributes: [(Valid(Semantic::Positions), positions)].into(),
            extensions: None,
            extras: Default::default(),
            indices: Some(indices),
            material: None,
            mode: Valid(Mode::Triangles),
            targets: None,
        }],
        extensions: None,
        extras: Default::default(),
        name: None,
        weights: None,
    });
    let node = root.push(Node { mesh: Some(mesh), scale: Some([0.001; 3]), ..Node::default() });
    let scene = root.push(Scene {
        nodes: vec![node],
        name: None,
        extensions: None,
        extras: Default::default(),
    });
    root.scene = Some(scene);
    root
}

fn accessor(view: Index<View>, count: usize, kind: ComponentType, shape: Type) -> Accessor {
    Accessor {
        buffer_view: Some(view),
        byte_offset: Some(USize64(0)),
        count: USize64::from(count),
        component_type: Valid(GenericComponentType(kind)),
        type_: Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
        extensions: None,
        extras: Default::default(),
    }
}

fn extreme(points: &[[f32; 3]], pick: fn(f32, f32) -> f32) -> serde_json::Value {
    let first = points.first().copied().unwrap_or_default();
    let best = points.iter().fold(first, |m, p| [0, 1, 2].map(|k| pick(m[k], p[k])));
    serde_json::Value::from(best.to_vec())
}

/// Header, JSON chunk padded with blanks, binary chunk (already a multiple of four).
fn pack(mut json: Vec<u8>, binary: Vec<u8>) -> Result<Vec<u8>, String> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let Ok(total) = u32::try_from(length) else {
        return Err(format!("{length} bytes are more than a GLB can hold"));
    };
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    for (chunk, kind) in [(json, b"JSON"), (binary, b"BIN\0")] {
        out.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(&chunk);
    }
    Ok(out)
}
