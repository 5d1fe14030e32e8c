use super::*;
use std::collections::BTreeSet;

#[test]
fn a_case_of_every_setting_can_be_made_and_comes_again() {
    for index in 0..10 {
        let case = Case::drawn(3, index).unwrap();
        assert_eq!(case.setting, Setting::of(index));
        let again = Case::drawn(3, index).unwrap();
        assert_eq!(case.capture.survey.sfm.points, again.capture.survey.sfm.points, "{:?}", case.setting);
        assert_eq!(case.modelled, again.modelled);
    }
}

#[test]
fn points_that_are_not_wrong_lie_where_the_truth_puts_them() {
    for setting in [Setting::Street, Setting::Drone, Setting::Airborne] {
        let case = Case::with(5, 1, setting, &Levels::none()).unwrap();
        let city: Vec<Face> = case.modelled.faces().cloned().collect();
        let survey = &case.capture.survey;
        let mut off: Vec<f64> = survey
            .sfm
            .points
            .iter()
            .zip(&survey.face_of_point)
            .filter_map(|(x, face)| {
                let face = &city[(*face)?];
                Some(face.normal().dot(&(survey.city_from_sfm.apply(x) - face.corners[0])).abs())
            })
            .collect();
        off.sort_by(f64::total_cmp);
        assert!(off.len() > 300 && off[off.len() / 2] < 0.08, "{setting:?} {} {}", off.len(), off[off.len() / 2]);
    }
}

#[test]
fn a_wrong_level_of_one_fault_leaves_the_places_of_the_houses() {
    let with = |levels: &Levels| Case::with(5, 2, Setting::Drone, levels).unwrap();
    let few = with(&Levels::none());
    let bent = with(&Levels { bend: 0.005, outliers: 0.4, ..Levels::none() });
    assert_eq!(few.modelled, bent.modelled);
    assert!(bent.capture.is_wrong.iter().any(|w| *w) && !few.capture.is_wrong.iter().any(|w| *w));
}

#[test]
fn starts_lie_where_they_are_asked_to() {
    let case = Case::drawn(3, 0).unwrap();
    let truth = case.capture.survey.city_from_sfm;
    let middle = median(case.capture.survey.sfm.points.iter().copied());
    let off = |errand| {
        let start = *case.request(errand).start.city_from_sfm();
        (start.apply(&middle) - truth.apply(&middle)).norm()
    };
    assert!(off(Errand::RightPlace) < 35.0 && off(Errand::WrongPlace) > 30.0);
    let scale = case.request(Errand::WrongScale).fixed_scale.unwrap() / truth.scale;
    assert!(((scale - 1.0).abs() - 0.05).abs() < 1e-9, "{scale}");
    assert_eq!(Errand::ALL.iter().filter(|e| case.request(**e).fixed_scale.is_some()).count(), 1);
}

#[test]
fn a_wall_of_its_own_is_a_wall() {
    let case = Case::drawn(3, 8).unwrap();
    let faces: BTreeSet<usize> = case.capture.survey.face_of_point.iter().flatten().copied().collect();
    assert!(faces.len() <= 2, "a wall, and the ground: {faces:?}");
}
