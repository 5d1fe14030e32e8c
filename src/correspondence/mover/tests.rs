use super::*;
use crate::random::Random;

#[test]
fn a_mover_moves_places_as_the_pose_and_turns_directions() {
    let mut random = Random::stream(65, 0);
    for _ in 0..50 {
        let pose = Similarity {
            scale: 0.2 + 3.0 * random.unit(),
            rotation: random.rotation(),
            translation: 9.0 * random.normal_vector(),
        };
        let position = Point3::from(5.0 * random.normal_vector());
        let point = OrientedPoint { position, normal: random.direction(), sided: true, min_cos: 0.7 };
        let moved = Mover::new(&pose).sample_point(&point);
        assert!((moved.position - pose.apply(&position)).norm() < 1e-12);
        assert!((moved.normal - pose.rotation * point.normal).norm() < 1e-14);
        assert_eq!((moved.sided, moved.min_cos), (true, 0.7));
    }
}
