use super::*;
use crate::geometry::{Point3, Rotation3};
use crate::merging::limits::MergeLimits;
use crate::random::Random;

fn camera(random: &mut Random) -> CameraPair {
    CameraPair {
        center_a: Point3::from(3.0 * random.normal_vector()),
        center_b: Point3::from(3.0 * random.normal_vector()),
        a_from_b_rotation: random.rotation(),
        axis_a: random.direction(),
        focal_doubt: 0.1 * random.unit(),
        depth_a: 2.0 + 5.0 * random.unit(),
        scale: None,
    }
}

/// Half the sum of squared residuals.
fn loss(rows: &CameraRows, pose: &Similarity) -> f64 {
    let of = |camera: &&CameraPair| {
        let (center, turn) = rows.residuals(camera, pose);
        0.5 * (center.norm_squared() + turn.norm_squared())
    };
    rows.cameras.iter().map(of).sum()
}

#[test]
fn the_gradient_is_that_of_the_squared_residuals() {
    let mut random = Random::stream(33, 0);
    let limits = MergeLimits::default().fit.cameras;
    for _ in 0..20 {
        let pairs: Vec<CameraPair> = (0..3).map(|_| camera(&mut random)).collect();
        // Turned by next to nothing against the cameras: rows are exact to first order there.
        let pose = Similarity { scale: 1.3, rotation: pairs[0].a_from_b_rotation, translation: random.normal_vector() };
        let one: Vec<&CameraPair> = pairs[..1].iter().collect();
        let rows = CameraRows { cameras: one, bend: 0.02, limits: &limits };
        let parameters = MotionParameters::of_similarity(Point3::new(1.0, -1.0, 0.5), 4.0);
        let mut sums = NormalEquations::default();
        rows.add_rows(&pose, &parameters, 1.0, &mut sums);
        for k in 0..7 {
            let at = |step: f64| {
                let mut unknowns = Vector7::zeros();
                unknowns[k] = step;
                loss(&rows, &parameters.moved(&pose, &unknowns))
            };
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            let size = 1.0 + sums.gradient.norm();
            assert!((slope - sums.gradient[k]).abs() < 1e-4 * size, "{k}: {slope} {}", sums.gradient[k]);
        }
    }
}

#[test]
fn a_camera_that_stands_or_looks_elsewhere_does_not_agree() {
    let mut random = Random::stream(34, 0);
    let limits = MergeLimits::default().fit.cameras;
    let right = camera(&mut random);
    let pose = Similarity::about(&right.center_b, &right.center_a, 1.7, right.a_from_b_rotation);
    let shifted = CameraPair { center_a: right.center_a + Vector3::new(3.0, 3.0, 3.0), ..right.clone() };
    let turned = CameraPair {
        a_from_b_rotation: Rotation3::new(Vector3::new(0.0, 0.3, 0.0)) * right.a_from_b_rotation,
        ..right.clone()
    };
    let rows = CameraRows { cameras: vec![&right, &shifted, &turned], bend: 0.02, limits: &limits };
    assert_eq!(rows.agree(&pose), [true, false, false]);
}
