//! One equation: a point of the sensor lies on a plane of the object.

use crate::geometry::Vector3;

/// `normal . x + offset = 0` for the image `x = scale * rotation * point + translation` of `point`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// In the sensor frame.
    pub point: Vector3<f64>,
    /// In the object frame, `|normal| = 1`; either side of the plane will do.
    pub normal: Vector3<f64>,
    /// In units of the object frame.
    pub offset: f64,
}

impl Row {
    /// The two rows of a point on an edge (or on any line): it lies on two planes through it.
    pub fn on_edge(point: Vector3<f64>, planes: [(Vector3<f64>, f64); 2]) -> [Row; 2] {
        planes.map(|(normal, offset)| Row { point, normal, offset })
    }

    /// The three rows of a point on a vertex.
    pub fn on_vertex(point: Vector3<f64>, planes: [(Vector3<f64>, f64); 3]) -> [Row; 3] {
        planes.map(|(normal, offset)| Row { point, normal, offset })
    }
}

/// Mean of the points.
pub fn centroid(rows: &[Row]) -> Vector3<f64> {
    rows.iter().map(|row| row.point).sum::<Vector3<f64>>() / rows.len() as f64
}
