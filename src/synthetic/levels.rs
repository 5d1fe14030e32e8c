//! Levels: how far a capture and its model are from ideal, each fault by its own number.

use super::draws::{log_between, one_of};
use crate::solvers::scene::Random;

/// How strong each fault is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Each modelled house is shifted by so much (one sigma, each level axis), and its ends are turned by as much.
    pub building_m: f64,
    /// Each modelled plane is off by so much (one sigma), besides.
    pub plane_m: f64,
    /// Walls stand so far inside the roof's edge, where the model has them.
    pub eaves_m: f64,
    /// The model is of blocks under flat lids.
    pub lids: bool,
    /// Share of houses that are gone, of another height or rebuilt; half as many are missing in the model.
    pub changed: f64,
    /// Windows, balconies and cladding; 1 is usual.
    pub relief: f64,
    /// Trees, cars and fences; 1 is usual.
    pub clutter: f64,
    /// Share of points that are wrong.
    pub outliers: f64,
    /// One sigma of a keypoint; what it makes of a point grows with the distance, along the line of sight two to six times as fast.
    pub noise_px: f64,
    /// Largest bend of the reconstruction that no similarity takes away, in shares of its extent.
    pub bend: f64,
    /// Points that are not wrong, at most.
    pub points: usize,
    /// Whether the model has the ground.
    pub ground: bool,
    /// Whether the reconstruction tells its cameras and tracks.
    pub cameras: bool,
}

/// A fault, or its cure: the name, and what it changes.
pub type Fault = (&'static str, fn(&mut Levels));

impl std::fmt::Display for Levels {
    /// One line, faults that are there only.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let share = |value: f64, name: &str| (value > 0.0).then(|| format!("{name} {value}"));
        let flag = |is: bool, name: &str| is.then(|| name.to_owned());
        let told = [
            share(self.building_m, "houses off"),
            share(self.plane_m, "planes off"),
            share(self.eaves_m, "eaves"),
            flag(self.lids, "flat lids"),
            share(self.changed, "changed"),
            share(self.relief, "relief"),
            share(self.clutter, "clutter"),
            share(self.outliers, "outliers"),
            share(self.noise_px, "noise px"),
            share(self.bend, "bent"),
            flag(!self.ground, "no ground"),
            flag(!self.cameras, "no cameras"),
        ];
        write!(f, "{} points, {}", self.points, told.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

impl Levels {
    /// Half a pixel of noise and nothing else.
    pub fn none() -> Levels {
        Levels {
            building_m: 0.0,
            plane_m: 0.0,
            eaves_m: 0.0,
            lids: false,
            changed: 0.0,
            relief: 0.0,
            clutter: 0.0,
            outliers: 0.0,
            noise_px: 0.5,
            bend: 0.0,
            points: 2500,
            ground: true,
            cameras: true,
        }
    }

    /// As good as things are: what single faults are added to.
    pub fn good() -> Levels {
        Levels { building_m: 0.02, plane_m: 0.01, clutter: 0.3, outliers: 0.05, ..Levels::none() }
    }

    /// As things are. Shares chosen after the faults that were seen in real pairs of capture and model.
    pub fn drawn(random: &mut Random) -> Levels {
        Levels {
            building_m: one_of(random, &[(0.03, 0.3), (0.1, 0.5), (0.25, 0.2)]),
            plane_m: one_of(random, &[(0.01, 0.3), (0.03, 0.5), (0.08, 0.2)]),
            eaves_m: one_of(random, &[(0.0, 0.4), (0.25, 0.4), (0.5, 0.2)]),
            lids: one_of(random, &[(false, 0.85), (true, 0.15)]),
            changed: one_of(random, &[(0.0, 0.25), (0.1, 0.35), (0.25, 0.4)]),
            relief: one_of(random, &[(0.3, 0.3), (1.0, 0.5), (1.5, 0.2)]),
            clutter: one_of(random, &[(0.3, 0.3), (1.0, 0.5), (2.0, 0.2)]),
            outliers: one_of(random, &[(0.05, 0.4), (0.15, 0.4), (0.4, 0.2)]),
            noise_px: one_of(random, &[(0.5, 0.4), (1.0, 0.4), (2.0, 0.2)]),
            bend: one_of(random, &[(0.0, 0.15), (0.001, 0.35), (0.0025, 0.3), (0.005, 0.2)]),
            points: log_between(random, 630.0, 5000.0) as usize,
            ground: one_of(random, &[(true, 0.7), (false, 0.3)]),
            cameras: one_of(random, &[(true, 0.65), (false, 0.35)]),
        }
    }

    /// One fault at a time, to be laid over [`Levels::good`].
    pub const FAULTS: &[Fault] = &[
        ("none", |_| ()),
        ("houses off by 5 cm", |l| l.building_m = 0.05),
        ("houses off by 10 cm", |l| l.building_m = 0.1),
        ("houses off by 25 cm", |l| l.building_m = 0.25),
        ("planes off by 8 cm", |l| l.plane_m = 0.08),
        ("walls 25 cm under eaves", |l| l.eaves_m = 0.25),
        ("walls 50 cm under eaves", |l| l.eaves_m = 0.5),
        ("flat lids (LoD1)", |l| l.lids = true),
        ("a quarter of houses changed", |l| l.changed = 0.25),
        ("relief of facades", |l| l.relief = 1.0),
        ("twice the clutter", |l| l.clutter = 2.0),
        ("40 % outliers", |l| l.outliers = 0.4),
        ("noise of 2 pixels", |l| l.noise_px = 2.0),
        ("bent by 0.1 %", |l| l.bend = 0.001),
        ("bent by 0.25 %", |l| l.bend = 0.0025),
        ("bent by 0.5 %", |l| l.bend = 0.005),
        ("thinned to a quarter", |l| l.points /= 4),
        ("no ground in the model", |l| l.ground = false),
        ("no cameras", |l| l.cameras = false),
    ];
    /// One fault taken away, to be laid over the levels of a case: what of them makes its answer wrong?
    pub const CURES: &[Fault] = &[
        ("as it is", |_| ()),
        ("houses right", |l| l.building_m = 0.0),
        ("planes right", |l| l.plane_m = 0.0),
        ("no eaves", |l| l.eaves_m = 0.0),
        ("pitched roofs", |l| l.lids = false),
        ("nothing changed", |l| l.changed = 0.0),
        ("no relief", |l| l.relief = 0.0),
        ("no clutter", |l| l.clutter = 0.0),
        ("no outliers", |l| l.outliers = 0.0),
        ("half a pixel", |l| l.noise_px = 0.5),
        ("straight", |l| l.bend = 0.0),
        ("5000 points", |l| l.points = 5000),
        ("ground modelled", |l| l.ground = true),
        ("cameras told", |l| l.cameras = true),
        ("all of it good", |l| *l = Levels { points: l.points, ..Levels::good() }),
    ];
}

#[cfg(test)]
mod tests;
