//! What a search for the place answers.

use std::fmt;

use super::judged::JudgedPose;
use crate::geometry::{Point3, Rotation3, Similarity, Start, StartSigmas, Vector3};
use crate::limits::PlaceSearchLimits;
use crate::planes::Upright;

/// Places where a reconstruction may stand, and how much was searched.
#[derive(Clone, Debug, Default)]
pub struct PlaceSearch {
    /// All within reach of the best, the best first.
    pub candidates: Vec<PlaceCandidate>,
    /// Poses that were looked at, or would have been had the time sufficed.
    pub poses_scanned: u64,
    /// Share of the city's walls that poses were tied to: less than one where the time was over before.
    pub share_searched: f64,
    /// Poses that may be as good as the best and were not compared, because there are too many.
    pub unexamined: usize,
    /// Why nothing was searched.
    pub obstacle: Option<PlaceObstacle>,
}

/// A place where a reconstruction may stand.
#[derive(Clone, Copy, Debug)]
pub struct PlaceCandidate {
    /// To the city's local frame.
    pub start: Start,
    /// The up under which it was found.
    pub upright: Upright,
    /// Walls, heights and lines of sight against chance, in standard deviations of it.
    pub z: f64,
}

/// Why a place cannot be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceObstacle {
    /// The cloud shows no wall.
    NoWalls,
    TooFewWalls {
        found: usize,
        needed: usize,
    },
    /// Along them every place is as good.
    OneDirection,
    /// There is no wall in the city, or none where the reconstruction may stand.
    NoCityWalls,
}

impl PlaceSearch {
    pub(super) fn refused(obstacle: PlaceObstacle) -> PlaceSearch {
        PlaceSearch { obstacle: Some(obstacle), ..PlaceSearch::default() }
    }

    /// The size of the space that was searched, as a logarithm to base 2: what evidence for one of its poses has to outweigh.
    pub fn space_bits(&self) -> f64 {
        (self.poses_scanned.max(1) as f64).log2()
    }
}

impl PlaceCandidate {
    pub(super) fn new(
        judged: &JudgedPose,
        level_from_sfm: &Similarity,
        upright: &Upright,
        limits: &PlaceSearchLimits,
    ) -> Option<PlaceCandidate> {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), judged.pose.heading_rad);
        let [x, y] = judged.pose.center;
        let center = Point3::new(x, y, judged.height_m());
        let city_from_level = Similarity::about(&Point3::origin(), &center, judged.pose.scale, turn);
        let [least, most] = limits.height_sigma_m;
        let sigmas = StartSigmas {
            position_m: limits.position_sigma_m,
            height_m: ((judged.heights_m[1] - judged.heights_m[0]) / 2.0).clamp(least, most),
            heading_rad: limits.heading_sigma_rad,
            tilt_rad: upright.sigma_rad.max(limits.heading_sigma_rad),
            log_scale: limits.log_scale_sigma,
        };
        let start = Start::new(city_from_level * *level_from_sfm, sigmas).ok()?;
        Some(PlaceCandidate { start, upright: *upright, z: judged.z })
    }
}

impl fmt::Display for PlaceObstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlaceObstacle::NoWalls => {
                write!(f, "the reconstruction shows no wall, and places are told by walls; give a start")
            }
            PlaceObstacle::TooFewWalls { found, needed } => {
                write!(
                    f,
                    "the reconstruction shows {found} walls, and {needed} at least tell a place; give a start, or add photographs"
                )
            }
            PlaceObstacle::OneDirection => {
                write!(
                    f,
                    "all walls of the reconstruction have one direction, along which every place is as good; give a start, or add a photograph round a corner"
                )
            }
            PlaceObstacle::NoCityWalls => {
                write!(
                    f,
                    "the city has no wall that could be seen where the reconstruction may stand; check the place that was given"
                )
            }
        }
    }
}
