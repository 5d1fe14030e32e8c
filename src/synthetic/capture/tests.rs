use super::*;

fn exact() -> CaptureOptions {
    CaptureOptions { noise_m: 0.0, noise_px: 0.0, outlier_share: 0.0, clutter: 0, ..CaptureOptions::default() }
}

#[test]
fn keypoints_are_the_pixels_of_points_that_nothing_hides() {
    let block = Block::mixed_houses();
    let stations: Vec<Station> = [Ring::street(12), Ring::drone(8)].iter().flat_map(|r| r.stations(&block)).collect();
    let Survey { sfm, city_from_sfm, face_of_point } = block.capture(&stations, &exact());
    assert!(sfm.points.len() > 2000, "{}", sfm.points.len());
    let faces: Vec<Face> = block.seen_faces().collect();
    for (p, x) in sfm.points.iter().enumerate() {
        let track = sfm.track(PointIndex(p as u32));
        assert!(track.len() > 1);
        for (i, k) in track {
            let image = &sfm.images[i.0 as usize];
            let o = image.observations[*k as usize];
            let [x_px, y_px] = sfm.camera_of(*i).project(&image.cam_from_sfm(x)).unwrap();
            assert!((x_px - o.x_px).hypot(y_px - o.y_px) < 1e-9 && o.point == Some(PointIndex(p as u32)));
            let normal = faces[face_of_point[p].unwrap()].normal();
            let eye = city_from_sfm.apply(&image.center());
            assert!((eye - stations[i.0 as usize].center).norm() < 1e-9);
            assert!(normal.dot(&(eye - city_from_sfm.apply(x))) > 0.0, "seen from behind");
        }
    }
}

#[test]
fn the_street_sees_no_roof_and_the_drone_does() {
    let block = Block::four_houses();
    let faces: Vec<Face> = block.seen_faces().collect();
    let roofs = |ring: Ring| {
        let survey = block.capture(&ring.stations(&block), &exact());
        survey.face_of_point.iter().flatten().filter(|f| faces[**f].surface == crate::synthetic::Surface::Roof).count()
    };
    assert_eq!(roofs(Ring::street(16)), 0);
    assert!(roofs(Ring::drone(16)) > 200);
}

#[test]
fn what_is_wrong_is_as_much_as_was_asked_for() {
    let block = Block::four_houses();
    let options = CaptureOptions { outlier_share: 0.2, ..exact() };
    let survey = block.capture(&Ring::street(12).stations(&block), &options);
    let wrong = survey.face_of_point.iter().filter(|f| f.is_none()).count() as f64;
    assert!((wrong / survey.sfm.points.len() as f64 - 0.2).abs() < 0.03);
}
