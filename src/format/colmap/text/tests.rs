use super::*;

#[test]
fn names_keep_their_blanks_and_lines_may_end_as_on_windows() {
    let file =
        b"# comment\r\n\r\n7 1 0 0 0 0 0 0 1 my photos/first one.jpg \r\n1.5 2.5 -1\r\n8 1 0 0 0 0 0 0 1 b\r\n\r\n";
    let images = images(file).unwrap();
    assert_eq!((images[0].id, images[0].name.as_slice()), (7, &b"my photos/first one.jpg"[..]));
    assert_eq!(images[0].observations, [ObservationRecord { x: 1.5, y: 2.5, point_id: NO_POINT }]);
    assert_eq!((images[1].name.as_slice(), images[1].observations.len()), (&b"b"[..], 0));
}

#[test]
fn the_last_image_may_lack_its_second_line() {
    let images = images(b"7 1 0 0 0 0 0 0 1 a").unwrap();
    assert_eq!((images.len(), images[0].observations.len()), (1, 0));
}

#[test]
fn points_of_many_pieces_stand_in_their_order() {
    let count = 3 * PIECE_BYTES / 30;
    let line = |id: usize| format!("{id} {id}.5 -1e-3 2 1 2 3 0.25 {} {}\n", id % 7, id % 5);
    let file: String = (0..count).map(line).collect();
    assert!(pieces(file.as_bytes()).len() > 2);
    let points = points(file.as_bytes()).unwrap();
    assert!(points.ids.iter().copied().eq(0..count as u64));
    assert!(points.positions.iter().enumerate().all(|(i, p)| *p == [i as f64 + 0.5, -1e-3, 2.0]));
    assert!(points.track_starts.iter().copied().eq(0..=count as u32));
    assert!(points.track_elements.iter().enumerate().all(|(i, e)| *e == ((i % 7) as u32, (i % 5) as u32)));
}

#[test]
fn of_several_faults_the_first_is_told() {
    let mut file: Vec<u8> = (0..4 * PIECE_BYTES / 20).flat_map(|_| *b"1 2 3 4 0 0 0 0.5\n").collect();
    let last = file.len() - 5;
    (file[PIECE_BYTES / 2], file[last]) = (b'x', b'x');
    let Err(Fault::Malformed { at, .. }) = points(&file) else { panic!() };
    assert!((at as usize) < PIECE_BYTES);
}

#[test]
fn numbers_beyond_their_range_are_refused() {
    for file in ["18446744073709551616 0 0 0 1 2 3 0", "1 0 0 0 1 2 3 0 4294967296 0", "-1 0 0 0 1 2 3 0"] {
        assert!(points(file.as_bytes()).is_err(), "{file}");
    }
    assert!(points(b"18446744073709551615 0 0 0 255 2 3 0 4294967295 0").is_ok());
}
