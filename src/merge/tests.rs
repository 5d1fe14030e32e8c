use super::*;
use crate::geometry::{Point3, Similarity};
use crate::merging::MergeVerdict;
use crate::observer::{Cancelled, Observer};
use crate::synthetic::{Block, CaptureOptions, Ring, Survey};

/// Two parts of one block from overlapping photographs, each in a frame of its own.
fn two_parts() -> (Vec<MergePart>, [Similarity; 2]) {
    let block = Block::four_houses();
    let stations = Ring::street(20).stations(&block);
    let part = |name: &str, stations: &[crate::synthetic::Station], scale: f64| {
        let plain = CaptureOptions {
            places: 1500,
            clutter: 0,
            outlier_share: 0.0,
            noise_m: 0.002,
            ..CaptureOptions::default()
        };
        let sfm_from_city = Similarity { scale, ..plain.sfm_from_city };
        let Survey { sfm, city_from_sfm, .. } =
            block.capture(stations, &CaptureOptions { sfm_from_city, noise_px: 0.1, ..plain });
        (MergePart { name: name.into(), sfm, place: Place::default() }, city_from_sfm)
    };
    let ((one, city_from_one), (other, city_from_other)) =
        (part("one", &stations[..13], 0.13), part("other", &stations[7..], 0.4));
    (vec![one, other], [city_from_one, city_from_other])
}

#[test]
fn parts_that_share_photographs_become_one_without_a_city() {
    let (parts, [city_from_one, city_from_other]) = two_parts();
    let merged = merge(parts, None, &MergeOptions::default(), &()).unwrap();
    assert_eq!(merged.verdict, MergeVerdict::Merged, "{}", merged.reason);
    let poses: Vec<Similarity> = merged.parts.iter().map(|part| part.merged_from_part.unwrap()).collect();
    let x = Point3::new(6.0, -1.0, 3.0);
    let of = |pose: &Similarity, city_from_part: &Similarity| pose.apply(&city_from_part.inverse().apply(&x));
    let apart = of(&poses[0], &city_from_one) - of(&poses[1], &city_from_other);
    // The first part gives the frame, whose unit is some eight metres.
    assert!(apart.norm() / 0.13 < 0.05, "{apart}");
}

#[test]
fn a_folder_in_which_no_shared_photograph_is_becomes_a_warning() {
    let (parts, _) = two_parts();
    let folder = tempfile::tempdir().unwrap();
    let superpixels = Some(SuperpixelSource::Photos(folder.path().into()));
    let merged = merge(parts, None, &MergeOptions { superpixels, ..MergeOptions::default() }, &()).unwrap();
    assert_eq!(merged.verdict, MergeVerdict::Merged, "{}", merged.reason);
    assert!(merged.warnings.iter().any(|w| w.contains("no file there is that of a photograph that two parts share")));
}

#[test]
fn an_observer_that_wants_the_end_gets_it() {
    struct Impatient;
    impl Observer for Impatient {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let (parts, _) = two_parts();
    let ended = merge(parts, None, &MergeOptions::default(), &Impatient);
    assert!(matches!(ended, Err(MergeError::Cancelled(Cancelled))), "{ended:?}");
}
