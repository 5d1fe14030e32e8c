//! Planes of the city that a patch may lie on, sorted by the way they face.
//!
//! Assumption   a plane is bound to the box of its corners

use crate::geometry::{Plane, Point3, Vector3};
use crate::planes::{CityPlanes, PlaneId};

/// A plane of the city that a patch may lie on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub id: PlaneId,
    pub plane: Plane,
    /// Azimuth of the outward normal, radians; meaningless for level planes.
    pub azimuth: f64,
    /// Of the outward normal above the horizon, radians.
    pub elevation: f64,
    pub low: Point3<f64>,
    pub high: Point3<f64>,
    pub weight: f64,
}

/// The planes that are offered.
pub(super) struct Targets {
    /// With an azimuth, sorted by it.
    turned: Vec<Target>,
    /// Level planes.
    pub level: Vec<Target>,
}

/// A normal nearer to up than this has no azimuth worth using.
pub(super) const LEAST_SIN_FOR_AZIMUTH: f64 = 0.3;

impl Targets {
    /// The planes named, as far as they are no smaller than `smallest_m2`.
    pub fn new(planes: &CityPlanes, named: &[PlaneId], smallest_m2: f64) -> Targets {
        let target = |&id: &PlaneId| {
            let p = &planes.planes[id.0 as usize];
            (p.area_m2 >= smallest_m2).then(|| Target {
                id,
                plane: p.plane,
                azimuth: azimuth(&p.plane.normal),
                elevation: elevation(&p.plane.normal),
                low: p.low,
                high: p.high,
                weight: p.area_m2.sqrt(),
            })
        };
        let all = named.iter().filter_map(target);
        let (mut turned, level): (Vec<Target>, Vec<Target>) = all.partition(|t| has_azimuth(&t.plane.normal));
        turned.sort_by(|a, b| a.azimuth.total_cmp(&b.azimuth).then(a.id.cmp(&b.id)));
        Targets { turned, level }
    }

    pub fn all(&self) -> impl Iterator<Item = &Target> {
        self.turned.iter().chain(&self.level)
    }

    /// Planes whose azimuth is within `reach` of `azimuth`, radians.
    pub fn facing(&self, azimuth: f64, reach: f64) -> impl Iterator<Item = &Target> {
        let targets = &self.turned;
        let between = |low: f64, high: f64| {
            let first = targets.partition_point(|t| t.azimuth < low);
            &targets[first..targets.partition_point(|t| t.azimuth <= high).max(first)]
        };
        let (low, high) = (wrapped(azimuth) - reach, wrapped(azimuth) + reach);
        let turn = std::f64::consts::TAU;
        let all = reach >= std::f64::consts::PI;
        let main = if all { &targets[..] } else { between(low, high) };
        let over = if all { &[][..] } else { between(low + turn, high + turn) };
        let under = if all { &[][..] } else { between(low - turn, high - turn) };
        under.iter().chain(main).chain(over)
    }
}

pub(super) fn azimuth(normal: &Vector3<f64>) -> f64 {
    normal.y.atan2(normal.x)
}

pub(super) fn elevation(normal: &Vector3<f64>) -> f64 {
    normal.z.clamp(-1.0, 1.0).asin()
}

pub(super) fn has_azimuth(normal: &Vector3<f64>) -> bool {
    normal.xy().norm() > LEAST_SIN_FOR_AZIMUTH
}

/// To (-pi, pi].
pub(super) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::ObjectId;
    use crate::planes::CityPlane;

    /// Walls that face the azimuths, degrees, and a floor; a square metre each.
    fn targets(azimuths_deg: &[f64]) -> Targets {
        let plane = |normal: Vector3<f64>| CityPlane {
            plane: Plane { normal, offset: 0.0 },
            facets: Vec::new(),
            area_m2: 1.0,
            low: Point3::origin(),
            high: Point3::origin(),
            object: ObjectId(0),
        };
        let walls = azimuths_deg.iter().map(|deg| deg.to_radians().sin_cos());
        let mut planes: Vec<CityPlane> = walls.map(|(sin, cos)| plane(Vector3::new(cos, sin, 0.0))).collect();
        planes.push(plane(Vector3::z()));
        let named: Vec<PlaneId> = (0..planes.len() as u32).map(PlaneId).collect();
        Targets::new(&CityPlanes { planes, plane_of_facet: Vec::new() }, &named, 0.5)
    }

    #[test]
    fn finds_the_walls_that_face_an_azimuth_across_the_half_turn_too() {
        let targets = targets(&[0.0, 90.0, 175.0, -175.0, -90.0]);
        let facing = |deg: f64, reach: f64| -> Vec<u32> {
            let mut ids: Vec<u32> = targets.facing(f64::to_radians(deg), reach.to_radians()).map(|t| t.id.0).collect();
            ids.sort();
            ids
        };
        assert_eq!(facing(0.0, 10.0), [0]);
        assert_eq!(facing(180.0, 10.0), [2, 3]);
        assert_eq!(facing(-179.0, 10.0), [2, 3]);
        assert_eq!(facing(450.0, 1.0), [1]);
        assert_eq!(facing(30.0, 180.0), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn level_planes_stand_apart_and_small_ones_are_not_offered() {
        let all = targets(&[0.0, 90.0]);
        assert_eq!((all.all().count(), all.level.len()), (3, 1));
        let planes = CityPlanes::default();
        assert_eq!(Targets::new(&planes, &[], 0.5).all().count(), 0);
    }
}
