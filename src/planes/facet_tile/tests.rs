use super::*;
use crate::planes::PreparedCity;
use crate::robust::Random;
use crate::synthetic::Block;

/// The same by looking at every triangle of the city whose box comes as near as the gate or, where `is_beyond`, does not.
fn slowly(city: &PreparedCity, sample_point: &OrientedPoint, gate_m: f64, is_beyond: bool) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for t in (0..city.model.triangles.len() as u32).filter(|t| city.is_exposed(*t)) {
        let corners = city.corners(t);
        let [a, b, c] = &corners;
        let (low, high, p) = (a.inf(b).inf(c), a.sup(b).sup(c), &sample_point.position);
        if (0..3).all(|k| p[k] > low[k] - gate_m && p[k] < high[k] + gate_m) == is_beyond {
            continue;
        }
        let triangle = TileTriangle::new(t, &corners, city, city.facet_of(t)).unwrap();
        let Some(hit) = triangle.hit(sample_point) else { continue };
        if hit.distance_sq() < best.as_ref().map_or(gate_m * gate_m, Hit::distance_sq) {
            best = Some(hit);
        }
    }
    best
}

#[test]
fn agrees_to_the_bit_with_looking_at_every_triangle() {
    let city = PreparedCity::new(Block::town(2, 2, 5).with_ground().city().unwrap());
    let (low, high) = city.model.bounds().unwrap();
    let mut random = Random::stream(5, 0);
    let normals: Vec<Vector3<f64>> = city.model.facets.iter().map(|facet| facet.plane.normal).collect();
    let (mut found, mut beyond) = (0, 0);
    for reach_m in [0.3, 1.5, 6.0] {
        let grid = city.grid(reach_m);
        for _ in 0..3000 {
            let position = low + (high - low).map(|extent| extent * (1.4 * random.unit() - 0.2));
            let off = Vector3::from_fn(|_, _| random.unit() - 0.5);
            let normal = (normals[random.below(normals.len())] + 0.6 * off).normalize();
            let (sided, min_cos) = (random.unit() < 0.5, [0.95, 0.9063, 0.12][random.below(3)]);
            let sample_point = OrientedPoint { position, normal, sided, min_cos };
            let gate_m = reach_m * random.unit();
            let told = |hit: &Option<Hit>| {
                hit.map(|h| (h.distance_sq().to_bits(), h.plane, h.across_m.to_bits(), h.outside_m.to_bits()))
            };
            let fast = city.nearest(&grid, &sample_point, gate_m);
            // Beyond a sharp corner a triangle seems nearer than it is.
            let is_seeming = told(&fast) != told(&slowly(&city, &sample_point, gate_m, false));
            if is_seeming {
                assert_eq!(told(&fast), told(&slowly(&city, &sample_point, gate_m, true)), "{sample_point:?} {gate_m}");
            }
            beyond += usize::from(is_seeming);
            found += usize::from(fast.is_some());
        }
    }
    assert!(found > 200 && beyond < found / 15, "{found} {beyond}");
}
