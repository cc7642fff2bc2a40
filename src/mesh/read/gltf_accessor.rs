//! The numbers of a glTF, handed out only after every offset and count is checked against the
//! bytes there are.

use super::{buffers::Buffers, gltf_document::Document};
use crate::mesh::error::{Parsed, fault};
use glam::DVec3;

/// The component type of f32.
pub(super) const F32: u32 = 5126;

/// A document with its bytes.
pub(super) struct Source<'a> {
    pub document: &'a Document,
    pub buffers: Buffers<'a>,
}

impl Source<'_> {
    /// The indices of a primitive.
    pub fn indices(&self, id: usize) -> Parsed<Vec<u32>> {
        let a = self.accessor(id)?;
        let width = match a.component {
            _ if a.shape != "SCALAR" => 0,
            5121 => 1,
            5123 => 2,
            5125 => 4,
            _ => 0,
        };
        if width == 0 {
            let why = format!(
                "indices are {} of type {}, expected SCALAR of u8, u16 or u32 (5121, 5123, 5125)",
                a.shape, a.component
            );
            return fault(format!("accessors[{id}]"), why);
        }
        let index = |i| a.item(i).iter().rev().fold(0, |n, &b| n << 8 | u32::from(b));
        Ok((0..a.count).map(index).collect())
    }

    /// The bytes of an accessor, once they are known to be there.
    pub fn accessor(&self, id: usize) -> Parsed<Items<'_>> {
        let at = format!("accessors[{id}]");
        let d = self.document;
        let Some(a) = d.accessors.get(id) else {
            return fault(at, format!("there are {} accessors", d.accessors.len()));
        };
        if a.sparse.is_some() {
            return fault(at, "sparse accessors are not supported");
        }
        let Some(view) = a.buffer_view else {
            return fault(at, "no bufferView");
        };
        let bytes = self.view(view)?;
        let size = match (a.component_type, a.shape.as_str()) {
            (5120 | 5121, "SCALAR") => 1,
            (5122 | 5123, "SCALAR") => 2,
            (5125 | 5126, "SCALAR") => 4,
            (5120 | 5121, "VEC3") => 3,
            (5122 | 5123, "VEC3") => 6,
            (5125 | 5126, "VEC3") => 12,
            (kind, shape) => {
                return fault(at, format!("{shape} of type {kind} is not expected here"));
            }
        };
        let stride = d.buffer_views[view].byte_stride.unwrap_or(size);
        if stride < size {
            return fault(at, format!("byteStride {stride} is under the {size} bytes of an item"));
        }
        let last = a.count.saturating_sub(1).checked_mul(stride);
        let end = last.and_then(|n| n.checked_add(size)?.checked_add(a.byte_offset));
        if a.count > 0 && end.is_none_or(|end| end > bytes.len() as u64) {
            let (count, has) = (a.count, bytes.len());
            let why = format!("{count} items reach past the {has} bytes of bufferViews[{view}]");
            return fault(at, why);
        }
        let bytes = bytes.get(a.byte_offset as usize..).unwrap_or_default();
        let (stride, size) = (stride as usize, size as usize);
        let (component, shape) = (a.component_type, a.shape.as_str());
        Ok(Items { bytes, stride, size, count: a.count as usize, component, shape })
    }

    fn view(&self, i: usize) -> Parsed<&[u8]> {
        let at = format!("bufferViews[{i}]");
        let Some(view) = self.document.buffer_views.get(i) else {
            return fault(at, format!("there are {}", self.document.buffer_views.len()));
        };
        let Some(buffer) = self.buffers.get(view.buffer) else {
            let (n, count) = (view.buffer, self.document.buffers.len());
            return fault(at, format!("buffer {n}, but there are {count}"));
        };
        let end = view.byte_offset.checked_add(view.byte_length);
        let range = usize::try_from(view.byte_offset).ok().zip(end.and_then(|e| e.try_into().ok()));
        match range.and_then(|(start, end): (usize, usize)| buffer.get(start..end)) {
            Some(bytes) => Ok(bytes),
            None => fault(at, format!("reaches past the {} bytes of its buffer", buffer.len())),
        }
    }
}

/// Items of equal size at equal distances; all of them lie inside `bytes`.
pub(super) struct Items<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    pub count: usize,
    pub component: u32,
    pub shape: &'a str,
}

impl Items<'_> {
    fn item(&self, i: usize) -> &[u8] {
        self.bytes.get(i * self.stride..).and_then(|b| b.get(..self.size)).unwrap_or_default()
    }

    /// Item `i` as three f32.
    pub fn point(&self, i: usize) -> DVec3 {
        let mut p = [0.0; 3];
        for (x, b) in p.iter_mut().zip(self.item(i).chunks_exact(4)) {
            *x = f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        }
        p.into()
    }
}
