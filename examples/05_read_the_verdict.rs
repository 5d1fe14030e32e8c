//! What a program does with each verdict, shown on the sample: with all of the city, and with its walls alone.
//!
//!     cargo run --release --example 05_read_the_verdict

use std::error::Error;
use std::path::Path;

use cityweld::{
    AlignOptions, Alignment, CityModel, CityOptions, PreparedCity, Verdict, align, read_city, read_reconstruction,
    read_start,
};

fn main() -> Result<(), Box<dyn Error>> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let city = read_city(&sample.join("city.obj"), &[], &CityOptions::default())?;
    let sfm = read_reconstruction(&sample.join("sfm"))?;
    let start = read_start(&sample.join("start.json"))?;
    let options = AlignOptions::new(start);

    for (name, city) in [("its walls alone", walls_of(&city)), ("the whole city", city)] {
        println!("{name}:");
        tell(&align(&PreparedCity::new(city), &sfm, None, &options, &())?);
    }
    Ok(())
}

fn tell(alignment: &Alignment) {
    println!("  {}: {}", alignment.verdict.word(), alignment.reason);
    // Only this one is to be built upon; its sigmas say how far.
    if let Some(pose) = alignment.transform() {
        println!("  use it: scale {:.4}", pose.scale);
    }
    match alignment.verdict {
        Verdict::Aligned => {}
        // Sound but for some freedoms: good where those do not matter, or where something else fixes them.
        Verdict::Undetermined => {
            for freedom in alignment.freedoms.iter().filter(|freedom| !freedom.determined) {
                println!("  open: {}, sigma {:.2} {}", freedom.name, freedom.sigma, freedom.unit.symbol());
            }
        }
        // One of these is right; a better start or a person decides.
        Verdict::Ambiguous => {
            for other in &alignment.alternatives {
                println!("  or: {} (weight {:.2})", other.differs, other.weight);
            }
        }
        Verdict::Failed => println!("  nothing to use: look at the start and at the model"),
    }
}

/// Roofs and floors taken away: nothing is left that holds the height.
fn walls_of(city: &CityModel) -> CityModel {
    city.subset(|facet| city.facets[facet.0 as usize].plane.normal.z.abs() < 0.05)
}
