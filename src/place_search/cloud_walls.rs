//! The walls of the cloud in plan.
//!
//! Question     where do walls stand in the reconstruction, how long and tall, and from which side were they seen?
//! Method       upright patches in the level frame; patches of one direction and side that lie in one line, with no wide gap, are one wall,
//!              the strongest first
//! Fails when   up is wrong by more than some degrees: walls then lean, and patches of one wall part

use super::city_walls::horizontal;
use super::raster::angle;
use crate::geometry::{Point3, Rotation3, Similarity, Vector3};
use crate::limits::{Limits, PlaceSearchLimits};
use crate::planes::{Patch, Patches, Upright};
use crate::robust::quantile;

/// A wall in the level frame: sfm units, z up, origin in the middle of the cloud.
#[derive(Clone, Copy, Debug)]
pub struct CloudWall {
    pub middle: [f64; 2],
    /// Unit, as seen from the cameras where `sided`.
    pub normal: [f64; 2],
    pub sided: bool,
    pub length: f64,
    pub bottom: f64,
    pub top: f64,
    pub points: usize,
}

impl CloudWall {
    pub fn height(&self) -> f64 {
        self.top - self.bottom
    }

    pub fn azimuth(&self) -> f64 {
        angle(self.normal)
    }

    pub fn along(&self) -> [f64; 2] {
        [-self.normal[1], self.normal[0]]
    }

    /// The place at a share of the length, 0 to 1.
    pub fn at(&self, share: f64) -> [f64; 2] {
        [0, 1].map(|k| self.middle[k] + (share - 0.5) * self.length * self.along()[k])
    }

    /// How firmly it ties a pose: a long wall tells the heading, many points that it is there.
    pub fn strength(&self, radius: f64) -> f64 {
        self.length.min(radius) * (self.points as f64).sqrt()
    }
}

/// All walls of a cloud, the strongest first.
pub struct CloudWalls {
    /// Of scale 1.
    pub level_from_sfm: Similarity,
    pub walls: Vec<CloudWall>,
    /// In plan, within which nine in ten points of patches lie.
    pub radius: f64,
}

/// Normals of patches of one wall differ by no more, degrees. Chosen: patch normals are good to some degrees.
const SAME_NORMAL_DEG: f64 = 10.0;
/// Patches of one wall are off its line by so many of the cloud's noise and this share of its radius, and as far apart along it as that.
/// Chosen: balconies and reveals are of one wall, a side street parts two.
const ACROSS_NOISES: f64 = 3.0;
const ACROSS_SHARE: f64 = 0.004;
const GAP_SHARE: f64 = 0.05;
/// Points beyond this share at either end of a wall are strays.
const STRAY_SHARE: f64 = 0.03;

impl CloudWalls {
    pub fn new(patches: &Patches, upright: &Upright, limits: &Limits) -> CloudWalls {
        let leveling = Rotation3::rotation_between(&upright.up, &Vector3::z())
            .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let level_from_sfm = Similarity::about(&patches.middle(), &Point3::origin(), 1.0, leveling);
        let level: Vec<Point3<f64>> = patches.points.iter().map(|p| level_from_sfm.apply(p)).collect();
        let members = patches.patches.iter().flat_map(|p| &p.members);
        let mut far: Vec<f64> = members.map(|&m| level[m as usize].xy().coords.norm()).collect();
        let radius = quantile(&mut far, 0.9).unwrap_or(0.0);
        let mut upright_patches: Vec<(&Patch, [f64; 2])> = Vec::new();
        for patch in &patches.patches {
            let normal = leveling * patch.fit.plane.normal;
            if normal.z.abs() < limits.upright_sin {
                upright_patches.extend(horizontal(&normal).map(|n| (patch, n)));
            }
        }
        upright_patches.sort_by_key(|(patch, _)| std::cmp::Reverse(patch.members.len()));
        let mut growing: Vec<Growing> = Vec::new();
        let across = ACROSS_NOISES * patches.noise + ACROSS_SHARE * radius;
        for (patch, normal) in upright_patches {
            let points: Vec<Point3<f64>> = patch.members.iter().map(|&m| level[m as usize]).collect();
            let new = Growing { normal, sided: patch.sided, points };
            match growing.iter_mut().find(|wall| wall.continues_in(&new, across, GAP_SHARE * radius)) {
                Some(wall) => wall.points.extend(new.points),
                None => growing.push(new),
            }
        }
        let mut walls: Vec<CloudWall> = growing.iter().filter_map(Growing::wall).collect();
        walls.sort_by(|a, b| b.strength(radius).total_cmp(&a.strength(radius)));
        CloudWalls { level_from_sfm, walls, radius }
    }

    pub fn strongest(&self, count: usize) -> &[CloudWall] {
        &self.walls[..self.walls.len().min(count)]
    }

    /// How far from the middle walls reach, in plan.
    pub fn reach(&self) -> f64 {
        let ends = self.walls.iter().flat_map(|wall| [wall.at(0.0), wall.at(1.0)]);
        ends.map(|[x, y]| x.hypot(y)).fold(0.0, f64::max)
    }

    /// The numbers of the walls that poses are tied to: the strongest, at most half of them (one at least) of one direction.
    pub fn anchors(&self, limits: &PlaceSearchLimits) -> Vec<usize> {
        let (count, same_deg) = (limits.anchors, limits.one_direction_deg);
        let mut anchors: Vec<usize> = Vec::new();
        for (number, wall) in self.strongest(limits.most_walls).iter().enumerate() {
            let parallel = anchors.iter().filter(|&&a| is_parallel(&self.walls[a], wall, same_deg)).count();
            if anchors.len() < count && parallel < (count / 2).max(1) {
                anchors.push(number);
            }
        }
        anchors
    }
}

/// Whether two walls are of one direction, whichever their sides.
pub fn is_parallel(a: &CloudWall, b: &CloudWall, same_deg: f64) -> bool {
    let cos = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1];
    cos.abs() > same_deg.to_radians().cos()
}

/// A wall that patches are still joined to.
struct Growing {
    normal: [f64; 2],
    sided: bool,
    points: Vec<Point3<f64>>,
}

impl Growing {
    fn continues_in(&self, other: &Growing, across: f64, gap: f64) -> bool {
        let cos = self.normal[0] * other.normal[0] + self.normal[1] * other.normal[1];
        if self.sided != other.sided || cos < SAME_NORMAL_DEG.to_radians().cos() {
            return false;
        }
        let n = self.normal;
        let range = |points: &[Point3<f64>], axis: [f64; 2]| {
            let of = points.iter().map(|p| p.x * axis[0] + p.y * axis[1]);
            of.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
        };
        let mean =
            |points: &[Point3<f64>]| points.iter().map(|p| p.x * n[0] + p.y * n[1]).sum::<f64>() / points.len() as f64;
        if (mean(&self.points) - mean(&other.points)).abs() > across {
            return false;
        }
        let along = [-n[1], n[0]];
        let (a, b) = (range(&self.points, along), range(&other.points, along));
        a[0] <= b[1] + gap && b[0] <= a[1] + gap
    }

    fn wall(&self) -> Option<CloudWall> {
        let count = self.points.len() as f64;
        let mean = self.points.iter().fold([0.0; 2], |[x, y], p| [x + p.x / count, y + p.y / count]);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for p in &self.points {
            let (x, y) = (p.x - mean[0], p.y - mean[1]);
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        }
        // The main axis of the points in plan, unless they are too narrow to have one: then the patch's own.
        let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        let mut normal = [-sin, cos];
        let along_patch = normal[0] * self.normal[0] + normal[1] * self.normal[1];
        if along_patch.abs() < SAME_NORMAL_DEG.to_radians().cos() {
            normal = self.normal;
        } else if along_patch < 0.0 {
            normal = normal.map(|c| -c);
        }
        let along = [-normal[1], normal[0]];
        let mut t: Vec<f64> =
            self.points.iter().map(|p| (p.x - mean[0]) * along[0] + (p.y - mean[1]) * along[1]).collect();
        let mut z: Vec<f64> = self.points.iter().map(|p| p.z).collect();
        let (from, to) = (quantile(&mut t, STRAY_SHARE)?, quantile(&mut t, 1.0 - STRAY_SHARE)?);
        Some(CloudWall {
            middle: [0, 1].map(|k| mean[k] + along[k] * (from + to) / 2.0),
            normal,
            sided: self.sided,
            length: to - from,
            bottom: quantile(&mut z, STRAY_SHARE)?,
            top: quantile(&mut z, 1.0 - STRAY_SHARE)?,
            points: self.points.len(),
        })
    }
}
