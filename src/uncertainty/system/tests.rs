use super::super::observations::observations;
use super::super::rows::OF_BUILDING_PLANE;
use super::*;
use crate::correspondence::test_scene::Made;
use crate::robust::Motion;
use crate::synthetic::Offset;

#[test]
fn the_information_is_that_of_least_squares_with_the_dense_covariance() {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let (refiner, pose) = (PoseRefiner::new(&scene), made.truth(&scene));
    let parameters = refiner.assess(&[], &pose, 0.0).parameters;
    let observed = observations(&refiner, &pose, scene.gate_unit_m);
    let system = System::converged(&refiner, &pose, &parameters, &observed);
    let (n, count) = (system.common, observed.cells.len());
    let mut covariance = DMatrix::zeros(count, count);
    let known = system.known();
    let mut share = |cells: &std::ops::Range<usize>, column: usize, variance: f64| {
        for i in cells.clone() {
            for j in cells.clone() {
                covariance[(i, j)] += system.rows[(column, i)] * system.rows[(column, j)] * variance;
            }
        }
    };
    (POSE..n).for_each(|k| share(&(0..count), k, 1.0 / known[(k, k)]));
    for (b, building) in observed.buildings.iter().enumerate() {
        let building_planes = &observed.building_planes[building.building_planes.clone()];
        let cells = building_planes[0].cells.start..building_planes[building_planes.len() - 1].cells.end;
        let variance = system.variances.building[building.kind as usize] / system.building_weights[b];
        (0..OF_BUILDING).for_each(|k| share(&cells, n + 1 + k, variance));
        for f in building.building_planes.clone() {
            let building_plane = &observed.building_planes[f];
            let variance =
                system.variances.building_plane[building_plane.kind as usize] / system.building_plane_weights[f];
            (0..OF_BUILDING_PLANE).for_each(|k| share(&building_plane.cells, n + 1 + OF_BUILDING + k, variance));
        }
    }
    for i in 0..count {
        covariance[(i, i)] += system.variance_of_cell(i) / system.cell_weights[i];
    }
    let pose_rows = system.rows.rows(0, POSE).transpose();
    let expected = pose_rows.transpose() * inverse(covariance) * &pose_rows;
    let found = system.held().full();
    assert!((found - &expected).norm() < 1e-6 * expected.norm(), "{found} {expected}");
}
