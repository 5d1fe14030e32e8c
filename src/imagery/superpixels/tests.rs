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

/// The superpixels of a picture with blotches, and its size.
fn blotches(count: usize, keypoints: &[(f64, f64)]) -> LabelMap {
    let photo = RgbImage::from_fn(150, 110, |x, y| {
        let tone = |k: u32| ((x / 23 * 7 + y / 19 * k + (x * y) % 3) * 31 % 200) as u8;
        image::Rgb([tone(3), tone(5), tone(11)])
    });
    cut_superpixels(&photo, keypoints, &SuperpixelOptions { count, ..SuperpixelOptions::default() })
}

#[test]
fn superpixels_hang_together() {
    for count in [2, 9, 40] {
        let map = blotches(count, &[(20.0, 30.0), (90.0, 80.0)]);
        let labels: Vec<u32> = map.labels.iter().collect();
        let (width, height) = (map.width as usize, map.height as usize);
        let mut seen = vec![false; labels.len()];
        let mut pieces = 0;
        for first in 0..labels.len() {
            if seen[first] {
                continue;
            }
            pieces += 1;
            let mut open = vec![first];
            while let Some(at) = open.pop() {
                if seen[at] || labels[at] != labels[first] {
                    continue;
                }
                seen[at] = true;
                let (x, y) = (at % width, at / width);
                open.extend((x > 0).then(|| at - 1));
                open.extend((x + 1 < width).then_some(at + 1));
                open.extend((y > 0).then(|| at - width));
                open.extend((y + 1 < height).then_some(at + width));
            }
        }
        assert_eq!(pieces, count);
    }
}

#[test]
fn fewer_superpixels_are_unions_of_more() {
    let (few, many) = (blotches(6, &[]), blotches(25, &[]));
    let mut whole = std::collections::BTreeMap::new();
    for (small, large) in many.labels.iter().zip(few.labels.iter()) {
        assert_eq!(*whole.entry(small).or_insert(large), large, "superpixel {small} is in two");
    }
    assert_eq!(whole.len(), 25);
}

#[test]
fn the_same_photograph_has_the_same_superpixels_and_keypoints_outside_change_nothing() {
    assert_eq!(blotches(12, &[]), blotches(12, &[]));
    assert_eq!(blotches(12, &[(-1.0, 5.0), (1e9, 5.0), (f64::NAN, 5.0)]), blotches(12, &[]));
}
