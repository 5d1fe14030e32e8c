//! From a PLY cloud to a reconstruction without images.

use std::path::Path;

use super::{Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::ply::{CloudField, PlyCloud};
use crate::geometry::{Point3, Vector3};

pub(super) fn reconstruction(path: &Path, cloud: PlyCloud) -> Result<Reconstruction, ReconstructionError> {
    if cloud.positions.is_empty() {
        return Err(ReconstructionError::NoPoints { path: path.into() });
    }
    let mut warnings = Vec::new();
    if let Some(first) = cloud.first_dropped {
        let example = format!("vertex {first}");
        warnings.push(ReconstructionWarning {
            kind: WarningKind::PointsWithoutPosition,
            count: cloud.dropped,
            example,
        });
    }
    let normals: Vec<_> = cloud.normals.into_iter().map(unit_or_zero).collect();
    if let Some(first) = normals.iter().position(|n| *n == Vector3::zeros()) {
        let count = normals.iter().filter(|n| **n == Vector3::zeros()).count();
        let example = format!("that of point {first}");
        warnings.push(ReconstructionWarning { kind: WarningKind::NormalsWithoutDirection, count, example });
    }
    if let Some(line) = cloud.first_odd_line {
        let (kind, example) = (WarningKind::OddRowsPassedOver, format!("line {line}"));
        warnings.push(ReconstructionWarning { kind, count: cloud.odd_rows, example });
    }
    warnings.extend(dropped(WarningKind::FieldsDropped, cloud.lists));
    let (splats, fields) = split_fields(cloud.fields);
    warnings.extend(dropped(WarningKind::SplatFieldsDropped, splats.into_iter().map(|f| f.name).collect()));
    let points = cloud.positions.into_iter().map(Point3::from).collect();
    let format = SfmFormat::Ply;
    Ok(Reconstruction { format, points, colors: cloud.colors, normals, fields, warnings, ..Reconstruction::default() })
}

/// Names what is not carried.
fn dropped(kind: WarningKind, names: Vec<String>) -> Option<ReconstructionWarning> {
    let count = names.len();
    (count > 0).then(|| ReconstructionWarning { kind, count, example: names.join(", ") })
}

/// Begin the names of the parameters of a Gaussian splat: colours by spherical harmonics, opacity, logarithms of sizes,
/// a quaternion (Kerbl et al. 2023).
const SPLAT_NAMES: [&str; 5] = ["f_dc_", "f_rest_", "opacity", "scale_", "rot_"];

/// The parameters of splats, which turn and grow with the frame, and what stays as it is. A cloud has splats where it has both
/// their sizes and their turns.
fn split_fields(fields: Vec<CloudField>) -> (Vec<CloudField>, Vec<CloudField>) {
    let has = |name: &str| fields.iter().any(|f| f.name == name);
    if !(has("scale_0") && has("rot_0")) {
        return (Vec::new(), fields);
    }
    fields.into_iter().partition(|f| SPLAT_NAMES.iter().any(|start| f.name.starts_with(start)))
}

/// How far from one a length may be and still be taken for one: what rounding to f32 leaves.
const UNIT_TOLERANCE: f64 = 1e-15;

fn unit_or_zero(normal: [f64; 3]) -> Vector3<f64> {
    let normal = Vector3::from(normal);
    let length = normal.norm();
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        // Left as it is, so that writing and reading again changes no bit.
        return normal;
    }
    normal.try_normalize(f64::MIN_POSITIVE).filter(|n| n.iter().all(|v| v.is_finite())).unwrap_or_default()
}
