use super::*;

fn checker() -> Checker {
    Checker { folder: PathBuf::from("model"), warnings: Vec::new() }
}

#[test]
fn each_kind_of_warning_is_told_once_with_its_first_example_and_the_sum() {
    let mut check = checker();
    check.warn(WarningKind::PointsWithoutTrack, 0, || unreachable!());
    check.warn(WarningKind::PointsWithoutTrack, 2, || "point 4".into());
    check.warn(WarningKind::ImagesWithoutObservations, 1, || "image 9".into());
    check.warn(WarningKind::PointsWithoutTrack, 5, || unreachable!());
    let told: Vec<String> = check.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["7 points without a track (such as point 4)", "1 images without keypoints (such as image 9)"]);
}

#[test]
fn a_fault_names_file_object_and_what_was_expected() {
    let error = checker().index("images", "image", [3u64, 4, 3].into_iter()).err().unwrap().to_string();
    assert!(error.contains("images") && error.contains("image 3") && error.contains("ids that differ"), "{error}");
    assert_eq!(checker().index("images", "image", [3u64, 4].into_iter()).ok().unwrap().get(4), Some(1));
}

#[test]
fn a_pose_without_a_direction_or_a_place_is_refused() {
    let pose = |quaternion_wxyz, translation| PoseRecord { quaternion_wxyz, translation };
    let check =
        |pose: &PoseRecord| checker().check_pose("images", || "image 1".into(), pose).err().map(|e| e.to_string());
    assert_eq!(check(&pose([2.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0])), None);
    for quaternion in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0]] {
        let error = check(&pose(quaternion, [0.0; 3])).unwrap();
        assert!(error.contains("image 1") && error.contains("a finite quaternion"), "{error}");
    }
    let error = check(&pose([1.0, 0.0, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0])).unwrap();
    assert!(error.contains("a finite translation"), "{error}");
}
