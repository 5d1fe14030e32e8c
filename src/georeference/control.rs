//! From control points to a start.
//!
//! Question     which similarity lays these points of the reconstruction on their places in the city, and how surely?
//! Input        points with coordinates in both frames, or seen in photographs and intersected (`rays.rs`)
//! Output       [`Estimate`] with all points; check points take no part
//! Method       consensus of triples (least median, as for positions) where there are five or more; least squares weighted by the points'
//!              sigmas; its information, made less by what the residuals say beyond these sigmas
//! Fails when   fewer than three points, or points on a line

use super::GeoreferenceError;
use super::estimate::{ControlPoint, ControlUse, Estimate};
use super::extent::{middle, radius};
use super::heights::reading;
use super::names::PhotographNames;
use super::point_fit::{PointCouple, PointFit, point_fit};
use super::projection::ToCity;
use super::rays::{Sightline, intersection};
use crate::city::CityModel;
use crate::format::control::{ControlFile, PointRole, PointSight, StoredPoint};
use crate::format::positions::Frame;
use crate::geometry::{LEAST_SPREAD_M, Point3, Similarity, Start, StartSigmas, Vector3};
use crate::reconstruction::Reconstruction;

/// Sigma of a point whose file does not say it, metres. Chosen: a corner that was picked in a model and in a cloud.
const PICKED_M: f64 = 0.25;
/// The same where it was measured and clicked in photographs: ODM's own assumption is of this size.
const MEASURED_M: f64 = 0.1;
/// Heights of another system, once converted, one sigma, metres: EGM96 and the datum of the city.
const FOREIGN_HEIGHT_M: f64 = 2.0;

/// Sets a reconstruction on control points. `city_frame`: the city's coordinate system where it is known.
pub fn from_control_points(
    file: &ControlFile,
    source_name: &str,
    sfm: &Reconstruction,
    city: &CityModel,
    city_frame: Option<&Frame>,
) -> Result<Estimate, GeoreferenceError> {
    let to_city = ToCity::new(&file.frame, city_frame, source_name)?;
    let Located { mut points, unseen, notes } = located(file, source_name, sfm, city, &to_city)?;
    let used: Vec<usize> = (0..points.len()).filter(|&i| points[i].use_of == ControlUse::Control).collect();
    let too_few = || GeoreferenceError::TooFewPoints {
        found: used.len(),
        left_out: if unseen.is_empty() { "all that are given".into() } else { unseen.join("; ") },
        source_name: source_name.into(),
    };
    let couple =
        |&i: &usize| PointCouple { in_sfm: points[i].in_sfm, in_city: points[i].in_city, sigma_m: points[i].sigma_m };
    let couples: Vec<PointCouple> = used.iter().map(couple).collect();
    let middle = middle(&sfm.points);
    let fit = point_fit(&couples, &middle).ok_or_else(too_few)?;
    let heights = reading(&to_city, &sfm.points, &fit.city_from_sfm, city);
    let shift = city.origin + Vector3::z() * heights.shift_m;
    for point in &mut points {
        point.in_city += shift;
    }
    let wrong: Vec<usize> = (0..used.len()).filter(|k| !fit.believed.contains(k)).map(|k| used[k]).collect();
    wrong.iter().for_each(|&i| points[i].use_of = ControlUse::LeftOut);
    let pose = Similarity { translation: fit.city_from_sfm.translation + shift, ..fit.city_from_sfm };
    let radius_m = pose.scale * radius(&sfm.points, &middle);
    let sigmas = sigmas(&fit, heights.is_foreign).at_least(LEAST_SPREAD_M, radius_m);
    let start = Start::new(pose, sigmas);
    let start = start.map_err(|error| GeoreferenceError::Start { source_name: source_name.into(), error })?;
    let source = format!(
        "{} {} ({source_name}{}), {:.3} m about them",
        fit.believed.len(),
        file.format,
        heights.words,
        fit.rms_m
    );
    let mut warnings: Vec<String> = unseen.iter().map(|why| format!("control point left out: {why}")).collect();
    warnings.extend(notes);
    warnings.extend(wrong.iter().map(|&i| {
        let point = &points[i];
        let distance = (pose.apply(&point.in_sfm) - point.in_city).norm();
        format!("control point {} is {distance:.2} m from where the others put it, left out", point.name)
    }));
    Ok(Estimate { start, middle, source, warnings, points })
}

fn sigmas(fit: &PointFit, has_foreign_heights: bool) -> StartSigmas {
    let s = &fit.sigmas;
    let height_m = if has_foreign_heights { s.height_m.hypot(FOREIGN_HEIGHT_M) } else { s.height_m };
    StartSigmas { height_m, ..*s }
}

/// What is known of the points of a file.
struct Located {
    /// With both places, city's local frame.
    points: Vec<ControlPoint>,
    /// Why others have none.
    unseen: Vec<String>,
    /// What was left out of the points that are used.
    notes: Vec<String>,
}

/// Finds the points in both frames.
fn located(
    file: &ControlFile,
    source_name: &str,
    sfm: &Reconstruction,
    city: &CityModel,
    to_city: &ToCity,
) -> Result<Located, GeoreferenceError> {
    let names = PhotographNames::new(&sfm.images);
    let (mut points, mut unseen, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for stored in &file.points {
        let place = to_city.place(stored.east_north, Some(stored.height_m))?;
        let [east, north] = place.east_north;
        let in_city = Point3::new(east, north, place.height_m.unwrap_or(stored.height_m)) - city.origin;
        match in_sfm(stored, source_name, sfm, &names)? {
            Ok((in_sfm, sigma, note)) => {
                points.push(Sighted { stored, in_city, in_sfm, sigma });
                notes.extend(note);
            }
            Err(why) => unseen.push(why),
        }
    }
    let scale = rough_scale(&points);
    Ok(Located { points: points.iter().map(|point| point.told(scale)).collect(), unseen, notes })
}

/// A point with its places in both frames; the sigma of that in the sfm frame in sfm units.
struct Sighted<'a> {
    stored: &'a StoredPoint,
    in_city: Point3<f64>,
    in_sfm: Point3<f64>,
    sigma: f64,
}

impl Sighted<'_> {
    fn told(&self, scale: f64) -> ControlPoint {
        let usual_m = if matches!(self.stored.sight, PointSight::At(_)) { PICKED_M } else { MEASURED_M };
        ControlPoint {
            name: self.stored.name.clone(),
            use_of: match self.stored.role {
                PointRole::Control => ControlUse::Control,
                PointRole::Check => ControlUse::Check,
            },
            in_sfm: self.in_sfm,
            in_city: self.in_city,
            sigma_m: self.stored.sigma_m.unwrap_or(usual_m).hypot(self.sigma * scale),
        }
    }
}

/// Metres per sfm unit by the spread of the points in both frames; zero where there is none.
fn rough_scale(points: &[Sighted]) -> f64 {
    let spread = |of: fn(&Sighted) -> Point3<f64>| {
        let mean = points.iter().map(|p| of(p).coords).sum::<Vector3<f64>>() / points.len().max(1) as f64;
        points.iter().map(|p| (of(p).coords - mean).norm_squared()).sum::<f64>().sqrt()
    };
    let scale = spread(|p| p.in_city) / spread(|p| p.in_sfm);
    if scale.is_finite() { scale } else { 0.0 }
}

/// The place in the sfm frame, its sigma and what was left out of it; or why there is none.
type InSfm = Result<(Point3<f64>, f64, Option<String>), String>;

fn in_sfm(
    point: &StoredPoint,
    source_name: &str,
    sfm: &Reconstruction,
    names: &PhotographNames,
) -> Result<InSfm, GeoreferenceError> {
    let sights = match &point.sight {
        PointSight::At(place) => return Ok(Ok((Point3::from(*place), 0.0, None))),
        PointSight::In(sights) => sights,
    };
    let mut rays = Vec::new();
    for (pixel, photograph) in sights {
        let Some(image) = names.find(photograph, source_name)? else { continue };
        rays.extend(Sightline::new(&sfm.images[image.0 as usize], sfm.camera_of(image), *pixel));
    }
    let name = &point.name;
    if rays.len() < 2 {
        return Ok(Err(format!("{name} is seen in {} photographs of the reconstruction", rays.len())));
    }
    let Some(met) = intersection(&rays) else {
        return Ok(Err(format!("the {} rays of {name} do not meet", rays.len())));
    };
    let left_out = format!("{} of {} sights of {name} are of another place, left out", met.left_out, rays.len());
    Ok(Ok((met.point, met.sigma, Some(left_out).filter(|_| met.left_out > 0))))
}
