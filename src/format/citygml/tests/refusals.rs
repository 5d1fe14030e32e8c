//! What is refused, with its place; and what may not take memory or time.

use super::*;
use crate::format::surface_error::Place;

#[test]
fn a_file_that_is_cut_between_two_elements_is_refused_with_its_last_line() {
    let text = solid_of_links(true);
    let cut = &text[..text.find("<bldg:boundedBy>").unwrap()];
    let error = refused(cut);
    assert!(error.to_string().contains("cut off: 3 elements"), "{error}");
    let line = cut.lines().count() as u64;
    assert_eq!(error.place, Place::Line { line, byte: cut.len() as u64 });
    assert_eq!(error.object.as_deref(), Some("house"));
}

#[test]
fn what_is_wrong_is_told_with_line_and_object() {
    let at = |positions: &str| {
        building(&format!("\n<bldg:lod2MultiSurface>\n{}</bldg:lod2MultiSurface>", polygon("p", positions)))
    };
    for (text, expected) in [
        (at("0 0 0 1 0 nan 0 1 0"), "`nan` is no coordinate"),
        (at("0 0 0 1 0 1e999 0 1 0"), "`1e999` is no coordinate"),
        (at("0 0 0 1 0 0,5 0 1 0"), "`0,5` is no coordinate"),
        (at("0 0 0 1 0 0 0 1"), "8 numbers do not make positions of 3"),
        (at("0 0 &lol; 1 0 0 0 1 0"), "entity `&lol;`"),
        (at(TRIANGLE).replace("<gml:posList>", "<gml:posList srsDimension='4'>"), "srsDimension is `4`"),
        (at(TRIANGLE).replace("</gml:Polygon>", "</gml:Polygo>"), "XML is broken"),
        (at("<gml:LinearRing/>"), "ring or polygon within another"),
    ] {
        let error = refused(&text);
        assert!(error.to_string().contains(expected), "{error}");
        assert!(matches!(error.place, Place::Line { line: 5..=6, .. }), "{error:?}");
        assert_eq!(error.object.as_deref(), Some("house"), "{error}");
    }
    assert!(refused("<a><b/></a>").to_string().contains("begins with `a`"));
    assert!(refused("").to_string().contains("no namespace"));
    assert!(refused(&"<a>".repeat(1 << 20)).to_string().contains("more than 512"));
}

#[test]
fn a_billion_laughs_stay_small() {
    let entities: String =
        (1..30).map(|at| format!("<!ENTITY e{at} \"{}\">", format!("&e{};", at - 1).repeat(10))).collect();
    let text =
        format!("<!DOCTYPE CityModel [<!ENTITY e0 \"ha\">{entities}]>{}", building("<bldg:name>&e29;</bldg:name>"));
    assert_eq!(read(&text).objects.len(), 1);
    let in_id = text.replace("\"house\"", "\"&e29;\"");
    assert!(read_citygml(in_id.as_bytes()).is_err());
}
