//! Sets one reconstruction into a city: read, align, look at the verdict, write.
//!
//!     cargo run --release --example 01_align_one

use std::error::Error;
use std::path::Path;

use cityweld::steps::{CityCounts, InputSummary, SfmCounts};
use cityweld::{
    AlignOptions, CityOptions, PreparedCity, SuperpixelOptions, SuperpixelSource, align, lift_superpixels, read_city,
    read_reconstruction, read_start, write_alignment,
};

fn main() -> Result<(), Box<dyn Error>> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");

    // What is known: the city, the reconstruction, which pixels belong together, and roughly where all of it stands.
    let city = PreparedCity::new(read_city(&sample.join("city.obj"), &[], &CityOptions::default())?);
    let sfm = read_reconstruction(&sample.join("sfm"))?;
    let labels = SuperpixelSource::Labels(sample.join("labels"));
    let superpixels = lift_superpixels(&sfm, &labels, &SuperpixelOptions::default(), &())?;
    let start = read_start(&sample.join("start.json"))?;

    let alignment = align(&city, &sfm, Some(&superpixels), &AlignOptions::new(start), &())?;
    println!("{}: {}", alignment.verdict.word(), alignment.reason);

    // The similarity maps the reconstruction to absolute city coordinates; there is none unless the verdict is `aligned`.
    if let (Some(city_from_sfm), Some(point)) = (alignment.transform(), sfm.points.first()) {
        println!(
            "scale {:.4} m per unit; the first point stands at {:.3}",
            city_from_sfm.scale,
            city_from_sfm.apply(point)
        );
    }

    let out = tempfile::tempdir()?;
    let input = InputSummary {
        city: CityCounts::of(&city.model, vec!["city.obj".into()]),
        sfm: SfmCounts::of(&sfm, "sfm".into(), Some(superpixels.superpixels.len())),
        prior: None,
    };
    let files = write_alignment(out.path(), &alignment, &input, &city.model, &sfm)?;
    println!("written: {}", files.join(", "));
    Ok(())
}
