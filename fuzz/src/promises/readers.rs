//! The readers of cityweld, each with what is held against its answer. Only the reading itself is measured.

use std::path::Path;

use cityweld::output::read_alignment;
use cityweld::{
    CityOptions, inspect, read_city, read_city_contents, read_control_points, read_positions, read_reconstruction,
    read_start,
};

use super::{city, finite, las_of_text, places, sfm, told, written};
use crate::trial::{Meter, Seen};

/// Reads a path; the folder is spare. `Err`: a promise that was broken.
pub type Reader = fn(&Path, &Path, &mut Meter) -> Result<Seen, String>;

/// Checks what was read, or the message of its refusal.
fn judged<T, E: std::fmt::Display>(
    read: Result<T, E>,
    check: impl FnOnce(&T) -> Result<(), String>,
) -> Result<Seen, String> {
    match read {
        Ok(model) => check(&model).map(|()| Seen::Read),
        Err(error) => told::check(&error.to_string()).map(|()| Seen::Refused),
    }
}

fn options() -> CityOptions {
    CityOptions::default().with_height_field("height")
}

pub fn city(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_city(path, &[], &options())), city::check)
}

pub fn city_contents(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_city_contents(&[path.to_owned()], &options())), |_| Ok(()))
}

pub fn reconstruction(path: &Path, spare: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_reconstruction(path)), |model| {
        sfm::check(model)?;
        written::check(model, spare)
    })
}

pub fn start(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_start(path)), places::check_start)
}

pub fn alignment(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_alignment(path)), places::check_alignment)
}

pub fn positions(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_positions(path)), places::check_positions)
}

pub fn control_points(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| read_control_points(path)), places::check_points)
}

pub fn inspection(path: &Path, _: &Path, meter: &mut Meter) -> Result<Seen, String> {
    judged(meter.reading(|| inspect(path)), |seen| {
        let corners = seen.low.into_iter().chain(seen.high).chain(seen.up_guess).flatten();
        finite("an inspection", corners)?;
        seen.warnings.iter().try_for_each(|warning| told::check(warning))
    })
}

/// The text as the reference system of a cloud, and of a city that does not say its own.
pub fn crs_of_text(path: &Path, spare: &Path, meter: &mut Meter) -> Result<Seen, String> {
    let text = std::fs::read(path).map_err(|error| error.to_string())?;
    let cloud = spare.join("cloud.las");
    std::fs::write(&cloud, las_of_text::las_of_text(&text)).map_err(|error| error.to_string())?;
    judged(meter.reading(|| read_reconstruction(&cloud)), sfm::check)?;
    let house = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds/stl/house.stl");
    let options = options().with_crs(String::from_utf8_lossy(&text));
    judged(meter.reading(|| read_city(&house, &[], &options)), city::check)
}
