//! A minimal solver alone: seven points on four planes give scale and pose in closed form, all solutions, without heap.
//!
//!     cargo run --release --example 04_solver_alone

use cityweld::solvers::{Row, sim3_3211};
use cityweld::{Rotation3, Similarity, Vector3};

fn main() {
    // Ground, two walls and a roof: unit normals and offsets, metres. `normal . x + offset = 0` on the plane.
    let ground = (Vector3::new(0.0, 0.0, 1.0), 0.0);
    let wall = (Vector3::new(1.0, 0.0, 0.0), -4.0);
    let other_wall = (Vector3::new(0.0, 1.0, 0.0), 3.0);
    let roof = (Vector3::new(0.6, 0.0, 0.8), -9.0);

    // Places on them: three on the first, two on the second, one on each of the others.
    let places = [
        (ground, [0.0, 0.0]),
        (ground, [2.0, -1.0]),
        (ground, [-1.0, 3.0]),
        (wall, [1.0, 2.0]),
        (wall, [-2.0, 5.0]),
        (other_wall, [3.0, 1.5]),
        (roof, [0.5, -0.5]),
    ];

    // What a reconstruction has of them, in a frame and a scale of its own.
    let truth = Similarity {
        scale: 7.5,
        rotation: Rotation3::from_euler_angles(0.3, -1.2, 0.8),
        translation: Vector3::new(10.0, -4.0, 2.0),
    };
    let rows = places.map(|((normal, offset), [u, v])| {
        let point = truth.inverse().apply(&on_plane(&normal, offset, u, v).into()).coords;
        Row { point, normal, offset }
    });

    let poses = sim3_3211(&rows);
    println!("{} poses lay all seven points on their planes:", poses.iter().count());
    for pose in poses.iter() {
        let residual = rows.iter().map(|row| distance(row, pose).abs()).fold(0.0, f64::max);
        let turn = (truth.rotation.inverse() * pose.rotation).angle().to_degrees();
        println!("  scale {:.6}, {turn:.3e} deg from the truth, largest distance {residual:.1e} m", pose.scale);
    }

    // An eighth point tells them apart.
    let eighth = on_plane(&roof.0, roof.1, 2.0, 1.0);
    let row = Row { point: truth.inverse().apply(&eighth.into()).coords, normal: roof.0, offset: roof.1 };
    let best = poses.iter().min_by(|a, b| distance(&row, a).abs().total_cmp(&distance(&row, b).abs()));
    println!("an eighth point chooses scale {:.6} ({} is right)", best.map_or(f64::NAN, |b| b.scale), truth.scale);
}

/// The place with coordinates (u, v) in a plane, from the foot of the origin.
fn on_plane(normal: &Vector3<f64>, offset: f64, u: f64, v: f64) -> Vector3<f64> {
    let across = normal.cross(&Vector3::new(0.31, 0.52, 0.79)).normalize();
    -normal * offset + across * u + normal.cross(&across) * v
}

fn distance(row: &Row, pose: &Similarity) -> f64 {
    row.normal.dot(&pose.apply(&row.point.into()).coords) + row.offset
}
