//! The contact-sensor experiment of the paper's section 5: a probe touches a known solid, and its pose follows.
//!
//! 100 noisy contacts on four faces of an icosahedron, in the probe's own frame and unsorted. Planes fitted to the contacts sort
//! them into clusters; a maximum clique finds faces at the same angles as the clusters; a minimal solver and a polish on
//! all contacts give the pose. An icosahedron looks the same in 60 poses and angles do not tell a solid from its mirror
//! image: all largest cliques are tried, and the error is taken over the solid's symmetries.
//!
//! `cargo run --release --example contact_sensor [SEED]`

use cityweld::internals::Graph;
use cityweld::solvers::scene::{Random, angle_between_rad, pose};
use cityweld::solvers::{Row, Sought, refine, solve_minimal};
use cityweld::{Matrix3, Rotation3, Similarity, Vector3};

/// Edge of the solid: some 100 mm.
const EDGE_MM: f64 = 100.0;
/// Standard deviation of a contact, each coordinate.
pub const NOISE_MM: f64 = 0.5;
const CONTACTS_ON_EACH_FACE: usize = 25;
const FACES: usize = 4;
/// Contacts within this distance of a plane belong to it: four sigmas.
const BAND_MM: f64 = 4.0 * NOISE_MM;
/// Cosines of cluster normals and face normals agree within this: a cluster's normal is good to about half a degree.
const COSINE: f64 = 0.05;
const PLANE_TRIALS: usize = 2000;
const REFITS: usize = 5;
const CLIQUE_BUDGET: usize = 1_000_000;

/// A face's plane, in the solid's frame, with its corners.
pub struct Face {
    normal: Vector3<f64>,
    offset: f64,
    corners: [Vector3<f64>; 3],
}

pub struct Outcome {
    pub clusters: usize,
    pub clique: usize,
    pub error_deg: f64,
    pub error_mm: f64,
    pub rms_mm: f64,
}

/// Twelve corners (0, +-1, +-golden ratio) and their cyclic changes; faces are the triples at edge length 2.
pub fn icosahedron() -> Vec<Face> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut corners = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-golden, golden] {
            corners.extend([Vector3::new(0.0, a, b), Vector3::new(a, b, 0.0), Vector3::new(b, 0.0, a)]);
        }
    }
    let joined = |a: usize, b: usize| ((corners[a] - corners[b]).norm() - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in 0..i {
            for k in 0..j {
                if joined(i, j) && joined(j, k) && joined(i, k) {
                    let corners = [i, j, k].map(|c| corners[c] * (0.5 * EDGE_MM));
                    let normal = (corners[0] + corners[1] + corners[2]).normalize();
                    faces.push(Face { normal, offset: -normal.dot(&corners[0]), corners });
                }
            }
        }
    }
    faces
}

/// The whole experiment; `None` where the contacts could not be sorted.
pub fn run(seed: u64) -> Option<Outcome> {
    let mut random = Random::stream(seed, 0);
    let faces = icosahedron();
    let truth = pose(&mut random, &Sought::Rigid);
    let contacts = contacts(&mut random, &faces, &truth);
    let clusters = clusters(&mut random, &contacts);
    let cliques = matchings(&clusters, &faces);
    let mut best: Vec<(f64, Similarity)> = cliques
        .iter()
        .filter_map(|clique| {
            let pose = solve(&clusters, &faces, clique)?;
            Some((rms(&clusters, &faces, clique, &pose), pose))
        })
        .collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (rms_mm, found) = *best.first()?;
    let (error_deg, error_mm) = error(&faces, &found, &truth);
    Some(Outcome { clusters: clusters.len(), clique: cliques.first()?.len(), error_deg, error_mm, rms_mm })
}

/// Noisy contacts, uniform on four random faces, in the probe's frame.
fn contacts(random: &mut Random, faces: &[Face], object_from_sensor: &Similarity) -> Vec<Vector3<f64>> {
    let mut order: Vec<(f64, usize)>;
    // Two pairs of opposite faces have their normals in one plane, and no contacts on them determine a pose.
    while {
        order = (0..faces.len()).map(|i| (random.unit(), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let drawn: Vec<usize> = order[..FACES].iter().map(|entry| entry.1).collect();
        widest(&drawn, faces).0 < 0.1
    } {}
    let sensor_from_object = object_from_sensor.inverse();
    let mut contacts = Vec::new();
    for &(_, face) in &order[..FACES] {
        let [a, b, c] = faces[face].corners;
        for _ in 0..CONTACTS_ON_EACH_FACE {
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let x = a + (b - a) * u + (c - a) * v + random.normal_vector() * NOISE_MM;
            contacts.push((random.unit(), sensor_from_object.apply(&x.into()).coords));
        }
    }
    // Unsorted, as a probe that goes round would deliver them.
    contacts.sort_by(|a, b| a.0.total_cmp(&b.0));
    contacts.into_iter().map(|contact| contact.1).collect()
}

/// Contacts of one plane, and its normal out of the solid.
pub struct Cluster {
    points: Vec<Vector3<f64>>,
    normal: Vector3<f64>,
}

/// The plane with most contacts again and again, from random triples.
fn clusters(random: &mut Random, contacts: &[Vector3<f64>]) -> Vec<Cluster> {
    let mut found = planes(random, contacts);
    // The first planes have taken contacts of their neighbours near common edges: every contact goes to its nearest plane.
    for _ in 0..REFITS {
        let distance = |plane: &(Vector3<f64>, Vector3<f64>), x: &Vector3<f64>| plane.1.dot(&(x - plane.0)).abs();
        let nearest = |x: &Vector3<f64>| {
            (0..found.len()).min_by(|&a, &b| distance(&found[a], x).total_cmp(&distance(&found[b], x)))
        };
        let owner: Vec<Option<usize>> = contacts.iter().map(nearest).collect();
        let members = |plane| (0..contacts.len()).filter(|&i| owner[i] == Some(plane)).collect::<Vec<_>>();
        found = (0..found.len()).map(|plane| fitted(contacts, &members(plane))).collect();
    }
    let mean = contacts.iter().sum::<Vector3<f64>>() / contacts.len() as f64;
    let cluster = |(centre, normal): &(Vector3<f64>, Vector3<f64>)| {
        // The probe is outside: the contacts of all faces together lie behind each of them.
        let normal = if normal.dot(&(centre - mean)) < 0.0 { -*normal } else { *normal };
        let on = |x: &&Vector3<f64>| normal.dot(&(**x - centre)).abs() < BAND_MM;
        Cluster { points: contacts.iter().filter(on).copied().collect(), normal }
    };
    found.iter().map(cluster).collect()
}

/// Centres and normals of planes with many contacts.
fn planes(random: &mut Random, contacts: &[Vector3<f64>]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let mut left = contacts.to_vec();
    let mut found = Vec::new();
    while left.len() >= CONTACTS_ON_EACH_FACE / 2 && found.len() < FACES {
        let mut best: Vec<usize> = Vec::new();
        for _ in 0..PLANE_TRIALS {
            let [a, b, c] = [0; 3].map(|_| left[(random.unit() * left.len() as f64) as usize]);
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(EDGE_MM) else { continue };
            let on: Vec<usize> = (0..left.len()).filter(|&i| normal.dot(&(left[i] - a)).abs() < BAND_MM).collect();
            if on.len() > best.len() {
                best = on;
            }
        }
        if best.len() < CONTACTS_ON_EACH_FACE / 2 {
            break;
        }
        let (mut centre, mut normal) = fitted(&left, &best);
        // A plane through three noisy contacts is slanted: fit and collect again.
        for _ in 0..REFITS {
            best = (0..left.len()).filter(|&i| normal.dot(&(left[i] - centre)).abs() < BAND_MM).collect();
            (centre, normal) = fitted(&left, &best);
        }
        found.push((centre, normal));
        let mut index = 0;
        left.retain(|_| {
            index += 1;
            !best.contains(&(index - 1))
        });
    }
    found
}

/// Centre and normal of the plane nearest to some contacts.
fn fitted(contacts: &[Vector3<f64>], members: &[usize]) -> (Vector3<f64>, Vector3<f64>) {
    let centre = members.iter().map(|&i| contacts[i]).sum::<Vector3<f64>>() / members.len() as f64;
    let outer = |i: &usize| (contacts[*i] - centre) * (contacts[*i] - centre).transpose();
    let eigen = members.iter().map(outer).sum::<Matrix3<f64>>().symmetric_eigen();
    (centre, eigen.eigenvectors.column(eigen.eigenvalues.imin()).into())
}

/// Largest sets of (cluster, face) pairs at equal angles.
fn matchings(clusters: &[Cluster], faces: &[Face]) -> Vec<Vec<usize>> {
    let mut graph = Graph::new(clusters.len() * faces.len());
    for a in 0..clusters.len() * faces.len() {
        for b in 0..a {
            let (ca, cb) = (&clusters[a / faces.len()], &clusters[b / faces.len()]);
            let (fa, fb) = (&faces[a % faces.len()], &faces[b % faces.len()]);
            let different = a / faces.len() != b / faces.len() && a % faces.len() != b % faces.len();
            if different && (ca.normal.dot(&cb.normal) - fa.normal.dot(&fb.normal)).abs() < COSINE {
                graph.join(a, b);
            }
        }
    }
    graph.largest_cliques(CLIQUE_BUDGET).cliques
}

fn rows(clusters: &[Cluster], faces: &[Face], clique: &[usize]) -> Vec<Row> {
    let mut rows = Vec::new();
    for &pair in clique {
        let (cluster, face) = (&clusters[pair / faces.len()], &faces[pair % faces.len()]);
        rows.extend(cluster.points.iter().map(|&point| Row { point, normal: face.normal, offset: face.offset }));
    }
    rows
}

/// The three of some faces whose normals span the largest volume, with that volume.
fn widest(pairs: &[usize], faces: &[Face]) -> (f64, [usize; 3]) {
    let mut best = (0.0, [0; 3]);
    for i in 0..pairs.len() {
        for j in 0..i {
            for k in 0..j {
                let three = [pairs[i], pairs[j], pairs[k]];
                let [a, b, c] = three.map(|pair| faces[pair % faces.len()].normal);
                let volume = a.cross(&b).dot(&c).abs();
                if volume > best.0 {
                    best = (volume, three);
                }
            }
        }
    }
    best
}

/// Three distant contacts on each of three clusters give the start, all contacts the pose.
fn solve(clusters: &[Cluster], faces: &[Face], clique: &[usize]) -> Option<Similarity> {
    let all = rows(clusters, faces, clique);
    let mut sample = Vec::new();
    for pair in widest(clique, faces).1 {
        let of_pair = rows(clusters, faces, &[pair]);
        let first = of_pair[0];
        let far = |from: &[Row]| {
            let reach = |row: &Row| from.iter().map(|f| (row.point - f.point).norm()).fold(f64::INFINITY, f64::min);
            of_pair.iter().copied().max_by(|a, b| reach(a).total_cmp(&reach(b)))
        };
        let second = far(&[first])?;
        sample.extend([first, second, far(&[first, second])?]);
    }
    let starts = solve_minimal(&Sought::Rigid, &[3, 3, 3], &sample);
    // The probe touches from outside: a pose that turns a face inside out fits its plane, not the face.
    let outside = |start: &&Similarity| {
        clique.iter().all(|pair| {
            let (cluster, face) = (&clusters[pair / faces.len()], &faces[pair % faces.len()]);
            (start.rotation * cluster.normal).dot(&face.normal) > 0.0
        })
    };
    let refined = starts.iter().filter(outside).filter_map(|start| refine(&Sought::Rigid, &all, start));
    refined.min_by(|a, b| rms(clusters, faces, clique, a).total_cmp(&rms(clusters, faces, clique, b)))
}

fn rms(clusters: &[Cluster], faces: &[Face], clique: &[usize], pose: &Similarity) -> f64 {
    let rows = rows(clusters, faces, clique);
    let square = |row: &Row| (row.normal.dot(&pose.apply(&row.point.into()).coords) + row.offset).powi(2);
    (rows.iter().map(square).sum::<f64>() / rows.len() as f64).sqrt()
}

/// Smallest error over the rotations that map the solid onto itself: degrees, and millimetres at the solid's centre.
fn error(faces: &[Face], found: &Similarity, truth: &Similarity) -> (f64, f64) {
    let centre = truth.inverse().translation;
    let mut best = f64::INFINITY;
    let adjacent = faces[0].normal.dot(&neighbour(faces, 0).normal);
    for a in faces {
        for b in faces.iter().filter(|b| (a.normal.dot(&b.normal) - adjacent).abs() < 1e-9) {
            let frame = |a: &Vector3<f64>, b: &Vector3<f64>| {
                let z = a.cross(b).normalize();
                Matrix3::from_columns(&[*a, z.cross(a), z])
            };
            let symmetry =
                frame(&a.normal, &b.normal) * frame(&faces[0].normal, &neighbour(faces, 0).normal).transpose();
            let turned = Rotation3::from_matrix_unchecked(symmetry) * truth.rotation;
            best = best.min(angle_between_rad(&turned, &found.rotation).to_degrees());
        }
    }
    (best, found.apply(&centre.into()).coords.norm())
}

fn neighbour(faces: &[Face], of: usize) -> &Face {
    let others = faces.iter().enumerate().filter(|(i, _)| *i != of).map(|(_, face)| face);
    let nearest = others.max_by(|a, b| a.normal.dot(&faces[of].normal).total_cmp(&b.normal.dot(&faces[of].normal)));
    nearest.unwrap_or(&faces[of])
}

#[allow(dead_code)] // A test includes this file for what stands above.
fn main() {
    let seed = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(0);
    match run(seed) {
        None => println!("the contacts could not be sorted"),
        Some(outcome) => println!(
            "{} contacts with {NOISE_MM} mm noise: {} clusters, {} matched; error {:.2} deg, {:.2} mm at the centre; rms {:.2} mm",
            FACES * CONTACTS_ON_EACH_FACE,
            outcome.clusters,
            outcome.clique,
            outcome.error_deg,
            outcome.error_mm,
            outcome.rms_mm
        ),
    }
}
