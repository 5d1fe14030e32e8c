use super::super::{binary, text};
use super::*;

fn pose(start: f64) -> PoseRecord {
    let value = |i: usize| start * 10f64.powi(3 * i as i32 - 9) / 3.0;
    PoseRecord { quaternion_wxyz: std::array::from_fn(value), translation: std::array::from_fn(|i| -value(i + 4)) }
}

#[test]
fn rigs_and_frames_are_read_as_they_were_written() {
    let sensor = |kind, id| SensorRecord { kind, id };
    let rigs = [
        RigRecord { id: 4, reference: None, others: vec![] },
        RigRecord {
            id: 5,
            reference: Some(sensor(0, 1)),
            others: vec![(sensor(0, 2), None), (sensor(1, 9), Some(pose(1.0)))],
        },
        RigRecord { id: 6, reference: Some(sensor(77, 3)), others: vec![(sensor(-1, 4), Some(pose(-2.0)))] },
    ];
    let data = vec![(sensor(0, 1), 12), (sensor(1, 9), u64::MAX)];
    let frames = [
        FrameRecord { id: 1, rig_id: 5, rig_from_world: pose(7.0), data },
        FrameRecord { id: 2, rig_id: 5, rig_from_world: pose(-0.0), data: vec![] },
    ];
    let file = rigs_file(Encoding::Text, &rigs);
    assert_eq!(text::rigs(&file).unwrap(), rigs);
    let file = rigs_file(Encoding::Binary, &rigs);
    assert_eq!(binary::rigs(binary::Cursor::new(&file[..], file.len() as u64)).unwrap(), rigs);
    let file = frames_file(Encoding::Text, &frames);
    assert_eq!(text::frames(&file).unwrap(), frames);
    let file = frames_file(Encoding::Binary, &frames);
    assert_eq!(binary::frames(binary::Cursor::new(&file[..], file.len() as u64)).unwrap(), frames);
}

#[test]
fn cameras_of_every_model_are_read_as_they_were_written() {
    let cameras: Vec<_> = CAMERA_MODELS
        .iter()
        .zip(1..)
        .map(|(model, id)| {
            let params = (0..model.parameter_count).map(|i| 1.0 / (i as f64 - 2.5)).collect();
            CameraRecord { id, model, width: 1 << 40, height: 7, params }
        })
        .collect();
    let file = cameras_file(Encoding::Text, &cameras);
    assert_eq!(text::cameras(&file).unwrap(), cameras);
    let file = cameras_file(Encoding::Binary, &cameras);
    assert_eq!(binary::cameras(binary::Cursor::new(&file[..], file.len() as u64)).unwrap(), cameras);
}

#[test]
fn numbers_in_text_read_back_to_the_same_bits() {
    let values = [0.1, -0.0, 5e-324, f64::MAX, 1.0 / 3.0, 5_411_932.500_000_001, 1e21, -1e-7, 640.0];
    let points = |i: usize| {
        let head = PointHead { id: i as u64, position: [values[i], 1.0, 2.0], color: [255; 3], error: -values[i] };
        (head, [(u32::MAX, i as u32)].into_iter())
    };
    let mut file = Vec::new();
    write_points(&mut file, Encoding::Text, values.len(), points).unwrap();
    let read = text::points(&file).unwrap();
    for (i, value) in values.iter().enumerate() {
        assert_eq!(read.positions[i][0].to_bits(), value.to_bits(), "{value}");
        assert_eq!(read.errors[i].to_bits(), (-value).to_bits(), "{value}");
    }
    assert_eq!(read.track_elements[3], (u32::MAX, 3));
}
