//! Regions of points that lie in one plane, grown from the flattest points over their neighbours.
//!
//! Input        the points, a surface at each, its neighbours in space, and superpixels
//! Output       disjoint groups of points, the flattest first
//! Method       a region takes in neighbours, in space and in the same superpixel, that lie in its plane and agree with its normal; the
//!              plane is fitted anew each time the region has doubled. A superpixel's plane gives its points a firmer normal first
//! Source       Rabbani, van den Heuvel and Vosselman 2006; superpixel planes: Ramalingam et al. 2010

use std::collections::VecDeque;

use super::cloud::{LocalSurface, NEIGHBOURS};
use super::fit::{fit_plane, fit_plane_robustly};
use crate::geometry::{Point3, Vector3};
use crate::limits::PatchLimits;

/// Why a superpixel has no plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RejectedGroup {
    TooFewPoints,
    NotPlanar,
}

/// Grows regions over the neighbourhood graph.
pub(super) struct Grower<'a> {
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
    pub(super) fn new(
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
    pub(super) fn add_superpixel(&mut self, group: Vec<u32>) -> Result<(), RejectedGroup> {
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
    pub(super) fn grow(&self, fewest: usize) -> Vec<Vec<u32>> {
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
