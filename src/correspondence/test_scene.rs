//! Scenes of made-up blocks with their truth, for the tests of this room and of those above it.

use super::scene::Scene;
use crate::geometry::{Point3, Similarity, Start, StartSigmas, Vector3};
use crate::limits::Limits;
use crate::planes::{Patches, PreparedCity, Upright, patches};
use crate::robust::Motion;
use crate::synthetic::{Block, CaptureOptions, CloudOptions, Move, Offset, Ring, Station, Survey};

/// A block, what was seen of it, and all that scenes are made of.
pub struct Made {
    pub block: Block,
    pub survey: Survey,
    pub city: PreparedCity,
    pub patches: Patches,
    pub limits: Limits,
}

/// Walls alone were seen, 2 cm of noise and nothing wrong.
pub fn walls_alone() -> CloudOptions {
    CloudOptions { points_on_ground: 0, outlier_share: 0.0, seed: 7, ..CloudOptions::default() }
}

impl Made {
    /// `block` is what the city knows; the survey may be of more or less.
    pub fn new(block: Block, survey: Survey) -> Made {
        let city = PreparedCity::new(block.city().unwrap());
        let patches = patches(&survey.sfm, None, &Limits::default().patches);
        Made { block, survey, city, patches, limits: Limits::default() }
    }

    pub fn cloud(block: Block, options: &CloudOptions) -> Made {
        let survey = block.cloud(options);
        Made::new(block, survey)
    }

    /// Four houses on modelled ground: walls, roofs and ground were seen, 2 cm of noise, one point in ten anywhere.
    pub fn four_houses() -> Made {
        let seen = CloudOptions { points_per_roof: 100, seed: 5, ..CloudOptions::default() };
        Made::cloud(Block::four_houses().with_ground(), &seen)
    }

    /// Walls of four houses without ground: nothing but their tops and feet tells the height.
    pub fn walls() -> Made {
        Made::cloud(Block::four_houses(), &walls_alone())
    }

    /// The same houses on their ground, photographed from the street and the air, without clutter and wrong depths.
    pub fn photographed() -> Made {
        let block = Block::four_houses().with_ground();
        let rings = [Ring::street(12), Ring::drone(12)];
        let stations: Vec<Station> = rings.iter().flat_map(|ring| ring.stations(&block)).collect();
        let exact = CaptureOptions { clutter: 0, outlier_share: 0.0, places: 4000, ..CaptureOptions::default() };
        let survey = block.capture(&stations, &exact);
        Made::new(block, survey)
    }

    /// With a start that is off by so much and a vertical that is known exactly.
    pub fn scene(&self, start: &Offset, motion: Motion) -> Scene<'_> {
        let vertical = self.survey.city_from_sfm.rotation.inverse() * Vector3::z();
        let upright = Upright { up: vertical, sigma_rad: 0.0, known: true };
        self.scene_with(start, StartSigmas::default(), motion, &upright)
    }

    /// With a start that is off by so much, whose own vertical is all that is known of up.
    pub fn leaning_scene(&self, start: &Offset, motion: Motion) -> Scene<'_> {
        let sigmas = StartSigmas { tilt_rad: 5f64.to_radians(), ..StartSigmas::default() };
        let up = self.city_from_sfm(start).rotation.inverse() * Vector3::z();
        self.scene_with(start, sigmas, motion, &Upright { up, sigma_rad: sigmas.tilt_rad, known: false })
    }

    pub fn scene_with(&self, start: &Offset, sigmas: StartSigmas, motion: Motion, upright: &Upright) -> Scene<'_> {
        let start = Start::new(self.city_from_sfm(start), sigmas).unwrap();
        Scene::new(&self.city, &self.patches, &start, motion, upright, &self.limits)
    }

    /// To the city's local frame, off by so much.
    fn city_from_sfm(&self, off: &Offset) -> Similarity {
        (self.block.off(off) * self.survey.city_from_sfm).relative_to(&self.city.model.origin)
    }

    /// The pose of a scene that is off the truth by so much.
    pub fn pose(&self, scene: &Scene, off: &Offset) -> Similarity {
        self.city_from_sfm(off) * scene.level_cloud.level_from_sfm.inverse()
    }

    pub fn truth(&self, scene: &Scene) -> Similarity {
        self.pose(scene, &Offset::default())
    }

    /// How far a pose puts the houses from where they are.
    pub fn error(&self, scene: &Scene, city_from_level: &Similarity) -> Move {
        let found = scene.city_from_sfm(city_from_level).relative_to(&-self.city.model.origin);
        self.block.move_by(&(found * self.survey.city_from_sfm.inverse()))
    }

    /// How much too high a pose puts the middle of the houses, metres.
    pub fn rise_m(&self, scene: &Scene, city_from_level: &Similarity) -> f64 {
        let found = scene.city_from_sfm(city_from_level).relative_to(&-self.city.model.origin);
        let middle = self.block.middle();
        (found * self.survey.city_from_sfm.inverse()).apply(&middle).z - middle.z
    }

    /// The face that a sample point of a scene was drawn on.
    pub fn face_of(&self, scene: &Scene, sample_point: u32) -> Option<usize> {
        let point = self.patches.support[scene.level_cloud.point_of[sample_point as usize] as usize];
        self.survey.face_of_point[point.0 as usize]
    }
}

/// The survey with further points (city frame), each with the direction to those who saw it; those that were there tell no side.
pub fn with_points(mut survey: Survey, seen: &[(Point3<f64>, Vector3<f64>)]) -> Survey {
    let sfm_from_city = survey.city_from_sfm.inverse();
    survey.sfm.normals.resize(survey.sfm.points.len(), Vector3::zeros());
    for (x_in_city, to_viewer) in seen {
        survey.sfm.points.push(sfm_from_city.apply(x_in_city));
        survey.sfm.normals.push(sfm_from_city.rotation * to_viewer);
        survey.face_of_point.push(None);
    }
    survey
}

/// All sample points of patches.
pub fn patch_points(scene: &Scene) -> Vec<u32> {
    (0..scene.level_cloud.patch_points as u32).collect()
}

/// All sample points.
pub fn all(scene: &Scene) -> Vec<u32> {
    (0..scene.level_cloud.sample_points.len() as u32).collect()
}
