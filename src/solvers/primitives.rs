//! Points, lines and planes of the sensor on points, lines and planes of the object: everything as points on planes.
//!
//! ```text
//! Question    which rows say that one primitive lies on another
//! Method      A sensor point, line or plane is 1, 2 or 3 of its points; an object plane, line or point is 1, 2 or 3 planes
//!             through it; one row for each product. The points are taken about the data's centre, as far apart as the data.
//!             Cameras come in the same way: a pixel's ray is a line of the object, an image line a plane through the centre.
//! Fails when  a line is to lie on a point, or a plane on a line or a point: there the constraint is linear in R and -R^T t, not in
//!             R and t. Exchange the two frames.
//! Source      Ramalingam et al. 2010, section 4; mathematics.md section 9
//! ```
//!
//! Rigid poses (real solutions on average over random problems; each scenario is a test):
//!
//! | scenario | rows | at most | average |
//! |---|---|---|---|
//! | 3 points on lines (generalised P3P; points on edges) | 6 | 8 | 3.1 |
//! | 3 points on concurrent rays (P3P, with the images behind the camera) | 6 | 8 | 4.8 |
//! | 3 lines in planes; in concurrent planes (P3L) | 6 | 8 | 4.6 |
//! | 6 points on planes through one centre | 6 | 8 | 4.6 |
//! | 2 points on lines, 2 on planes; 1 on a line, 4 on planes | 6 | 8 | 3.1; 2.9 |
//! | 2 points on lines, a line in a plane; the same concurrent | 6 | 4 | 3.0; 4.0 |
//! | point on a line, 2 lines in planes; concurrent | 6 | 8 | 3.5; 4.6 |
//! | point on a line, line in a plane, 2 points on planes | 6 | 8 | 3.1 |
//! | 2 lines in planes, 2 points; 1 line, 4 points on planes | 6 | 8 | 3.5; 3.1 |
//! | 3 points on points | 9 | 1 | 1 |
//! | 2 points on points, a point on a plane; on a line | 7; 8 | 2; 1 | 2; 1 |
//! | point on point, point on line, point on plane | 6 | 4 | 3.3 |
//! | point on point, 3 points on planes; line and point on planes | 6 | 8; 4 | 3.1; 3.3 |
//! | point on point, 2 points on lines; line on line | 7 | 1; 2 | 1; 2 |
//! | 2 lines on lines | 8 | 2 | 2 |
//! | line on line with 2 points on planes; point on line; line in plane | 6 | 4 | 3.4; 4; 4 |
//! | 3 planes on planes; 2 and a point; 2 and a line | 9; 7; 8 | 1; 2; 1 | 1; 2; 1 |
//! | plane on plane, line and point on planes = (3,2,1) | 6 | 4 | 4 |
//! | plane on plane, 3 points on planes; on a line and a plane = (3,1,1,1) | 6 | 4 | 2.8; 2.6 |
//! | plane on plane, 2 lines in planes; a line on a line | 7 | 1; 2 | 1; 2 |
//!
//! Similarities (scale > 0):
//!
//! | scenario | rows | at most | average |
//! |---|---|---|---|
//! | 3 points on lines, a point on a plane; point on point, 4 on planes | 7 | 8 | 2.6; 2.7 |
//! | 3 lines in planes, a point on a plane | 7 | 8 | 2.6 |
//! | 4 points on lines (generalised P4P with scale) | 8 | 1 | 1 |
//! | 2 points on points, a point on a plane | 7 | 4 | 2 |
//! | 3 points on points | 9 | 1 | 1 |
//! | point on point, 2 points on lines | 7 | 8 | 2.3 |
//! | plane on plane, line in plane, 2 points; line on line, 3 points | 7 | 4 | 2.2; 2.1 |
//! | point on point, line on line | 7 | 4 | 2 |
//! | 2 lines on lines; 3 planes on planes and a point; 4 planes | 8; 10; 12 | 2; 1; 1 | 2; 1; 1 |
//!
//! Known vertical:
//!
//! | scenario | rows | poses |
//! |---|---|---|
//! | rigid: 2 points on lines; point on point and point on plane; point on line and 2 on planes; line in plane and point on line | 4 | 2 |
//! | rigid: 2 points on points; 2 lines in planes and a point; line on line and a point | 6; 5; 5 | 1 |
//! | similarity: 2 points on lines and a point; point on point and 2 points; point on line and 3 points | 5 | 2, of which 1.5 to 1.6 with scale > 0 |
//! | similarity: 3 points on lines; 2 points on points | 6 | 1 |

use crate::geometry::{Axes, Vector3};

use super::row::Row;

/// What the sensor saw. Directions and normals may have any length, and carry no sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorPrimitive {
    Point(Vector3<f64>),
    Line { point: Vector3<f64>, direction: Vector3<f64> },
    Plane { normal: Vector3<f64>, offset: f64 },
}

/// What it lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectPrimitive {
    Plane { normal: Vector3<f64>, offset: f64 },
    Line { point: Vector3<f64>, direction: Vector3<f64> },
    Point(Vector3<f64>),
}

/// Why a pair is no point-to-plane problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PrimitiveError {
    #[error("pair {0}: a direction or normal is zero")]
    NoDirection(usize),
    #[error(
        "pair {0}: a line on a point, or a plane on a line or a point, is no point-to-plane problem (exchange sensor and object)"
    )]
    Exchanged(usize),
}

/// The rows that say that every first lies on its second. Normals of planes are passed on as they are, of any length.
pub fn rows_of(pairs: &[(SensorPrimitive, ObjectPrimitive)]) -> Result<Vec<Row>, PrimitiveError> {
    let (centre, size) = extent(pairs);
    let mut rows = Vec::new();
    for (i, (sensor, object)) in pairs.iter().enumerate() {
        let exchanged = match sensor {
            SensorPrimitive::Point(_) => false,
            SensorPrimitive::Line { .. } => matches!(object, ObjectPrimitive::Point(_)),
            SensorPrimitive::Plane { .. } => !matches!(object, ObjectPrimitive::Plane { .. }),
        };
        let points = points_of(sensor, &centre, size).ok_or(PrimitiveError::NoDirection(i))?;
        let planes = planes_of(object).ok_or(PrimitiveError::NoDirection(i))?;
        if exchanged {
            return Err(PrimitiveError::Exchanged(i));
        }
        for point in &points {
            rows.extend(planes.iter().map(|(normal, offset)| Row { point: *point, normal: *normal, offset: *offset }));
        }
    }
    Ok(rows)
}

/// Mean of the points given, and the largest distance from it (1 where there is none).
fn extent(pairs: &[(SensorPrimitive, ObjectPrimitive)]) -> (Vector3<f64>, f64) {
    let anchors: Vec<Vector3<f64>> = pairs
        .iter()
        .filter_map(|(sensor, _)| match sensor {
            SensorPrimitive::Point(point) | SensorPrimitive::Line { point, .. } => Some(*point),
            SensorPrimitive::Plane { .. } => None,
        })
        .collect();
    let centre = anchors.iter().sum::<Vector3<f64>>() / anchors.len().max(1) as f64;
    let size = anchors.iter().map(|a| length(&(a - centre))).fold(0.0, f64::max);
    (centre, if size > 0.0 { size } else { 1.0 })
}

fn points_of(sensor: &SensorPrimitive, centre: &Vector3<f64>, size: f64) -> Option<Vec<Vector3<f64>>> {
    Some(match sensor {
        SensorPrimitive::Point(point) => vec![*point],
        SensorPrimitive::Line { point, direction } => {
            let v = unit(direction)?;
            let foot = point + v * v.dot(&(centre - point));
            vec![foot - v * size, foot + v * size]
        }
        SensorPrimitive::Plane { normal, offset } => {
            let n = unit(normal)?;
            let foot = centre - n * (n.dot(centre) + offset / length(normal));
            let Axes { x, y, .. } = Axes::about(&n);
            vec![foot + x * size, foot + (y - x) * (0.5 * size), foot - (x + y) * (0.5 * size)]
        }
    })
}

fn planes_of(object: &ObjectPrimitive) -> Option<Vec<(Vector3<f64>, f64)>> {
    Some(match object {
        ObjectPrimitive::Plane { normal, offset } => {
            unit(normal)?;
            vec![(*normal, *offset)]
        }
        ObjectPrimitive::Line { point, direction } => {
            let Axes { x, y, .. } = Axes::about(&unit(direction)?);
            vec![(x, -x.dot(point)), (y, -y.dot(point))]
        }
        ObjectPrimitive::Point(point) => {
            vec![(Vector3::x(), -point.x), (Vector3::y(), -point.y), (Vector3::z(), -point.z)]
        }
    })
}

/// Any length but zero, without overflow.
fn unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = v.amax();
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}

fn length(v: &Vector3<f64>) -> f64 {
    let largest = v.amax();
    if largest > 0.0 { largest * (v / largest).norm() } else { 0.0 }
}

#[cfg(test)]
mod tests;
