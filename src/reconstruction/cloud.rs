//! From the points of LAS and E57 files to a reconstruction without images.

use std::path::Path;

use super::{LasPacking, Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::crs::Crs;
use crate::format::e57::E57Cloud;
use crate::format::las::{LasCloud, LasCrs};
use crate::format::wkt::WktUnit;
use crate::geometry::Point3;

/// `classes`: those that were asked for.
pub(super) fn of_las(
    path: &Path,
    mut cloud: LasCloud,
    classes: Option<&[u8]>,
) -> Result<Reconstruction, ReconstructionError> {
    let mut warnings = Vec::new();
    if let Some(wanted) = classes.filter(|_| cloud.positions.is_empty()) {
        let (wanted, found) = (listed(wanted), listed(&cloud.classes));
        return Err(ReconstructionError::NoPointsOfClasses { path: path.into(), wanted, found });
    }
    if cloud.of_other_classes > 0 {
        let example = format!("in {}", file_name(path));
        let count = cloud.of_other_classes;
        warnings.push(ReconstructionWarning { kind: WarningKind::OtherClassesLeftOut, count, example });
    }
    if cloud.noise > 0 {
        let example = format!("in {}", file_name(path));
        warnings.push(ReconstructionWarning { kind: WarningKind::NoiseLeftOut, count: cloud.noise, example });
    }
    if cloud.extra_bytes > 0 {
        let example = format!("{} bytes of each point beyond its format", cloud.extra_bytes);
        warnings.push(ReconstructionWarning { kind: WarningKind::FieldsDropped, count: 1, example });
    }
    if cloud.times_left_out {
        let example = "gps_time, which is not unpacked from layered LAZ (point formats 6 to 10)".into();
        warnings.push(ReconstructionWarning { kind: WarningKind::FieldsDropped, count: 1, example });
    }
    if let Some(crs) = &cloud.crs {
        refuse_degrees(path, crs, &cloud.positions)?;
        let (horizontal, vertical) = (crs.understood.horizontal.as_ref(), crs.understood.vertical.as_ref());
        warnings.extend(unit_warning(horizontal));
        warnings.extend(bring_heights(&mut cloud.positions, horizontal, vertical));
    }
    let packing = match (cloud.is_compressed, cloud.is_copc) {
        (_, true) => LasPacking::Copc,
        (true, false) => LasPacking::Laz,
        (false, false) => LasPacking::Las,
    };
    let LasCloud { version, positions, colors, fields, crs, .. } = cloud;
    let crs = crs.map(|crs| Crs::understood(&crs.text));
    let format = SfmFormat::Las { version, packing };
    with_points(path, positions, Reconstruction { format, crs, colors, fields, warnings, ..Reconstruction::default() })
}

pub(super) fn of_e57(path: &Path, cloud: E57Cloud) -> Result<Reconstruction, ReconstructionError> {
    let mut warnings = Vec::new();
    if cloud.invalid > 0 {
        let example = format!("in {}", file_name(path));
        warnings.push(ReconstructionWarning {
            kind: WarningKind::PointsWithoutPosition,
            count: cloud.invalid,
            example,
        });
    }
    if !cloud.not_carried.is_empty() {
        let (kind, count) = (WarningKind::FieldsDropped, cloud.not_carried.len());
        warnings.push(ReconstructionWarning { kind, count, example: cloud.not_carried.join(", ") });
    }
    let E57Cloud { positions, colors, fields, crs, .. } = cloud;
    let understood = crs.as_deref().map(crate::format::wkt::wkt_crs);
    warnings.extend(understood.as_ref().and_then(|crs| unit_warning(crs.horizontal.as_ref())));
    let crs = crs.as_deref().map(Crs::understood);
    let format = SfmFormat::E57;
    with_points(path, positions, Reconstruction { format, crs, colors, fields, warnings, ..Reconstruction::default() })
}

fn listed<'a>(classes: impl IntoIterator<Item = &'a u8>) -> String {
    classes.into_iter().map(u8::to_string).collect::<Vec<_>>().join(", ")
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn with_points(
    path: &Path,
    positions: Vec<[f64; 3]>,
    cloud: Reconstruction,
) -> Result<Reconstruction, ReconstructionError> {
    if positions.is_empty() {
        return Err(ReconstructionError::NoPoints { path: path.into() });
    }
    Ok(Reconstruction { points: positions.into_iter().map(Point3::from).collect(), ..cloud })
}

/// Latitude and longitude make no shape. Files that name such a system and hold larger numbers are of another one.
fn refuse_degrees(path: &Path, crs: &LasCrs, positions: &[[f64; 3]]) -> Result<(), ReconstructionError> {
    let within = |place: &[f64; 3]| place[0].abs() <= 360.0 && place[1].abs() <= 360.0;
    if crs.understood.is_geographic && positions.iter().all(within) {
        return Err(ReconstructionError::Degrees { path: path.into() });
    }
    Ok(())
}

/// How far a unit may be from another and count as the same: feet differ by two millionths.
const SAME_UNIT: f64 = 1e-4;

fn unit_warning(unit: Option<&WktUnit>) -> Option<ReconstructionWarning> {
    let WktUnit { name, metres } = unit.filter(|unit| (unit.metres - 1.0).abs() > SAME_UNIT)?;
    let plural = name.to_lowercase().replace("foot", "feet");
    let example = format!(
        "the coordinates are in {plural} (unit `{name}`), not metres: the scale that fits is about {metres:.4}"
    );
    Some(ReconstructionWarning { kind: WarningKind::UnitNotMetres, count: 1, example })
}

/// Heights in another unit than the plan are brought to the plan's, as no similarity could.
fn bring_heights(
    positions: &mut [[f64; 3]],
    horizontal: Option<&WktUnit>,
    vertical: Option<&WktUnit>,
) -> Option<ReconstructionWarning> {
    let (plan, heights) = (horizontal?, vertical?);
    let factor = heights.metres / plan.metres;
    if !(factor.is_finite() && factor > 0.0 && (factor - 1.0).abs() > SAME_UNIT) {
        return None;
    }
    positions.iter_mut().for_each(|place| place[2] *= factor);
    let example = format!(
        "heights in `{}` were multiplied by {factor:.4}, to be in `{}` as the plan is",
        heights.name, plan.name
    );
    Some(ReconstructionWarning { kind: WarningKind::HeightsBrought, count: 1, example })
}

#[cfg(test)]
mod tests;
