use std::io::Cursor;

use las::point::{Classification, Format};
use las::{Builder, Color, Point, Writer};

use super::*;

/// A LAS file (or LAZ) of some points; formats from 6 on keep classes in a byte of their own.
fn file(format: u8, is_compressed: bool, points: &[Point]) -> tempfile::NamedTempFile {
    let mut builder = Builder::from((1, 4));
    builder.point_format = Format::new(format).unwrap();
    builder.point_format.is_compressed = is_compressed;
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    points.iter().for_each(|point| writer.write_point(point.clone()).unwrap());
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), writer.into_inner().unwrap().into_inner()).unwrap();
    file
}

fn point(x: f64, class: Classification) -> Point {
    let color = Some(Color::new(65535, 256, 0));
    Point { x, y: 2.0, z: 3.0, classification: class, intensity: 700, color, gps_time: Some(0.25), ..Point::default() }
}

fn value(cloud: &LasCloud, name: &str, point: usize) -> Option<f64> {
    cloud.fields.iter().find(|field| field.name == name)?.value(point)
}

#[test]
fn points_colours_and_further_values_are_read_from_both_packings() {
    let points = [point(1.0, Classification::Building), point(-4.0, Classification::HighVegetation)];
    for format in [3, 7] {
        for is_compressed in [false, true] {
            let cloud = read_las(file(format, is_compressed, &points).path(), None).unwrap();
            assert_eq!(cloud.positions, [[1.0, 2.0, 3.0], [-4.0, 2.0, 3.0]]);
            assert_eq!((cloud.colors.as_slice(), cloud.is_compressed), ([[255, 1, 0]; 2].as_slice(), is_compressed));
            assert_eq!(
                (value(&cloud, "classification", 0), value(&cloud, "classification", 1)),
                (Some(6.0), Some(5.0))
            );
            let is_layered = is_compressed && format == 7;
            let time = Some(0.25).filter(|_| !is_layered);
            assert_eq!((value(&cloud, "intensity", 1), value(&cloud, "gps_time", 0)), (Some(700.0), time));
            assert_eq!(cloud.times_left_out, is_layered);
            assert_eq!(value(&cloud, "point_source_id", 0), None, "zeros say nothing");
        }
    }
}

#[test]
fn noise_and_withheld_points_are_left_out_with_all_their_values() {
    let withheld = Point { is_withheld: true, ..point(9.0, Classification::Ground) };
    for (format, high_noise) in [(3, Classification::new(18).unwrap()), (7, Classification::HighNoise)] {
        let points = [
            point(1.0, Classification::LowPoint),
            point(2.0, high_noise),
            withheld.clone(),
            point(4.0, Classification::Ground),
        ];
        let cloud = read_las(file(format, false, &points).path(), None).unwrap();
        assert_eq!((cloud.positions.as_slice(), cloud.noise), ([[4.0, 2.0, 3.0]].as_slice(), 3));
        assert_eq!((cloud.colors.len(), value(&cloud, "classification", 0)), (1, Some(2.0)));
        assert_eq!(value(&cloud, "classification", 1), None);
    }
}

#[test]
fn colours_of_eight_bits_are_taken_as_they_are() {
    let eight_bits = Point { color: Some(Color::new(200, 100, 7)), ..point(1.0, Classification::Ground) };
    assert_eq!(read_las(file(3, false, &[eight_bits]).path(), None).unwrap().colors, [[200, 100, 7]]);
}

#[test]
fn more_points_than_a_piece_stand_in_their_order() {
    let points: Vec<Point> = (0..POINTS_AT_ONCE + 3).map(|i| point(i as f64 / 8.0, Classification::Ground)).collect();
    let cloud = read_las(file(3, false, &points).path(), None).unwrap();
    let is_in_order = cloud.positions.iter().zip(&points).all(|(place, point)| (place[0] - point.x).abs() < 2e-3);
    assert!(cloud.positions.len() == points.len() && is_in_order);
    // So regular a cloud packs into less than a real one ever does.
    assert!(read_las(file(3, true, &points).path(), None).unwrap_err().to_string().contains("at most"));
}

fn changed(bytes: &[u8], at: usize, value: &[u8]) -> tempfile::NamedTempFile {
    let mut bytes = bytes.to_vec();
    bytes[at..at + value.len()].copy_from_slice(value);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    file
}

/// The number of points of a file of version 1.4, and of earlier ones; where the points begin; the number of records.
const COUNT_AT: usize = 247;
const EARLIER_COUNT_AT: usize = 107;
const POINTS_AT: usize = 96;
const RECORDS_AT: usize = 100;

#[test]
fn headers_that_lie_are_refused_before_memory_is_taken() {
    for is_compressed in [false, true] {
        let file = file(3, is_compressed, &[point(1.0, Classification::Ground), point(2.0, Classification::Ground)]);
        let bytes = std::fs::read(file.path()).unwrap();
        for (at, value, words) in [
            (COUNT_AT, 4_000_000_000u64.to_le_bytes().as_slice(), "points, of which at most"),
            (POINTS_AT, &u32::MAX.to_le_bytes(), "points begin at byte"),
            (RECORDS_AT, &u32::MAX.to_le_bytes(), "records cannot lie"),
        ] {
            let mut lying = bytes.clone();
            // Both counts, as a reader may take either.
            if at == COUNT_AT {
                lying[EARLIER_COUNT_AT..EARLIER_COUNT_AT + 4].copy_from_slice(&u32::MAX.to_le_bytes());
            }
            let message = read_las(changed(&lying, at, value).path(), None).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}

const HEADER_BYTES_AT: usize = 94;
/// Where the header of version 1.4 says where records behind the points begin; the number of those follows.
const RECORDS_BEHIND_AT: usize = 235;

#[test]
fn records_behind_the_points_that_lie_about_their_length_are_refused() {
    let mut bytes = std::fs::read(file(7, false, &[point(1.0, Classification::Ground)]).path()).unwrap();
    let end = bytes.len() as u64;
    let mut record = [0; 60 + 5];
    record[20..28].copy_from_slice(&5u64.to_le_bytes());
    bytes.extend(record);
    bytes[RECORDS_BEHIND_AT..RECORDS_BEHIND_AT + 8].copy_from_slice(&end.to_le_bytes());
    let with = |count: u32| changed(&bytes, RECORDS_BEHIND_AT + 8, &count.to_le_bytes());
    assert_eq!(read_las(with(1).path(), None).unwrap().positions.len(), 1);
    let message = read_las(with(2).path(), None).unwrap_err().to_string();
    assert!(message.contains("record 2 of 2 behind the points"), "{message}");
    for length in [6, 1 << 37, u64::MAX] {
        bytes[end as usize + 20..end as usize + 28].copy_from_slice(&u64::to_le_bytes(length));
        bytes[RECORDS_BEHIND_AT + 8] = 1;
        // The second says that its header is one of 1.2.
        for header_bytes in [375u16, 227] {
            let lying = changed(&bytes, HEADER_BYTES_AT, &header_bytes.to_le_bytes());
            let message = read_las(lying.path(), None).unwrap_err().to_string();
            assert!(message.contains("record 1 of 1 behind the points") && message.contains("beyond"), "{message}");
        }
    }
}

#[test]
fn packed_points_that_lie_about_their_chunks_are_refused_before_memory_is_taken() {
    for format in [3, 7] {
        let bytes = std::fs::read(file(format, true, &[point(1.0, Classification::Ground)]).path()).unwrap();
        let u32_at = |at: usize| u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
        let points_at = u32_at(POINTS_AT);
        let count_at = u32_at(points_at) + 4;
        assert_eq!(u32_at(count_at), 1);
        let message =
            read_las(changed(&bytes, count_at, &u32::MAX.to_le_bytes()).path(), None).unwrap_err().to_string();
        assert!(message.contains("chunks of packed points, of which at most"), "{message}");
        if format == 7 {
            // Behind the offset of the table and the first point, with its colour, and the number of points.
            let first_layer = points_at + 8 + 36 + 4;
            let lying = changed(&bytes, first_layer, &0xF000_0000u32.to_le_bytes());
            let message = read_las(lying.path(), None).unwrap_err().to_string();
            assert!(message.contains("chunk 1 of 1, at byte") && message.contains("beyond the file's"), "{message}");
            // The table lies beyond the file; the crate would begin to unpack there.
            let message = read_las(changed(&bytes, points_at, &[0xFF; 4]).path(), None).unwrap_err().to_string();
            assert!(message.contains("the table of the packed chunks cannot be read"), "{message}");
        }
    }
}

#[test]
fn cut_and_changed_files_never_panic() {
    for (format, is_compressed) in [(3, false), (3, true), (7, true)] {
        let points: Vec<Point> = (0..40).map(|i| point(f64::from(i), Classification::Ground)).collect();
        let bytes = std::fs::read(file(format, is_compressed, &points).path()).unwrap();
        let target = tempfile::NamedTempFile::new().unwrap();
        for at in (0..bytes.len()).step_by(3) {
            std::fs::write(target.path(), &bytes[..at]).unwrap();
            assert!(read_las(target.path(), None).is_err(), "cut at {at}");
            for value in [0, 0xFF, bytes[at] ^ 0x10] {
                std::fs::write(target.path(), std::fs::read(changed(&bytes, at, &[value]).path()).unwrap()).unwrap();
                if let Ok(cloud) = read_las(target.path(), None) {
                    assert!(cloud.positions.len() < 1 << 17);
                }
            }
        }
    }
}

/// The bytes of the layer of times in a file of one chunk of format 6: the last of nine layers, behind the offset of the table, the first
/// point, the number of points and the lengths of all layers.
fn times_of(bytes: &[u8]) -> std::ops::Range<usize> {
    let u32_at = |at: usize| u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
    let lengths_at = u32_at(POINTS_AT) + 8 + 30 + 4;
    let lengths: Vec<usize> = (0..9).map(|layer| u32_at(lengths_at + 4 * layer)).collect();
    let end = lengths_at + 4 * lengths.len() + lengths.iter().sum::<usize>();
    end - lengths[8]..end
}

#[test]
fn layered_times_that_change_clocks_without_end_are_not_unpacked() {
    let time = |i: usize| Some((i * i % 977) as f64 * 1.7e3);
    let of_number = |i| Point { color: None, gps_time: time(i), ..point(i as f64, Classification::Ground) };
    let points: Vec<Point> = (0..2000).map(of_number).collect();
    let file = file(6, true, &points);
    let bytes = std::fs::read(file.path()).unwrap();
    let times = times_of(&bytes);
    // The crate goes a call deeper for each change: more than any stack holds.
    assert!(times.len() > 4096, "{times:?}");
    let endless = read_las(changed(&bytes, times.start, &vec![0xFF; times.len()]).path(), None).unwrap();
    assert_eq!(endless.positions.len(), points.len());
    assert_eq!(endless.positions, read_las(file.path(), None).unwrap().positions);
}
