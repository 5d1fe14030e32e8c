//! Planar groups of points: the sensor's side of every correspondence.
//!
//! Question     which points of the cloud lie in one plane, and on which side of it stood the cameras?
//! Input        the cloud, its tracks, and superpixels where there are photographs or labels
//! Output       [`Patches`]: disjoint groups with a fitted plane each, and the groups that have none with the reason
//! Method       0. points at one place are one point;
//!              1. a plane through each point's neighbours gives the cloud's noise and a first normal;
//!              2. a superpixel's points get a plane by robust fitting; its inliers take over that firmer normal;
//!              3. regions grow from the flattest points over neighbours (in space, and in the same superpixel) that lie in
//!                 the region's plane and agree with its normal, so that small superpixels of one wall become one patch.
//! Assumptions  the noise of neighbouring points is alike; planes are larger than the spacing of the points
//! Fails when   the cloud has no planes (trees, rubble): then there are few patches or none, and that is the answer
//! Source       region growing after Rabbani, van den Heuvel, Vosselman (2006); superpixel planes after Ramalingam et al. (2010)

use std::cmp::Ordering;
use std::collections::{HashMap, VecDeque};

use rayon::prelude::*;

use super::cloud::{LocalSurface, NEIGHBOURS, local_surfaces};
use super::fit::{FittedPlane, fit_plane, fit_plane_robustly};
use crate::geometry::{Point3, Rotation3, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::limits::PatchLimits;
use crate::reconstruction::{PointIndex, Reconstruction};
use crate::robust::median;

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
    /// The points that take part, one at each place: all of them, or an even thinning of a large cloud. Their order is that of
    /// their places, so that neither the order of the file nor copies in it change what follows.
    pub support: Vec<PointIndex>,
    /// Their positions, sfm frame.
    pub points: Vec<Point3<f64>>,
    /// Mean direction from each of them to the cameras that saw it (or the file's own normal), any length; zero where
    /// neither is known.
    pub views: Vec<Vector3<f64>>,
    /// Centres of the cameras, sfm frame.
    pub cameras: Vec<Point3<f64>>,
    /// How the cameras were held, one for each of `cameras`.
    pub cam_from_sfm_rotations: Vec<Rotation3<f64>>,
    /// For each supporting point the nearest and the farthest camera that saw it.
    pub viewers: Vec<[Option<u32>; 2]>,
    pub patches: Vec<Patch>,
    /// Median standard deviation of points across their local planes, sfm units.
    pub noise: f64,
    /// Superpixels without a plane, by reason.
    pub too_few_points: usize,
    pub not_planar: usize,
    /// Points that stand exactly at the place of another one and count once with it.
    pub repeated: usize,
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

/// Finds the patches of a reconstruction.
pub fn patches(r: &Reconstruction, superpixels: Option<&LiftedSuperpixels>, limits: &PatchLimits) -> Patches {
    let places = Places::of(&r.points);
    let support = thinned(&r.points, &places.firsts, limits.most_points);
    let points: Vec<Point3<f64>> = support.iter().map(|p| r.points[p.0 as usize]).collect();
    let slots = places.slots(&support);
    let (surfaces, neighbours) = local_surfaces(&points);
    let smooth = surfaces.iter().flatten().filter(|s| s.roughness < limits.seed_roughness);
    let noise = median(&mut smooth.map(|s| s.rms).collect::<Vec<f64>>()).unwrap_or(0.0);
    let repeated = r.points.len() - places.firsts.len();
    let mut found = Patches { support, points, noise, repeated, ..Patches::default() };
    let mut grower = Grower::new(&found.points, surfaces, neighbours, noise, limits);
    if let Some(lifted) = superpixels {
        for group in groups_in_support(lifted, &slots) {
            match grower.add_superpixel(group) {
                Ok(()) => {}
                Err(RejectedGroup::TooFewPoints) => found.too_few_points += 1,
                Err(RejectedGroup::NotPlanar) => found.not_planar += 1,
            }
        }
    }
    let regions = grower.grow(limits.fewest_points);
    found.cameras = r.images.iter().map(|image| image.center()).collect();
    found.cam_from_sfm_rotations = r.images.iter().map(|image| image.cam_from_sfm_rotation).collect();
    found.views = outward_hints(r, &slots, &found);
    found.viewers = viewers(r, &slots, &found);
    found.patches = regions.into_iter().filter_map(|members| patch(&found.points, members, &found.views)).collect();
    found
}

/// Which points stand at one place. Copies are told by equal coordinates alone: in a frame of large coordinates a tolerance
/// that takes in the rounding of a copy takes in the neighbours as well.
struct Places {
    /// The first point of each place, by place.
    firsts: Vec<PointIndex>,
    /// For each point the first one at its place.
    first_at: Vec<PointIndex>,
}

impl Places {
    fn of(points: &[Point3<f64>]) -> Places {
        let mut order: Vec<PointIndex> = (0..points.len() as u32).map(PointIndex).collect();
        let place = |i: &PointIndex| &points[i.0 as usize];
        order.par_sort_unstable_by(|a, b| by_place(place(a), place(b)).then(a.cmp(b)));
        let mut places = Places { firsts: Vec::with_capacity(points.len()), first_at: order.clone() };
        for copies in order.chunk_by(|a, b| by_place(place(a), place(b)).is_eq()) {
            places.firsts.push(copies[0]);
            copies.iter().for_each(|i| places.first_at[i.0 as usize] = copies[0]);
        }
        places
    }

    /// For each point where its place stands in the support.
    fn slots(&self, support: &[PointIndex]) -> Vec<Option<u32>> {
        let mut slot_of = vec![None; self.first_at.len()];
        support.iter().zip(0..).for_each(|(p, slot)| slot_of[p.0 as usize] = Some(slot));
        self.first_at.iter().map(|first| slot_of[first.0 as usize]).collect()
    }
}

/// By x, then y, then z; the two zeros are one.
fn by_place(a: &Point3<f64>, b: &Point3<f64>) -> Ordering {
    let coordinate = |k: usize| (a[k] + 0.0).total_cmp(&(b[k] + 0.0));
    coordinate(0).then_with(|| coordinate(1)).then_with(|| coordinate(2))
}

/// An even thinning of `places` (sorted) to about `most` of them: of each cell of a grid the point next to its middle, the cell
/// widened until few enough are left.
fn thinned(points: &[Point3<f64>], places: &[PointIndex], most: usize) -> Vec<PointIndex> {
    if places.len() <= most {
        return places.to_vec();
    }
    let place = |p: &PointIndex| &points[p.0 as usize];
    // Outliers must not set the cell: the box of the middle 96 % of a coordinate does.
    let mut low = [0.0; 3];
    let mut extent = [0.0; 3];
    for k in 0..3 {
        let mut c: Vec<f64> = places.iter().map(|p| place(p)[k]).collect();
        let mut at = |rank: usize| *c.select_nth_unstable_by(rank, f64::total_cmp).1;
        low[k] = at(places.len() / 50);
        extent[k] = (at(places.len() - 1 - places.len() / 50) - low[k]).max(f64::MIN_POSITIVE);
    }
    // A surface of area A in cells of width w meets about A / w^2 of them, a line of length l about l / w.
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let [a, b, c] = extent.map(|e| e / longest);
    let area = 2.0 * (a * b + b * c + c * a);
    let mut width = longest * (area / (8.0 * most as f64)).sqrt().max(1.0 / most as f64);
    loop {
        let mut next_to_middle: HashMap<[i64; 3], (f64, PointIndex)> = HashMap::with_capacity(most * 2);
        for &p in places {
            let in_cells = [0, 1, 2].map(|k| (place(&p)[k] - low[k]) / width);
            let off = in_cells.iter().map(|x| (x - x.floor() - 0.5).powi(2)).sum();
            let kept = next_to_middle.entry(in_cells.map(|x| x.floor() as i64)).or_insert((off, p));
            if off < kept.0 {
                *kept = (off, p);
            }
        }
        if next_to_middle.len() <= most {
            let mut kept: Vec<PointIndex> = next_to_middle.into_values().map(|(_, p)| p).collect();
            kept.sort_unstable_by(|a, b| by_place(place(a), place(b)));
            return kept;
        }
        width *= (next_to_middle.len() as f64 / most as f64).sqrt().max(1.05);
    }
}

/// The superpixels' points as indices into the support, each once.
fn groups_in_support(lifted: &LiftedSuperpixels, slots: &[Option<u32>]) -> Vec<Vec<u32>> {
    let of = |points: &[PointIndex]| -> Vec<u32> {
        let mut group: Vec<u32> = points.iter().filter_map(|p| *slots.get(p.0 as usize)?).collect();
        group.sort_unstable();
        group.dedup();
        group
    };
    lifted.superpixels.iter().map(|s| of(&s.points)).filter(|g| !g.is_empty()).collect()
}

/// For each supporting point the sum of the directions to the cameras that saw it (or a copy of it), or of the file's own
/// normals; zero where neither is known.
fn outward_hints(r: &Reconstruction, slots: &[Option<u32>], found: &Patches) -> Vec<Vector3<f64>> {
    let mut hints = vec![Vector3::zeros(); found.support.len()];
    for (i, slot) in slots.iter().enumerate() {
        let Some(slot) = slot.map(|s| s as usize) else { continue };
        if r.images.is_empty() {
            hints[slot] += r.normals.get(i).copied().unwrap_or_default();
        }
        for (image, _) in r.seen_by(PointIndex(i as u32)) {
            let to_camera = found.cameras[image.0 as usize] - found.points[slot];
            hints[slot] += to_camera.try_normalize(0.0).unwrap_or_default();
        }
    }
    hints
}

/// For each supporting point the nearest and the farthest of the cameras that saw it or a copy of it.
fn viewers(r: &Reconstruction, slots: &[Option<u32>], found: &Patches) -> Vec<[Option<u32>; 2]> {
    let mut viewers = vec![[None; 2]; found.support.len()];
    for (i, slot) in slots.iter().enumerate() {
        let Some(slot) = slot.map(|s| s as usize) else { continue };
        let distance = |camera: u32| (found.cameras[camera as usize] - found.points[slot]).norm_squared();
        let [nearest, farthest]: &mut [Option<u32>; 2] = &mut viewers[slot];
        for &(image, _) in r.seen_by(PointIndex(i as u32)) {
            if nearest.is_none_or(|n| distance(image.0) < distance(n)) {
                *nearest = Some(image.0);
            }
            if farthest.is_none_or(|f| distance(image.0) >= distance(f)) {
                *farthest = Some(image.0);
            }
        }
    }
    viewers.into_iter().map(|[nearest, farthest]| [nearest, farthest.filter(|_| farthest != nearest)]).collect()
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
    limits: &'a PatchLimits,
}

impl<'a> Grower<'a> {
    fn new(
        points: &'a [Point3<f64>],
        surfaces: Vec<Option<LocalSurface>>,
        neighbours: Vec<u32>,
        noise: f64,
        limits: &'a PatchLimits,
    ) -> Self {
        let count = points.len();
        let memberships = vec![Vec::new(); count];
        Grower { points, surfaces, neighbours, superpixels: Vec::new(), memberships, noise, limits }
    }

    /// Fits a plane to a superpixel's points and gives its normal to those that lie in it.
    fn add_superpixel(&mut self, group: Vec<u32>) -> Result<(), RejectedGroup> {
        if group.len() < self.limits.fewest_in_superpixel {
            return Err(RejectedGroup::TooFewPoints);
        }
        let points: Vec<Point3<f64>> = group.iter().map(|&i| self.points[i as usize]).collect();
        let fit = fit_plane_robustly(&points, self.limits.gate_sigmas * self.noise);
        let (fit, inside) = fit.ok_or(RejectedGroup::NotPlanar)?;
        let planar = inside.len() >= self.limits.fewest_in_superpixel
            && inside.len() as f64 >= self.limits.planar_share * group.len() as f64
            && fit.rms < self.limits.seed_roughness * fit.spread[1];
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
        let mut seeds: Vec<u32> =
            (0..self.points.len() as u32).filter(|&i| flatness(i) < self.limits.seed_roughness).collect();
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
        let tolerance = self.limits.gate_sigmas * self.noise;
        let cos_tolerance = self.limits.same_normal_deg.to_radians().cos();
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

#[cfg(test)]
mod tests;
