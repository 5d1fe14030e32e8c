use super::*;

#[test]
fn pieces_of_one_value_that_do_not_touch_become_cells_of_their_own() {
    let cells = connected(&[7, 7, 3, 3, 7, 3, 7, 7, 3], 3, 3);
    assert_eq!((cells.count, cells.of_pixel), (3, vec![0, 0, 1, 2, 0, 1, 0, 0, 1]));
}

#[test]
fn a_cell_ends_where_the_colour_does() {
    let photo = image::RgbImage::from_fn(60, 40, |x, _| image::Rgb(if x < 27 { [200, 40, 40] } else { [40, 60, 200] }));
    let image = LabImage::of(&photo);
    let cells = slic(&image);
    for (i, cell) in cells.of_pixel.iter().enumerate().filter(|(i, _)| i % 60 < 26) {
        let other_side = i / 60 * 60 + 28;
        assert_ne!(*cell, cells.of_pixel[other_side]);
    }
}

#[test]
fn pieces_are_those_of_a_flood_and_numbered_as_they_come() {
    let (width, height) = (37, 29);
    let mut random = crate::robust::Random::stream(4, 0);
    for kinds in [2, 3, 6] {
        let values: Vec<u32> = (0..width * height).map(|_| random.below(kinds) as u32).collect();
        let cells = connected(&values, width, height);
        let mut flooded = vec![usize::MAX; values.len()];
        let mut count = 0;
        for first in 0..values.len() {
            if flooded[first] != usize::MAX {
                continue;
            }
            let mut open = vec![first];
            while let Some(at) = open.pop() {
                if flooded[at] != usize::MAX || values[at] != values[first] {
                    continue;
                }
                flooded[at] = count;
                let (x, y) = (at % width, at / width);
                open.extend((x > 0).then(|| at - 1).into_iter().chain((x + 1 < width).then_some(at + 1)));
                open.extend((y > 0).then(|| at - width).into_iter().chain((y + 1 < height).then_some(at + width)));
            }
            count += 1;
        }
        assert_eq!(cells.count, count);
        assert!(cells.of_pixel.iter().zip(flooded).all(|(a, b)| *a as usize == b));
    }
}

/// A photograph of blotches.
fn blotches(width: u32, height: u32) -> LabImage {
    LabImage::of(&image::RgbImage::from_fn(width, height, |x, y| {
        let tone = |k: u32| ((x / 17 * 7 + y / 13 * k + (x * y) % 5) * 29 % 200) as u8;
        image::Rgb([tone(3), tone(5), tone(11)])
    }))
}

#[test]
fn every_pixel_is_in_one_cell_and_cells_hang_together() {
    for (width, height) in [(97, 61), (10, 10), (33, 200)] {
        let image = blotches(width, height);
        let cells = slic(&image);
        assert_eq!(cells.of_pixel.len(), image.width * image.height);
        let again = connected(&cells.of_pixel, image.width, image.height);
        assert_eq!((again.count, again.of_pixel), (cells.count, cells.of_pixel.clone()), "no cell is in two pieces");
        let mut met = vec![false; cells.count];
        cells.of_pixel.iter().for_each(|cell| met[*cell as usize] = true);
        assert!(met.iter().all(|met| *met), "no number is left out");
    }
}

#[test]
fn a_cell_is_no_larger_than_its_window() {
    let image = blotches(120, 90);
    let cells = slic(&image);
    let mut boxes = vec![[usize::MAX, 0, usize::MAX, 0]; cells.count];
    for (at, cell) in cells.of_pixel.iter().enumerate() {
        let (x, y, bounds) = (at % image.width, at / image.width, &mut boxes[*cell as usize]);
        *bounds = [bounds[0].min(x), bounds[1].max(x), bounds[2].min(y), bounds[3].max(y)];
    }
    let most = 2 * CELL_PX as usize + LANES + 1;
    assert!(boxes.iter().all(|[left, right, top, bottom]| right - left <= most && bottom - top <= most));
}

#[test]
fn an_even_photograph_is_cut_into_even_cells() {
    let image = LabImage::of(&image::RgbImage::from_pixel(100, 80, image::Rgb([90, 120, 60])));
    let cells = slic(&image);
    assert_eq!(cells.count, 80);
    let mut sizes = vec![0; cells.count];
    cells.of_pixel.iter().for_each(|cell| sizes[*cell as usize] += 1);
    assert!(sizes.iter().all(|size| (60..=150).contains(size)), "{sizes:?}");
}

#[test]
fn the_nearest_centre_is_the_one_that_a_look_at_every_centre_finds() {
    let image = blotches(64, 48);
    let centers = seeds(&image);
    let count = image.width * image.height;
    let (mut least, mut nearest) = (vec![f32::INFINITY; count], vec![0; count]);
    assign(&image, &centers, &mut least, &mut nearest);
    let per_px = (COMPACTNESS / CELL_PX).powi(2);
    for at in 0..count {
        let (x, y, colour) = ((at % image.width) as f32, (at / image.width) as f32, image.pixel(at));
        let off = |center: &Center| {
            let colours: f32 = (0..3).map(|k| (colour[k] - center.colour[k]).powi(2)).sum();
            colours + per_px * ((x - center.x).powi(2) + (y - center.y).powi(2))
        };
        let inside = |center: &&Center| (x - center.x).abs() < CELL_PX && (y - center.y).abs() < CELL_PX;
        let best = centers.iter().filter(inside).map(off).fold(f32::INFINITY, f32::min);
        let found = off(&centers[nearest[at] as usize]);
        assert!(found <= best * (1.0 + 1e-4) + 1e-3, "pixel {at}: {found} {best}");
    }
}
