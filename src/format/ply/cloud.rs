//! What the vertices of a PLY file become.

use super::field::CloudField;
use super::header::{Element, PropertyKind};

/// What a file says of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyCloud {
    pub positions: Vec<[f64; 3]>,
    /// One per point or empty.
    pub colors: Vec<[u8; 3]>,
    /// One per point or empty; of any length, as in the file.
    pub normals: Vec<[f64; 3]>,
    /// Further properties, each with one value per point.
    pub fields: Vec<CloudField>,
    /// Names of the vertices' properties that are lists, which nobody carries.
    pub lists: Vec<String>,
    /// Vertices without a finite position, left out; tools write them for pixels without depth.
    pub dropped: usize,
    /// Number of the first vertex left out, from 0.
    pub first_dropped: Option<usize>,
    /// Rows of other elements than the vertices that are not as the header says, and the line of the first.
    pub odd_rows: usize,
    pub first_odd_line: Option<usize>,
}

/// What a property of a vertex is for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Position(usize),
    /// With the value of a full colour.
    Color(usize, f64),
    Normal(usize),
    /// Of this number.
    Field(usize),
    List,
}

/// Names of the three colours, and of the components of a normal, as tools write them.
const COLOR_NAMES: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];
const NORMAL_NAMES: [&str; 3] = ["nx", "ny", "nz"];

/// Gathers vertices, a row of values at a time.
pub(super) struct Collector {
    cloud: PlyCloud,
    roles: Vec<Role>,
    has_colors: bool,
    has_normals: bool,
    seen: usize,
}

impl Collector {
    pub fn new(vertex: &Element) -> Collector {
        let is_scalar =
            |name: &str| vertex.properties.iter().any(|p| p.name == name && matches!(p.kind, PropertyKind::Scalar(_)));
        let colors = COLOR_NAMES.iter().find(|names| names.iter().all(|name| is_scalar(name)));
        let normals = Some(NORMAL_NAMES).filter(|names| names.iter().all(|name| is_scalar(name)));
        let mut cloud = PlyCloud::default();
        let mut roles = Vec::new();
        let place = |names: &[&str; 3], name: &str| names.iter().position(|known| *known == name);
        for property in &vertex.properties {
            let PropertyKind::Scalar(kind) = property.kind else {
                cloud.lists.push(property.name.clone());
                roles.push(Role::List);
                continue;
            };
            let name = property.name.as_str();
            let color = colors.and_then(|names| place(names, name)).map(|i| Role::Color(i, kind.color_of_one()));
            let normal = normals.and_then(|names| place(&names, name)).map(Role::Normal);
            let position = place(&["x", "y", "z"], name).map(Role::Position);
            roles.push(position.or(color).or(normal).unwrap_or_else(|| {
                cloud.fields.push(CloudField::new(name, kind));
                Role::Field(cloud.fields.len() - 1)
            }));
        }
        Collector { cloud, roles, has_colors: colors.is_some(), has_normals: normals.is_some(), seen: 0 }
    }

    /// A vertex: a value for each of its properties, any for those that are lists.
    pub fn push(&mut self, values: &[f64]) {
        self.seen += 1;
        let (mut position, mut color, mut normal) = ([f64::NAN; 3], [0; 3], [0.0; 3]);
        for (role, value) in self.roles.iter().zip(values) {
            match *role {
                Role::Position(i) => position[i] = *value,
                // The cast holds values outside within 0 to 255 and turns a NaN into 0.
                Role::Color(i, one) => color[i] = (value * (255.0 / one)).round() as u8,
                Role::Normal(i) => normal[i] = *value,
                Role::Field(_) | Role::List => {}
            }
        }
        if !position.iter().all(|v| v.is_finite()) {
            self.cloud.dropped += 1;
            self.cloud.first_dropped.get_or_insert(self.seen - 1);
            return;
        }
        self.cloud.positions.push(position);
        if self.has_colors {
            self.cloud.colors.push(color);
        }
        if self.has_normals {
            self.cloud.normals.push(normal);
        }
        for (role, value) in self.roles.iter().zip(values) {
            if let Role::Field(number) = *role {
                self.cloud.fields[number].push(*value);
            }
        }
    }

    pub fn finish(self) -> PlyCloud {
        self.cloud
    }
}
