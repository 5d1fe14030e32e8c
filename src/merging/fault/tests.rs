use super::*;

#[test]
fn an_edge_that_is_not_used_says_why_in_the_words_of_its_pair() {
    let pair = PairFault::FewPairsAgree { inliers: 3, pairs: 40 };
    assert_eq!(EdgeFault::from(pair.clone()).to_string(), pair.to_string());
    assert_eq!(pair.to_string(), "only 3 of 40 point pairs agree with one similarity");
}

#[test]
fn shares_of_the_radius_are_told_as_per_cent_of_the_extent() {
    let (names, share, sigmas) = ("one and two".to_owned(), 0.04, 12.4);
    let off = EdgeFault::Contradicted { names: names.clone(), share, sigmas }.to_string();
    assert_eq!(off, "puts one and two 2.0 % of the extent (12 sigmas) off from where the other edges put them");
    let open = EdgeFault::OpenCycle { names, share, sigmas, choices: 4 }.to_string();
    assert!(
        open.starts_with("a cycle does not close") && open.contains("disagree by 2.0 %") && open.contains("any of 4")
    );
    assert!(PairFault::Bent { bend: 0.03 }.to_string().contains("disagree by 1.50 % of the extent"));
    assert!(PairFault::SurfacesApart { off: 0.01 }.to_string().contains("0.50 % of the extent apart"));
}

#[test]
fn a_freedom_that_nothing_holds_is_told_with_a_number_too() {
    let open = PairFault::FreedomOpen { inliers: 9, counted: "point pairs", sigma: f64::INFINITY }.to_string();
    assert!(!open.contains("inf") && open.starts_with("9 point pairs leave one freedom open"), "{open}");
}
