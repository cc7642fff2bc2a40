//! The parts of a document, put together one after another.

use gltf_json::{
    Accessor, Asset, Buffer, Index, Material, Mesh, Node, Root, Scene,
    accessor::{ComponentType, GenericComponentType, Type},
    animation::{Animation, Channel, Interpolation, Property, Sampler},
    buffer::{Target, View},
    material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    mesh::{Mode, MorphTarget, Primitive, Semantic},
    validation::{Checked::Valid, USize64},
};

/// Metres of a millimetre.
const METRES: f32 = 0.001;

/// A document and its one buffer, both growing.
pub(super) struct Document {
    root: Root,
    binary: Vec<u8>,
    buffer: Index<Buffer>,
}

/// What a surface looks like.
pub(super) struct Look {
    /// sRGB.
    pub color: [u8; 3],
    /// Whether it is seen from behind, too.
    pub double_sided: bool,
}

impl Document {
    pub fn new(note: &str) -> Self {
        let generator = Some(format!("fieldgraft {note}").trim_end().into());
        let mut root = Root { asset: Asset { generator, ..Asset::default() }, ..Root::default() };
        let buffer = root.push(Buffer {
            byte_length: USize64(0),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        Self { root, binary: vec![], buffer }
    }

    /// Bytes of the buffer so far.
    pub fn bytes(&self) -> usize {
        self.binary.len()
    }

    /// Positions of vertices.
    pub fn positions(&mut self, values: &[[f32; 3]]) -> Index<Accessor> {
        let values = values.as_flattened();
        self.floats(values, Type::Vec3, Some(Target::ArrayBuffer))
    }

    /// Three numbers a key of an animation.
    pub fn vectors(&mut self, values: &[[f32; 3]]) -> Index<Accessor> {
        self.floats(values.as_flattened(), Type::Vec3, None)
    }

    /// One number a key of an animation, or several.
    pub fn numbers(&mut self, values: &[f32]) -> Index<Accessor> {
        self.floats(values, Type::Scalar, None)
    }

    fn floats(&mut self, values: &[f32], shape: Type, target: Option<Target>) -> Index<Accessor> {
        let start = self.binary.len();
        values.iter().for_each(|x| self.binary.extend_from_slice(&x.to_le_bytes()));
        let view = self.view(start, target);
        let width = if shape == Type::Vec3 { 3 } else { 1 };
        let count = values.len() / width;
        let mut accessor = accessor(view, count, ComponentType::F32, shape);
        accessor.min = Some(extreme(values, width, f32::min));
        accessor.max = Some(extreme(values, width, f32::max));
        self.root.push(accessor)
    }

    /// Corners of faces.
    pub fn indices(&mut self, faces: &[[u32; 3]]) -> Index<Accessor> {
        let start = self.binary.len();
        let corners = faces.as_flattened();
        corners.iter().for_each(|v| self.binary.extend_from_slice(&v.to_le_bytes()));
        let view = self.view(start, Some(Target::ElementArrayBuffer));
        self.root.push(accessor(view, corners.len(), ComponentType::U32, Type::Scalar))
    }

    /// From `start` to the end of the buffer.
    fn view(&mut self, start: usize, target: Option<Target>) -> Index<View> {
        self.root.push(View {
            buffer: self.buffer,
            byte_length: USize64::from(self.binary.len() - start),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        })
    }

    /// A dull material.
    pub fn material(&mut self, look: &Look) -> Index<Material> {
        let [r, g, b] = look.color.map(linear);
        self.root.push(Material {
            double_sided: look.double_sided,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(0.75),
                ..PbrMetallicRoughness::default()
            },
            ..Material::default()
        })
    }

    pub fn mesh(&mut self, primitive: Primitive, weights: Option<Vec<f32>>) -> Index<Mesh> {
        self.root.push(Mesh {
            primitives: vec![primitive],
            extensions: None,
            extras: Default::default(),
            name: None,
            weights,
        })
    }

    /// What a program shows as the names of a mesh's targets.
    pub fn target_names(&mut self, mesh: Index<Mesh>, names: &[String]) -> Result<(), String> {
        let names = serde_json::json!({ "targetNames": names }).to_string();
        let extras = serde_json::value::RawValue::from_string(names).map_err(|e| e.to_string())?;
        self.root.meshes[mesh.value()].extras = Some(extras);
        Ok(())
    }

    pub fn node(&mut self, node: Node) -> Index<Node> {
        self.root.push(node)
    }

    /// The node, to change it.
    pub fn node_mut(&mut self, node: Index<Node>) -> &mut Node {
        &mut self.root.nodes[node.value()]
    }

    /// One animation: a property of each node takes its values at the same times, in seconds.
    pub fn animation(
        &mut self,
        name: &str,
        seconds: &[f32],
        (property, interpolation): (Property, Interpolation),
        tracks: &[(Index<Node>, Index<Accessor>)],
    ) {
        let input = self.numbers(seconds);
        let sampler = |&(_, output): &(_, Index<Accessor>)| Sampler {
            extensions: None,
            extras: Default::default(),
            input,
            interpolation: Valid(interpolation),
            output,
        };
        let channel = |(i, &(node, _)): (usize, &(Index<Node>, _))| Channel {
            sampler: Index::new(i as u32),
            target: gltf_json::animation::Target {
                extensions: None,
                extras: Default::default(),
                node,
                path: Valid(property),
            },
            extensions: None,
            extras: Default::default(),
        };
        self.root.push(Animation {
            extensions: None,
            extras: Default::default(),
            channels: tracks.iter().enumerate().map(channel).collect(),
            name: Some(name.to_owned()),
            samplers: tracks.iter().map(sampler).collect(),
        });
    }

    /// A file in two parts: all before the buffer, and the buffer. The scene holds these nodes.
    pub fn finish(mut self, nodes: Vec<Index<Node>>) -> Result<[Vec<u8>; 2], String> {
        let scene = self.root.push(Scene {
            nodes,
            name: None,
            extensions: None,
            extras: Default::default(),
        });
        self.root.scene = Some(scene);
        self.root.buffers[self.buffer.value()].byte_length = USize64::from(self.binary.len());
        let json = self.root.to_string().map_err(|e| e.to_string())?;
        Ok([head(json.into_bytes(), self.binary.len())?, self.binary])
    }
}

/// Triangles of one material.
pub(super) fn primitive(
    positions: Index<Accessor>,
    normals: Option<Index<Accessor>>,
    indices: Index<Accessor>,
    material: Option<Index<Material>>,
) -> Primitive {
    let normals = normals.map(|n| (Valid(Semantic::Normals), n));
    Primitive {
        attributes: [(Valid(Semantic::Positions), positions)].into_iter().chain(normals).collect(),
        extensions: None,
        extras: Default::default(),
        indices: Some(indices),
        material,
        mode: Valid(Mode::Triangles),
        targets: None,
    }
}

/// How far each vertex goes, and its normal with it.
pub(super) fn target(positions: Index<Accessor>, normals: Index<Accessor>) -> MorphTarget {
    MorphTarget { positions: Some(positions), normals: Some(normals), tangents: None }
}

/// A node that brings a mesh from mm to metres.
pub(super) fn placed(mesh: Index<Mesh>) -> Node {
    Node { mesh: Some(mesh), ..metres() }
}

/// A node that brings what is in it from mm to metres.
pub(super) fn metres() -> Node {
    Node { scale: Some([METRES; 3]), ..Node::default() }
}

/// A share of light from an sRGB value.
fn linear(value: u8) -> f32 {
    let x = f32::from(value) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
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

/// The least or the greatest of each component.
fn extreme(values: &[f32], width: usize, pick: fn(f32, f32) -> f32) -> serde_json::Value {
    let component = |k: usize| {
        let all = values.iter().skip(k).step_by(width).copied();
        all.reduce(pick).unwrap_or_default()
    };
    serde_json::Value::from((0..width).map(component).collect::<Vec<f32>>())
}

/// Header, JSON chunk padded with blanks, and the head of the binary chunk (already a multiple of
/// four).
fn head(mut json: Vec<u8>, binary: usize) -> Result<Vec<u8>, String> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + binary;
    let Ok(total) = u32::try_from(length) else {
        return Err(format!("{length} bytes are more than a GLB can hold"));
    };
    let mut out = Vec::with_capacity(length - binary);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    out.extend_from_slice(&(json.len() as u32).to_le_bytes());
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&json);
    out.extend_from_slice(&(binary as u32).to_le_bytes());
    out.extend_from_slice(b"BIN\0");
    Ok(out)
}
