//! The same thing sampled in another way: points chosen anew, surfaces cut into other facets.

use super::block::Block;
use super::house::{Face, House};
use crate::reconstruction::{Image, PointIndex, Reconstruction};

/// The reconstruction of some of the points, each as often and in such order as it is named.
pub fn resampled(sfm: &Reconstruction, chosen: &[usize]) -> Reconstruction {
    fn some<T: Clone>(of: &[T], chosen: &[usize]) -> Vec<T> {
        if of.is_empty() { Vec::new() } else { chosen.iter().map(|i| of[*i].clone()).collect() }
    }
    let mut images: Vec<Image> =
        sfm.images.iter().map(|image| Image { observations: Vec::new(), ..image.clone() }).collect();
    let (mut track_starts, mut track_elements) = (vec![0], Vec::new());
    for (new, old) in chosen.iter().enumerate() {
        for (image, k) in sfm.track(PointIndex(*old as u32)) {
            let mut seen = sfm.images[image.0 as usize].observations[*k as usize];
            seen.point = Some(PointIndex(new as u32));
            let observations = &mut images[image.0 as usize].observations;
            track_elements.push((*image, observations.len() as u32));
            observations.push(seen);
        }
        track_starts.push(track_elements.len() as u32);
    }
    let has_tracks = !sfm.track_starts.is_empty();
    Reconstruction {
        points: some(&sfm.points, chosen),
        // Ids are of points, which may be here twice.
        point_ids: if sfm.point_ids.is_empty() { Vec::new() } else { (1..=chosen.len() as u64).collect() },
        point_errors_px: some(&sfm.point_errors_px, chosen),
        colors: some(&sfm.colors, chosen),
        normals: some(&sfm.normals, chosen),
        images,
        track_starts: if has_tracks { track_starts } else { Vec::new() },
        track_elements,
        ..sfm.clone()
    }
}

impl Block {
    /// The same surfaces in triangles.
    pub fn in_triangles(&self) -> Block {
        let triangles = |face: &Face| {
            let surface = face.surface;
            face.triangles().map(|t| Face { surface, corners: t.to_vec() }).collect::<Vec<_>>()
        };
        self.recut(triangles)
    }

    /// The same surfaces, each facet cut in two.
    pub fn in_halves(&self) -> Block {
        self.recut(|face| face.halves().to_vec())
    }

    /// The ground, one face, stays as it is: a block has no other.
    fn recut(&self, cut: impl Fn(&Face) -> Vec<Face>) -> Block {
        let house = |house: &House| House { faces: house.faces.iter().flat_map(&cut).collect() };
        Block { houses: self.houses.iter().map(house).collect(), ground: self.ground.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{CaptureOptions, CloudOptions, Ring};

    #[test]
    fn points_chosen_anew_keep_their_tracks() {
        let block = Block::four_houses();
        let sfm = block.capture(&Ring::street(8).stations(&block), &CaptureOptions::default()).sfm;
        let chosen = [5, 3, 3, 40];
        let other = resampled(&sfm, &chosen);
        for (new, old) in chosen.iter().enumerate() {
            assert_eq!(other.points[new], sfm.points[*old]);
            let (now, then) = (other.track(PointIndex(new as u32)), sfm.track(PointIndex(*old as u32)));
            assert_eq!(now.len(), then.len());
            for ((image, k), (of_old, of_old_k)) in now.iter().zip(then) {
                let o = other.images[image.0 as usize].observations[*k as usize];
                let before = sfm.images[of_old.0 as usize].observations[*of_old_k as usize];
                assert_eq!((image, o.x_px, o.point), (of_old, before.x_px, Some(PointIndex(new as u32))));
            }
        }
        let all: Vec<usize> = (0..sfm.points.len()).collect();
        assert_eq!(resampled(&sfm, &all).track_elements, sfm.track_elements);
        let cloud = block.cloud(&CloudOptions::default()).sfm;
        assert!(resampled(&cloud, &[0, 1]).track_starts.is_empty());
    }

    #[test]
    fn surfaces_keep_their_area_in_other_facets() {
        let block = Block::mixed_houses().with_ground();
        let area = |b: &Block| b.faces().map(Face::area).sum::<f64>();
        for other in [block.in_triangles(), block.in_halves()] {
            assert!((area(&other) - area(&block)).abs() < 1e-6);
            assert!(other.faces().count() > block.faces().count() + 20);
            assert!(other.city().is_ok());
        }
    }
}
