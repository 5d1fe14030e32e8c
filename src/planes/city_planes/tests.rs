use super::*;

#[test]
fn every_facet_is_in_the_plane_that_names_it_and_lies_within_its_tolerance() {
    let city = crate::synthetic::Block::town(2, 2, 7).with_ground().in_triangles().city().unwrap();
    let found = city_planes(&city);
    assert_eq!(found.plane_of_facet.len(), city.facets.len());
    let mut listed = 0;
    for (number, plane) in (0..).zip(&found.planes) {
        for facet in &plane.facets {
            assert_eq!(found.of_facet(*facet), PlaneId(number));
            let of = &city.facets[facet.0 as usize];
            assert_eq!(of.object, plane.object);
            for corner in &of.outline {
                let x = &city.vertices[*corner as usize];
                assert!(plane.plane.signed_distance(x).abs() <= OFFSET_TOLERANCE_M + 1e-9);
                assert!((0..3).all(|k| plane.low[k] <= x[k] && x[k] <= plane.high[k]));
            }
        }
        let area: f64 = plane.facets.iter().map(|f| city.facets[f.0 as usize].area).sum();
        assert!((area - plane.area_m2).abs() < 1e-9 * area);
        listed += plane.facets.len();
    }
    assert_eq!(listed, city.facets.len());
}

#[test]
fn surfaces_cut_into_other_facets_have_the_same_planes() {
    let block = crate::synthetic::Block::mixed_houses();
    let areas = |block: &crate::synthetic::Block| {
        let mut areas: Vec<f64> = city_planes(&block.city().unwrap()).planes.iter().map(|p| p.area_m2).collect();
        areas.sort_by(f64::total_cmp);
        areas
    };
    let whole = areas(&block);
    for other in [block.in_triangles(), block.in_halves()] {
        let other = areas(&other);
        assert_eq!(other.len(), whole.len());
        assert!(whole.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}
