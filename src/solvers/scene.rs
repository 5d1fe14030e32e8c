//! Random scenes for tests, examples and benchmarks: the simulation of the paper's section 5.
//!
//! Planes with uniform normals pass through uniform points of a cube of side 100; points lie uniformly on the planes inside
//! the cube. The pose that is sought is uniform.

use crate::geometry::{Rotation3, Similarity, Vector3};
pub use crate::random::Random;

use super::row::Row;
use super::sought::Sought;
use super::up::Up;

/// Side of the cube; the unit is arbitrary.
pub const SIDE: f64 = 100.0;

/// Draws of a scene.
impl Random {
    /// A uniform point of the cube about the origin.
    pub fn in_cube(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| SIDE * (self.unit() - 0.5))
    }

    /// A plane of the scene: unit normal and offset.
    pub fn plane(&mut self) -> (Vector3<f64>, f64) {
        let normal = self.direction();
        (normal, -normal.dot(&self.in_cube()))
    }

    /// A uniform point of the part of a plane inside the cube; near the plane's foot where that part is a mere corner.
    pub fn on_plane(&mut self, plane: &(Vector3<f64>, f64)) -> Vector3<f64> {
        let (normal, offset) = plane;
        let foot = -normal * *offset;
        let mut x = foot;
        for _ in 0..1000 {
            let shift = self.normal_vector().cross(normal);
            let across = shift.norm();
            // Uniform on a disc that holds the whole section of the cube.
            x = foot + shift * (SIDE * 1.75 * self.unit().sqrt() / across);
            if x.amax() <= 0.5 * SIDE {
                break;
            }
        }
        x
    }
}

/// A sample of rows, and the pose that made them.
pub struct Sample {
    pub rows: Vec<Row>,
    pub truth: Similarity,
}

/// A random sample with so many points on each of so many planes. A known vertical fixes the tilt of the true pose; a
/// sought scale is log-uniform in [1/10, 10].
pub fn sample(random: &mut Random, sought: &Sought, points_per_plane: &[usize]) -> Sample {
    let truth = pose(random, sought);
    let inverse = truth.inverse();
    let mut rows = Vec::new();
    for &points in points_per_plane {
        let plane = random.plane();
        for _ in 0..points {
            let point = inverse.apply(&random.on_plane(&plane).into()).coords;
            rows.push(Row { point, normal: plane.0, offset: plane.1 });
        }
    }
    Sample { rows, truth }
}

/// A random pose of the kind that is sought.
pub fn pose(random: &mut Random, sought: &Sought) -> Similarity {
    let rotation = match sought {
        Sought::Rigid | Sought::Similarity => random.rotation(),
        Sought::UprightRigid(up) | Sought::UprightSimilarity(up) => {
            let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
            Rotation3::from_matrix_unchecked(up.rotation(cos, sin))
        }
    };
    let scale = match sought {
        Sought::Rigid | Sought::UprightRigid(_) => 1.0,
        Sought::Similarity | Sought::UprightSimilarity(_) => 100f64.powf(random.unit() - 0.5),
    };
    Similarity { scale, rotation, translation: random.in_cube() }
}

/// A random vertical in both frames.
pub fn up(random: &mut Random) -> Up {
    loop {
        if let Some(up) = Up::new(&random.direction(), &random.direction()) {
            return up;
        }
    }
}

/// Angle between two rotations, without the loss of digits of an arc cosine.
pub fn angle_between_rad(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    let chord = (a.matrix() - b.matrix()).norm();
    2.0 * (chord / 8f64.sqrt()).min(1.0).asin()
}

/// Largest distance of an image from its plane, over the size of the image or of the planes' offsets.
pub fn relative_residual(rows: &[Row], pose: &Similarity) -> f64 {
    let mut size = 0.0f64;
    let mut worst = 0.0f64;
    for row in rows {
        let image = pose.apply(&row.point.into()).coords;
        size = size.max(image.norm()).max(row.offset.abs()).max(pose.scale * row.point.norm());
        worst = worst.max((row.normal.dot(&image) + row.offset).abs());
    }
    worst / size
}
