//! A city of any number of buildings: given models side by side, each copy turned, and stretched unequally so that no two are twins.
//!
//!     cargo run --release --example large_city -- 100000 large.city.jsonl city_a.obj city_b.obj
//!
//! Written as CityJSONSeq, one feature a building. Shapes are told apart under any scale: the stretch along an axis of the plan, the stretch of heights,
//! and the axis itself differ from copy to copy, each stretch by steps of 15 %. There are 360 shapes of a model; with four models of 800 buildings
//! that is a million. The same arguments give the same bytes.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use cityweld::{CityModel, CityOptions, Facet, Point3, Vector3, read_city};

/// Ratio of neighbouring stretches.
const STEP: f64 = 1.15;
/// Steps of the stretch in plan (none is none at all), steps of the height, axes of the stretch.
const PLAN_STEPS: [i32; 10] = [1, -1, 2, -2, 3, -3, 4, -4, 5, -5];
const HEIGHT_STEPS: [i32; 9] = [0, 1, -1, 2, -2, 3, -3, 4, -4];
const AXES: usize = 4;
/// The largest half stretch in plan, and the street between copies, metres.
const WIDEST: f64 = 1.42;
const STREET_M: f64 = 20.0;
/// South-west corner; metres of no particular system.
const CORNER: [f64; 3] = [100_000.0, 400_000.0, 0.0];
/// Digits of the file, metres.
const DIGIT_M: f64 = 0.001;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, output, given @ ..] = &arguments[..] else {
        return Err("give a number, a file to write, models".into());
    };
    let count: usize = count.parse()?;
    let read = |path: &String| read_city(Path::new(path), &[], &CityOptions::default());
    let models = given.iter().map(read).collect::<Result<Vec<CityModel>, _>>()?;
    if models.is_empty() {
        return Err("give at least one model".into());
    }
    let per_round: usize = models.iter().map(|model| model.objects.len()).sum();
    let copies = count.div_ceil(per_round) * models.len();
    let columns = (copies as f64).sqrt().ceil() as usize;
    let spacing_m = models.iter().map(reach_m).fold(0.0, f64::max) * 2.0 * WIDEST + STREET_M;

    let mut out = BufWriter::with_capacity(1 << 20, File::create(output)?);
    let [x, y, z] = CORNER;
    writeln!(
        out,
        r#"{{"type":"CityJSON","version":"2.0","transform":{{"scale":[{DIGIT_M},{DIGIT_M},{DIGIT_M}],"translate":[{x},{y},{z}]}},"CityObjects":{{}},"vertices":[]}}"#
    )?;
    let mut written = 0;
    for copy in 0..copies {
        let model = &models[copy % models.len()];
        let shape = Shape::of(copy / models.len(), copy);
        let place = Vector3::new((copy % columns) as f64, (copy / columns) as f64, 0.0) * spacing_m;
        let mut facets: Vec<&Facet> = model.facets.iter().collect();
        facets.sort_by_key(|facet| facet.object);
        for building in facets.chunk_by(|a, b| a.object == b.object).take(count - written) {
            out.write_all(feature(model, building, &shape, &place, copy).as_bytes())?;
            written += 1;
        }
    }
    out.flush()?;
    println!(
        "{written} buildings in {copies} copies of {} models, {:.1} km wide",
        models.len(),
        columns as f64 * spacing_m / 1e3
    );
    Ok(())
}

/// From the middle of a model to its farthest corner in plan.
fn reach_m(model: &CityModel) -> f64 {
    let middle = middle(model);
    model.vertices.iter().map(|vertex| (vertex - middle).xy().norm()).fold(0.0, f64::max)
}

fn middle(model: &CityModel) -> Point3<f64> {
    let (low, high) = model.bounds().unwrap_or_default();
    Point3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z)
}

/// What is done to a copy: stretched along an axis of the plan and across it, and in height; then turned.
struct Shape {
    axis: f64,
    along: f64,
    height: f64,
    heading: f64,
}

impl Shape {
    /// The `nth` shape of a model.
    fn of(nth: usize, copy: usize) -> Shape {
        let [plan, rest] = [nth % PLAN_STEPS.len(), nth / PLAN_STEPS.len()];
        let [height, axis] = [rest % HEIGHT_STEPS.len(), rest / HEIGHT_STEPS.len() % AXES];
        Shape {
            axis: axis as f64 * std::f64::consts::FRAC_PI_2 / AXES as f64,
            along: STEP.powf(f64::from(PLAN_STEPS[plan]) / 2.0),
            height: STEP.powi(HEIGHT_STEPS[height]),
            // The golden angle: no two headings are alike, and none is preferred.
            heading: copy as f64 * 2.399_963_229_728_653,
        }
    }

    fn put(&self, v: Vector3<f64>) -> Vector3<f64> {
        let turned = |v: Vector3<f64>, angle: f64| {
            let (sin, cos) = angle.sin_cos();
            Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
        };
        let v = turned(v, -self.axis);
        turned(Vector3::new(v.x * self.along, v.y / self.along, v.z * self.height), self.axis + self.heading)
    }
}

/// One building as a line of the file.
fn feature(model: &CityModel, facets: &[&Facet], shape: &Shape, place: &Vector3<f64>, copy: usize) -> String {
    let mut used: Vec<u32> = facets.iter().flat_map(|facet| facet.rings().flatten()).copied().collect();
    used.sort_unstable();
    used.dedup();
    let middle = middle(model);
    let vertices = used.iter().map(|&vertex| {
        let put = shape.put(model.vertices[vertex as usize] - middle) + place;
        let [x, y, z] = <[f64; 3]>::from(put).map(|value| (value / DIGIT_M).round() as i64);
        format!("[{x},{y},{z}]")
    });
    let vertices = vertices.collect::<Vec<_>>().join(",");
    let ring = |ring: &[u32]| {
        let corners = ring.iter().map(|vertex| used.partition_point(|other| other < vertex).to_string());
        format!("[{}]", corners.collect::<Vec<_>>().join(","))
    };
    let surface = |facet: &&Facet| format!("[{}]", facet.rings().map(ring).collect::<Vec<_>>().join(","));
    let boundaries = facets.iter().map(surface).collect::<Vec<_>>().join(",");
    let id = format!("{copy}-{}", facets[0].object.0);
    let mut line = String::new();
    let _ = writeln!(
        line,
        r#"{{"type":"CityJSONFeature","id":"{id}","CityObjects":{{"{id}":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"2","boundaries":[{boundaries}]}}]}}}},"vertices":[{vertices}]}}"#
    );
    line
}
