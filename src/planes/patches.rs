//! Planar groups of points: the sensor's side of every correspondence.
//!
//! Question     which points of the cloud lie in one plane, and on which side of it stood the cameras?
//! Input        the cloud, its tracks, and superpixels where there are photographs or labels
//! Output       [`Patches`]: disjoint groups with a fitted plane each, and the groups that have none with the reason
//! Method       1. a plane through each point's neighbours gives the cloud's noise and a first normal;
//!              2. a superpixel's points get a plane by robust fitting; its inliers take over that firmer normal;
//!              3. regions grow from the flattest points over neighbours (in space, and in the same superpixel) that lie in
//!                 the region's plane and agree with its normal, so that small superpixels of one wall become one patch.
//! Assumptions  the noise of neighbouring points is alike; planes are larger than the spacing of the points
//! Fails when   the cloud has no planes (trees, rubble): then there are few patches or none, and that is the answer
//! Source       region growing after Rabbani, van den Heuvel, Vosselman (2006); superpixel planes after Ramalingam et al. (2010)

use std::collections::VecDeque;

use super::cloud::{LocalSurface, NEIGHBOURS, local_surfaces};
use super::fit::{FittedPlane, fit_plane, fit_plane_robustly};
use crate::geometry::{Point3, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::reconstruction::{PointIndex, Reconstruction};

/// Points of one plane, seen from one side.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Indices into [`Patches::points`].
    pub members: Vec<u32>,
    /// Sfm frame; the normal points to the cameras where `sided`.
    pub fit: FittedPlane,
    /// True where cameras (or the file's own normals) tell the outward side.
    pub sided: bool,
}

/// Why a superpixel has no plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RejectedGroup {
    TooFewPoints,
    NotPlanar,
}

/// All patches of a reconstruction.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// The points that take part: all of them, or an even thinning of a large cloud.
    pub support: Vec<PointIndex>,
    /// Their positions, sfm frame.
    pub points: Vec<Point3<f64>>,
    /// Mean direction from each of them to the cameras that saw it (or the file's own normal), any length; zero where
    /// neither is known.
    pub views: Vec<Vector3<f64>>,
    /// Centres of the cameras, sfm frame.
    pub cameras: Vec<Point3<f64>>,
    /// For each supporting point the nearest and the farthest camera that saw it.
    pub viewers: Vec<[Option<u32>; 2]>,
    pub patches: Vec<Patch>,
    /// Median standard deviation of points across their local planes, sfm units.
    pub noise: f64,
    /// Superpixels without a plane, by reason.
    pub too_few_points: usize,
    pub not_planar: usize,
}

impl Patches {
    /// The median of each coordinate over the patches' points.
    pub fn middle(&self) -> Point3<f64> {
        let middle = |k: usize| {
            let members = self.patches.iter().flat_map(|p| &p.members);
            let mut values: Vec<f64> = members.map(|&m| self.points[m as usize][k]).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(0.0)
        };
        Point3::new(middle(0), middle(1), middle(2))
    }
}

/// How patches are made.
#[derive(Clone, Copy, Debug)]
pub struct PatchOptions {
    /// A larger cloud is thinned evenly to about this many points: more do not make a pose better, since the model's own error
    /// is shared by all points of a plane.
    pub most_points: usize,
    /// A plane is fixed by three points; fewer than this many say nothing about whether they lie in one.
    pub fewest_points: usize,
}

impl Default for PatchOptions {
    fn default() -> Self {
        PatchOptions { most_points: 40_000, fewest_points: 8 }
    }
}

/// Fewest points of a superpixel that get a plane of their own: three define it, three more can contradict.
const FEWEST_IN_SUPERPIXEL: usize = 6;
/// A superpixel has a plane when at least this share of its points lies in it.
const PLANAR_SHARE: f64 = 0.6;
/// Points belong to a plane within this many sigmas of its noise.
const GATE_SIGMAS: f64 = 2.5;
/// Normals of neighbours in one region differ by no more than this: local planes of 14 points are good to some 4 degrees,
/// edges of buildings turn by 20 and more.
const SAME_NORMAL_DEG: f64 = 20.0;
/// A local plane rougher than this starts no region.
const SEED_ROUGHNESS: f64 = 0.35;

/// Finds the patches of a reconstruction.
pub fn patches(r: &Reconstruction, superpixels: Option<&LiftedSuperpixels>, options: &PatchOptions) -> Patches {
    let support = thinned(&r.points, options.most_points);
    let points: Vec<Point3<f64>> = support.iter().map(|p| r.points[p.0 as usize]).collect();
    let (surfaces, neighbours) = local_surfaces(&points);
    let noise = median(surfaces.iter().flatten().filter(|s| s.roughness < SEED_ROUGHNESS).map(|s| s.rms));
    let mut found = Patches { support, points, noise, ..Patches::default() };
    let mut grower = Grower::new(&found.points, surfaces, neighbours, noise);
    if let Some(lifted) = superpixels {
        let groups = groups_in_support(lifted, &found.support, r.points.len());
        for group in groups {
            match grower.add_superpixel(group) {
                Ok(()) => {}
                Err(RejectedGroup::TooFewPoints) => found.too_few_points += 1,
                Err(RejectedGroup::NotPlanar) => found.not_planar += 1,
            }
        }
    }
    let views = outward_hints(r, &found.support);
    let regions = grower.grow(options.fewest_points);
    found.patches = regions.into_iter().filter_map(|members| patch(&found.points, members, &views)).collect();
    found.views = views;
    found.cameras = r.images.iter().map(|image| image.center()).collect();
    found.viewers = found.support.iter().map(|&p| viewers(r, p, &found.cameras)).collect();
    found
}

/// Indices of an even thinning to about `most` points: one point (the first) of each cell of a grid, the cell widened until few
/// enough are left.
fn thinned(points: &[Point3<f64>], most: usize) -> Vec<PointIndex> {
    let all = || (0..points.len() as u32).map(PointIndex);
    if points.len() <= most {
        return all().collect();
    }
    // Outliers must not set the cell: the box of the middle 96 % of a coordinate does.
    let mut low = [0.0; 3];
    let mut extent = [0.0; 3];
    for k in 0..3 {
        let mut c: Vec<f64> = points.iter().step_by(1 + points.len() / 10_000).map(|p| p[k]).collect();
        c.sort_by(f64::total_cmp);
        low[k] = c[c.len() / 50];
        extent[k] = (c[c.len() - 1 - c.len() / 50] - low[k]).max(f64::MIN_POSITIVE);
    }
    // A surface of area A in cells of width w meets about A / w^2 of them.
    let area = 2.0 * (extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0]);
    let mut width = (area / (8.0 * most as f64)).sqrt();
    loop {
        let mut seen = std::collections::HashSet::with_capacity(most * 2);
        let cell = |p: &Point3<f64>| [0, 1, 2].map(|k| ((p[k] - low[k]) / width).floor() as i64);
        let kept: Vec<PointIndex> = all().filter(|i| seen.insert(cell(&points[i.0 as usize]))).collect();
        if kept.len() <= most {
            return kept;
        }
        width *= (kept.len() as f64 / most as f64).sqrt().max(1.05);
    }
}

/// The superpixels' points as indices into the support.
fn groups_in_support(lifted: &LiftedSuperpixels, support: &[PointIndex], count: usize) -> Vec<Vec<u32>> {
    let mut place = vec![u32::MAX; count];
    for (i, p) in support.iter().enumerate() {
        place[p.0 as usize] = i as u32;
    }
    let of = |points: &[PointIndex]| -> Vec<u32> {
        points.iter().filter_map(|p| place.get(p.0 as usize).copied()).filter(|&i| i != u32::MAX).collect()
    };
    lifted.superpixels.iter().map(|s| of(&s.points)).filter(|g| !g.is_empty()).collect()
}

/// For each supporting point the mean direction to the cameras that saw it, or the file's own normal; zero where
/// neither is known.
fn outward_hints(r: &Reconstruction, support: &[PointIndex]) -> Vec<Vector3<f64>> {
    let centers: Vec<Point3<f64>> = r.images.iter().map(|image| image.center()).collect();
    let toward_cameras = |p: PointIndex| -> Vector3<f64> {
        let x = r.points[p.0 as usize];
        let to = |&(image, _): &(crate::reconstruction::ImageIndex, u32)| {
            (centers[image.0 as usize] - x).try_normalize(0.0).unwrap_or_default()
        };
        r.track(p).iter().map(to).sum()
    };
    let hint = |&p: &PointIndex| match r.normals.get(p.0 as usize) {
        Some(normal) if r.images.is_empty() => *normal,
        _ if r.images.is_empty() => Vector3::zeros(),
        _ => toward_cameras(p),
    };
    support.iter().map(hint).collect()
}

/// The nearest and the farthest of the cameras that saw a point.
fn viewers(r: &Reconstruction, p: PointIndex, cameras: &[Point3<f64>]) -> [Option<u32>; 2] {
    let place = r.points[p.0 as usize];
    let distance = |i: &u32| (cameras[*i as usize] - place).norm_squared();
    let seen_by = || r.track(p).iter().map(|(image, _)| image.0);
    let nearest = seen_by().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let farthest = seen_by().max_by(|a, b| distance(a).total_cmp(&distance(b)));
    [nearest, farthest.filter(|_| farthest != nearest)]
}

/// The patch of a region; `None` where its points lie on a line.
fn patch(points: &[Point3<f64>], members: Vec<u32>, views: &[Vector3<f64>]) -> Option<Patch> {
    let mut fit = fit_plane(members.iter().map(|&i| points[i as usize]))?;
    let side: f64 = members.iter().map(|&i| views[i as usize].dot(&fit.plane.normal)).sum();
    if side < 0.0 {
        fit.plane = fit.plane.flipped();
    }
    Some(Patch { members, fit, sided: side != 0.0 })
}

/// Grows regions over the neighbourhood graph.
struct Grower<'a> {
    points: &'a [Point3<f64>],
    surfaces: Vec<Option<LocalSurface>>,
    neighbours: Vec<u32>,
    /// Superpixels that have a plane: inliers, and which of them each point belongs to.
    superpixels: Vec<Vec<u32>>,
    memberships: Vec<Vec<u32>>,
    noise: f64,
}

impl<'a> Grower<'a> {
    fn new(points: &'a [Point3<f64>], surfaces: Vec<Option<LocalSurface>>, neighbours: Vec<u32>, noise: f64) -> Self {
        let count = points.len();
        let memberships = vec![Vec::new(); count];
        Grower { points, surfaces, neighbours, superpixels: Vec::new(), memberships, noise }
    }

    /// Fits a plane to a superpixel's points and gives its normal to those that lie in it.
    fn add_superpixel(&mut self, group: Vec<u32>) -> Result<(), RejectedGroup> {
        if group.len() < FEWEST_IN_SUPERPIXEL {
            return Err(RejectedGroup::TooFewPoints);
        }
        let points: Vec<Point3<f64>> = group.iter().map(|&i| self.points[i as usize]).collect();
        let fit = fit_plane_robustly(&points, GATE_SIGMAS * self.noise);
        let (fit, inside) = fit.ok_or(RejectedGroup::NotPlanar)?;
        let planar = inside.len() >= FEWEST_IN_SUPERPIXEL
            && inside.len() as f64 >= PLANAR_SHARE * group.len() as f64
            && fit.rms < SEED_ROUGHNESS * fit.spread[1];
        if !planar {
            return Err(RejectedGroup::NotPlanar);
        }
        let id = self.superpixels.len() as u32;
        let members: Vec<u32> = inside.iter().map(|&i| group[i]).collect();
        let roughness = fit.rms / fit.spread[1];
        for &m in &members {
            let m = m as usize;
            self.memberships[m].push(id);
            if self.surfaces[m].is_none_or(|surface| roughness < surface.roughness) {
                self.surfaces[m] = Some(LocalSurface { normal: fit.plane.normal, rms: fit.rms, roughness });
            }
        }
        self.superpixels.push(members);
        Ok(())
    }

    /// All regions of at least `fewest` points, from the flattest seeds on.
    fn grow(&self, fewest: usize) -> Vec<Vec<u32>> {
        let flatness = |i: u32| self.surfaces[i as usize].map_or(f64::INFINITY, |s| s.roughness);
        let mut seeds: Vec<u32> = (0..self.points.len() as u32).filter(|&i| flatness(i) < SEED_ROUGHNESS).collect();
        seeds.sort_by(|&a, &b| flatness(a).total_cmp(&flatness(b)).then(a.cmp(&b)));
        let mut taken = vec![false; self.points.len()];
        let mut regions = Vec::new();
        for seed in seeds {
            if taken[seed as usize] {
                continue;
            }
            let region = self.region(seed, &mut taken);
            if region.len() >= fewest {
                regions.push(region);
            } else {
                // Others may still take these points; the seed itself has had its turn.
                region.iter().skip(1).for_each(|&i| taken[i as usize] = false);
            }
        }
        regions
    }

    fn region(&self, seed: u32, taken: &mut [bool]) -> Vec<u32> {
        let mut members = Vec::new();
        let Some(surface) = self.surfaces[seed as usize] else { return members };
        let mut region = RegionPlane { center: self.points[seed as usize].coords, normal: surface.normal };
        let tolerance = GATE_SIGMAS * self.noise;
        let cos_tolerance = SAME_NORMAL_DEG.to_radians().cos();
        let mut refit_at = 12;
        let mut queue = VecDeque::from([seed]);
        taken[seed as usize] = true;
        while let Some(i) = queue.pop_front() {
            members.push(i);
            if members.len() == refit_at {
                refit_at *= 2;
                region = RegionPlane::fitted(self.points, &members).unwrap_or(region);
            }
            let in_space = &self.neighbours[i as usize * self.stride()..(i as usize + 1) * self.stride()];
            let in_photo = self.memberships[i as usize].iter().flat_map(|&s| &self.superpixels[s as usize]);
            for &j in in_space.iter().chain(in_photo) {
                let Some(other) = self.surfaces[j as usize] else { continue };
                let lies_in = (self.points[j as usize].coords - region.center).dot(&region.normal).abs() <= tolerance;
                if !taken[j as usize] && lies_in && other.normal.dot(&region.normal).abs() > cos_tolerance {
                    taken[j as usize] = true;
                    queue.push_back(j);
                }
            }
        }
        members
    }

    fn stride(&self) -> usize {
        NEIGHBOURS.min(self.points.len())
    }
}

#[derive(Clone, Copy)]
struct RegionPlane {
    center: Vector3<f64>,
    normal: Vector3<f64>,
}

impl RegionPlane {
    fn fitted(points: &[Point3<f64>], members: &[u32]) -> Option<RegionPlane> {
        let fit = fit_plane(members.iter().map(|&i| points[i as usize]))?;
        Some(RegionPlane { center: fit.center.coords, normal: fit.plane.normal })
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
