use super::*;
use crate::synthetic::{Block, House};

#[test]
fn a_tetrahedron_is_closed_and_one_without_a_side_or_with_one_turned_over_is_not() {
    let closed = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    assert!(is_closed(&closed) && is_closed(&[]) && !is_closed(&closed[3..]));
    let mut turned = closed;
    turned.swap(0, 1);
    assert!(!is_closed(&turned));
}

#[test]
fn a_house_is_open_at_its_missing_floor() {
    let city = Block::new(vec![House::flat([4.0, 5.0, 6.0])]).city().unwrap();
    assert!(!is_closed(&shared_vertices(&city, city.triangles.iter()).1));
}

#[test]
fn vertices_that_triangles_share_are_written_once_and_in_their_places() {
    let city = Block::four_houses().city().unwrap();
    for facets in facets_by_object(&city, None).values() {
        let triangles: Vec<&[u32; 3]> = facets.iter().flat_map(|(_, facet)| triangles_of(&city, facet)).collect();
        let (positions, indices) = shared_vertices(&city, triangles.iter().copied());
        let used: std::collections::BTreeSet<u32> = triangles.iter().flat_map(|t| **t).collect();
        assert_eq!(positions.len(), used.len());
        for (index, corner) in indices.iter().zip(triangles.iter().flat_map(|t| **t)) {
            assert_eq!(positions[*index as usize], turned(&city.vertices[corner as usize]));
        }
    }
}

#[test]
fn every_object_is_a_node_of_its_name() {
    let city = Block::four_houses().with_ground().city().unwrap();
    let mut glb = Glb::default();
    let (node, written) = city_node(&mut glb, &city, None);
    assert_eq!(written, city.triangles.len());
    let bytes = glb.into_bytes(node.unwrap(), &serde_json::json!({})).unwrap();
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    let names: Vec<&str> = gltf.meshes().filter_map(|mesh| mesh.name()).collect();
    assert_eq!(names, city.objects.iter().map(String::as_str).collect::<Vec<_>>());
    let (_, nothing) = city_node(&mut Glb::default(), &CityModel::default(), None);
    assert_eq!(nothing, 0);
}
