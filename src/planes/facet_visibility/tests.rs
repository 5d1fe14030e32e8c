use super::*;

#[test]
fn of_houses_that_stand_free_every_face_but_the_floor_is_seen_and_of_nested_ones_nothing() {
    let limits = crate::limits::Limits::default().facet_visibility;
    let of = |houses: Vec<crate::synthetic::House>| {
        let surface = CitySurface::new(crate::synthetic::Block::new(houses).city().unwrap());
        let visibility = FacetVisibility::new(&surface, &limits);
        let seen: Vec<(u32, bool)> =
            (0..surface.model.triangles.len() as u32).map(|t| (t, visibility.of(t, &surface))).collect();
        // Asked once more, the answer is the same.
        assert!(seen.iter().all(|(t, answer)| visibility.of(*t, &surface) == *answer));
        let object = |t: u32| surface.model.facets[surface.facet_of(t).0 as usize].object.0;
        let normal_z = |t: u32| surface.normal_of(t).z;
        seen.into_iter().map(|(t, answer)| (object(t), normal_z(t), answer)).collect::<Vec<_>>()
    };
    let house = || crate::synthetic::House::flat([10.0, 8.0, 6.0]);
    let free = of(vec![house(), house().at([40.0, 0.0, 0.0])]);
    assert!(free.iter().filter(|(_, z, _)| *z > -0.5).all(|(_, _, seen)| *seen));
    let inner = crate::synthetic::House::flat([4.0, 3.0, 2.0]).at([3.0, 2.5, 2.0]);
    let nested = of(vec![house(), inner]);
    assert!(nested.iter().filter(|(object, _, _)| *object == 1).all(|(_, _, seen)| !seen), "{nested:?}");
    assert!(nested.iter().filter(|(object, z, _)| *object == 0 && *z > -0.5).all(|(_, _, seen)| *seen));
}

#[test]
fn the_fan_looks_outwards_in_unit_directions() {
    let mut random = crate::random::Random::stream(84, 0);
    for _ in 0..100 {
        let normal = random.direction();
        for direction in fan(&normal) {
            assert!((direction.norm() - 1.0).abs() < 1e-12 && direction.dot(&normal) > 0.57);
        }
    }
}

#[test]
fn a_majority_is_more_than_half() {
    for count in 1..8usize {
        for yes in 0..=count {
            let answers = (0..count).map(|k| k < yes);
            assert_eq!(most(answers, count), 2 * yes > count, "{yes} of {count}");
            assert_eq!(most((0..count).map(|k| k >= count - yes), count), 2 * yes > count);
        }
    }
}

#[test]
fn places_lie_on_the_triangle() {
    let corners = [Point3::new(0.0, 0.0, 0.0), Point3::new(9.0, 0.0, 0.0), Point3::new(0.0, 7.0, 3.0)];
    for (large_m2, count) in [(1e9, 1), (1.0, 3)] {
        let places = places(&corners, large_m2);
        assert_eq!(places.len(), count);
        for x in places {
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            assert!(normal.dot(&(x - corners[0])).abs() < 1e-9);
            for k in 0..3 {
                let edge = corners[(k + 1) % 3] - corners[k];
                assert!(normal.dot(&edge.cross(&(x - corners[k]))) > 0.0);
            }
        }
    }
}
