//! Whether facets stand upright about another axis than the one that was taken for up.

use super::warning::CityDefect;
use super::{CityModel, CityRole, CityUp};

/// The sine of what is off by three degrees: level or upright enough.
const STRAIGHT: f64 = 0.05;

/// Share of the city's area that must be level or upright about y, and by how much more than about z. Chosen: a city has about nine
/// tenths of its area level or upright, about another axis a third, unless its streets run along the axes, which tells nothing.
const LEAST_SHARE: f64 = 0.6;
const LEAST_LEAD: f64 = 0.2;

/// What to try where the city stands upright about y. `turned`: the axis that was taken for up.
pub(super) fn odd_up(model: &CityModel, taken: CityUp) -> Option<CityDefect> {
    UprightAreas::of(model).odd_up(taken)
}

/// Area of a city's facets, and what of it is level or upright about an axis; square metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct UprightAreas {
    about_y: f64,
    about_z: f64,
    whole: f64,
}

impl UprightAreas {
    pub fn of(model: &CityModel) -> UprightAreas {
        let (mut about_y, mut about_z, mut whole) = (0.0, 0.0, 0.0);
        for source in model.sources.iter().filter(|source| source.role == CityRole::City) {
            for facet in &model.facets[source.facets.start as usize..source.facets.end as usize] {
                let is_straight = |along: f64| along.abs() < STRAIGHT || 1.0 - along.abs() < STRAIGHT * STRAIGHT / 2.0;
                about_y += if is_straight(facet.plane.normal.y) { facet.area } else { 0.0 };
                about_z += if is_straight(facet.plane.normal.z) { facet.area } else { 0.0 };
                whole += facet.area;
            }
        }
        UprightAreas { about_y, about_z, whole }
    }

    pub fn add(&mut self, other: &UprightAreas) {
        self.about_y += other.about_y;
        self.about_z += other.about_z;
        self.whole += other.whole;
    }

    pub fn odd_up(&self, taken: CityUp) -> Option<CityDefect> {
        let UprightAreas { about_y, about_z, whole } = *self;
        let tells = about_y > LEAST_SHARE * whole && about_y > about_z + LEAST_LEAD * whole;
        let attempt = match taken {
            CityUp::Z => CityUp::Y,
            CityUp::Y => CityUp::Z,
        };
        tells.then_some(CityDefect::UprightAboutY { share: about_y / whole, attempt })
    }
}
