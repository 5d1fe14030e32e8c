//! The types of numbers in a PLY file, and further properties of points as they are carried from file to file.

/// A type of numbers, by either of the names that PLY files give it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A further property of the points of a cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudField {
    pub name: String,
    pub kind: FieldKind,
    /// The values one after the other, little-endian, as many as there are points.
    pub bytes: Vec<u8>,
}

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::format) enum ByteOrder {
    Little,
    Big,
}

impl FieldKind {
    /// Every type with its old and its new name.
    const NAMES: [(FieldKind, &'static str, &'static str); 8] = [
        (FieldKind::I8, "char", "int8"),
        (FieldKind::U8, "uchar", "uint8"),
        (FieldKind::I16, "short", "int16"),
        (FieldKind::U16, "ushort", "uint16"),
        (FieldKind::I32, "int", "int32"),
        (FieldKind::U32, "uint", "uint32"),
        (FieldKind::F32, "float", "float32"),
        (FieldKind::F64, "double", "float64"),
    ];

    pub(super) fn named(name: &str) -> Option<FieldKind> {
        FieldKind::NAMES.iter().find(|(_, old, new)| [*old, *new].contains(&name)).map(|(kind, _, _)| *kind)
    }

    /// The name that every reader of PLY knows.
    pub fn name(self) -> &'static str {
        FieldKind::NAMES[self as usize].1
    }

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            FieldKind::I8 | FieldKind::U8 => 1,
            FieldKind::I16 | FieldKind::U16 => 2,
            FieldKind::I32 | FieldKind::U32 | FieldKind::F32 => 4,
            FieldKind::F64 => 8,
        }
    }

    /// The value of a full colour: 1 for floating-point numbers, 255 for bytes and for integers as wide as nobody's sensor.
    pub(super) fn color_of_one(self) -> f64 {
        match self {
            FieldKind::I8 => 127.0,
            FieldKind::U8 | FieldKind::I32 | FieldKind::U32 => 255.0,
            FieldKind::I16 => 32767.0,
            FieldKind::U16 => 65535.0,
            FieldKind::F32 | FieldKind::F64 => 1.0,
        }
    }

    /// The number in the first bytes; `None` where there are too few. Every type fits an f64 exactly.
    pub(in crate::format) fn read(self, bytes: &[u8], order: ByteOrder) -> Option<f64> {
        macro_rules! number {
            ($kind:ty) => {{
                let raw = *bytes.first_chunk()?;
                f64::from(match order {
                    ByteOrder::Little => <$kind>::from_le_bytes(raw),
                    ByteOrder::Big => <$kind>::from_be_bytes(raw),
                })
            }};
        }
        Some(match self {
            FieldKind::I8 => number!(i8),
            FieldKind::U8 => number!(u8),
            FieldKind::I16 => number!(i16),
            FieldKind::U16 => number!(u16),
            FieldKind::I32 => number!(i32),
            FieldKind::U32 => number!(u32),
            FieldKind::F32 => number!(f32),
            FieldKind::F64 => number!(f64),
        })
    }
}

impl CloudField {
    pub fn new(name: impl Into<String>, kind: FieldKind) -> CloudField {
        CloudField { name: name.into(), kind, bytes: Vec::new() }
    }

    /// Adds a value, held within what the type can hold.
    pub fn push(&mut self, value: f64) {
        // Casts of floating-point numbers saturate.
        match self.kind {
            FieldKind::I8 => self.bytes.extend((value as i8).to_le_bytes()),
            FieldKind::U8 => self.bytes.extend((value as u8).to_le_bytes()),
            FieldKind::I16 => self.bytes.extend((value as i16).to_le_bytes()),
            FieldKind::U16 => self.bytes.extend((value as u16).to_le_bytes()),
            FieldKind::I32 => self.bytes.extend((value as i32).to_le_bytes()),
            FieldKind::U32 => self.bytes.extend((value as u32).to_le_bytes()),
            FieldKind::F32 => self.bytes.extend((value as f32).to_le_bytes()),
            FieldKind::F64 => self.bytes.extend(value.to_le_bytes()),
        }
    }

    /// The bytes of a point's value; none where there are fewer points.
    pub fn value_bytes(&self, point: usize) -> &[u8] {
        let size = self.kind.size();
        self.bytes.get(point * size..(point + 1) * size).unwrap_or_default()
    }

    /// A point's value.
    pub fn value(&self, point: usize) -> Option<f64> {
        self.kind.read(self.value_bytes(point), ByteOrder::Little)
    }

    /// Values.
    pub fn len(&self) -> usize {
        self.bytes.len() / self.kind.size()
    }

    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}
