use super::super::leave_out::by_building_plane;
use super::super::observations::observations;
use super::super::rows::OF_BUILDING_PLANE;
use super::super::variances::BuildingPlaneFound;
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

/// A system about the truth of four houses, and all of its unknowns as one dense system: common, then each building's, then each
/// building plane's. Its matrix, right side, and where the unknowns of each begin.
struct Dense {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    building_starts: Vec<usize>,
    plane_starts: Vec<usize>,
    /// For each cell its row over all unknowns.
    rows: Vec<DVector<f64>>,
}

fn dense(system: &System, observed: &Observations) -> Dense {
    let n = system.common;
    let building_starts: Vec<usize> = (0..observed.buildings.len()).map(|b| n + OF_BUILDING * b).collect();
    let first_plane = n + OF_BUILDING * observed.buildings.len();
    let plane_starts: Vec<usize> =
        (0..observed.building_planes.len()).map(|p| first_plane + OF_BUILDING_PLANE * p).collect();
    let size = first_plane + OF_BUILDING_PLANE * observed.building_planes.len();
    let (mut matrix, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let mut rows = vec![DVector::zeros(0); observed.cells.len()];
    let prior = system.known() + &system.start;
    matrix.view_mut((0, 0), (n, n)).copy_from(&prior);
    for (b, building) in observed.buildings.iter().enumerate() {
        let variance = system.variances.building[building.kind as usize] / system.building_weights[b];
        (0..OF_BUILDING).for_each(|k| matrix[(building_starts[b] + k, building_starts[b] + k)] += 1.0 / variance);
        for p in building.building_planes.clone() {
            let plane = &observed.building_planes[p];
            let variance = system.variances.building_plane[plane.kind as usize] / system.building_plane_weights[p];
            (0..OF_BUILDING_PLANE).for_each(|k| matrix[(plane_starts[p] + k, plane_starts[p] + k)] += 1.0 / variance);
            for cell in plane.cells.clone() {
                let short = system.rows.column(cell);
                let mut row = DVector::zeros(size);
                row.rows_mut(0, n).copy_from(&short.rows(0, n));
                row.rows_mut(building_starts[b], OF_BUILDING).copy_from(&short.rows(n + 1, OF_BUILDING));
                row.rows_mut(plane_starts[p], OF_BUILDING_PLANE)
                    .copy_from(&short.rows(n + 1 + OF_BUILDING, OF_BUILDING_PLANE));
                let weight = system.cell_weights[cell] / system.variance_of_cell(cell);
                matrix += &row * row.transpose() * weight;
                right -= &row * (weight * short[n]);
                rows[cell] = row;
            }
        }
    }
    Dense { matrix, right, building_starts, plane_starts, rows }
}

fn with_system(check: impl Fn(&System, &Observations)) {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let (refiner, pose) = (PoseRefiner::new(&scene), made.truth(&scene));
    let parameters = refiner.assess(&[], &pose, 0.0).parameters;
    let observed = observations(&refiner, &pose, scene.gate_unit_m);
    check(&System::converged(&refiner, &pose, &parameters, &observed), &observed);
}

#[test]
fn what_is_found_is_what_one_dense_system_of_all_unknowns_says() {
    with_system(|system, observed| {
        let Dense { matrix, right, .. } = dense(system, observed);
        let covariance = inverse(matrix);
        let found = &covariance * right;
        let n = system.common;
        let off = (found.rows(0, n) - &system.found).norm();
        assert!(off < 1e-7 * (1.0 + system.found.norm()), "{off}");
        let off = (covariance.view((0, 0), (n, n)) - &system.covariance).norm();
        assert!(off < 1e-7 * system.covariance.norm(), "{off}");
    });
}

#[test]
fn unknowns_of_buildings_and_planes_put_back_are_those_of_the_dense_system() {
    with_system(|system, observed| {
        let Dense { matrix, right, building_starts, plane_starts, rows } = dense(system, observed);
        let covariance = inverse(matrix);
        let found = &covariance * right;
        let n = system.common;
        assert_eq!(rows.len(), observed.cells.len());
        for (b, building) in observed.buildings.iter().enumerate() {
            let (own, joint, squared) = system.building_found(b);
            let start = building_starts[b];
            assert!((found.rows(start, OF_BUILDING) - &own).norm() < 1e-7);
            let block = covariance.view((start, start), (OF_BUILDING, OF_BUILDING));
            let expected = found.rows(start, OF_BUILDING).norm_squared() + block.trace();
            assert!((squared - expected).abs() < 1e-7 * expected, "{squared} {expected}");
            for (k, p) in building.building_planes.clone().enumerate() {
                let BuildingPlaneFound { offsets, squared, joint } = system.building_plane_found(b, k, &own, &joint);
                let start = plane_starts[p];
                assert!((found.rows(start, OF_BUILDING_PLANE) - &offsets).norm() < 1e-7);
                let block = covariance.view((start, start), (OF_BUILDING_PLANE, OF_BUILDING_PLANE));
                let expected = found.rows(start, OF_BUILDING_PLANE).norm_squared() + block.trace();
                assert!((squared - expected).abs() < 1e-6 * expected, "{squared} {expected}");
                let of_plane = BuildingPlaneFound { offsets, squared, joint };
                for cell in observed.building_planes[p].cells.clone() {
                    let (off_m, unknown) = system.residual(cell, &own, &of_plane);
                    let row = &rows[cell];
                    let expected_m = system.rows[(n, cell)] + row.dot(&found);
                    assert!((off_m - expected_m).abs() < 1e-7, "{off_m} {expected_m}");
                    let expected = row.dot(&(&covariance * row));
                    assert!((unknown - expected).abs() < 1e-6 * expected, "{unknown} {expected}");
                }
            }
        }
    });
}

#[test]
fn information_without_a_building_plane_is_that_of_the_dense_system_without_its_cells() {
    with_system(|system, observed| {
        let Dense { matrix, rows, .. } = dense(system, observed);
        let without = by_building_plane(system);
        assert_eq!(without.len(), observed.building_planes.len());
        let planes = observed.buildings.iter().flat_map(|building| building.building_planes.clone());
        for (found, p) in without.iter().zip(planes) {
            let mut left = matrix.clone();
            let pose = left.view((0, 0), (POSE, POSE)) - system.start.view((0, 0), (POSE, POSE));
            left.view_mut((0, 0), (POSE, POSE)).copy_from(&pose);
            for cell in observed.building_planes[p].cells.clone() {
                let weight = system.cell_weights[cell] / system.variance_of_cell(cell);
                left -= &rows[cell] * rows[cell].transpose() * weight;
            }
            let expected = inverse(inverse(left).view((0, 0), (POSE, POSE)).into_owned());
            assert!((found - &expected).norm() < 1e-6 * expected.norm(), "{found} {expected}");
        }
    });
}
