//! Cases: a capture of some place of a town, the town's model, and starts at the right place and at wrong ones.
//!
//! Question     what does the program say where the model differs from the world, and where there is nothing to be found?
//! Output       [`Case`]: everything that is drawn comes from (seed, index); another level of one fault leaves the rest as it was
//! Method       a town is planned, built ([`Site`]) and modelled; photographs or a scan of one place are reconstructed
//!              ([`Imperfect`]); a start is the truth disturbed by its own sigmas, or as much about another place

use std::f64::consts::{PI, TAU};

use super::block::Block;
use super::draws::{between, one_of, stream, whole};
use super::house::Face;
use super::imperfect::{Imperfect, photographed, scanned};
use super::levels::Levels;
use super::quarters::{Quarters, Repeated};
use super::site::Site;
use super::viewpoints;
use super::world::{Matter, World};
use crate::city::{CityError, CityModel};
use crate::geometry::{Point3, Rotation3, Similarity, Start, StartSigmas, Vector3};
use crate::solvers::scene::Random;

/// A town is so many blocks wide and deep: 300 m, so that a wrong place has its own streets.
const BLOCKS: usize = 5;

/// Clutter stands this near the place, metres; from the air farther.
const REACH_M: f64 = 75.0;
const REACH_FROM_AIR_M: f64 = 115.0;

/// Draws of a place until enough is seen of it.
const TRIES: u64 = 8;

/// A capture of which less lies on houses is drawn again.
const FEWEST_ON_HOUSES: usize = 80;

/// A start in the wrong place is so far off, metres.
const WRONG_PLACE_M: [f64; 2] = [60.0, 200.0];

/// One sigma of a start beyond which none is drawn: its reach is three.
const MOST_SIGMAS: f64 = 2.7;

/// Where a capture is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Setting {
    Street,
    Court,
    /// A block from all sides.
    Block,
    /// One house of its own.
    Single,
    Drone,
    /// The rim of the town.
    Outskirts,
    /// A scan from the air, without cameras.
    Airborne,
    /// A town of equal houses, of which the start's heading says little.
    Repeated(Repeated),
    /// One wall, with or without the ground before it.
    Facade,
    /// Nothing of any house.
    NoBuilding,
}

impl Setting {
    /// Those at which a right pose is there to be found.
    pub const TOLD_APART: [Setting; 7] = [
        Setting::Street,
        Setting::Court,
        Setting::Block,
        Setting::Single,
        Setting::Drone,
        Setting::Outskirts,
        Setting::Airborne,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Setting::Street => "street",
            Setting::Court => "court",
            Setting::Block => "block all round",
            Setting::Single => "single house",
            Setting::Drone => "drone ring",
            Setting::Outskirts => "outskirts",
            Setting::Airborne => "airborne scan",
            Setting::Repeated(_) => "repeated houses",
            Setting::Facade => "one facade",
            Setting::NoBuilding => "no building in view",
        }
    }

    /// The setting of a case: seven in ten times one at which there is something to be found, each kind as often.
    pub fn of(index: u64) -> Setting {
        match index % 10 {
            k @ 0..7 => Setting::TOLD_APART[k as usize],
            7 => Setting::Repeated(Repeated::ALL[(index / 10 % 5) as usize]),
            8 => Setting::Facade,
            _ => Setting::NoBuilding,
        }
    }
}

/// What a start is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Errand {
    /// The truth, off by its sigmas.
    RightPlace,
    /// Another place of the same town, 60 to 200 m away.
    WrongPlace,
    /// Some place of another town.
    ForeignTown,
    /// The right place, with a scale that is held and 5 % off.
    WrongScale,
}

impl Errand {
    pub const ALL: [Errand; 4] = [Errand::RightPlace, Errand::WrongPlace, Errand::ForeignTown, Errand::WrongScale];

    pub fn name(self) -> &'static str {
        match self {
            Errand::RightPlace => "right place",
            Errand::WrongPlace => "wrong place, same town",
            Errand::ForeignTown => "foreign town",
            Errand::WrongScale => "scale 5 % off",
        }
    }
}

/// A capture and the model of where it was made.
#[derive(Clone, Debug)]
pub struct Case {
    pub setting: Setting,
    pub levels: Levels,
    /// What the program is given; city frame.
    pub modelled: Block,
    /// `survey.city_from_sfm` is the truth; its faces are those of what was built.
    pub capture: Imperfect,
    seed: u64,
}

/// Where and how the program is asked to look.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    pub start: Start,
    pub fixed_scale: Option<f64>,
}

impl Case {
    /// Case `index` of a seed, at a setting and levels of its own. `None` where no place was found of which enough is seen.
    pub fn drawn(seed: u64, index: u64) -> Option<Case> {
        let levels = Levels::drawn(&mut stream(seed ^ 0x1e7e15, index));
        Case::with(seed, index, Setting::of(index), &levels)
    }

    /// The same with given levels.
    pub fn with(seed: u64, index: u64, setting: Setting, levels: &Levels) -> Option<Case> {
        (0..TRIES).find_map(|try_number| {
            let seed = stream(seed, TRIES * index + try_number).unit().to_bits();
            Case::at(setting, levels, seed)
        })
    }

    fn at(setting: Setting, levels: &Levels, seed: u64) -> Option<Case> {
        let mut random = stream(seed, 1);
        let town = Quarters::new(BLOCKS, BLOCKS, seed);
        let plan = match setting {
            Setting::Repeated(kind) => kind.block(&mut random),
            _ => town.block.clone(),
        };
        // A lone wall is there, or the case is none.
        let levels = if setting == Setting::Facade { Levels { changed: 0.0, ..*levels } } else { *levels };
        let site = Site::new(&plan, &levels, seed);
        let capture = seen(setting, &town, &site.built, &levels, seed, &mut random)?;
        let on_houses = capture.survey.face_of_point.iter().flatten().count();
        if setting != Setting::NoBuilding && on_houses < FEWEST_ON_HOUSES {
            return None;
        }
        // Plans lie along the axes of the grid; towns do not.
        let turn = between(&mut random, 0.0, TAU);
        let place = [between(&mut random, 80_000.0, 90_000.0), between(&mut random, 440_000.0, 450_000.0), 3.0];
        let city_from_plan = Similarity {
            scale: 1.0,
            rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), turn),
            translation: place.into(),
        };
        let mut capture = capture;
        capture.survey.city_from_sfm = city_from_plan * capture.survey.city_from_sfm;
        Some(Case { setting, levels, modelled: site.modelled.turned(turn).at(place), capture, seed })
    }

    /// The model as the program reads it.
    pub fn city(&self) -> Result<CityModel, CityError> {
        self.modelled.city()
    }

    /// The model of another town, for [`Errand::ForeignTown`].
    pub fn foreign_city(&self) -> Result<CityModel, CityError> {
        let seed = self.seed ^ 0xf0_e16;
        Site::new(&Quarters::new(BLOCKS, BLOCKS, seed).block, &self.levels, seed).modelled.city()
    }

    /// The points that are not wrong, sfm frame.
    pub fn points(&self) -> Vec<Point3<f64>> {
        let points = self.capture.survey.sfm.points.iter().zip(&self.capture.is_wrong);
        points.filter(|(_, wrong)| !**wrong).map(|(x, _)| *x).collect()
    }

    /// A start for an errand, and the scale that is held.
    pub fn request(&self, errand: Errand) -> Request {
        let mut random = stream(self.seed, 10 + errand as u64);
        let truth = self.capture.survey.city_from_sfm;
        let middle = median(self.points().iter().map(|x| truth.apply(x)));
        let heading_rad = match self.setting {
            Setting::Repeated(_) => one_of(&mut random, &[(30f64, 0.34), (90.0, 0.33), (180.0, 0.33)]).to_radians(),
            _ => StartSigmas::default().heading_rad,
        };
        let sigmas = StartSigmas { heading_rad, ..StartSigmas::default() };
        let place = match errand {
            Errand::RightPlace | Errand::WrongScale => middle,
            Errand::WrongPlace => self.elsewhere(&middle, &mut random),
            // Towns are planned about the same place, on the ground.
            Errand::ForeignTown => {
                let far = super::quarters::STEP_M * (BLOCKS - 1) as f64;
                let [x, y] = [0, 1].map(|_| between(&mut random, 0.0, far));
                Point3::new(x, y, middle.z - self.modelled.bounds().0.z)
            }
        };
        let any_heading = match errand {
            Errand::RightPlace | Errand::WrongScale => false,
            Errand::WrongPlace => random.unit() < 0.5,
            Errand::ForeignTown => true,
        };
        let turn = if any_heading { between(&mut random, -PI, PI) } else { 0.0 };
        let mut start = disturbed(&truth, &middle, &place, turn, &sigmas, &mut random);
        let fixed_scale = (errand == Errand::WrongScale).then(|| truth.scale * [0.95, 1.05][whole(&mut random, 0, 2)]);
        if let Some(scale) = fixed_scale {
            start = Similarity::about(&start.inverse().apply(&place), &place, scale, start.rotation);
        }
        // Sigmas of a start are positive here, so it is one.
        let start = Start::with_default_sigmas(start);
        let start = Start::new(*start.city_from_sfm(), sigmas).unwrap_or(start);
        Request { start, fixed_scale }
    }

    /// A place of the same town, 60 to 200 m away.
    fn elsewhere(&self, middle: &Point3<f64>, random: &mut Random) -> Point3<f64> {
        let (low, high) = self.modelled.bounds();
        let mut drawn = || {
            let angle = between(random, 0.0, TAU);
            middle + between(random, WRONG_PLACE_M[0], WRONG_PLACE_M[1]) * Vector3::new(angle.cos(), angle.sin(), 0.0)
        };
        let inside = |p: &Point3<f64>| (0..2).all(|k| (low[k]..high[k]).contains(&p[k]));
        let first = drawn();
        (0..50).map(|_| drawn()).find(inside).unwrap_or(first)
    }
}

/// What is seen at a setting.
fn seen(
    setting: Setting,
    town: &Quarters,
    built: &Block,
    levels: &Levels,
    seed: u64,
    random: &mut Random,
) -> Option<Imperfect> {
    let rays = built.rays();
    let middle = built.middle();
    let on_ground = Point3::new(middle.x, middle.y, 0.0);
    let faces: Vec<Face> = built.faces().cloned().collect();
    let mut only = None;
    let stations = match setting {
        Setting::Street | Setting::NoBuilding => viewpoints::street(town, &rays, random),
        Setting::Court => viewpoints::court(town, &rays, random),
        Setting::Block => viewpoints::round_block(town, &rays, random),
        Setting::Single => {
            let (place, half_m) = viewpoints::detached_house(town, random);
            viewpoints::single(place, half_m, &rays, random)
        }
        Setting::Drone => {
            let astray = 60.0 * Vector3::new(between(random, -1.0, 1.0), between(random, -1.0, 1.0), 0.0);
            viewpoints::drone(on_ground + astray, between(random, 18.0, 35.0), random)
        }
        Setting::Outskirts => viewpoints::outskirts(town, &rays, random),
        Setting::Airborne => Vec::new(),
        Setting::Repeated(kind) => repeated(kind, built, &rays, random),
        Setting::Facade => {
            let (number, stations) = viewpoints::before_a_wall(&faces, &rays, random)?;
            only = Some(number);
            stations
        }
    };
    if setting == Setting::Airborne {
        let astray = 80.0 * Vector3::new(between(random, -1.0, 1.0), between(random, -1.0, 1.0), 0.0);
        let (place, radius_m) = (on_ground + astray, between(random, 30.0, 60.0));
        let world = World::new(built, &place, radius_m, levels, seed);
        return scanned(&world, &place, radius_m, levels, seed);
    }
    if stations.len() < 6 {
        return None;
    }
    let place = Point3::from(stations.iter().map(|s| s.center.coords).sum::<Vector3<f64>>() / stations.len() as f64);
    let reach_m = if setting == Setting::Drone { REACH_FROM_AIR_M } else { REACH_M };
    let world = World::new(built, &place, reach_m, levels, seed);
    let with_ground = random.unit() < 0.5;
    photographed(&world, &stations, levels, seed, |met, random| match (setting, met.matter) {
        (Setting::NoBuilding, matter) => !matter.is_house(),
        (Setting::Facade, Matter::Wall | Matter::Roof) => met.face == only,
        (Setting::Facade, Matter::Ground) => with_ground,
        (Setting::Facade, _) => random.unit() < 0.5,
        _ => true,
    })
}

/// Photographs of equal houses: along their fronts, or from all sides, or out of the court.
fn repeated(
    kind: Repeated,
    built: &Block,
    rays: &crate::geometry::RayCaster,
    random: &mut Random,
) -> Vec<super::Station> {
    let (low, high) = built.bounds();
    let middle = built.middle();
    let on_ground = Point3::new(middle.x, middle.y, 0.0);
    let half_m = 0.5 * (high - low).xy().norm();
    match kind {
        Repeated::Row | Repeated::StreetOfRows => {
            let from = Point3::new(low.x + between(random, 0.0, 10.0), -7.0, 0.0);
            viewpoints::walk(from, 0.0, rays, random)
        }
        Repeated::Detached | Repeated::SymmetricBlock => viewpoints::single(on_ground, half_m, rays, random),
        Repeated::Courtyard => viewpoints::drone(on_ground, half_m, random),
    }
}

/// The truth about `middle`, put to `place`, turned, and off by sigmas within reach.
fn disturbed(
    truth: &Similarity,
    middle: &Point3<f64>,
    place: &Point3<f64>,
    turn: f64,
    sigmas: &StartSigmas,
    random: &mut Random,
) -> Similarity {
    let mut drawn = |sigma: f64| sigma * random.normal().clamp(-MOST_SIGMAS, MOST_SIGMAS);
    // A sigma of half a turn says that any heading is as likely.
    let is_open = sigmas.heading_rad > 3.0;
    let heading = if is_open { drawn(1e3) } else { drawn(sigmas.heading_rad) };
    // Sigmas of positions are of a distance: each axis has its part (score.py).
    let level = sigmas.position_m * std::f64::consts::FRAC_1_SQRT_2;
    let shift = Vector3::new(drawn(level), drawn(level), drawn(sigmas.height_m));
    let rotation = Rotation3::from_euler_angles(drawn(sigmas.tilt_rad), drawn(sigmas.tilt_rad), turn + heading);
    let off = Similarity::about(middle, &(place + shift), drawn(sigmas.log_scale).exp(), rotation);
    off * *truth
}

fn median(points: impl Iterator<Item = Point3<f64>>) -> Point3<f64> {
    let points: Vec<Point3<f64>> = points.collect();
    let of_axis = |axis: usize| {
        let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    Point3::new(of_axis(0), of_axis(1), of_axis(2))
}

#[cfg(test)]
mod tests;
