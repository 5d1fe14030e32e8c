//! Sizes of pictures, for formats that do not tell them: by the photographs where they lie beside the file, else by where points
//! appear.

use std::path::Path;

use super::posed::warn;
use super::{ReconstructionWarning, WarningKind};
use crate::format::picture_size::picture_size;

/// Observations from which a picture's middle is told. Chosen.
const FEWEST_OBSERVATIONS: usize = 10;

/// Pictures whose estimated middles differ by no more than this share are taken to be of one size: one camera took them.
const ALIKE: f64 = 0.02;

/// The size of a photograph, if it lies below the folder. Names that lead elsewhere find nothing.
pub(super) fn size_of_photograph(folder: &Path, name: &str) -> Option<(u64, u64)> {
    let name = name.replace('\\', "/");
    let stays = Path::new(&name)
        .components()
        .all(|part| matches!(part, std::path::Component::Normal(_) | std::path::Component::CurDir));
    let beside = Path::new(&name).file_name().map(|name| folder.join(name));
    let places = stays.then(|| folder.join(&name)).into_iter().chain(beside);
    let (width, height) = places.into_iter().find_map(|path| picture_size(&path))?;
    Some((width.into(), height.into()))
}

/// Sizes by half of them, as far as they could be estimated for each picture; those about alike become one. `None` where nothing is
/// known of any picture.
pub(super) fn sizes_by_halves(halves: &[Option<[f64; 2]>]) -> Option<Vec<(u64, u64)>> {
    let known: Vec<[f64; 2]> = halves.iter().flatten().copied().collect();
    let common = [0, 1].map(|k| median(known.iter().map(|half| half[k]).collect()));
    let [Some(x), Some(y)] = common else { return None };
    let size = |half: Option<[f64; 2]>| {
        let own = half.unwrap_or([x, y]);
        let is_alike = (own[0] - x).abs() <= ALIKE * x && (own[1] - y).abs() <= ALIKE * y;
        let [half_x, half_y] = if is_alike { [x, y] } else { own };
        ((2.0 * half_x).round().max(1.0) as u64, (2.0 * half_y).round().max(1.0) as u64)
    };
    Some(halves.iter().map(|half| size(*half)).collect())
}

/// The median of each coordinate, of enough places.
pub(super) fn middle(places: &[[f64; 2]]) -> Option<[f64; 2]> {
    if places.len() < FEWEST_OBSERVATIONS {
        return None;
    }
    median_place(places)
}

/// The median of each coordinate, of however few places.
pub(super) fn median_place(places: &[[f64; 2]]) -> Option<[f64; 2]> {
    let [x, y] = [0, 1].map(|k| median(places.iter().map(|place| place[k]).collect()));
    Some([x?, y?])
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Tells that the size of a picture was estimated.
pub(super) fn warn_of_guess(warnings: &mut Vec<ReconstructionWarning>, name: &str, (width, height): (u64, u64)) {
    warn(warnings, WarningKind::SizesGuessed, || format!("{name}, {width} x {height} pixels"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_about_alike_become_of_one_size_and_others_keep_theirs() {
        let halves = [Some([100.2, 75.1]), Some([99.9, 74.9]), None, Some([75.0, 100.0]), Some([100.0, 75.0])];
        let sizes = sizes_by_halves(&halves).unwrap();
        assert_eq!(sizes, [(200, 150), (200, 150), (200, 150), (150, 200), (200, 150)]);
        assert_eq!(sizes_by_halves(&[None, None]), None);
    }

    #[test]
    fn few_places_have_no_middle() {
        assert_eq!(middle(&[[1.0, 2.0]; 9]), None);
        assert_eq!(middle(&[[1.0, 2.0]; 10]), Some([1.0, 2.0]));
        assert_eq!(middle(&[[f64::NAN, 2.0]; 10]), None);
    }

    #[test]
    fn a_photograph_is_found_by_its_path_or_its_name_within_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("in")).unwrap();
        image::GrayImage::new(7, 5).save(folder.path().join("a.png")).unwrap();
        for name in ["a.png", "./a.png", "C:\\photos\\a.png", "other/a.png", "/elsewhere/a.png"] {
            assert_eq!(size_of_photograph(folder.path(), name), Some((7, 5)), "{name}");
        }
        assert_eq!(size_of_photograph(&folder.path().join("in"), "../a.png"), None);
    }
}
