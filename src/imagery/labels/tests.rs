use super::*;

fn two_by_two() -> LabelMap {
    LabelMap { width: 2, height: 2, labels: Labels::U8(vec![1, 2, 3, 4]) }
}

#[test]
fn ids_are_the_same_at_every_width() {
    let ids = [0, 7, 255];
    let all = [
        Labels::U8(ids.map(|id| id as u8).to_vec()),
        Labels::U16(ids.map(|id| id as u16).to_vec()),
        Labels::U32(ids.to_vec()),
    ];
    assert!(all.iter().all(|labels| labels.iter().eq(ids) && labels.get(3).is_none() && labels.len() == 3));
}

#[test]
fn a_point_falls_on_the_pixel_of_its_floor() {
    let map = two_by_two();
    assert_eq!(map.label_at(0.99, 0.0, (2, 2)), Some(1));
    assert_eq!(map.label_at(1.0, 0.5, (2, 2)), Some(2));
    assert_eq!(map.label_at(0.5, 1.5, (2, 2)), Some(3));
}

#[test]
fn a_smaller_map_is_stretched_over_the_image() {
    let map = two_by_two();
    assert_eq!(map.label_at(4.99, 4.99, (10, 10)), Some(1));
    assert_eq!(map.label_at(5.0, 9.99, (10, 10)), Some(4));
}

#[test]
fn points_outside_and_nan_have_no_label() {
    let map = two_by_two();
    for (x, y) in [(-0.1, 0.5), (2.0, 0.5), (0.5, 2.0), (f64::NAN, 0.5), (f64::INFINITY, 0.5)] {
        assert_eq!(map.label_at(x, y, (2, 2)), None);
    }
    assert_eq!(map.label_at(2.0_f64.next_down(), 0.0, (2, 2)), Some(2));
}

#[test]
fn labels_of_every_width_tell_the_same() {
    let ids = [0u8, 3, 255, 7];
    let wide =
        [Labels::U8(ids.to_vec()), Labels::U16(ids.map(u16::from).to_vec()), Labels::U32(ids.map(u32::from).to_vec())];
    for labels in wide {
        assert_eq!(labels.iter().collect::<Vec<_>>(), [0, 3, 255, 7]);
        assert_eq!((labels.len(), labels.is_empty(), labels.get(4)), (4, false, None));
    }
    assert!(Labels::U16(Vec::new()).is_empty());
}

#[test]
fn a_map_of_another_size_is_read_at_the_nearest_pixel() {
    let map = LabelMap { width: 3, height: 2, labels: Labels::U8(vec![1, 2, 3, 4, 5, 6]) };
    // Each label covers 100 by 100 pixels of the photograph.
    for y in 0..200 {
        for x in (0..300).step_by(7) {
            let expected = 1 + x / 100 + 3 * (y / 100);
            assert_eq!(map.label_at(f64::from(x), f64::from(y), (300, 200)), Some(expected));
        }
    }
    for (x, y) in [(-0.1, 5.0), (300.0, 5.0), (5.0, 200.0), (f64::NAN, 5.0), (5.0, f64::INFINITY)] {
        assert_eq!(map.label_at(x, y, (300, 200)), None);
    }
}
