//! Parts for tests of merging that a clone alone can run: pieces of the sample, as a structure-from-motion tool might have left
//! them apart, and parts that do not belong to it.
#![allow(dead_code, reason = "no test file needs all of it")]

use std::ops::Range;
use std::path::{Path, PathBuf};

use cityweld::solvers::scene::Random;
use cityweld::synthetic::{Block, CaptureOptions, Ring};
use cityweld::types::{ImageIndex, PointIndex};
use cityweld::{
    Image, Matrix3, Point3, Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction, write_colmap,
};
use serde_json::Value;

/// A file or folder of the sample.
pub fn of_sample(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample").join(path)
}

pub fn sample() -> Reconstruction {
    read_reconstruction(&of_sample("sfm")).unwrap()
}

/// Writes a part as a COLMAP model and gives its folder.
pub fn write_part(room: &Path, name: &str, part: &Reconstruction) -> PathBuf {
    let folder = room.join(name);
    write_colmap(&folder, part).unwrap();
    folder
}

/// As a run of its own would have left a piece: every point off by `sigma` along each axis, in the piece's units.
pub fn blurred(mut piece: Reconstruction, sigma: f64, seed: u64) -> Reconstruction {
    let mut random = Random::stream(seed, 0);
    piece.points.iter_mut().for_each(|x| *x += sigma * random.normal_vector());
    piece
}

/// Photographs of another place through the sample's camera; the first ones are called `names`.
pub fn another_place(names: &[&str]) -> Reconstruction {
    let block = Block::mixed_houses();
    let camera = sample().cameras.swap_remove(0);
    let mut part =
        block.capture(&Ring::drone(10).stations(&block), &CaptureOptions { camera, ..CaptureOptions::default() }).sfm;
    part.images.iter_mut().zip(names).for_each(|(image, name)| image.name = (*name).to_owned());
    part
}

/// A sound model of a mirrored place, as mirrored photographs give it: keypoints, points and cameras are reflected alike.
pub fn mirrored(mut part: Reconstruction) -> Reconstruction {
    let flip = |v: &Vector3<f64>| Vector3::new(-v.x, v.y, v.z);
    part.points.iter_mut().for_each(|p| *p = Point3::from(flip(&p.coords)));
    for image in &mut part.images {
        let mut turn = image.cam_from_sfm_rotation.into_inner();
        for (i, j) in [(0, 1), (0, 2), (1, 0), (2, 0)] {
            turn[(i, j)] = -turn[(i, j)];
        }
        image.cam_from_sfm_rotation = Rotation3::from_matrix_unchecked(turn);
        image.cam_from_sfm_translation = flip(&image.cam_from_sfm_translation);
        let camera = &part.cameras[image.camera.0 as usize];
        let width_px = camera.width_px as f64;
        // SIMPLE_PINHOLE and SIMPLE_RADIAL: focal length, then the principal point.
        assert_eq!(2.0 * camera.params[1], width_px, "a lens in the middle is its own mirror image");
        image.observations.iter_mut().for_each(|o| o.x_px = width_px - o.x_px);
    }
    without_frames(part)
}

/// Longer by `factor` along x; no similarity undoes it.
pub fn stretched(mut part: Reconstruction, factor: f64) -> Reconstruction {
    part.points.iter_mut().for_each(|p| p.x *= factor);
    for image in &mut part.images {
        let mut center = image.center();
        center.x *= factor;
        image.cam_from_sfm_translation = -(image.cam_from_sfm_rotation * center.coords);
    }
    without_frames(part)
}

/// Frames would hold the old places of the cameras.
fn without_frames(mut part: Reconstruction) -> Reconstruction {
    if let Some(colmap) = &mut part.colmap {
        (colmap.rigs, colmap.frames) = (None, None);
    }
    part
}

/// A similarity as reports and truths write it.
pub fn similarity(t: &Value) -> Similarity {
    let number = |v: &Value| v.as_f64().unwrap();
    let rotation = Matrix3::from_fn(|row, column| number(&t["rotation"][row][column]));
    let translation = Vector3::from_fn(|k, _| number(&t["translation"][k]));
    Similarity::try_new(number(&t["scale"]), rotation, translation).unwrap()
}

/// Root mean square of how far b's points are off in a's frame, a share of the extent of a.
pub fn share_off(points: [&[Point3<f64>]; 2], a_from_b: &Similarity, true_a_from_b: &Similarity) -> f64 {
    let [of_a, of_b] = points;
    let center = of_a.iter().map(|p| p.coords).sum::<Vector3<f64>>() / of_a.len() as f64;
    // Sky and far mismatches are left out.
    let nearest = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.truncate(values.len() * 98 / 100);
        values
    };
    let from_center = nearest(of_a.iter().map(|p| (p.coords - center).norm()).collect());
    let off = nearest(of_b.iter().map(|p| (a_from_b.apply(p) - true_a_from_b.apply(p)).norm()).collect());
    let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
    rms / (2.0 * from_center.last().unwrap())
}

/// The images `views` with what at least two of them see, in a frame of the piece's own.
pub fn piece(whole: &Reconstruction, views: Range<usize>, piece_from_whole: &Similarity) -> Reconstruction {
    let inside = |element: &&(ImageIndex, u32)| views.contains(&(element.0.0 as usize));
    let number = |p: usize| PointIndex(p as u32);
    let kept: Vec<usize> =
        (0..whole.points.len()).filter(|p| whole.track(number(*p)).iter().filter(inside).count() > 1).collect();
    let mut new_number = vec![None; whole.points.len()];
    kept.iter().enumerate().for_each(|(new, old)| new_number[*old] = Some(number(new)));
    let mut piece = Reconstruction {
        cameras: whole.cameras.clone(),
        camera_ids: whole.camera_ids.clone(),
        images: whole.images[views.clone()].iter().map(|image| renumbered(image, &new_number)).collect(),
        points: kept.iter().map(|p| whole.points[*p]).collect(),
        point_ids: kept.iter().map(|p| whole.point_ids[*p]).collect(),
        colors: kept.iter().map(|p| whole.colors[*p]).collect(),
        track_starts: vec![0],
        colmap: whole.colmap.clone(),
        ..Reconstruction::default()
    };
    for p in &kept {
        let track = whole.track(number(*p)).iter().filter(inside);
        piece.track_elements.extend(track.map(|(image, k)| (ImageIndex(image.0 - views.start as u32), *k)));
        piece.track_starts.push(piece.track_elements.len() as u32);
    }
    piece.point_errors_px = (0..kept.len()).map(|p| mean_error_px(&piece, p)).collect();
    let has = |id: u64| piece.images.iter().any(|image| u64::from(image.id) == id);
    if let Some(frames) = piece.colmap.as_mut().and_then(|colmap| colmap.frames.as_mut()) {
        frames.retain(|frame| frame.data.iter().any(|(_, id)| has(*id)));
    }
    piece.transformed(piece_from_whole)
}

fn renumbered(image: &Image, new_number: &[Option<PointIndex>]) -> Image {
    let mut image = image.clone();
    for o in &mut image.observations {
        o.point = o.point.and_then(|p| new_number[p.0 as usize]);
    }
    image
}

fn mean_error_px(r: &Reconstruction, point: usize) -> f64 {
    let track = r.track(PointIndex(point as u32));
    let error = |(index, keypoint): &(ImageIndex, u32)| {
        let image = &r.images[index.0 as usize];
        let o = &image.observations[*keypoint as usize];
        let [x, y] = r.camera_of(*index).project(&image.cam_from_sfm(&r.points[point])).unwrap();
        (x - o.x_px).hypot(y - o.y_px)
    };
    track.iter().map(error).sum::<f64>() / track.len() as f64
}
