//! Triangles of a model to where its tile stands.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Matrix4, Point3};

use super::tree::UpAxis;
use crate::format::gltf::{GltfError, GltfFile, GltfPart, read_gltf};
use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::{Place, SurfaceError};

/// How far from zero a position may be, metres; farther than any on the earth.
const COORDINATE_LIMIT: f64 = 1e9;

/// A model's place, and what it is called.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement<'a> {
    pub root_from_tile: Matrix4<f64>,
    /// Added once the model is z up.
    pub center: [f64; 3],
    pub up: UpAxis,
    /// Of the file, for objects without a name.
    pub name: &'a str,
    pub feature_names: &'a [String],
}

/// Adds the triangles of a glTF or GLB model. Buffers beside it are looked for in `folder`.
pub(super) fn add_model(
    bytes: &[u8],
    folder: &Path,
    placement: &Placement<'_>,
    builder: &mut SurfaceBuilder,
) -> Result<f64, SurfaceError> {
    let file = read_gltf(bytes, folder).map_err(from_gltf)?;
    builder.skip("primitives of points and lines", file.without_surface as usize, || placement.name.to_owned());
    let spacing = file.parts.iter().map(|part| part.spacing_m).fold(0.0, f64::max);
    let mut objects = Objects { features: HashMap::new(), placement };
    for part in &file.parts {
        add_part(part, &file, &mut objects, builder)?;
    }
    Ok(spacing)
}

fn add_part(
    part: &GltfPart,
    file: &GltfFile,
    objects: &mut Objects<'_>,
    builder: &mut SurfaceBuilder,
) -> Result<(), SurfaceError> {
    let Placement { root_from_tile, center, up, .. } = *objects.placement;
    // CESIUM_RTC stands beside RTC_CENTER, in the tile's axes and not in the model's.
    let inner = file.center.unwrap_or_default();
    let placed = |position: &[f64; 3]| {
        let turned = z_up([0, 1, 2].map(|axis| position[axis] - inner[axis]), up);
        let in_tile = [0, 1, 2].map(|axis| turned[axis] + inner[axis] + center[axis]);
        let in_root = root_from_tile.transform_point(&Point3::from(in_tile));
        [in_root.x, in_root.y, in_root.z]
    };
    let first = u32::try_from(builder.file.positions.len()).unwrap_or(u32::MAX);
    builder.file.positions.extend(part.positions.iter().map(placed));
    let added = builder.file.positions.get(first as usize..).unwrap_or_default();
    if !added.iter().flatten().all(|value| value.abs() <= COORDINATE_LIMIT) {
        let problem = format!(
            "a position is not finite or farther than {COORDINATE_LIMIT:e} m from zero; mend the tile's transform"
        );
        return Err(SurfaceError::whole(problem).of(Some(part.name.clone())));
    }
    if builder.file.positions.len() > u32::MAX as usize {
        return Err(SurfaceError::whole("more than 4 billion positions; split the tileset"));
    }
    let is_mirrored = root_from_tile.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
    let whole = if part.features.is_empty() { Some(objects.of_part(part, builder)) } else { None };
    for &[a, b, c] in &part.triangles {
        let object = match whole {
            Some(object) => object,
            None => objects.of_feature(part.features[a as usize], builder),
        };
        let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
        let traits = SurfaceTraits { object, ..SurfaceTraits::default() };
        builder.add_polygon(corners.map(|corner| first + corner), traits)?;
    }
    Ok(())
}

/// Objects of one model.
struct Objects<'a> {
    features: HashMap<u32, u32>,
    placement: &'a Placement<'a>,
}

impl Objects<'_> {
    fn of_part(&self, part: &GltfPart, builder: &mut SurfaceBuilder) -> u32 {
        builder.add_object(format!("{} {}", self.placement.name, part.name), "Mesh", None)
    }

    fn of_feature(&mut self, feature: u32, builder: &mut SurfaceBuilder) -> u32 {
        let Placement { name, feature_names, .. } = *self.placement;
        *self.features.entry(feature).or_insert_with(|| {
            let id = feature_names.get(feature as usize).cloned();
            builder.add_object(id.unwrap_or_else(|| format!("{name} feature {feature}")), "Feature", None)
        })
    }
}

/// The turn from the model's axes to the tile's.
fn z_up([x, y, z]: [f64; 3], up: UpAxis) -> [f64; 3] {
    match up {
        UpAxis::X => [-z, y, x],
        UpAxis::Y => [x, -z, y],
        UpAxis::Z => [x, y, z],
    }
}

fn from_gltf(error: GltfError) -> SurfaceError {
    let place = if error.place.is_empty() { Place::Whole } else { Place::Part(error.place.clone()) };
    SurfaceError::at(place, error.to_string()).of(error.object)
}
