//! From a PLY cloud to a reconstruction without images.

use std::path::Path;

use super::{Reconstruction, ReconstructionError, ReconstructionWarning, WarningKind};
use crate::format::ply::PlyCloud;
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
    let points = cloud.positions.into_iter().map(Point3::from).collect();
    Ok(Reconstruction { points, colors: cloud.colors, normals, warnings, ..Reconstruction::default() })
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
