//! Pieces of one reconstruction, as a structure-from-motion tool might have left them apart.

use std::ops::Range;

use cityweld::geometry::Similarity;
use cityweld::reconstruction::{Image, ImageIndex, PointIndex, Reconstruction};

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
