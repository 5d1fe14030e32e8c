//! The noise simulation of the paper's section 5 (its Fig. 4): errors of the best of 100 samples, by configuration and noise.
//!
//! `cargo run --release --example figure4 [TRIALS] [FOLDER]` prints the table and writes `figure4.csv`,
//! `figure4_rotation.svg` and `figure4_position.svg` to FOLDER (default `target/figure4`).

use cityweld::solvers::scene::{Random, SIDE, angle_between_rad, pose};
use cityweld::solvers::{Row, Sought, linear_least_squares, refine, solve_minimal};
use cityweld::{Point3, Similarity};

/// Noise of each coordinate, as a share of the cube's side.
pub const NOISE: [f64; 5] = [0.005, 0.01, 0.02, 0.03, 0.05];
pub const PLANES: usize = 32;
pub const POINTS_ON_EACH: usize = 10;
pub const SAMPLES: usize = 100;

/// How a pose is made from a sample with so many points on each plane.
#[derive(Clone, Copy)]
pub enum Method {
    Minimal,
    /// Twelve unknowns, then the nearest rotation.
    Linear,
    MinimalPolished,
    LinearPolished,
}

pub const METHODS: [(&str, Method, &[usize]); 17] = [
    ("(3,2,1)", Method::Minimal, &[3, 2, 1]),
    ("(2,2,2)", Method::Minimal, &[2, 2, 2]),
    ("(3,1,1,1)", Method::Minimal, &[3, 1, 1, 1]),
    ("(2,2,1,1)", Method::Minimal, &[2, 2, 1, 1]),
    ("(2,1,1,1,1)", Method::Minimal, &[2, 1, 1, 1, 1]),
    ("(1,1,1,1,1,1)", Method::Minimal, &[1, 1, 1, 1, 1, 1]),
    ("(3,3,3)", Method::Minimal, &[3, 3, 3]),
    ("(3,3,2)", Method::Minimal, &[3, 3, 2]),
    ("(3,3,1)", Method::Minimal, &[3, 3, 1]),
    ("(3,2,2)", Method::Minimal, &[3, 2, 2]),
    ("(3,3,3) polished", Method::MinimalPolished, &[3, 3, 3]),
    ("linear, 12 points, 3 planes", Method::Linear, &[4, 4, 4]),
    ("linear, 12 points, 4 planes", Method::Linear, &[3, 3, 3, 3]),
    ("linear, 12 points, 6 planes", Method::Linear, &[2, 2, 2, 2, 2, 2]),
    ("linear, 20 points, 6 planes", Method::Linear, &[4, 4, 3, 3, 3, 3]),
    ("linear 12, 4 planes, polished", Method::LinearPolished, &[3, 3, 3, 3]),
    ("linear 20, 6 planes, polished", Method::LinearPolished, &[4, 4, 3, 3, 3, 3]),
];

/// A scene with noisy points, plane by plane.
pub struct Scene {
    pub rows: Vec<Row>,
    pub truth: Similarity,
}

impl Scene {
    pub fn new(random: &mut Random, noise: f64) -> Scene {
        let truth = pose(random, &Sought::Rigid);
        let inverse = truth.inverse();
        let mut rows = Vec::new();
        for _ in 0..PLANES {
            let plane = random.plane();
            for _ in 0..POINTS_ON_EACH {
                let x = random.on_plane(&plane) + random.normal_vector() * (noise * SIDE);
                rows.push(Row { point: inverse.apply(&x.into()).coords, normal: plane.0, offset: plane.1 });
            }
        }
        Scene { rows, truth }
    }

    /// Rows of a random sample: so many points on each of so many planes.
    pub fn draw(&self, random: &mut Random, points_per_plane: &[usize]) -> Vec<Row> {
        let mut rows = Vec::new();
        for (plane, &points) in distinct(random, PLANES, points_per_plane.len()).into_iter().zip(points_per_plane) {
            let of_plane = distinct(random, POINTS_ON_EACH, points);
            rows.extend(of_plane.into_iter().map(|point| self.rows[plane * POINTS_ON_EACH + point]));
        }
        rows
    }

    /// Mean distance of all points from their planes.
    pub fn mean_distance(&self, pose: &Similarity) -> f64 {
        let distance = |row: &Row| (row.normal.dot(&pose.apply(&row.point.into()).coords) + row.offset).abs();
        self.rows.iter().map(distance).sum::<f64>() / self.rows.len() as f64
    }

    /// Best pose of so many samples.
    pub fn best_of(
        &self,
        random: &mut Random,
        method: Method,
        points_per_plane: &[usize],
        samples: usize,
    ) -> Option<Similarity> {
        let mut best = (f64::INFINITY, None);
        for _ in 0..samples {
            for pose in poses(method, points_per_plane, &self.draw(random, points_per_plane)) {
                let distance = self.mean_distance(&pose);
                if distance < best.0 {
                    best = (distance, Some(pose));
                }
            }
        }
        best.1
    }

    /// Error of the rotation in degrees, and of the position of the cube's centre in the scene's unit.
    pub fn error(&self, pose: &Similarity) -> (f64, f64) {
        let centre = self.truth.inverse().apply(&Point3::origin());
        (angle_between_rad(&pose.rotation, &self.truth.rotation).to_degrees(), pose.apply(&centre).coords.norm())
    }
}

fn poses(method: Method, points_per_plane: &[usize], rows: &[Row]) -> Vec<Similarity> {
    let polish = |pose: &Similarity| refine(&Sought::Rigid, rows, pose);
    let linear = linear_least_squares(rows).map(|fit| fit.object_from_sensor);
    match method {
        Method::Minimal => solve_minimal(&Sought::Rigid, points_per_plane, rows).to_vec(),
        Method::MinimalPolished => {
            solve_minimal(&Sought::Rigid, points_per_plane, rows).iter().filter_map(polish).collect()
        }
        Method::Linear => linear.into_iter().collect(),
        Method::LinearPolished => linear.iter().filter_map(polish).collect(),
    }
}

/// Distinct indices below `below`.
fn distinct(random: &mut Random, below: usize, count: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..below).collect();
    for i in 0..count {
        let j = i + (random.unit() * (below - i) as f64) as usize;
        all.swap(i, j);
    }
    all.truncate(count);
    all
}

/// Mean errors (degrees, position) over trials.
pub fn mean_errors(method: Method, points_per_plane: &[usize], noise: f64, trials: usize) -> (f64, f64) {
    let mut random = Random::stream(4, 0);
    let (mut rotation, mut position, mut solved) = (0.0, 0.0, 0.0);
    for _ in 0..trials {
        let scene = Scene::new(&mut random, noise);
        if let Some(pose) = scene.best_of(&mut random, method, points_per_plane, SAMPLES) {
            let (degrees, distance) = scene.error(&pose);
            rotation += degrees;
            position += distance;
            solved += 1.0;
        }
    }
    (rotation / solved, position / solved)
}

#[allow(dead_code)] // A test includes this file for what stands above.
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let trials = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(100);
    let folder = std::path::PathBuf::from(std::env::args().nth(2).unwrap_or("target/figure4".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let mut csv = String::from("method,noise,rotation_deg,position\n");
    let mut curves = Vec::new();
    println!(
        "rotation in degrees / position for a cube of side {SIDE}, mean of {trials} trials, best of {SAMPLES} samples"
    );
    println!("| | {} |", NOISE.map(|noise| format!("{:.1} %", 100.0 * noise)).join(" | "));
    println!("|---{}|", "|---".repeat(NOISE.len()));
    for (name, method, points) in METHODS {
        let errors = NOISE.map(|noise| mean_errors(method, points, noise, trials));
        println!("| {name} | {} |", errors.map(|(r, p)| format!("{r:.2} / {p:.2}")).join(" | "));
        for (noise, (rotation, position)) in NOISE.iter().zip(errors) {
            csv += &format!("\"{name}\",{noise},{rotation},{position}\n");
        }
        curves.push((name, errors));
    }
    std::fs::write(folder.join("figure4.csv"), csv)?;
    // Three planes leave the linear method without an answer; its curve would flatten all others.
    curves.retain(|(name, _)| !name.ends_with("3 planes"));
    let rotation: Vec<_> = curves.iter().map(|(name, errors)| (*name, errors.map(|e| e.0))).collect();
    let position: Vec<_> = curves.iter().map(|(name, errors)| (*name, errors.map(|e| e.1))).collect();
    draw(&folder.join("figure4_rotation.svg"), "error of the rotation, degrees", &rotation)?;
    draw(&folder.join("figure4_position.svg"), "error of the position, cube of side 100", &position)?;
    Ok(())
}

#[allow(dead_code)]
fn draw(path: &std::path::Path, title: &str, curves: &[(&str, [f64; 5])]) -> Result<(), Box<dyn std::error::Error>> {
    use plotters::prelude::*;
    let top = curves.iter().flat_map(|(_, errors)| errors).fold(0.0f64, |a, &b| a.max(b)) * 1.05;
    let root = SVGBackend::new(path, (900, 600)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d(0.0..6.5, 0.0..top)?;
    chart.configure_mesh().x_desc("noise, per cent of the side").y_desc(title).draw()?;
    for (i, (name, errors)) in curves.iter().enumerate() {
        let colour = Palette99::pick(i).to_rgba();
        let points: Vec<(f64, f64)> = NOISE.iter().zip(errors).map(|(noise, e)| (100.0 * noise, *e)).collect();
        chart.draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?;
        chart.draw_series(points.iter().map(|&at| Circle::new(at, 3, colour.filled())))?;
        let end = points[points.len() - 1];
        chart.draw_series([Text::new((*name).to_owned(), (end.0 + 0.1, end.1), ("sans-serif", 12).into_font())])?;
    }
    root.present()?;
    Ok(())
}
