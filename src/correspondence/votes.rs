//! The cloud as a set of votes in the level frame: metres as the start has them, z up, heading as the start has it, origin in
//! the middle of the cloud.
//!
//! Question     which points shall judge a pose, and how much does each of them count?
//! Method       points of patches only. Within a patch all count alike; patches count by the square root of their size, since
//!              their points share one error; classes of direction count by the square root of their patches' sum, so that the
//!              little ground that holds the height is not outvoted by the walls.

use crate::geometry::{Point3, Rotation3, Similarity, Start, Vector3};
use crate::planes::{Patches, Upright};

use super::field::Probe;

/// A planar group in the level frame.
#[derive(Clone, Debug)]
pub struct LevelPatch {
    pub center: Point3<f64>,
    pub normal: Vector3<f64>,
    pub sided: bool,
    /// Standard deviations along the two in-plane axes, and the axes.
    pub spread: [f64; 2],
    pub axes: [Vector3<f64>; 2],
    /// Range in [`Votes::probes`].
    pub probes: std::ops::Range<usize>,
    /// Share of the whole vote.
    pub weight: f64,
}

/// All votes of a cloud.
#[derive(Clone, Debug)]
pub struct Votes {
    pub level_from_sfm: Similarity,
    /// Where the start puts the level frame's origin; city frame (local).
    pub center_in_city: Point3<f64>,
    pub patches: Vec<LevelPatch>,
    /// Points of the patches, patch by patch, then loose points that cameras saw; level frame.
    pub probes: Vec<Probe>,
    /// Where the cameras stood; level frame.
    pub cameras: Vec<Point3<f64>>,
    /// For each probe the nearest and the farthest camera that saw it (indices into `cameras`).
    pub viewers: Vec<[Option<u32>; 2]>,
    /// How many of the probes belong to patches.
    pub firm: usize,
    /// Weight of each probe: those of patches add up to 1, loose ones have none.
    pub weights: Vec<f64>,
    /// Index of each probe in `Patches::points`.
    pub point_of: Vec<u32>,
    /// Noise of points across their local planes, level frame (metres of the start).
    pub noise_m: f64,
    /// Horizontal radius within which nine in ten votes lie, metres of the start.
    pub radius_m: f64,
}

/// Normals of a patch and its facet agree within this angle: patch normals are good to some degrees, walls of a block turn
/// by more.
const SAME_NORMAL_DEG: f64 = 25.0;
/// A facet that is seen at a more grazing angle shows no points.
const GRAZING_DEG: f64 = 83.0;
/// Flat enough for a floor: a wall leans less than this from upright and a floor from level.
const UPRIGHT_SIN: f64 = 0.2;
/// A frame that leans by less than this still tells a floor, up to 37 degrees from its z, from the ceiling that it would be upside down.
const TELLS_FLOORS_RAD: f64 = 0.8;

impl Votes {
    /// `start` maps the cloud to the city's local frame; `upright` tells its up.
    pub fn new(patches: &Patches, start: &Start, upright: &Upright) -> Votes {
        let city_from_sfm = &start.city_from_sfm;
        // The smallest turn that levels the cloud after the start's rotation.
        let up_in_city = city_from_sfm.rotation * upright.up;
        let leveling = Rotation3::rotation_between(&up_in_city, &Vector3::z()).unwrap_or_else(Rotation3::identity);
        let middle = middle_of(patches);
        let rotation = leveling * city_from_sfm.rotation;
        let level_from_sfm = Similarity::about(&middle, &Point3::origin(), city_from_sfm.scale, rotation);
        let mut votes = Votes {
            level_from_sfm,
            center_in_city: city_from_sfm.apply(&middle),
            patches: Vec::new(),
            probes: Vec::new(),
            cameras: patches.cameras.iter().map(|c| level_from_sfm.apply(c)).collect(),
            viewers: Vec::new(),
            firm: 0,
            weights: Vec::new(),
            point_of: Vec::new(),
            noise_m: patches.noise * city_from_sfm.scale,
            radius_m: 0.0,
        };
        votes.take_patches(patches, 3.0 * upright.sigma_rad < TELLS_FLOORS_RAD);
        votes.firm = votes.probes.len();
        votes.weigh();
        votes.take_loose_points(patches);
        votes.viewers = votes.point_of.iter().map(|&i| patches.viewers[i as usize]).collect();
        votes.radius_m = votes.horizontal_radius();
        votes
    }

    /// `floors_look_up`: whether z is near enough to up to tell the side of level patches.
    fn take_patches(&mut self, patches: &Patches, floors_look_up: bool) {
        let to_level = self.level_from_sfm;
        let min_cos = SAME_NORMAL_DEG.to_radians().cos();
        for patch in &patches.patches {
            let mut normal = to_level.rotation * patch.fit.plane.normal;
            // Nobody scans a floor from below: where no camera tells, level surfaces look up.
            let level = floors_look_up && normal.z.abs() > 1.0 - UPRIGHT_SIN;
            if !patch.sided && level && normal.z < 0.0 {
                normal = -normal;
            }
            let sided = patch.sided || level;
            let first = self.probes.len();
            for &m in &patch.members {
                let position = to_level.apply(&patches.points[m as usize]);
                self.probes.push(Probe { position, normal, sided, min_cos });
                self.point_of.push(m);
            }
            self.patches.push(LevelPatch {
                center: to_level.apply(&patch.fit.center),
                normal,
                sided,
                spread: patch.fit.spread.map(|s| s * to_level.scale),
                axes: patch.fit.axes.map(|a| to_level.rotation * a),
                probes: first..self.probes.len(),
                weight: 0.0,
            });
        }
    }

    /// Points outside all patches say nothing in a search; beside a nearly right pose those on small or grazed facets help to
    /// hold it, since a facet must at least face the cameras that saw the point.
    fn take_loose_points(&mut self, patches: &Patches) {
        let to_level = self.level_from_sfm;
        let mut taken = vec![false; patches.points.len()];
        self.point_of.iter().for_each(|&i| taken[i as usize] = true);
        let min_cos = GRAZING_DEG.to_radians().cos();
        for (i, (point, view)) in patches.points.iter().zip(&patches.views).enumerate() {
            let Some(view) = view.try_normalize(0.0).filter(|_| !taken[i]) else { continue };
            let position = to_level.apply(point);
            self.probes.push(Probe { position, normal: to_level.rotation * view, sided: true, min_cos });
            self.point_of.push(i as u32);
            self.weights.push(0.0);
        }
    }

    fn weigh(&mut self) {
        let mut classes = [0.0; CLASSES];
        for patch in &self.patches {
            classes[class(&patch.normal)] += (patch.probes.len() as f64).sqrt();
        }
        let total: f64 = classes.iter().map(|c| c.sqrt()).sum();
        self.weights = vec![0.0; self.probes.len()];
        for patch in &mut self.patches {
            let size = patch.probes.len() as f64;
            patch.weight = size.sqrt() / classes[class(&patch.normal)].sqrt() / total;
            self.weights[patch.probes.clone()].fill(patch.weight / size);
        }
    }

    fn horizontal_radius(&self) -> f64 {
        let mut radii: Vec<f64> = self.probes[..self.firm].iter().map(|p| p.position.coords.xy().norm()).collect();
        radii.sort_by(f64::total_cmp);
        radii.get(radii.len() * 9 / 10).copied().unwrap_or(0.0)
    }

    /// `count` indices of probes, each drawn with its weight, evenly over the patches: every one of them counts alike.
    pub fn panel(&self, count: usize) -> Vec<u32> {
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

const CLASSES: usize = 17;

/// Class of direction: floors and ceilings; walls by eight azimuths; slopes by eight azimuths.
fn class(normal: &Vector3<f64>) -> usize {
    let azimuth = normal.y.atan2(normal.x) / std::f64::consts::TAU * 8.0;
    let octant = (azimuth.round() as i64).rem_euclid(8) as usize;
    match normal.z.abs() {
        z if z > 1.0 - UPRIGHT_SIN => 0,
        z if z < UPRIGHT_SIN => 1 + octant,
        _ => 9 + octant,
    }
}

/// The median of each coordinate over the patches' points.
fn middle_of(patches: &Patches) -> Point3<f64> {
    let middle = |k: usize| {
        let mut values: Vec<f64> =
            patches.patches.iter().flat_map(|p| &p.members).map(|&m| patches.points[m as usize][k]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    Point3::new(middle(0), middle(1), middle(2))
}
