//! The planes that an alignment compares: those of the city model, and those of the point cloud.
//!
//! * **The city's side.** Facets of one building in one plane are one plane (`city_planes`); facets that nobody could have seen from outside
//!   (party walls, undersides) are left out (`facet_visibility`); a grid answers which facet of a given side and direction is nearest to a
//!   point (`facet_grid`, with `facet_tile`, `tile_triangle`, `directions`). [`PreparedCity`] holds all of it for one city, for any number of alignments.
//! * **The cloud's side.** One point a place, large clouds thinned evenly (`places`); a plane through each point's neighbours (`cloud`,
//!   `fit`); regions of points in one plane (`regions`) become [`Patches`] with a plane, its noise and its outward side, as far as cameras
//!   tell it (`viewers`).
//! * **The vertical.** Which way is up in the reconstruction, by its walls and floors, the cameras and the start (`upright`, `up_votes`), or without one
//!   (`up_without_start`).

mod city_planes;
mod cloud;
mod directions;
mod facet_visibility;
mod facet_grid;
mod facet_tile;
mod fit;
mod hit;
mod patches;
mod places;
mod prepared_city;
mod regions;
mod surface;
mod tile_triangle;
mod up_votes;
mod up_without_start;
mod upright;
mod viewers;

pub use city_planes::{CityPlane, CityPlanes, PlaneId, city_planes};
pub use directions::Facing;
pub use facet_grid::{FacetGrid, Look};
pub use fit::{FittedPlane, fit_plane_robustly};
pub use hit::{Hit, OrientedPoint};
pub use patches::{Patch, Patches, patches};
pub use prepared_city::PreparedCity;
pub use up_without_start::up_without_start;
pub use upright::{UpCandidate, UpChoice, Upright, choose_up, up_beyond_start, up_of_cameras};
