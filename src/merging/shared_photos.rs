//! Photographs that two parts have, and which keypoints of two versions of one photograph are the same pixel.

use std::collections::HashMap;

use super::pair_limits::KeypointLimits;
use crate::reconstruction::{ImageIndex, Observation, Reconstruction};

/// One photograph in two parts.
#[derive(Clone, Debug)]
pub(super) struct SharedPhoto {
    pub name: String,
    pub in_a: ImageIndex,
    pub in_b: ImageIndex,
}

/// The photographs that both parts have, by name, each once.
pub(super) fn shared_photos(a: &Reconstruction, b: &Reconstruction) -> Vec<SharedPhoto> {
    let mut by_name = HashMap::new();
    for (index, image) in b.images.iter().enumerate() {
        by_name.entry(image.name.as_str()).or_insert(ImageIndex(index as u32));
    }
    let mut found = Vec::new();
    for (index, image) in a.images.iter().enumerate() {
        if let Some(in_b) = by_name.remove(image.name.as_str()) {
            found.push(SharedPhoto { name: image.name.clone(), in_a: ImageIndex(index as u32), in_b });
        }
    }
    found.sort_by(|x, y| x.name.cmp(&y.name));
    found
}

/// Which pixel of one version of a photograph is which of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelMap {
    /// Factor from `b`'s pixels to `a`'s along x and y: the photograph may have been scaled.
    pub scale: [f64; 2],
    /// Pixels of `a`, to lay it elsewhere than where it belongs.
    pub shift: [f64; 2],
    /// Greatest distance of keypoints that are one, pixels of `a`.
    pub tolerance: f64,
}

impl PixelMap {
    pub fn of([a, b]: [&Reconstruction; 2], [in_a, in_b]: [ImageIndex; 2], limits: &KeypointLimits) -> PixelMap {
        let (to, from) = (a.camera_of(in_a), b.camera_of(in_b));
        let ratio = |to: u64, from: u64| if from == 0 || to == 0 { 1.0 } else { to as f64 / from as f64 };
        PixelMap {
            scale: [ratio(to.width_px, from.width_px), ratio(to.height_px, from.height_px)],
            shift: [0.0; 2],
            tolerance: (limits.same_share * to.width_px as f64).max(limits.same_px),
        }
    }

    /// Where a keypoint of `b` lies in `a`.
    pub fn carried(&self, o: &Observation) -> [f64; 2] {
        [o.x_px * self.scale[0] + self.shift[0], o.y_px * self.scale[1] + self.shift[1]]
    }

    /// Pairs of keypoints (index in `a`, index in `b`): of all in `b` whose nearest in `a` is this one, within the tolerance, the nearest; `keep` says which count.
    pub fn same_keypoints(
        &self,
        a: &[Observation],
        b: &[Observation],
        keep: &dyn Fn(&Observation) -> bool,
    ) -> Vec<(u32, u32)> {
        let cell = |x: f64, y: f64| ((x / self.tolerance).floor() as i64, (y / self.tolerance).floor() as i64);
        let mut grid: HashMap<(i64, i64), Vec<u32>> = HashMap::new();
        for (index, o) in a.iter().enumerate().filter(|(_, o)| keep(o)) {
            grid.entry(cell(o.x_px, o.y_px)).or_default().push(index as u32);
        }
        // For each of a the nearest of those in b whose nearest it is.
        let mut nearest_b: HashMap<u32, (f64, u32)> = HashMap::new();
        for (index, o) in b.iter().enumerate().filter(|(_, o)| keep(o)) {
            let [x, y] = self.carried(o);
            let (cx, cy) = cell(x, y);
            let around = (cx - 1..=cx + 1).flat_map(|gx| (cy - 1..=cy + 1).map(move |gy| (gx, gy)));
            let candidates = around.filter_map(|place| grid.get(&place)).flatten();
            let distance = |i: &u32| (a[*i as usize].x_px - x).hypot(a[*i as usize].y_px - y);
            let best = candidates.map(|i| (distance(i), *i)).min_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
            if let Some((distance, i)) = best.filter(|(distance, _)| *distance <= self.tolerance) {
                let entry = nearest_b.entry(i).or_insert((distance, index as u32));
                if distance < entry.0 {
                    *entry = (distance, index as u32);
                }
            }
        }
        let mut matches: Vec<(u32, u32)> = nearest_b.into_iter().map(|(i, (_, j))| (i, j)).collect();
        matches.sort_unstable();
        matches
    }
}

#[cfg(test)]
mod tests;
