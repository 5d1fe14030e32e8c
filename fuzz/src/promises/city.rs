//! A city that was read: finite, and every index within its list.

use cityweld::{CityModel, Facet};

use super::{finite, told, within};

pub fn check(city: &CityModel) -> Result<(), String> {
    finite("origin", city.origin.iter().copied())?;
    finite("a vertex", city.vertices.iter().flat_map(|vertex| vertex.iter().copied()))?;
    for corner in city.triangles.iter().flatten() {
        within("a triangle's corner", *corner as usize, city.vertices.len())?;
    }
    city.facets.iter().try_for_each(|facet| check_facet(facet, city))?;
    for source in &city.sources {
        finite("precision", [source.precision_m])?;
    }
    city.warnings.iter().try_for_each(|warning| told::check(&warning.to_string()))
}

fn check_facet(facet: &Facet, city: &CityModel) -> Result<(), String> {
    let normal = facet.plane.normal;
    finite("a facet's plane", normal.iter().copied().chain([facet.plane.offset]))?;
    finite("a facet's area", [facet.area])?;
    if (normal.norm() - 1.0).abs() > 1e-9 || facet.area < 0.0 {
        return Err(format!("a facet's normal of length {}, its area {}", normal.norm(), facet.area));
    }
    for corner in facet.rings().flatten() {
        within("a facet's corner", *corner as usize, city.vertices.len())?;
    }
    if facet.triangles.start > facet.triangles.end || facet.triangles.end as usize > city.triangles.len() {
        return Err(format!("a facet's triangles {:?} of {}", facet.triangles, city.triangles.len()));
    }
    within("a facet's object", facet.object.0 as usize, city.objects.len())
}
