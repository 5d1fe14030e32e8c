//! Houses, each a handful of flat faces.

use crate::geometry::{Point3, Rotation3, Vector3};

/// What a face is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    Wall,
    /// Roofs, and the ledge of a plinth.
    Roof,
    Ground,
}

/// A flat polygon of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    pub surface: Surface,
    /// Metres, z up, counter-clockwise seen from outside. All of the polygon can be seen from its first corner, so that the
    /// fan from there covers it.
    pub corners: Vec<Point3<f64>>,
}

/// A ground floor that stands out before the facade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plinth {
    pub height_m: f64,
    pub depth_m: f64,
}

/// A house without a floor, as city models have them. Built with its corner at the origin and its front along x at y = 0;
/// [`House::turned`] and [`House::at`] put it into its place.
#[derive(Clone, Debug, PartialEq)]
pub struct House {
    pub faces: Vec<Face>,
}

impl House {
    /// A box with a flat roof; width along x, depth along y and height, metres.
    pub fn flat([width, depth, height]: [f64; 3]) -> House {
        let footprint = [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)];
        House::extruded(&footprint, height)
    }

    /// A pitched roof whose ridge runs along x, `rise_m` above the eaves.
    pub fn gabled([width, depth, eaves]: [f64; 3], rise_m: f64) -> House {
        let (middle, top) = (0.5 * depth, eaves + rise_m);
        let p = Point3::new;
        let front = vec![p(0.0, 0.0, 0.0), p(width, 0.0, 0.0), p(width, 0.0, eaves), p(0.0, 0.0, eaves)];
        let back = vec![p(width, depth, 0.0), p(0.0, depth, 0.0), p(0.0, depth, eaves), p(width, depth, eaves)];
        let gable = |x: f64| {
            let profile = [(depth, 0.0), (0.0, 0.0), (0.0, eaves), (middle, top), (depth, eaves)];
            profile.map(|(y, z)| p(x, y, z)).to_vec()
        };
        let south = vec![p(0.0, 0.0, eaves), p(width, 0.0, eaves), p(width, middle, top), p(0.0, middle, top)];
        let north = vec![p(width, depth, eaves), p(0.0, depth, eaves), p(0.0, middle, top), p(width, middle, top)];
        let walls = [front, back, gable(0.0), turned_over(gable(width))].map(|corners| (Surface::Wall, corners));
        House::of(walls.into_iter().chain([south, north].map(|corners| (Surface::Roof, corners))))
    }

    /// An L with a flat roof: the box without the part of `notch` (width, depth) at its far right corner.
    pub fn l_shaped([width, depth, height]: [f64; 3], notch: [f64; 2]) -> House {
        let (inner_x, inner_y) = (width - notch[0], depth - notch[1]);
        let footprint =
            [(inner_x, inner_y), (inner_x, depth), (0.0, depth), (0.0, 0.0), (width, 0.0), (width, inner_y)];
        House::extruded(&footprint, height)
    }

    /// A box with a flat roof and a plinth before its front.
    pub fn on_plinth([width, depth, height]: [f64; 3], plinth: Plinth) -> House {
        let Plinth { height_m: ledge, depth_m: out } = plinth;
        let p = Point3::new;
        // From the inner corner of the ledge, which sees all of it.
        let profile = [(0.0, ledge), (0.0, height), (depth, height), (depth, 0.0), (-out, 0.0), (-out, ledge)];
        let side = |x: f64| profile.map(|(y, z)| p(x, y, z)).to_vec();
        // One strip of the front for each edge of the profile but the ground's.
        let strip = |i: usize| {
            let ((y0, z0), (y1, z1)) = (profile[i], profile[(i + 1) % profile.len()]);
            vec![p(width, y0, z0), p(width, y1, z1), p(0.0, y1, z1), p(0.0, y0, z0)]
        };
        let roofs = [1, 5].map(|i| (Surface::Roof, strip(i)));
        let walls = [0, 2, 4].map(|i| (Surface::Wall, strip(i)));
        let sides = [side(0.0), turned_over(side(width))].map(|corners| (Surface::Wall, corners));
        House::of(walls.into_iter().chain(sides).chain(roofs))
    }

    /// Walls along a footprint (counter-clockwise from above, all of it seen from its first corner) and a flat roof.
    fn extruded(footprint: &[(f64, f64)], height: f64) -> House {
        let next = |i: usize| footprint[(i + 1) % footprint.len()];
        let walls = footprint.iter().enumerate().map(|(i, a)| {
            let b = next(i);
            let corners = [(a.0, a.1, 0.0), (b.0, b.1, 0.0), (b.0, b.1, height), (a.0, a.1, height)];
            (Surface::Wall, corners.map(|(x, y, z)| Point3::new(x, y, z)).to_vec())
        });
        let roof = footprint.iter().map(|(x, y)| Point3::new(*x, *y, height)).collect();
        House::of(walls.chain([(Surface::Roof, roof)]))
    }

    fn of(faces: impl Iterator<Item = (Surface, Vec<Point3<f64>>)>) -> House {
        House { faces: faces.map(|(surface, corners)| Face { surface, corners }).collect() }
    }

    /// Turned counter-clockwise about the vertical through the origin.
    pub fn turned(self, angle_rad: f64) -> House {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle_rad);
        self.moved(|corner| turn * corner)
    }

    /// Moved by a vector, metres: a house as it was built gets its corner there.
    pub fn at(self, place: [f64; 3]) -> House {
        self.moved(|corner| corner + Vector3::from(place))
    }

    fn moved(mut self, to: impl Fn(Point3<f64>) -> Point3<f64>) -> House {
        self.faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|corner| *corner = to(*corner));
        self
    }
}

/// The other side of a polygon, from the same first corner on.
fn turned_over(mut corners: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    corners[1..].reverse();
    corners
}

impl Face {
    /// The triangles of the fan from the first corner.
    pub fn triangles(&self) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
        self.corners.windows(2).skip(1).map(|pair| [self.corners[0], pair[0], pair[1]])
    }

    /// Square metres.
    pub fn area(&self) -> f64 {
        self.triangles().map(|t| 0.5 * across(&t).norm()).sum()
    }

    /// Unit normal to the outside.
    pub fn normal(&self) -> Vector3<f64> {
        let sum: Vector3<f64> = self.triangles().map(|t| across(&t)).sum();
        sum.try_normalize(0.0).unwrap_or(sum)
    }
}

fn across([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

#[cfg(test)]
mod tests;
