//! The numbers of accessors of any component type, in f64, with their sparse values.

use gltf::json;
use gltf::json::accessor::{ComponentType, GenericComponentType};
use gltf::json::validation::Checked;

use super::GltfError;
use super::buffers::Buffers;
use super::check::{Items, Range, at_accessor};
use super::nodes::missing;

/// Elements of `N` numbers, one after the other. The accessor was checked.
pub(super) struct Values<'b, const N: usize> {
    component: ComponentType,
    /// Whole numbers that stand for -1 to 1, or 0 to 1.
    is_normalized: bool,
    base: Option<Range<'b>>,
    sparse: Option<Sparse<'b>>,
    next: usize,
    count: usize,
}

/// Elements that are another than in the base: their numbers, which rise, and their values.
struct Sparse<'b> {
    component: ComponentType,
    indices: Range<'b>,
    values: Range<'b>,
    next: usize,
}

impl<'b, const N: usize> Values<'b, N> {
    pub fn of(root: &json::Root, index: usize, buffers: &'b Buffers<'_>) -> Result<Values<'b, N>, GltfError> {
        let accessor = root
            .accessors
            .get(index)
            .ok_or_else(|| at_accessor(index, missing("accessor", index, root.accessors.len())))?;
        let component = match accessor.component_type {
            Checked::Valid(GenericComponentType(component)) => component,
            Checked::Invalid => ComponentType::F32,
        };
        let item_bytes = (N * component.size()) as u64;
        let items = |count, offset| Items { count, offset, item_bytes };
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let base = match accessor.buffer_view {
            Some(view) => Some(items(accessor.count.0, offset).range(root, view.value(), buffers)?),
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => {
                let of_index = match sparse.indices.component_type {
                    Checked::Valid(json::accessor::IndexComponentType(component)) => component,
                    Checked::Invalid => ComponentType::U32,
                };
                let (count, offset) = (sparse.count.0, sparse.indices.byte_offset.0);
                let indices = Items { count, offset, item_bytes: of_index.size() as u64 };
                let indices = indices.range(root, sparse.indices.buffer_view.value(), buffers)?;
                let values = items(count, sparse.values.byte_offset.0);
                let values = values.range(root, sparse.values.buffer_view.value(), buffers)?;
                Some(Sparse { component: of_index, indices, values, next: 0 })
            }
            None => None,
        };
        let count = accessor.count.0 as usize;
        Ok(Values { component, is_normalized: accessor.normalized, base, sparse, next: 0, count })
    }

    fn element(&self, bytes: &[u8]) -> [f64; N] {
        let size = self.component.size();
        std::array::from_fn(|at| {
            let value = number(self.component, bytes.get(at * size..).unwrap_or_default());
            if self.is_normalized { normalized(self.component, value) } else { value }
        })
    }
}

impl<const N: usize> Iterator for Values<'_, N> {
    type Item = [f64; N];

    fn next(&mut self) -> Option<[f64; N]> {
        let at = self.next;
        if at >= self.count {
            return None;
        }
        self.next += 1;
        let value_of =
            |range: &Range<'_>, at: usize| self.element(range.bytes.get(at * range.stride..).unwrap_or_default());
        let mut value = self.base.as_ref().map_or([0.0; N], |base| value_of(base, at));
        let replaced = self.sparse.as_ref().filter(|sparse| sparse.index() == Some(at));
        if let Some(sparse) = replaced {
            value = value_of(&sparse.values, sparse.next);
        }
        if let (true, Some(sparse)) = (replaced.is_some(), &mut self.sparse) {
            sparse.next += 1;
        }
        Some(value)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.count - self.next, Some(self.count - self.next))
    }
}

impl Sparse<'_> {
    fn index(&self) -> Option<usize> {
        let bytes = self.indices.bytes.get(self.next * self.indices.stride..).filter(|bytes| !bytes.is_empty())?;
        Some(number(self.component, bytes) as usize)
    }
}

/// What stands at the beginning of the bytes; missing bytes are zeros.
fn number(component: ComponentType, bytes: &[u8]) -> f64 {
    let mut word = [0; 4];
    let size = component.size().min(bytes.len());
    word[..size].copy_from_slice(&bytes[..size]);
    let [byte, second, ..] = word;
    match component {
        ComponentType::I8 => f64::from(byte.cast_signed()),
        ComponentType::U8 => f64::from(byte),
        ComponentType::I16 => f64::from(i16::from_le_bytes([byte, second])),
        ComponentType::U16 => f64::from(u16::from_le_bytes([byte, second])),
        ComponentType::U32 => f64::from(u32::from_le_bytes(word)),
        ComponentType::F32 => f64::from(f32::from_le_bytes(word)),
    }
}

/// glTF 2.0, section 3.11 (animations) and KHR_mesh_quantization: the lowest number of a signed type is -1, too.
fn normalized(component: ComponentType, value: f64) -> f64 {
    match largest(component) {
        Some(largest) => (value / largest).max(-1.0),
        None => value,
    }
}

/// The number of a whole type that stands for one.
pub(super) fn largest(component: ComponentType) -> Option<f64> {
    match component {
        ComponentType::I8 => Some(127.0),
        ComponentType::U8 => Some(255.0),
        ComponentType::I16 => Some(32767.0),
        ComponentType::U16 => Some(65535.0),
        ComponentType::U32 | ComponentType::F32 => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_each_type_are_read_and_made_parts_of_one() {
        let bytes = [0x80, 0xFF, 0x7F, 0x3F];
        for (component, expected, part) in [
            (ComponentType::I8, -128.0, -1.0),
            (ComponentType::U8, 128.0, 128.0 / 255.0),
            (ComponentType::I16, -128.0, -128.0 / 32767.0),
            (ComponentType::U16, 65408.0, 65408.0 / 65535.0),
            (ComponentType::U32, 1_065_353_088.0, 1_065_353_088.0),
        ] {
            let value = number(component, &bytes);
            assert_eq!((value, normalized(component, value)), (expected, part), "{component:?}");
        }
        assert_eq!(number(ComponentType::F32, &1.5_f32.to_le_bytes()), 1.5);
        assert_eq!(number(ComponentType::U32, &[]), 0.0);
    }
}
