//! Rows of a PLY file, whatever their properties.

use ply_rs_bw::ply::{PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

/// A row of another element than `vertex`; nothing of it is kept.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Skipped {
        Skipped
    }
}

/// A row of the element `vertex`, whatever its properties and their types.
#[derive(Clone, Copy, Default)]
pub(super) struct Vertex {
    pub position: [f64; 3],
    pub color: [u8; 3],
    pub normal: [f64; 3],
}

/// What a property of a vertex is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Position(usize),
    Color(usize),
    Normal(usize),
    Other,
}

/// A property of an element: what it is for, its name, its type.
pub(super) type Column<'a> = (Role, &'a str, &'a PropertyType);

impl Role {
    pub fn of(name: &str) -> Role {
        match name {
            "x" => Role::Position(0),
            "y" => Role::Position(1),
            "z" => Role::Position(2),
            "red" | "diffuse_red" | "r" => Role::Color(0),
            "green" | "diffuse_green" | "g" => Role::Color(1),
            "blue" | "diffuse_blue" | "b" => Role::Color(2),
            "nx" => Role::Normal(0),
            "ny" => Role::Normal(1),
            "nz" => Role::Normal(2),
            _ => Role::Other,
        }
    }
}

impl Vertex {
    /// `color_of_one` is the value of a full colour: 255 for bytes, 1 for floating-point numbers.
    pub fn set(&mut self, role: Role, value: f64, color_of_one: f64) {
        match role {
            Role::Position(i) => self.position[i] = value,
            // The cast holds values outside within 0 to 255 and turns a NaN into 0.
            Role::Color(i) => self.color[i] = (value * (255.0 / color_of_one)).round() as u8,
            Role::Normal(i) => self.normal[i] = value,
            Role::Other => {}
        }
    }

    pub fn set_named(&mut self, name: &str, value: f64, color_of_one: f64) -> PropertyAccessResult {
        self.set(Role::of(name), value, color_of_one);
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex::default()
    }

    fn set_char(&mut self, name: &str, value: i8) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 127.0)
    }

    fn set_uchar(&mut self, name: &str, value: u8) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 255.0)
    }

    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 32767.0)
    }

    fn set_ushort(&mut self, name: &str, value: u16) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 65535.0)
    }

    fn set_int(&mut self, name: &str, value: i32) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 255.0)
    }

    fn set_uint(&mut self, name: &str, value: u32) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 255.0)
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set_named(name, f64::from(value), 1.0)
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set_named(name, value, 1.0)
    }
}

pub(super) fn color_of_one(scalar: &ScalarType) -> f64 {
    match scalar {
        ScalarType::Char => 127.0,
        ScalarType::UChar | ScalarType::Int | ScalarType::UInt => 255.0,
        ScalarType::Short => 32767.0,
        ScalarType::UShort => 65535.0,
        ScalarType::Float | ScalarType::Double => 1.0,
    }
}

pub(super) fn bytes_of(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
