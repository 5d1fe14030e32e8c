//! The world about a place: houses with relief, ground, clutter; what a line of sight meets there.

use std::f64::consts::TAU;

use super::block::Block;
use super::clutter::{Thing, clutter};
use super::draws::{between, stream};
use super::house::{Face, Surface};
use super::levels::Levels;
use super::relief::Relief;
use crate::geometry::{Point3, RayCaster, Vector3};

/// No keypoint is found where a face is seen more obliquely than by this cosine, 83 degrees off its normal.
const GRAZING_COS: f64 = 0.12;

/// Leaves stand so far, one sigma, about the surface that hides what is behind them, metres.
const LEAVES_M: f64 = 0.35;

/// The ground rises and falls over so much, metres.
const WAVE_M: f64 = 40.0;

/// What a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Matter {
    Wall,
    Roof,
    Ground,
    Tree,
    Solid,
}

impl Matter {
    pub(super) fn is_house(self) -> bool {
        matches!(self, Matter::Wall | Matter::Roof)
    }

    /// How rich in keypoints it is, beside a wall.
    fn texture(self) -> f64 {
        match self {
            Matter::Wall => 1.0,
            Matter::Roof => 0.9,
            Matter::Ground => 0.45,
            Matter::Tree => 0.5,
            Matter::Solid => 0.8,
        }
    }
}

/// What stands about a place.
pub(super) struct World {
    /// Those of the houses and the ground, in the order of [`Block::faces`], then those of things.
    faces: Vec<(Matter, Relief)>,
    normals: Vec<Vector3<f64>>,
    face_of_triangle: Vec<usize>,
    pub(super) rays: RayCaster,
    waves: [(Vector3<f64>, f64); 4],
    wave_m: f64,
}

/// What a line of sight meets.
pub(super) struct Met {
    /// Number in [`Block::faces`], `None` for things.
    pub(super) face: Option<usize>,
    pub(super) matter: Matter,
    /// With relief.
    pub(super) at: Point3<f64>,
    /// The chance that a keypoint is found there.
    pub(super) found: f64,
}

impl World {
    pub(super) fn new(built: &Block, place: &Point3<f64>, reach_m: f64, levels: &Levels, seed: u64) -> World {
        let things = clutter(built, &built.rays(), place, reach_m, levels, seed.wrapping_add(1));
        let of_built = built.faces().map(|face| match face.surface {
            Surface::Wall => (Matter::Wall, face),
            Surface::Roof => (Matter::Roof, face),
            Surface::Ground => (Matter::Ground, face),
        });
        let of_things = things.iter().map(|(thing, face)| match thing {
            Thing::Tree => (Matter::Tree, face),
            Thing::Solid => (Matter::Solid, face),
        });
        let all: Vec<(Matter, &Face)> = of_built.chain(of_things).collect();
        // Only walls have windows.
        let relief = |(number, (matter, face)): (usize, &(Matter, &Face))| {
            let level = if *matter == Matter::Wall { levels.relief } else { 0.0 };
            (*matter, Relief::new(face, level, seed.wrapping_add(2), number))
        };
        let mut random = stream(seed, 3);
        let wave = |_| (TAU / WAVE_M * random.normal_vector(), TAU * random.unit());
        World {
            faces: all.iter().enumerate().map(relief).collect(),
            normals: all.iter().map(|(_, face)| face.normal()).collect(),
            face_of_triangle: all.iter().enumerate().flat_map(|(i, (_, f))| f.triangles().map(move |_| i)).collect(),
            rays: RayCaster::new(all.iter().flat_map(|(_, face)| face.triangles())),
            waves: std::array::from_fn(wave),
            wave_m: levels.relief * between(&mut stream(seed, 4), 0.01, 0.08),
        }
    }

    /// What is seen along a line, if a keypoint can be found there; `leaves` moves points of trees.
    pub(super) fn meet(
        &self,
        eye: &Point3<f64>,
        direction: &Vector3<f64>,
        reach_m: f64,
        leaves: Vector3<f64>,
    ) -> Option<Met> {
        let sight = self.rays.first_hit(eye, direction, reach_m)?;
        let number = self.face_of_triangle[sight.triangle as usize];
        let (matter, relief) = &self.faces[number];
        let normal = &self.normals[number];
        if sight.distance < 1.0 || normal.dot(direction).abs() < GRAZING_COS {
            return None;
        }
        let at = eye + sight.distance * direction;
        let (before_m, found) = relief.at(&at);
        let moved = match matter {
            Matter::Tree => LEAVES_M * leaves,
            Matter::Ground => self.wave_at(&at) * Vector3::z(),
            _ => before_m * normal,
        };
        Some(Met {
            face: (!matches!(matter, Matter::Tree | Matter::Solid)).then_some(number),
            matter: *matter,
            at: at + moved,
            found: found * matter.texture(),
        })
    }

    /// How far the ground stands above its plane.
    fn wave_at(&self, x: &Point3<f64>) -> f64 {
        self.waves.iter().map(|(number, phase)| self.wave_m * (number.xy().dot(&x.coords.xy()) + phase).sin()).sum()
    }
}
