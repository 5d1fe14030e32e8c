use super::*;

#[test]
fn links_are_a_set_whatever_the_order_and_the_parts() {
    let all: Vec<(u32, u32, u32)> = (0..200).map(|k| (k % 7, k * 3 % 50, k)).collect();
    let sum = |links: &mut dyn Iterator<Item = &(u32, u32, u32)>| {
        let mut found = Links::default();
        links.for_each(|(image, keypoint, point)| found.add(ImageIndex(*image), *keypoint, PointIndex(*point)));
        found
    };
    let whole = sum(&mut all.iter());
    assert_eq!(whole, sum(&mut all.iter().rev()));
    let mut joined = sum(&mut all[..61].iter());
    joined.join(sum(&mut all[61..].iter()));
    assert_eq!(whole, joined);
}

#[test]
fn any_other_link_changes_the_sum() {
    let mut seen = std::collections::BTreeSet::new();
    for image in 0..12 {
        for keypoint in 0..12 {
            for point in 0..12 {
                let mut one = Links::default();
                one.add(ImageIndex(image), keypoint, PointIndex(point));
                assert!(seen.insert(one.sum), "{image} {keypoint} {point}");
            }
        }
    }
}

#[test]
fn the_point_of_an_element_is_found_where_points_have_no_track_too() {
    let points = PointRecords { track_starts: vec![0, 2, 2, 5, 5], ..PointRecords::default() };
    assert_eq!([0, 1, 2, 3, 4].map(|element| point_of(&points, element)), [0, 0, 2, 2, 2]);
}
