//! Joins two partial reconstructions that have one photograph in common: read, merge, look at the verdict, write.
//!
//!     cargo run --release --example 02_merge_two

use std::collections::HashMap;
use std::error::Error;
use std::ops::Range;
use std::path::Path;

use cityweld::types::{ImageIndex, PointIndex};
use cityweld::{
    MergeOptions, MergePart, Place, Reconstruction, Rotation3, Similarity, SuperpixelSource, Vector3, merge,
    read_reconstruction, write_merge,
};

fn main() -> Result<(), Box<dyn Error>> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let whole = read_reconstruction(&sample.join("sfm"))?;

    // Two parts, as two runs of an SfM program would give them: the second in a frame and a scale of its own.
    let elsewhere = Similarity {
        scale: 0.4,
        rotation: Rotation3::from_euler_angles(1.0, -0.5, 2.0),
        translation: Vector3::new(9.0, -4.0, 2.0),
    };
    let sfms = [seen_from(&whole, 0..2), seen_from(&whole, 1..4).transformed(&elsewhere)];

    let named = ["west", "east"].into_iter().zip(sfms);
    let parts = named.map(|(name, sfm)| MergePart { name: name.into(), sfm, place: Place::default() }).collect();

    // The superpixels of the shared photograph: each is a plane in one part and holds points of the other.
    let labels = SuperpixelSource::Labels(sample.join("labels"));
    let options = MergeOptions { superpixels: Some(labels), ..MergeOptions::default() };
    let merged = merge(parts, None, &options, &())?;
    println!("{}: {}", merged.verdict.word(), merged.reason);
    if let Some(west_from_east) = &merged.parts[1].merged_from_part {
        println!("scale {:.6} (1 / 0.4 is right)", west_from_east.scale);
    }
    println!("images: {} given, {} fused", merged.ledger.images.given, merged.ledger.images.fused);

    let out = tempfile::tempdir()?;
    println!("written: {}", write_merge(out.path(), &merged, None)?.join(", "));
    Ok(())
}

/// What some of the images show: their points with two observations or more.
fn seen_from(whole: &Reconstruction, images: Range<usize>) -> Reconstruction {
    let mut part = Reconstruction {
        cameras: whole.cameras.clone(),
        camera_ids: whole.camera_ids.clone(),
        images: whole.images[images.clone()].to_vec(),
        track_starts: vec![0],
        ..Reconstruction::default()
    };
    let mut number = HashMap::new();
    for (p, at) in whole.points.iter().enumerate() {
        let p = PointIndex(p as u32);
        let seen = whole.track(p).iter().filter(|(image, _)| images.contains(&(image.0 as usize)));
        let track: Vec<_> = seen.map(|(image, k)| (ImageIndex(image.0 - images.start as u32), *k)).collect();
        if track.len() < 2 {
            continue;
        }
        number.insert(p, PointIndex(part.points.len() as u32));
        part.points.push(*at);
        part.point_ids.push(whole.point_ids[p.0 as usize]);
        part.point_errors_px.push(whole.point_errors_px[p.0 as usize]);
        part.colors.push(whole.colors[p.0 as usize]);
        part.track_elements.extend(track);
        part.track_starts.push(part.track_elements.len() as u32);
    }
    for observation in part.images.iter_mut().flat_map(|image| &mut image.observations) {
        observation.point = observation.point.and_then(|p| number.get(&p).copied());
    }
    part
}
