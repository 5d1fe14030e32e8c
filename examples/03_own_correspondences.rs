//! Correspondences that are known already: somebody has measured points and says on which facet of the city each of them lies.
//!
//!     cargo run --release --example 03_own_correspondences

use std::error::Error;
use std::path::Path;

use cityweld::solvers::{Row, Sought, linear_least_squares, refine};
use cityweld::{CityModel, CityOptions, Facet, Rotation3, Similarity, Vector3, read_city};

/// Facets that the points lie on, and points on each.
const FACETS: usize = 40;
const POINTS: usize = 5;
/// Half the width of the points' noise, metres.
const NOISE_M: f64 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let city = read_city(&sample.join("city.obj"), &[], &CityOptions::default())?;
    let mut facets: Vec<&Facet> = city.facets.iter().collect();
    facets.sort_by(|a, b| b.area.total_cmp(&a.area));

    // The instrument's frame, which we pretend not to know.
    let rotation = Rotation3::from_euler_angles(0.02, -0.01, 2.1);
    let truth = Similarity { scale: 1.02, rotation, translation: Vector3::new(12.0, -30.0, 1.6) };

    // One row says: the image of this point lies on this plane.
    let rows: Vec<Row> = facets[..FACETS].iter().flat_map(|facet| rows_on(&city, facet, &truth)).collect();

    // A linear start, then least squares of the distances. (`cityweld::solvers::solve` takes rows without noise and needs no start.)
    let start =
        linear_least_squares(&rows).ok_or("the rows do not fix a pose: fewer than twelve, or planes too much alike")?;
    let found = refine(&Sought::Similarity, &rows, &start.object_from_sensor).ok_or("the rows leave something open")?;

    println!("{} points on {FACETS} facets", rows.len());
    println!("scale     {:.6} ({} is right)", found.scale, truth.scale);
    println!("rotation  {:.4} deg off", (truth.rotation.inverse() * found.rotation).angle().to_degrees());
    println!("middle    {:.4} m off", (found.apply(&middle()) - truth.apply(&middle())).norm());
    Ok(())
}

/// Measured points on a facet: even mixtures of its corners, a little off, in the instrument's frame.
fn rows_on(city: &CityModel, facet: &Facet, city_from_sensor: &Similarity) -> Vec<Row> {
    let corners: Vec<Vector3<f64>> = facet.outline.iter().map(|&v| city.vertices[v as usize].coords).collect();
    let row = |k: usize| {
        let weights = (0..corners.len()).map(|c| 1.0 + ((7 * k + 3 * c) as f64 * 0.618_034).fract());
        let total: f64 = weights.clone().sum();
        let on_facet = corners.iter().zip(weights).map(|(c, w)| c * (w / total)).sum::<Vector3<f64>>();
        let noise = NOISE_M * (2.0 * ((k as f64 + facet.area) * 0.414_214).fract() - 1.0);
        let measured = city_from_sensor.inverse().apply(&(on_facet + facet.plane.normal * noise).into());
        Row { point: measured.coords, normal: facet.plane.normal, offset: facet.plane.offset }
    };
    (0..POINTS).map(row).collect()
}

/// Some place among the points, in the instrument's frame.
fn middle() -> nalgebra::Point3<f64> {
    nalgebra::Point3::new(20.0, 10.0, 5.0)
}
