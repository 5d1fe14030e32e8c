use std::collections::BTreeSet;

use super::*;

/// Two walls that meet at x = 47 and a strip of sky above them, each with a little texture.
fn corner() -> RgbImage {
    RgbImage::from_fn(120, 90, |x, y| {
        let grain = ((x * 7 + y * 13) % 11) as u8;
        let base = match (x < 47, y < 20) {
            (_, true) => [150, 180, 220],
            (true, _) => [170, 90, 70],
            (false, _) => [120, 110, 100],
        };
        image::Rgb(base.map(|v| v + grain))
    })
}

fn labels_of(map: &LabelMap, keep: impl Fn(u32, u32) -> bool) -> BTreeSet<u32> {
    let indexed = map.labels.iter().enumerate();
    indexed.filter(|(i, _)| keep(*i as u32 % map.width, *i as u32 / map.width)).map(|(_, label)| label).collect()
}

#[test]
fn as_many_superpixels_are_left_as_asked_for() {
    for count in [1, 3, 20] {
        let map = cut_superpixels(&corner(), &[], &SuperpixelOptions { count, ..SuperpixelOptions::default() });
        assert_eq!(labels_of(&map, |_, _| true), (1..=count as u32).collect());
    }
}

#[test]
fn no_superpixel_lies_on_both_sides_of_an_edge() {
    let map = cut_superpixels(&corner(), &[], &SuperpixelOptions { count: 6, ..SuperpixelOptions::default() });
    let sky = labels_of(&map, |_, y| y < 19);
    let left = labels_of(&map, |x, y| x < 46 && y > 21);
    let right = labels_of(&map, |x, y| x > 48 && y > 21);
    assert!(sky.is_disjoint(&left) && left.is_disjoint(&right) && right.is_disjoint(&sky));
}

#[test]
fn superpixels_are_smaller_where_keypoints_are_dense() {
    let keypoints: Vec<(f64, f64)> =
        (0..200).map(|i| (60.0 + f64::from(i % 50), 30.0 + f64::from(i / 50) * 12.0)).collect();
    let on_right = |keypoints: &[(f64, f64)]| {
        let map =
            cut_superpixels(&corner(), keypoints, &SuperpixelOptions { count: 20, ..SuperpixelOptions::default() });
        labels_of(&map, |x, y| x > 48 && y > 21).len()
    };
    assert!(on_right(&keypoints) > on_right(&[]));
}

#[test]
fn tiny_and_empty_pictures_are_cut_too() {
    for (width, height) in [(0, 0), (1, 1), (1, 40), (3, 2)] {
        let map = cut_superpixels(&RgbImage::new(width, height), &[(0.5, 0.5)], &SuperpixelOptions::default());
        assert_eq!(map.labels.len(), (width * height) as usize);
    }
}
