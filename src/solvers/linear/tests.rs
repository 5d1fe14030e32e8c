use super::*;
use crate::solvers::scene::{Random, angle_between_rad, sample};
use crate::solvers::{Sought, refine};

#[test]
fn twelve_points_on_four_planes_give_the_pose_and_three_planes_give_rank_nine() {
    let mut random = Random::stream(4, 0);
    let case = sample(&mut random, &Sought::Rigid, &[3, 3, 3, 3]);
    let fit = linear_least_squares(&case.rows).unwrap();
    assert_eq!(fit.rank, 12);
    assert!(angle_between_rad(&fit.object_from_sensor.rotation, &case.truth.rotation) < 1e-9);
    for points in [4, 7] {
        let case = sample(&mut random, &Sought::Rigid, &[points; 3]);
        assert_eq!(linear_least_squares(&case.rows).unwrap().rank, 9);
    }
}

#[test]
fn refining_a_noisy_linear_pose_lowers_the_residual() {
    let mut random = Random::stream(5, 0);
    let mut case = sample(&mut random, &Sought::Rigid, &[5, 5, 5, 5]);
    for row in &mut case.rows {
        row.point += random.normal_vector();
    }
    let sum = |pose: &Similarity| -> f64 {
        case.rows.iter().map(|r| (r.normal.dot(&pose.apply(&r.point.into()).coords) + r.offset).powi(2)).sum()
    };
    let linear = linear_least_squares(&case.rows).unwrap().object_from_sensor;
    let refined = refine(&Sought::Rigid, &case.rows, &linear).unwrap();
    assert!(sum(&refined) < sum(&linear));
    let again = refine(&Sought::Rigid, &case.rows, &refined).unwrap();
    assert!((again.rotation.matrix() - refined.rotation.matrix()).norm() < 1e-8);
}

#[test]
fn exact_rows_give_the_pose_whatever_the_unit_and_the_place_of_the_points() {
    let mut random = Random::stream(6, 0);
    for unit in [1e-3, 1.0, 1e4] {
        let case = sample(&mut random, &Sought::Rigid, &[4, 4, 4, 4, 4]);
        let scaled: Vec<Row> =
            case.rows.iter().map(|row| Row { point: row.point * unit, offset: row.offset * unit, ..*row }).collect();
        let fit = linear_least_squares(&scaled).unwrap();
        assert_eq!(fit.rank, 12);
        assert!(angle_between_rad(&fit.object_from_sensor.rotation, &case.truth.rotation) < 1e-8);
        let off = fit.object_from_sensor.translation / unit - case.truth.translation;
        assert!(off.norm() < 1e-6, "{off}");
    }
}

#[test]
fn too_few_rows_and_rows_of_one_point_have_no_answer() {
    let mut random = Random::stream(7, 0);
    let case = sample(&mut random, &Sought::Rigid, &[4, 4, 4]);
    assert!(linear_least_squares(&case.rows[..11]).is_none());
    let one_point: Vec<Row> = case.rows.iter().map(|row| Row { point: Vector3::x(), ..*row }).collect();
    assert!(linear_least_squares(&one_point).is_none());
}
