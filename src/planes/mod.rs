//! Planes on both sides of the problem: [`CityPlanes`] merged from facets, [`Patch`]es of points, and which way is up.

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
mod upright;
mod viewers;

pub use city_planes::{CityPlane, CityPlanes, PlaneId, city_planes};
pub use directions::Facing;
pub use facet_grid::{FacetGrid, Look};
pub use fit::{FittedPlane, fit_plane_robustly};
pub use hit::{Hit, OrientedPoint};
pub use patches::{Patches, patches};
pub use prepared_city::PreparedCity;
pub use upright::{UpCandidate, UpChoice, Upright, choose_up, up_beyond_start, up_of_cameras};
