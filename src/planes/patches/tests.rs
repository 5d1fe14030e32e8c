use super::*;
use crate::imagery::Superpixel;
use crate::limits::Limits;
use crate::reconstruction::{Image, ImageIndex};
use crate::robust::Random;

/// Points on the sides of a box, 3 : 2 : 1, a little off them.
fn on_a_box(count: usize) -> Vec<Point3<f64>> {
    let mut chance = Random::stream(3, 0);
    let mut place = |i: usize| {
        let mut p = Vector3::from_fn(|_, _| chance.unit());
        p[i % 3] = f64::from(i as u32 / 3 % 2) + 0.004 * (chance.unit() - 0.5);
        Point3::from(p.component_mul(&Vector3::new(3.0, 2.0, 1.0)))
    };
    (0..count).map(&mut place).collect()
}

fn cloud(points: Vec<Point3<f64>>) -> Reconstruction {
    Reconstruction { points, ..Reconstruction::default() }
}

fn found(points: Vec<Point3<f64>>) -> Patches {
    patches(&cloud(points), None, &PatchLimits { most_points: 2000, ..Limits::default().patches })
}

fn same(a: &Patches, b: &Patches) -> bool {
    let members = |p: &Patches| p.patches.iter().map(|p| p.members.clone()).collect::<Vec<_>>();
    a.points == b.points && a.noise == b.noise && members(a) == members(b)
}

#[test]
fn points_at_one_place_count_once() {
    let points = on_a_box(600);
    let once = found(points.clone());
    assert!(once.repeated == 0 && once.patches.len() == 6);
    for times in [2, 5] {
        let each = found(points.iter().flat_map(|p| vec![*p; times]).collect());
        assert!(same(&once, &each) && each.repeated == 600 * (times - 1));
        let behind = found(points.repeat(times));
        assert!(same(&once, &behind));
    }
    assert_eq!(found(vec![Point3::new(0.0, -0.0, 1.0), Point3::new(-0.0, 0.0, 1.0)]).repeated, 1);
}

#[test]
fn the_order_of_the_file_changes_nothing() {
    for count in [600, 6000] {
        let mut points = on_a_box(count);
        let once = found(points.clone());
        assert!(once.points.len() <= 2000 && once.patches.len() >= 6);
        points.reverse();
        points.rotate_left(count / 3);
        assert!(same(&once, &found(points.clone())));
        points.extend_from_within(0..count / 2);
        assert!(same(&once, &found(points)));
    }
}

#[test]
fn a_point_is_seen_by_all_who_saw_its_copies() {
    let image = |x: f64| Image { cam_from_sfm_translation: Vector3::new(-x, 0.0, 0.0), ..Image::default() };
    let r = Reconstruction {
        images: vec![image(3.0), image(1.0), image(2.0)],
        points: vec![Point3::origin(), Point3::new(0.0, 5.0, 0.0), Point3::origin()],
        track_starts: vec![0, 1, 1, 3],
        track_elements: vec![(ImageIndex(2), 0), (ImageIndex(0), 0), (ImageIndex(1), 0)],
        ..Reconstruction::default()
    };
    let found = patches(&r, None, &Limits::default().patches);
    assert_eq!(found.support, [PointIndex(0), PointIndex(1)]);
    assert_eq!(found.viewers, [[Some(1), Some(0)], [None, None]]);
    assert_eq!(found.views[0], Vector3::new(3.0, 0.0, 0.0));
}

#[test]
fn a_copy_in_a_superpixel_is_no_second_member() {
    let points = vec![PointIndex(0), PointIndex(1), PointIndex(2)];
    let superpixels = vec![Superpixel { image: ImageIndex(0), label: 1, points }];
    let lifted = LiftedSuperpixels { superpixels, ..LiftedSuperpixels::default() };
    assert_eq!(groups_in_support(&lifted, &[Some(4), Some(4), Some(3)]), [[3, 4]]);
}

#[test]
fn clouds_without_surfaces_have_no_patches() {
    let line = |count: usize, step: f64| (0..count).map(|i| Point3::new(i as f64 * step, 0.0, 0.0)).collect();
    for count in [0, 1, 2, 3, 20, 5000] {
        assert!(found(vec![Point3::new(1.0, 2.0, 3.0); count]).patches.is_empty());
        for step in [1.0, 1e-300, 1e300, 1e304] {
            let found = found(line(count, step));
            assert!(found.patches.is_empty() && found.points.len() >= count.min(1000), "{count} points, {step} apart");
        }
    }
}

#[test]
fn points_at_the_end_of_the_numbers_do_no_harm() {
    for huge in [1e160, 1e300, f64::MAX] {
        let mut points = on_a_box(600);
        points.extend([Point3::new(huge, 0.0, 0.0), Point3::new(-huge, huge, 0.0), Point3::new(0.0, -huge, huge)]);
        let found = found(points);
        assert_eq!(found.patches.len(), 6, "{huge}");
        assert!(found.patches.iter().all(|p| p.fit.rms < 0.01));
    }
}
