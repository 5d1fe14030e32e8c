use super::*;

#[test]
fn an_edge_is_used_unless_it_is_refused_and_a_refusal_comes_before_a_note() {
    let edge = Edge {
        a: 0,
        b: 2,
        source: EdgeSource::Tracks,
        shared_photos: Vec::new(),
        pairs: 9,
        inliers: 8,
        rms: 0.1,
        refusal: None,
        note: None,
    };
    assert!(edge.is_used() && edge.reason().is_none());
    assert!(edge.touches(0) && edge.touches(2) && !edge.touches(1));
    let noted = Edge { note: Some("a source was left out".into()), ..edge };
    assert!(noted.is_used() && noted.reason().as_deref() == Some("a source was left out"));
    let refused = Edge { refusal: Some(EdgeFault::OtherGroup), ..noted };
    assert!(!refused.is_used() && refused.reason() == Some(EdgeFault::OtherGroup.to_string()));
}

#[test]
fn the_words_of_the_report_differ() {
    let verdicts = [
        MergeVerdict::Merged,
        MergeVerdict::Partial,
        MergeVerdict::Undetermined,
        MergeVerdict::Ambiguous,
        MergeVerdict::Failed,
    ];
    let words: std::collections::BTreeSet<&str> = verdicts.iter().map(|v| v.word()).collect();
    assert_eq!(words.len(), verdicts.len());
    let sources = [EdgeSource::Tracks, EdgeSource::Superpixels, EdgeSource::City].map(EdgeSource::word);
    assert_eq!(sources, ["tracks", "superpixels", "city"]);
    assert_eq!(MergedFrame::Part("one".into()).words(), "one's");
    assert_eq!([MergedFrame::City.words(), MergedFrame::Nobodys.words()], ["the city's", "none"]);
}
