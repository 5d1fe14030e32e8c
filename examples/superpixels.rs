//! How well superpixels keep to the planes of a city: for scenes with truth, how many observations lie in a superpixel whose
//! majority plane is another than their own; for the superpixels of the photographs (which know where the keypoints are, not what
//! they belong to), for a regular grid with as many cells, for superpixels that know the colours alone, and for the labels that
//! come with the scene.
//!
//!     cargo run --release --example superpixels -- SCENE...
//!
//! A SCENE is a folder with scene.json (paths of the city and its terrain), truth.json (the pose of each reconstruction), photos/,
//! labels/ and one or more COLMAP models. A point's own plane is that of the city facet nearest to it under the truth.

use std::collections::HashMap;
use std::error::Error;
use std::path::{Path, PathBuf};

use cityweld::internals::{CityPlanes, PlaneId, city_planes};
use cityweld::steps::{LabelMap, Labels, cut_superpixels};
use cityweld::types::FacetId;
use cityweld::{
    CityModel, CityOptions, Image, Matrix3, Point3, Reconstruction, Similarity, SuperpixelOptions, Vector3, read_city,
    read_reconstruction,
};
use rayon::prelude::*;
use serde_json::Value;

/// Points farther from every facet belong to none: trees, cars, houses that the model lacks.
const REACH_M: f64 = 0.3;
/// Facets of one plane count as one, whichever object they belong to: neighbours in a row share their facade.
const SAME_NORMAL_DEG: f64 = 1.5;
const SAME_OFFSET_M: f64 = 0.03;
/// Side of the cells in which facets are looked up.
const CELL_M: f64 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    let scenes: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    if scenes.is_empty() {
        return Err("give the folders of scenes: superpixels SCENE...".into());
    }
    println!(
        "| scene | observations | superpixels a photo | share | grid | ratio | colours alone | ratio | labels | their grid |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for scene in &scenes {
        for (name, truth) in truths(scene)? {
            measure(scene, &name, &truth)?;
        }
    }
    Ok(())
}

/// The reconstructions of a scene and their true poses.
fn truths(scene: &Path) -> Result<Vec<(String, Similarity)>, Box<dyn Error>> {
    let truth = json(&scene.join("truth.json"))?;
    match truth["transforms"].as_object() {
        Some(several) => several.iter().map(|(name, t)| Ok((name.clone(), similarity(t)?))).collect(),
        None => Ok(vec![("sfm".to_owned(), similarity(&truth["transform"])?)]),
    }
}

fn json(path: &Path) -> Result<Value, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(serde_json::from_str(&text)?)
}

fn similarity(t: &Value) -> Result<Similarity, Box<dyn Error>> {
    let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
    let rotation = Matrix3::from_fn(|row, column| number(&t["rotation"][row][column]));
    let translation = Vector3::from_fn(|k, _| number(&t["translation"][k]));
    Ok(Similarity::try_new(number(&t["scale"]), rotation, translation)?)
}

/// One line of the table.
fn measure(scene: &Path, name: &str, city_from_sfm: &Similarity) -> Result<(), Box<dyn Error>> {
    let city = scene_city(scene)?;
    let sfm = read_reconstruction(&scene.join(name))?;
    let planes = planes_of_points(&city, &sfm, &city_from_sfm.relative_to(&city.origin));
    let photos: Vec<Tallies> = sfm
        .images
        .par_iter()
        .map(|image| tallies(scene, image, &planes).map_err(|error| format!("{}: {error}", image.name)))
        .collect::<Result<_, _>>()?;
    let sum = |of: fn(&Tallies) -> Tally| photos.iter().map(of).fold(Tally::default(), Tally::plus);
    let [ours, grid, labels, labels_grid] =
        [sum(|t| t.superpixels), sum(|t| t.grid), sum(|t| t.labels), sum(|t| t.labels_grid)];
    let colours = sum(|t| t.colours);
    println!(
        "| {} {name} | {} | {:.0} | {:.2} % | {:.2} % | {:.3} | {:.2} % | {:.3} | {:.2} % | {:.2} % |",
        scene.file_name().unwrap_or_default().display(),
        ours.observations,
        ours.cells as f64 / photos.len() as f64,
        100.0 * ours.share(),
        100.0 * grid.share(),
        ours.share() / grid.share(),
        100.0 * colours.share(),
        colours.share() / grid.share(),
        100.0 * labels.share(),
        100.0 * labels_grid.share(),
    );
    Ok(())
}

fn scene_city(scene: &Path) -> Result<CityModel, Box<dyn Error>> {
    let described = json(&scene.join("scene.json"))?;
    let path = |v: &Value| v.as_str().map(|relative| scene.join(relative));
    let city = path(&described["city"]).ok_or("scene.json names no city")?;
    let terrain: Vec<PathBuf> = described["terrain"].as_array().into_iter().flatten().filter_map(path).collect();
    Ok(read_city(&city, &terrain, &CityOptions::default())?)
}

/// Observations in the superpixels of one photograph or of many.
#[derive(Clone, Copy, Default)]
struct Tally {
    cells: usize,
    observations: usize,
    /// Those in a superpixel whose majority plane is another than their own.
    strays: usize,
}

impl Tally {
    fn plus(self, other: Tally) -> Tally {
        Tally {
            cells: self.cells + other.cells,
            observations: self.observations + other.observations,
            strays: self.strays + other.strays,
        }
    }

    fn share(&self) -> f64 {
        self.strays as f64 / self.observations as f64
    }
}

struct Tallies {
    superpixels: Tally,
    /// The same without knowing where the photograph has keypoints.
    colours: Tally,
    grid: Tally,
    labels: Tally,
    labels_grid: Tally,
}

fn tallies(scene: &Path, image: &Image, planes: &[Option<PlaneId>]) -> Result<Tallies, Box<dyn Error + Send + Sync>> {
    let photo = image::open(scene.join("photos").join(&image.name))?.into_rgb8();
    let labels = image::open(scene.join("labels").join(&image.name).with_extension("png"))?.into_luma16();
    let size = photo.dimensions();
    let seen: Vec<(f64, f64, PlaneId)> =
        image.observations.iter().filter_map(|o| Some((o.x_px, o.y_px, planes[o.point?.0 as usize]?))).collect();
    let with_points = image.observations.iter().filter(|o| o.point.is_some());
    let keypoints: Vec<(f64, f64)> = with_points.map(|o| (o.x_px, o.y_px)).collect();
    let cut = |keypoints: &[(f64, f64)]| cut_superpixels(&photo, keypoints, &SuperpixelOptions::default());
    let labels = LabelMap { width: labels.width(), height: labels.height(), labels: Labels::U16(labels.into_raw()) };
    let [superpixels, colours, labels] = [cut(&keypoints), cut(&[]), labels].map(|map| tally(&map, size, &seen));
    Ok(Tallies {
        superpixels,
        colours,
        grid: tally(&grid(size, superpixels.cells), size, &seen),
        labels,
        labels_grid: tally(&grid(size, labels.cells), size, &seen),
    })
}

/// Observations without a superpixel (label 0) do not count.
fn tally(map: &LabelMap, size: (u32, u32), seen: &[(f64, f64, PlaneId)]) -> Tally {
    let mut ids: Vec<u32> = map.labels.iter().filter(|&id| id != 0).collect();
    ids.sort_unstable();
    ids.dedup();
    let mut planes_in: HashMap<u32, HashMap<PlaneId, usize>> = HashMap::new();
    for &(x, y, plane) in seen {
        if let Some(id) = map.label_at(x, y, size).filter(|&id| id != 0) {
            *planes_in.entry(id).or_default().entry(plane).or_default() += 1;
        }
    }
    let observations = planes_in.values().flat_map(HashMap::values).sum();
    let majorities: usize = planes_in.values().filter_map(|counts| counts.values().max()).sum();
    Tally { cells: ids.len(), observations, strays: observations - majorities }
}

/// A regular grid of about `cells` cells, as square as they come.
fn grid((width, height): (u32, u32), cells: usize) -> LabelMap {
    let columns = (cells as f64 * f64::from(width) / f64::from(height)).sqrt().round().max(1.0);
    let rows = (cells as f64 / columns).round().max(1.0);
    let (columns, rows) = (columns as u32, rows as u32);
    let labels = (0..width * height).map(|i| {
        let (x, y) = (i % width, i / width);
        1 + y * rows / height * columns + x * columns / width
    });
    LabelMap { width, height, labels: Labels::U32(labels.collect()) }
}

/// For each point the plane of the facet nearest to it under the truth.
fn planes_of_points(city: &CityModel, sfm: &Reconstruction, city_from_sfm: &Similarity) -> Vec<Option<PlaneId>> {
    let facets = FacetGrid::new(city);
    let planes = city_planes(city);
    let points: Vec<Point3<f64>> = sfm.points.iter().map(|p| city_from_sfm.apply(p)).collect();
    let nearest: Vec<Option<PlaneId>> =
        points.par_iter().map(|p| facets.nearest(p).map(|facet| planes.of_facet(facet))).collect();
    let joined = joined_planes(city, &planes, &nearest);
    nearest.iter().map(|plane| plane.map(|plane| joined[&plane])).collect()
}

/// For each plane that occurs the first (by area) that it coincides with.
fn joined_planes(city: &CityModel, planes: &CityPlanes, found: &[Option<PlaneId>]) -> HashMap<PlaneId, PlaneId> {
    let area = |plane: &PlaneId| planes.planes[plane.0 as usize].area_m2;
    let mut occurring: Vec<PlaneId> = found.iter().flatten().copied().collect();
    occurring.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
    occurring.dedup();
    let coincide = |a: PlaneId, b: PlaneId| {
        let [a, b] = [a, b].map(|plane| &planes.planes[plane.0 as usize]);
        let mut corners = b.facets.iter().flat_map(|&f| &city.facets[f.0 as usize].outline);
        a.plane.normal.dot(&b.plane.normal) > SAME_NORMAL_DEG.to_radians().cos()
            && corners.all(|&v| a.plane.signed_distance(&city.vertices[v as usize]).abs() < SAME_OFFSET_M)
    };
    let mut firsts: Vec<PlaneId> = Vec::new();
    let mut joined = HashMap::new();
    for plane in occurring {
        let first = firsts.iter().copied().find(|&first| coincide(first, plane)).unwrap_or(plane);
        if first == plane {
            firsts.push(plane);
        }
        joined.insert(plane, first);
    }
    joined
}

/// Triangles by the cells that they come near.
struct FacetGrid {
    triangles: Vec<([Point3<f64>; 3], FacetId)>,
    cells: HashMap<[i32; 3], Vec<u32>>,
}

impl FacetGrid {
    fn new(city: &CityModel) -> FacetGrid {
        let mut grid = FacetGrid { triangles: Vec::new(), cells: HashMap::new() };
        for (id, facet) in city.facets_with_ids() {
            for corners in city.triangles_of(facet) {
                grid.insert(corners, id);
            }
        }
        grid
    }

    fn insert(&mut self, corners: [Point3<f64>; 3], facet: FacetId) {
        let [a, b, c] = corners;
        let low = cell(&(a.inf(&b).inf(&c) - Vector3::repeat(REACH_M)));
        let high = cell(&(a.sup(&b).sup(&c) + Vector3::repeat(REACH_M)));
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    self.cells.entry([x, y, z]).or_default().push(self.triangles.len() as u32);
                }
            }
        }
        self.triangles.push((corners, facet));
    }

    fn nearest(&self, p: &Point3<f64>) -> Option<FacetId> {
        let near = self.cells.get(&cell(p)).into_iter().flatten().map(|&t| &self.triangles[t as usize]);
        let by_distance = near.map(|(corners, facet)| (distance(p, corners), *facet));
        by_distance.filter(|(d, _)| *d <= REACH_M).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, facet)| facet)
    }
}

fn cell(p: &Point3<f64>) -> [i32; 3] {
    [p.x, p.y, p.z].map(|v| (v / CELL_M).floor() as i32)
}

/// From a point to a triangle: to its plane where the foot lies inside, else to the nearest edge.
fn distance(p: &Point3<f64>, corners: &[Point3<f64>; 3]) -> f64 {
    let edges = [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3] - corners[k]));
    let normal = edges[0].1.cross(&edges[1].1).normalize();
    let inside = edges.iter().all(|(from, edge)| normal.cross(edge).dot(&(p - from)) >= 0.0);
    if inside {
        return normal.dot(&(p - corners[0])).abs();
    }
    let to_edge = |(from, edge): &(Point3<f64>, Vector3<f64>)| {
        let along = (edge.dot(&(p - from)) / edge.norm_squared()).clamp(0.0, 1.0);
        (p - (from + edge * along)).norm()
    };
    edges.iter().map(to_edge).fold(f64::INFINITY, f64::min)
}
