use super::*;

#[test]
fn directions_are_told_by_up_or_by_their_azimuth_whatever_their_sense() {
    for (direction, told) in [
        ([0.0, 0.0, 1.0], "along up"),
        ([0.0, 1.0, 0.0], "along the azimuth 0 deg"),
        ([1.0, 0.0, 0.0], "along the azimuth 90 deg"),
        ([1.0, 1.0, 0.1], "along the azimuth 45 deg"),
        ([1.0, -1.0, 0.0], "along the azimuth 135 deg"),
        ([0.0, 1.0, 1.0], "along a slope towards the azimuth 0 deg"),
    ] {
        assert_eq!(shift(&Vector3::from(direction)), told);
        assert_eq!(shift(&(Vector3::from(direction) * -3.0)), told);
    }
    assert_eq!(turn(&Vector3::new(0.1, 0.0, -2.0)), "heading");
    assert_eq!(turn(&Vector3::y()), "tilt about the azimuth 0 deg");
}

#[test]
fn a_difference_names_what_differs_and_nothing_else() {
    let center = Point3::new(10.0, 20.0, 0.0);
    let about = |angle: f64, scale: f64, shift: [f64; 3]| {
        let rotation = crate::geometry::Rotation3::from_axis_angle(&Vector3::z_axis(), angle.to_radians());
        Similarity::about(&center, &(center + Vector3::from(shift)), scale, rotation)
    };
    let told = |b: &Similarity| difference(&Similarity::identity(), b, &center);
    assert_eq!(told(&about(0.1, 1.001, [0.01, 0.0, 0.0])), "by less than 0.05 m and 0.5 deg");
    assert_eq!(told(&about(90.0, 1.0, [0.0; 3])), "turned 90.0 deg about up at (10.0, 20.0)");
    assert_eq!(told(&about(0.0, 1.0, [1.0, -2.0, 0.5])), "shifted by (1.00, -2.00, 0.50) m");
    assert_eq!(told(&about(0.0, 1.05, [0.0; 3])), "scaled by +5.0 %");
    let all = told(&about(10.0, 0.9, [3.0, 0.0, 0.0]));
    assert!(
        all.contains("turned 10.0 deg") && all.contains("shifted by (3.00") && all.contains("scaled by -10.0 %"),
        "{all}"
    );
}

#[test]
fn every_freedom_has_a_remedy_of_its_own_and_scales_are_told_in_per_cent() {
    let freedom = |kind, direction: Vector3<f64>, unit| Freedom {
        kind,
        name: String::new(),
        direction,
        sigma: 0.0123,
        unit,
        determined: false,
        given: false,
    };
    let all = [
        freedom(FreedomKind::Shift, Vector3::z(), FreedomUnit::Metre),
        freedom(FreedomKind::Shift, Vector3::x(), FreedomUnit::Metre),
        freedom(FreedomKind::Turn, Vector3::z(), FreedomUnit::Degree),
        freedom(FreedomKind::Turn, Vector3::x(), FreedomUnit::Degree),
        freedom(FreedomKind::Scale, Vector3::zeros(), FreedomUnit::LogScale),
    ];
    let remedies: std::collections::BTreeSet<&str> = all.iter().map(remedy).collect();
    assert_eq!(remedies.len(), all.len());
    assert_eq!(sigma(&all[4]), "1.23 %");
    assert!(sigma(&all[0]).starts_with("0.01 "), "{}", sigma(&all[0]));
}
