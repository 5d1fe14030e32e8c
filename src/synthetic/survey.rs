//! A made-up reconstruction and the truth about it.

use std::collections::BTreeMap;

use crate::geometry::{Rotation3, Similarity, Vector3};
use crate::imagery::{LiftedSuperpixels, Superpixel};
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction};

/// What a structure-from-motion tool would have left, and what only the maker knows.
#[derive(Clone, Debug)]
pub struct Survey {
    pub sfm: Reconstruction,
    /// Exact.
    pub city_from_sfm: Similarity,
    /// The face that each point lies on (its number in [`super::Block::faces`]; the ground's where the ground is not
    /// modelled, too), `None` for what is no part of the city.
    pub face_of_point: Vec<Option<usize>>,
}

impl Survey {
    /// Superpixels that keep to the faces: in every photograph the points of one face within one cell of a grid, `cell_px` wide. What
    /// is no part of the city is on none. Empty for a cloud.
    pub fn superpixels(&self, cell_px: f64) -> LiftedSuperpixels {
        let mut superpixels = Vec::new();
        for (image, i) in self.sfm.images.iter().zip(0..) {
            let mut by_place: BTreeMap<[usize; 3], Vec<PointIndex>> = BTreeMap::new();
            for o in &image.observations {
                let Some(point) = o.point else { continue };
                let Some(face) = self.face_of_point[point.0 as usize] else { continue };
                let [column, row] = [o.x_px, o.y_px].map(|v| (v / cell_px) as usize);
                by_place.entry([face, row, column]).or_default().push(point);
            }
            let of_image = by_place.into_values().zip(1..).map(|(mut points, label)| {
                points.sort_unstable();
                Superpixel { image: ImageIndex(i), label, points }
            });
            superpixels.extend(of_image);
        }
        LiftedSuperpixels { superpixels, images_read: self.sfm.images.len(), ..LiftedSuperpixels::default() }
    }
}

/// A frame like any that structure from motion ends in: turned, about 8 m to its unit, its origin somewhere.
pub fn sfm_from_city() -> Similarity {
    Similarity {
        scale: 0.13,
        rotation: Rotation3::from_euler_angles(1.1, -0.4, 2.2),
        translation: Vector3::new(4.0, -2.0, 9.0),
    }
}

#[cfg(test)]
mod tests {
    use crate::synthetic::{Block, CaptureOptions, Ring};

    #[test]
    fn superpixels_hold_points_of_one_face_each_and_all_of_the_city() {
        let block = Block::four_houses();
        let survey = block.capture(&Ring::street(8).stations(&block), &CaptureOptions::default());
        let lifted = survey.superpixels(80.0);
        for superpixel in &lifted.superpixels {
            let face = |p: &crate::reconstruction::PointIndex| survey.face_of_point[p.0 as usize].unwrap();
            assert!(superpixel.points.iter().all(|p| face(p) == face(&superpixel.points[0])));
            assert!(superpixel.points.is_sorted_by(|a, b| a < b));
        }
        let held: usize = lifted.superpixels.iter().map(|s| s.points.len()).sum();
        let of_city =
            |o: &crate::reconstruction::Observation| survey.face_of_point[o.point.unwrap().0 as usize].is_some();
        assert_eq!(held, survey.sfm.images.iter().flat_map(|i| &i.observations).filter(|o| of_city(o)).count());
    }
}
