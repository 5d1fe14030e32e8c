//! The cloud in the level frame, each point with its weight: metres as the start has them, z up, heading as the start has it, origin in
//! the middle of the cloud.
//!
//! Question     which points shall judge a pose, and how much does each of them count?
//! Method       points of patches only. Within a patch all count alike; patches count by the square root of their size, since
//!              their points share one error; classes of direction count by the square root of their patches' sum, so that the
//!              little ground that holds the height is not outvoted by the walls.

use super::prior::Extent;
use crate::geometry::{Point3, Rotation3, Similarity, Vector3};
use crate::limits::Limits;
use crate::planes::{OrientedPoint, Patches, Upright};

/// A planar group in the level frame.
#[derive(Clone, Debug)]
pub struct LevelPatch {
    pub center: Point3<f64>,
    pub normal: Vector3<f64>,
    pub sided: bool,
    /// Standard deviations along the two in-plane axes, and the axes.
    pub spread: [f64; 2],
    pub axes: [Vector3<f64>; 2],
    /// Range in [`LevelCloud::sample_points`].
    pub sample_points: std::ops::Range<usize>,
    /// Share of the weight of all patches.
    pub weight: f64,
}

/// The weighted cloud in the level frame.
#[derive(Clone, Debug)]
pub struct LevelCloud {
    pub level_from_sfm: Similarity,
    /// Where the start puts the level frame's origin; city frame (local).
    pub center_in_city: Point3<f64>,
    pub patches: Vec<LevelPatch>,
    /// Points of the patches, patch by patch, then loose points that cameras saw; level frame.
    pub sample_points: Vec<OrientedPoint>,
    /// Where the cameras stood; level frame.
    pub cameras: Vec<Point3<f64>>,
    /// For each sample point the nearest and the farthest camera that saw it (indices into `cameras`).
    pub viewers: Vec<[Option<u32>; 2]>,
    /// How many of the sample points belong to patches.
    pub patch_points: usize,
    /// Weight of each sample point: those of patches add up to 1, loose ones have none.
    pub weights: Vec<f64>,
    /// Index of each sample point in `Patches::points`.
    pub point_of: Vec<u32>,
    /// Noise of points across their local planes, level frame (metres of the start).
    pub noise_m: f64,
    /// Horizontal radius within which nine in ten sample points lie, metres of the start.
    pub radius_m: f64,
}

impl LevelPatch {
    /// The normal, and its opposite where no camera tells the side.
    pub fn sides(&self) -> impl Iterator<Item = Vector3<f64>> + use<> {
        let normal = self.normal;
        [1.0, -1.0].into_iter().take(if self.sided { 1 } else { 2 }).map(move |side| normal * side)
    }
}

/// From which side level patches were seen, where no camera tells.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FloorSide {
    /// From above: z is near enough to up to tell floors from ceilings.
    Up,
    Unknown,
}

impl LevelCloud {
    /// `city_from_sfm` is where the start puts the cloud in the city's local frame; `upright` tells its up.
    pub fn new(patches: &Patches, city_from_sfm: &Similarity, upright: &Upright, limits: &Limits) -> LevelCloud {
        // The smallest turn that levels the cloud after the start's rotation.
        let up_in_city = city_from_sfm.rotation * upright.up;
        let leveling = Rotation3::rotation_between(&up_in_city, &Vector3::z()).unwrap_or_else(half_turn);
        let middle = patches.middle();
        let rotation = leveling * city_from_sfm.rotation;
        let level_from_sfm = Similarity::about(&middle, &Point3::origin(), city_from_sfm.scale, rotation);
        let mut level_cloud = LevelCloud {
            level_from_sfm,
            center_in_city: city_from_sfm.apply(&middle),
            patches: Vec::new(),
            sample_points: Vec::new(),
            cameras: patches.cameras.iter().map(|c| level_from_sfm.apply(c)).collect(),
            viewers: Vec::new(),
            patch_points: 0,
            weights: Vec::new(),
            point_of: Vec::new(),
            noise_m: patches.noise * city_from_sfm.scale,
            radius_m: 0.0,
        };
        let tells_floors = 3.0 * upright.sigma_rad < limits.tells_floors_rad;
        level_cloud.take_patches(patches, if tells_floors { FloorSide::Up } else { FloorSide::Unknown }, limits);
        level_cloud.patch_points = level_cloud.sample_points.len();
        level_cloud.weigh(limits);
        level_cloud.take_loose_points(patches, limits);
        level_cloud.viewers = level_cloud.point_of.iter().map(|&i| patches.viewers[i as usize]).collect();
        level_cloud.radius_m = level_cloud.horizontal_radius();
        level_cloud
    }

    fn take_patches(&mut self, patches: &Patches, floors: FloorSide, limits: &Limits) {
        let to_level = self.level_from_sfm;
        let min_cos = limits.same_normal_deg.to_radians().cos();
        for patch in &patches.patches {
            let mut normal = to_level.rotation * patch.fit.plane.normal;
            // Nobody scans a floor from below: where no camera tells, level surfaces look up.
            let level = floors == FloorSide::Up && normal.z.abs() > 1.0 - limits.upright_sin;
            if !patch.sided && level && normal.z < 0.0 {
                normal = -normal;
            }
            let sided = patch.sided || level;
            let first = self.sample_points.len();
            for &m in &patch.members {
                let position = to_level.apply(&patches.points[m as usize]);
                self.sample_points.push(OrientedPoint { position, normal, sided, min_cos });
                self.point_of.push(m);
            }
            self.patches.push(LevelPatch {
                center: to_level.apply(&patch.fit.center),
                normal,
                sided,
                spread: patch.fit.spread.map(|s| s * to_level.scale),
                axes: patch.fit.axes.map(|a| to_level.rotation * a),
                sample_points: first..self.sample_points.len(),
                weight: 0.0,
            });
        }
    }

    /// Points outside all patches say nothing in a search; beside a nearly right pose those on small or grazed facets help to
    /// hold it, since a facet must at least face the cameras that saw the point.
    fn take_loose_points(&mut self, patches: &Patches, limits: &Limits) {
        let to_level = self.level_from_sfm;
        let mut taken = vec![false; patches.points.len()];
        self.point_of.iter().for_each(|&i| taken[i as usize] = true);
        let min_cos = limits.grazing_deg.to_radians().cos();
        for (i, (point, view)) in patches.points.iter().zip(&patches.views).enumerate() {
            let Some(view) = view.try_normalize(0.0).filter(|_| !taken[i]) else { continue };
            let position = to_level.apply(point);
            self.sample_points.push(OrientedPoint { position, normal: to_level.rotation * view, sided: true, min_cos });
            self.point_of.push(i as u32);
            self.weights.push(0.0);
        }
    }

    fn weigh(&mut self, limits: &Limits) {
        let mut classes = [0.0; CLASSES];
        for patch in &self.patches {
            classes[class(&patch.normal, limits.upright_sin)] += (patch.sample_points.len() as f64).sqrt();
        }
        let total: f64 = classes.iter().map(|c| c.sqrt()).sum();
        self.weights = vec![0.0; self.sample_points.len()];
        for patch in &mut self.patches {
            let size = patch.sample_points.len() as f64;
            patch.weight = size.sqrt() / classes[class(&patch.normal, limits.upright_sin)].sqrt() / total;
            self.weights[patch.sample_points.clone()].fill(patch.weight / size);
        }
    }

    fn horizontal_radius(&self) -> f64 {
        let mut radii: Vec<f64> =
            self.sample_points[..self.patch_points].iter().map(|p| p.position.coords.xy().norm()).collect();
        radii.sort_by(f64::total_cmp);
        radii.get(radii.len() * 9 / 10).copied().unwrap_or(0.0)
    }

    /// How far the cloud reaches about its middle, stray points left out.
    pub fn extent(&self) -> Extent {
        let mut heights: Vec<f64> = self.sample_points[..self.patch_points].iter().map(|p| p.position.z).collect();
        heights.sort_by(f64::total_cmp);
        let at = |share: f64| heights.get((heights.len() as f64 * share) as usize).copied().unwrap_or(0.0);
        Extent { radius_m: BEYOND_RADIUS * self.radius_m, bottom_m: at(0.002), top_m: at(0.998) }
    }

    /// `count` indices of sample points, each drawn with its weight, evenly over the patches: every one of them counts alike.
    pub fn point_subset(&self, count: usize) -> Vec<u32> {
        let mut chosen = Vec::with_capacity(count);
        let mut sum = 0.0;
        for (i, w) in self.weights.iter().enumerate() {
            sum += w;
            while chosen.len() < count && sum * count as f64 > chosen.len() as f64 + 0.5 {
                chosen.push(i as u32);
            }
        }
        chosen
    }
}

/// Room for points beyond the nine tenths that the radius holds.
const BEYOND_RADIUS: f64 = 1.2;

const CLASSES: usize = 17;

/// Class of direction: floors and ceilings; walls by eight azimuths; slopes by eight azimuths.
fn class(normal: &Vector3<f64>, upright_sin: f64) -> usize {
    let azimuth = normal.y.atan2(normal.x) / std::f64::consts::TAU * 8.0;
    let octant = (azimuth.round() as i64).rem_euclid(8) as usize;
    match normal.z.abs() {
        z if z > 1.0 - upright_sin => 0,
        z if z < upright_sin => 1 + octant,
        _ => 9 + octant,
    }
}

/// The turn that sets upright what stands on its head.
fn half_turn() -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

#[cfg(test)]
mod tests;
