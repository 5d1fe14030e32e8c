use super::*;
use crate::geometry::{Matrix3, Similarity};
use crate::merging::limits::MergeLimits;
use crate::merging::pairwise::part;
use crate::random::Random;

fn surfaces() -> Surfaces {
    let part = part(4, 0.0, &Similarity::identity());
    let known = |p: PointIndex| KnownPoint { at: part.sfm.points[p.0 as usize], covariance: Matrix3::identity() };
    Surfaces::of(&part, known, &MergeLimits::default().patches).unwrap()
}

#[test]
fn the_patch_at_a_place_is_that_of_the_nearest_of_all_points() {
    let (surfaces, mut random) = (surfaces(), Random::stream(112, 0));
    let mut met = 0;
    for _ in 0..2000 {
        let place = Point3::from(Vector3::new(6.5 * random.unit(), 6.5 * random.unit(), 5.0 * random.unit()));
        let (normal, reach) = (random.direction(), 0.8);
        let off = |i: &usize| (surfaces.points[*i].at - place).norm();
        let nearest = (0..surfaces.points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        let patch = surfaces.patch_of[nearest];
        let is_it = off(&nearest) <= reach
            && surfaces.normals[patch as usize].dot(&normal)
                > MergeLimits::default().patches.same_normal_deg.to_radians().cos();
        assert_eq!(surfaces.patch_at(&place, &normal, reach), is_it.then_some(patch));
        met += usize::from(is_it);
    }
    assert!(met > 5, "{met}");
}

#[test]
fn the_spacing_is_that_of_the_grid_and_eyes_stand_before_their_patches() {
    let surfaces = surfaces();
    // Grids of 20 by 20 points on 6 m by 4 m and 6 m: the nearest neighbour is 0.2 m or 0.3 m away.
    assert!((0.19..0.31).contains(&surfaces.spacing), "{}", surfaces.spacing);
    for (point, patch) in surfaces.points.iter().zip(&surfaces.patch_of) {
        let (eye, normal) = (surfaces.eyes[*patch as usize], surfaces.normals[*patch as usize]);
        assert!(normal.dot(&(eye - point.at)) > 0.0);
    }
}
