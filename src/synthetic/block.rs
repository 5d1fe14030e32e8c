//! Blocks: houses, with or without the ground that they stand on.

use super::house::{Face, House, Plinth, Surface};
use crate::city::{CityError, CityModel};
use crate::geometry::{Point3, RayCaster, Rotation3, Vector3};
use crate::solvers::scene::Random;

/// How far the modelled ground reaches beyond the houses, metres: chosen, farther than any start of the tests is off.
pub(super) const GROUND_REACH_M: f64 = 40.0;

/// From the middle of a block of a town to the next, metres: houses up to 16 m and a street between.
const TOWN_STEP_M: f64 = 60.0;

/// A made-up piece of city. Coordinates are metres, z up; what is built on it uses them as the city frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    pub houses: Vec<House>,
    /// The modelled ground, `None` in a city of houses alone.
    pub ground: Option<Face>,
}

impl Block {
    /// A block of houses alone.
    pub fn new(houses: Vec<House>) -> Block {
        Block { houses, ground: None }
    }

    /// Four boxes, no two alike, none symmetric with another: the plainest block with one answer.
    pub fn four_houses() -> Block {
        let boxes = [
            ([0.0, 0.0, 0.0], [12.0, 8.0, 7.0], 0f64),
            ([20.0, 3.0, 0.0], [9.0, 14.0, 10.0], 25.0),
            ([-6.0, 20.0, 0.0], [18.0, 7.0, 5.5], -12.0),
            ([18.0, 28.0, 0.0], [7.0, 7.0, 12.0], 50.0),
        ];
        Block::new(boxes.map(|(place, size, deg)| House::flat(size).turned(deg.to_radians()).at(place)).to_vec())
    }

    /// The same places with pitched roofs, an L and a plinth: every shape that this room knows.
    pub fn mixed_houses() -> Block {
        let plinth = Plinth { height_m: 3.0, depth_m: 0.5 };
        let houses = [
            (House::gabled([12.0, 8.0, 6.0], 3.0), 0f64, [0.0, 0.0, 0.0]),
            (House::on_plinth([9.0, 14.0, 10.0], plinth), 25.0, [20.0, 3.0, 0.0]),
            (House::l_shaped([18.0, 12.0, 6.0], [9.0, 6.0]), -12.0, [-6.0, 20.0, 0.0]),
            (House::gabled([7.0, 9.0, 8.0], 4.0), 50.0, [18.0, 28.0, 0.0]),
        ];
        Block::new(houses.map(|(house, deg, place)| house.turned(deg.to_radians()).at(place)).to_vec())
    }

    /// Equal houses along x, each `step_m` from the one before: whoever sees only the row cannot tell which is which.
    pub fn row(house: &House, count: usize, step_m: f64) -> Block {
        Block::new((0..count).map(|i| house.clone().at([step_m * i as f64, 0.0, 0.0])).collect())
    }

    /// A long facade on a plinth, and a house across its end that tells where along it one is.
    pub fn plinth_facade(plinth: Plinth) -> Block {
        let facade = House::on_plinth([40.0, 10.0, 8.0], plinth);
        Block::new(vec![facade, House::flat([8.0, 12.0, 8.0]).at([-8.0, -12.0, 0.0])])
    }

    /// A town of `columns` x `rows` blocks, 60 m from one to the next, each of six houses of seeded sizes, turns and roofs.
    pub fn town(columns: usize, rows: usize, seed: u64) -> Block {
        let mut random = Random::stream(seed, 0);
        let mut houses = Vec::with_capacity(6 * columns * rows);
        for cell in 0..columns * rows {
            let corner = [(cell % columns) as f64, (cell / columns) as f64].map(|k| TOWN_STEP_M * k);
            for plot in 0..6 {
                houses.push(town_house(
                    &mut random,
                    [corner[0] + 15.0 * f64::from(plot % 3), corner[1] + 20.0 * f64::from(plot / 3)],
                ));
            }
        }
        Block::new(houses)
    }

    /// With modelled ground at z = 0, 40 m beyond the houses.
    pub fn with_ground(mut self) -> Block {
        self.ground = Some(self.ground_within(GROUND_REACH_M));
        self
    }

    /// All turned counter-clockwise about the vertical through the origin.
    pub fn turned(self, angle_rad: f64) -> Block {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle_rad);
        self.changed(|corner| turn * corner)
    }

    /// All moved by a vector, metres; to the coordinates of a national grid, say.
    pub fn at(self, place: [f64; 3]) -> Block {
        self.changed(|corner| corner + Vector3::from(place))
    }

    fn changed(mut self, to: impl Fn(Point3<f64>) -> Point3<f64>) -> Block {
        let faces = self.houses.iter_mut().flat_map(|house| &mut house.faces).chain(&mut self.ground);
        faces.flat_map(|face| &mut face.corners).for_each(|corner| *corner = to(*corner));
        self
    }

    /// All faces: those of the houses in order, then the ground.
    pub fn faces(&self) -> impl Iterator<Item = &Face> {
        self.houses.iter().flat_map(|house| &house.faces).chain(&self.ground)
    }

    /// The smallest box around the houses; of no size at the origin where there are none.
    pub fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        let mut corners = self.houses.iter().flat_map(|house| &house.faces).flat_map(|face| &face.corners);
        let first = *corners.next().unwrap_or(&Point3::origin());
        corners.fold((first, first), |(low, high), corner| (low.inf(corner), high.sup(corner)))
    }

    /// The middle of that box.
    pub fn middle(&self) -> Point3<f64> {
        let (low, high) = self.bounds();
        nalgebra::center(&low, &high)
    }

    /// A level rectangle at the foot of the houses, so far beyond them.
    pub(super) fn ground_within(&self, beyond_m: f64) -> Face {
        let (low, high) = self.bounds();
        let (x, y) = ([low.x - beyond_m, high.x + beyond_m], [low.y - beyond_m, high.y + beyond_m]);
        let corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])];
        Face { surface: Surface::Ground, corners: corners.map(|(x, y)| Point3::new(x, y, low.z)).to_vec() }
    }

    /// The block as the program reads a city: objects `house_0`, `house_1`, ... and `ground`. An error where there is no face.
    pub fn city(&self) -> Result<CityModel, CityError> {
        let of_houses =
            self.houses.iter().enumerate().flat_map(|(i, house)| {
                house.faces.iter().map(move |face| (format!("house_{i}"), face.corners.clone()))
            });
        let of_ground = self.ground.iter().map(|face| ("ground".to_owned(), face.corners.clone()));
        CityModel::from_polygons(&of_houses.chain(of_ground).collect::<Vec<_>>())
    }

    /// Lines of sight among the houses; the ground hides nothing that stands on it.
    pub(super) fn rays(&self) -> RayCaster {
        RayCaster::new(self.houses.iter().flat_map(|house| &house.faces).flat_map(Face::triangles))
    }
}

/// One house of a town: 8 to 12 m wide, 9 to 16 m deep, 5 to 16 m high, turned by up to 8 degrees.
pub(super) fn town_house(random: &mut Random, [x, y]: [f64; 2]) -> House {
    let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
    let size = [between(8.0, 12.0), between(9.0, 16.0), between(5.0, 16.0)];
    let house = if between(0.0, 1.0) < 0.5 { House::flat(size) } else { House::gabled(size, between(2.0, 5.0)) };
    house.turned(between(-8f64, 8.0).to_radians()).at([x, y, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::CityDefect;

    #[test]
    fn a_block_is_a_sound_city_but_for_its_missing_floors() {
        for block in [Block::four_houses(), Block::mixed_houses(), Block::town(3, 2, 1)] {
            let city = block.with_ground().city().unwrap();
            for warning in &city.warnings {
                assert!(matches!(warning.defect, CityDefect::OpenShell { .. }), "{warning:?}");
            }
        }
        let row = Block::row(&House::gabled([6.0, 9.0, 6.0], 3.0), 5, 6.0).city().unwrap();
        assert_eq!((row.objects.len(), row.facets.len()), (5, 30));
    }

    #[test]
    fn a_town_has_its_size_and_repeats() {
        let town = Block::town(4, 3, 9);
        assert_eq!(town.houses.len(), 72);
        assert_eq!(town, Block::town(4, 3, 9));
        assert_ne!(town, Block::town(4, 3, 10));
        let (low, high) = town.bounds();
        assert!(high.x - low.x > 200.0 && high.y - low.y > 140.0);
    }
}
