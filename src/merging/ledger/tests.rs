use super::*;

use crate::merging::part::Part;
use crate::reconstruction::{Image, Observation, PointIndex};

/// A part of so many images, each of which sees so many points, and one keypoint that sees none.
fn part(images: usize, points: usize) -> Part {
    let seen =
        |k: usize| Observation { x_px: k as f64, y_px: 0.0, point: (k < points).then_some(PointIndex(k as u32)) };
    let image = Image { observations: (0..=points).map(seen).collect(), ..Image::default() };
    let sfm = Reconstruction {
        images: vec![image; images],
        points: vec![crate::geometry::Point3::origin(); points],
        ..Reconstruction::default()
    };
    Part { name: "part".into(), sfm, superpixels: None, anchor: None }
}

#[test]
fn parts_without_a_place_are_dropped_with_all_that_they_hold() {
    let parts = [part(2, 5), part(3, 7)];
    let ledger = Ledger::open(&parts, |p| p == 0);
    assert_eq!([&ledger.images, &ledger.points, &ledger.observations].map(|a| a.given), [5, 12, 31]);
    let dropped = |account: &Account| account.dropped.get(&DropReason::PartNotPlaced).copied();
    assert_eq!([&ledger.images, &ledger.points, &ledger.observations].map(dropped), [Some(3), Some(7), Some(21)]);
    assert_eq!(Ledger::nothing_placed(&parts).check(&parts, None), Ok(()));
}

#[test]
fn accounts_that_do_not_balance_are_told_with_their_numbers() {
    let parts = [part(2, 5)];
    let mut ledger = Ledger::open(&parts, |_| true);
    let told = ledger.check(&parts, None).unwrap_err();
    assert_eq!((told.what, told.given, told.kept), ("images", 2, 0));
    (ledger.images.kept, ledger.points.kept, ledger.observations.kept) = (2, 4, 10);
    ledger.points.fused = 1;
    let model = Reconstruction { points: vec![crate::geometry::Point3::origin(); 4], ..parts[0].sfm.clone() };
    assert_eq!(ledger.check(&parts, Some(&model)), Ok(()));
    // One point more in the result than the ledger knows of.
    let told = ledger.check(&parts, Some(&parts[0].sfm)).unwrap_err();
    assert_eq!((told.what, told.kept, told.counted), ("points", 4, 5));
    assert!(told.to_string().contains("points does not balance"), "{told}");
}

#[test]
fn dropping_nothing_leaves_no_trace_and_reasons_add_up() {
    let mut account = Account::default();
    account.drop(DropReason::BehindCamera, 0);
    assert!(account.dropped.is_empty());
    account.drop(DropReason::BehindCamera, 2);
    account.drop(DropReason::BehindCamera, 3);
    account.drop(DropReason::SecondKeypoint, 1);
    assert_eq!(account.dropped[&DropReason::BehindCamera], 5);
    let words: std::collections::BTreeSet<&str> = account.dropped.keys().map(|reason| reason.words()).collect();
    assert_eq!(words.len(), 2);
}
