mod refusals;

use super::*;
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::{Lod, Skipped, SurfaceFile, SurfaceKind};
use crate::format::tests::{assert_sound, rings, volumes};

const NAMESPACES: &str = r#"xmlns="http://www.opengis.net/citygml/2.0" xmlns:gml="http://www.opengis.net/gml"
    xmlns:bldg="http://www.opengis.net/citygml/building/2.0" xmlns:xlink="http://www.w3.org/1999/xlink""#;

fn model(members: &str) -> String {
    format!("<CityModel {NAMESPACES}>\n{members}\n</CityModel>\n")
}

fn building(inside: &str) -> String {
    model(&format!(r#"<cityObjectMember><bldg:Building gml:id="house">{inside}</bldg:Building></cityObjectMember>"#))
}

fn read(text: &str) -> SurfaceFile {
    let file = read_citygml(text.as_bytes()).unwrap();
    assert_sound(&file);
    file
}

fn refused(text: &str) -> SurfaceError {
    read_citygml(text.as_bytes()).expect_err("an error")
}

fn polygon(id: &str, positions: &str) -> String {
    format!(
        r#"<gml:Polygon gml:id="{id}"><gml:exterior><gml:LinearRing><gml:posList>{positions}</gml:posList>
           </gml:LinearRing></gml:exterior></gml:Polygon>"#
    )
}

const TRIANGLE: &str = "0 0 0 1 0 0 0 1 0 0 0 0";

/// The four sides of the tetrahedron 0, x, y, z, looking outwards.
const TETRAHEDRON: [&str; 4] =
    ["0 0 0 0 1 0 1 0 0 0 0 0", "0 0 0 1 0 0 0 0 1 0 0 0", "0 0 0 0 0 1 0 1 0 0 0 0", "1 0 0 0 1 0 0 0 1 1 0 0"];

fn skipped(file: &SurfaceFile) -> Vec<(&str, usize, &str)> {
    let entries = file.skipped.iter();
    entries.map(|Skipped { what, count, example }| (*what, *count, example.as_str())).collect()
}

#[test]
fn a_polygon_has_its_object_level_and_kind_from_the_elements_around_it() {
    let member = format!(
        "<gml:MultiSurface><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface>",
        polygon("p", TRIANGLE)
    );
    for (name, kind) in [
        ("WallSurface", SurfaceKind::Wall),
        ("RoofSurface", SurfaceKind::Roof),
        ("GroundSurface", SurfaceKind::Ground),
        ("ClosureSurface", SurfaceKind::Closure),
        ("OuterCeilingSurface", SurfaceKind::Other),
        ("Door", SurfaceKind::Other),
    ] {
        let around = format!("<bldg:{name}><bldg:lod3MultiSurface>{member}</bldg:lod3MultiSurface></bldg:{name}>");
        let file = read(&building(&around));
        let surface = file.surfaces[0];
        assert_eq!((surface.kind, surface.lod, surface.shell), (Some(kind), Some(Lod(3, 0)), None));
        assert_eq!(file.objects[0].id, "house");
        assert_eq!(rings(&file, 0), [[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]]);
    }
}

#[test]
fn the_nearest_boundary_is_the_kind_and_geometries_are_none() {
    let wall = |inside: &str| format!("<bldg:WallSurface>{inside}</bldg:WallSurface>");
    let inner = format!(
        "<bldg:opening><bldg:Window><bldg:lod3MultiSurface>{}</bldg:lod3MultiSurface></bldg:Window></bldg:opening>",
        polygon("w", TRIANGLE)
    );
    let composite = format!(
        "<bldg:lod3MultiSurface><gml:CompositeSurface>{}</gml:CompositeSurface></bldg:lod3MultiSurface>",
        polygon("c", TRIANGLE)
    );
    let file = read(&building(&wall(&(inner + &composite))));
    assert_eq!(file.surfaces[0].kind, Some(SurfaceKind::Other));
    assert_eq!(file.surfaces[1].kind, Some(SurfaceKind::Wall));
}

#[test]
fn parts_name_their_buildings_also_where_they_are_written_elsewhere() {
    let text = model(
        r##"<cityObjectMember><bldg:Building gml:id="a"><bldg:consistsOfBuildingPart><bldg:BuildingPart gml:id="a1"/>
        </bldg:consistsOfBuildingPart><bldg:consistsOfBuildingPart xlink:href="#b1"/></bldg:Building></cityObjectMember>
        <cityObjectMember><bldg:BuildingPart gml:id="b1"><bldg:consistsOfBuildingPart xlink:href="#a"/></bldg:BuildingPart></cityObjectMember>"##,
    );
    let file = read(&text);
    let objects: Vec<_> = file.objects.iter().map(|o| (o.id.as_str(), o.class.as_str(), o.parent)).collect();
    assert_eq!(objects, [("a", "Building", None), ("a1", "BuildingPart", Some(0)), ("b1", "BuildingPart", Some(0))]);
    assert_eq!(skipped(&file), [("references to surfaces that are not there", 1, "#a")], "a circle is none");
}

/// A solid that names the polygons p0 to p3, and walls that hold them; in this order or the other.
fn solid_of_links(comes_first: bool) -> String {
    let links: String = (0..4).map(|at| format!(r##"<gml:surfaceMember xlink:href="#p{at}"/>"##)).collect();
    let solid = format!(
        "<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface>{links}</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid>"
    );
    let wall = |at: usize| {
        format!(
            "<bldg:boundedBy><bldg:WallSurface><bldg:lod2MultiSurface>{}</bldg:lod2MultiSurface></bldg:WallSurface></bldg:boundedBy>",
            polygon(&format!("p{at}"), TETRAHEDRON[at])
        )
    };
    let walls: String = (0..4).map(wall).collect();
    building(&if comes_first { solid + &walls } else { walls + &solid })
}

#[test]
fn a_solid_of_references_counts_no_polygon_twice_and_is_known_before_or_after_them() {
    for comes_first in [true, false] {
        let file = read(&solid_of_links(comes_first));
        assert_eq!(file.surfaces.len(), 4);
        assert!(
            file.surfaces.iter().all(|surface| surface.shell == Some(0) && surface.kind == Some(SurfaceKind::Wall))
        );
        assert_eq!(volumes(&file), [1.0]);
        assert_eq!(file.skipped, []);
    }
}

#[test]
fn walls_that_name_the_polygons_of_a_solid_give_them_their_kind() {
    let text = building(&format!(
        r##"<bldg:lod2Solid><gml:Solid><gml:exterior>{}</gml:exterior></gml:Solid></bldg:lod2Solid>
        <bldg:RoofSurface><bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember xlink:href="#p"/></gml:MultiSurface></bldg:lod2MultiSurface></bldg:RoofSurface>"##,
        polygon("p", TRIANGLE)
    ));
    let file = read(&text);
    assert_eq!(
        (file.surfaces.len(), file.surfaces[0].kind, file.surfaces[0].shell),
        (1, Some(SurfaceKind::Roof), Some(0))
    );
}

#[test]
fn references_lead_through_composites_to_the_polygons() {
    let text = building(&format!(
        r##"<bldg:lod2Solid><gml:Solid><gml:exterior xlink:href="#all"/></gml:Solid></bldg:lod2Solid>
        <bldg:lod2MultiSurface><gml:CompositeSurface gml:id="all"><gml:surfaceMember xlink:href="#p"/><gml:surfaceMember>{}</gml:surfaceMember></gml:CompositeSurface>
        </bldg:lod2MultiSurface><bldg:lod2MultiSurface>{}</bldg:lod2MultiSurface>"##,
        polygon("q", TRIANGLE),
        polygon("p", TRIANGLE)
    ));
    let file = read(&text);
    assert_eq!(file.surfaces.iter().map(|surface| surface.shell).collect::<Vec<_>>(), [Some(0), Some(0)]);
}

#[test]
fn references_in_a_circle_end_in_an_error() {
    let composite = |id: &str, href: &str| {
        format!(
            r##"<gml:CompositeSurface gml:id="{id}"><gml:surfaceMember xlink:href="#{href}"/></gml:CompositeSurface>"##
        )
    };
    let text = building(&format!(
        "<bldg:lod2MultiSurface>{}{}</bldg:lod2MultiSurface>",
        composite("a", "b"),
        composite("b", "a")
    ));
    assert!(refused(&text).to_string().contains("circle"), "{}", refused(&text));
}

#[test]
fn orientation_minus_turns_what_is_written_within_and_what_is_named() {
    let oriented = |inside: &str| format!(r#"<gml:OrientableSurface orientation="-">{inside}</gml:OrientableSurface>"#);
    let turned = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]];
    let file = read(&building(&format!(
        "<bldg:lod2MultiSurface>{}</bldg:lod2MultiSurface>",
        oriented(&polygon("p", TRIANGLE))
    )));
    assert_eq!(rings(&file, 0), [turned]);
    let twice = oriented(&oriented(&polygon("p", TRIANGLE)));
    let file = read(&building(&format!("<bldg:lod2MultiSurface>{twice}</bldg:lod2MultiSurface>")));
    assert_eq!(rings(&file, 0)[0][0], [0.0; 3]);
    // A solid has the polygon turned round, and nobody has it as it stands.
    let named = oriented(r##"<gml:baseSurface xlink:href="#p"/>"##);
    let solid = |inside: &str| {
        format!("<bldg:lod2Solid><gml:Solid><gml:exterior>{inside}</gml:exterior></gml:Solid></bldg:lod2Solid>")
    };
    let wall = format!("<bldg:lod2MultiSurface>{}</bldg:lod2MultiSurface>", polygon("p", TRIANGLE));
    let file = read(&building(&(solid(&named) + &wall)));
    assert_eq!((rings(&file, 0)[0].clone(), file.surfaces[0].shell), (turned.to_vec(), Some(0)));
    // Two solids share it: it stays with the one that has it as it stands.
    let plain = r##"<gml:CompositeSurface><gml:surfaceMember xlink:href="#p"/></gml:CompositeSurface>"##;
    let file = read(&building(&(solid(&named) + &solid(plain) + &wall)));
    assert_eq!((rings(&file, 0)[0][0], file.surfaces[0].shell), ([0.0; 3], Some(1)));
    assert_eq!(skipped(&file), [("second solids of a surface that two solids share", 1, "house")]);
}

#[test]
fn references_to_nothing_and_to_other_files_are_counted() {
    let links = r##"<gml:surfaceMember xlink:href="#no"/><gml:surfaceMember xlink:href="other.gml#p"/><gml:surfaceMember xlink:href="#nor"/>"##;
    let file = read(&building(&format!(
        "<bldg:lod2MultiSurface><gml:MultiSurface>{links}</gml:MultiSurface></bldg:lod2MultiSurface>"
    )));
    let expected = [
        ("references to surfaces that are not there", 2, "#no"),
        ("references to surfaces in other files", 1, "other.gml#p"),
    ];
    assert_eq!(skipped(&file), expected);
}

#[test]
fn holes_follow_the_outline_also_where_they_stand_before_it() {
    let ring = |role: &str, name: &str, positions: &str| {
        format!("<gml:{role}><gml:{name}><gml:posList>{positions}</gml:posList></gml:{name}></gml:{role}>")
    };
    let outline = ring("exterior", "LinearRing", "0 0 0 9 0 0 9 9 0 0 9 0 0 0 0");
    let hole = ring("interior", "LinearRing", "1 1 0 1 2 0 2 2 0 1 1 0");
    let speck = ring("interior", "LinearRing", "5 5 0 6 6 0 5 5 0");
    for rings_of_polygon in [[&outline, &hole, &speck], [&hole, &speck, &outline]] {
        let inside: String = rings_of_polygon.into_iter().map(String::as_str).collect();
        let file = read(&building(&format!(
            "<bldg:lod1MultiSurface><gml:Polygon>{inside}</gml:Polygon></bldg:lod1MultiSurface>"
        )));
        let found = rings(&file, 0);
        assert_eq!((found.len(), found[0].len(), found[1].len()), (2, 4, 3));
        assert_eq!(skipped(&file), [("holes with less than three corners", 1, "house")]);
    }
}

#[test]
fn positions_are_read_in_each_way_of_writing_them() {
    let expected = vec![vec![[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]]];
    for (ring, inside) in [
        ("LinearRing", "<gml:posList>0 0 .5 1 0 .5\n\t0 1 .5 0 0 .5</gml:posList>"),
        ("LinearRing", "<gml:posList srsDimension='3'>0 0 .5 1 0 .5<!-- here --> 0 1 .5 0 0 <![CDATA[.5]]></gml:posList>"),
        ("LinearRing", "<gml:pos>0 0 .5</gml:pos><gml:pos>1 0 .5</gml:pos><gml:pos>0 1 0.&#53;</gml:pos><gml:pos>0 0 .5</gml:pos>"),
        ("LinearRing", "<gml:coordinates>0,0,.5 1,0,.5 0,1,5e-1 0,0,.5</gml:coordinates>"),
        ("LinearRing", "<gml:coordinates decimal='.' cs=',' ts=' '>0,0,.5 1,0,.5 0,1,5e-1</gml:coordinates>"),
        ("LinearRing", "<gml:pointProperty><gml:Point><gml:pos>0 0 .5</gml:pos></gml:Point></gml:pointProperty><gml:pos>1 0 .5</gml:pos><gml:pos>0 1 .5</gml:pos>"),
        ("Ring", "<gml:curveMember><gml:LineString><gml:posList>0 0 .5 1 0 .5</gml:posList></gml:LineString></gml:curveMember>
                  <gml:curveMember><gml:LineString><gml:posList>1 0 .5 0 1 .5 0 0 .5</gml:posList></gml:LineString></gml:curveMember>"),
    ] {
        let text = format!("<gml:Polygon><gml:exterior><gml:{ring}>{inside}</gml:{ring}></gml:exterior></gml:Polygon>");
        let file = read(&building(&format!("<bldg:lod2MultiSurface>{text}</bldg:lod2MultiSurface>")));
        assert_eq!(rings(&file, 0), expected, "{inside}");
    }
}

#[test]
fn polygons_that_are_none_are_counted_with_an_example() {
    let polygon = |inside: &str| format!("<gml:surfaceMember><gml:Polygon>{inside}</gml:Polygon></gml:surfaceMember>");
    let ring = |inside: &str| format!("<gml:exterior><gml:LinearRing>{inside}</gml:LinearRing></gml:exterior>");
    let inside = [
        polygon(""),
        polygon(&ring("<gml:posList>0 0 0 1 1 1 0 0 0</gml:posList>")),
        polygon(&ring("<gml:posList srsDimension='2'>0 0 1 0 1 1 0 0</gml:posList>")),
        polygon("<gml:exterior><gml:Ring><gml:curveMember><gml:Curve><gml:segments><gml:Arc><gml:posList>0 0 0 1 0 0 1 1 0</gml:posList></gml:Arc></gml:segments></gml:Curve></gml:curveMember></gml:Ring></gml:exterior>"),
        polygon(&ring("<gml:pointProperty xlink:href='#a'/><gml:pointProperty xlink:href='#b'/>")),
    ]
    .concat();
    let curves = "<bldg:lod1TerrainIntersection><gml:MultiCurve/></bldg:lod1TerrainIntersection>";
    let file = read(&building(&format!(
        "<bldg:lod2MultiSurface><gml:MultiSurface>{inside}</gml:MultiSurface></bldg:lod2MultiSurface>{curves}"
    )));
    assert_eq!(file.surfaces, []);
    let expected = [
        "polygons without an outline",
        "polygons with less than three corners",
        "polygons without heights (in two dimensions)",
        "polygons bounded by arcs or splines",
        "polygons whose corners are references",
        "points and lines",
    ];
    assert_eq!(skipped(&file), expected.map(|what| (what, 1, "house")));
}

#[test]
fn a_relief_is_its_triangles_at_the_level_that_it_names() {
    let text = model(
        r#"<cityObjectMember><dem:ReliefFeature xmlns:dem="d" gml:id="land"><dem:lod>1</dem:lod><dem:reliefComponent><dem:TINRelief gml:id="tin"><dem:lod> 2 </dem:lod>
        <dem:tin><gml:TriangulatedSurface><gml:trianglePatches><gml:Triangle><gml:exterior><gml:LinearRing><gml:posList>0 0 0 1 0 0 0 1 0 0 0 0</gml:posList></gml:LinearRing></gml:exterior></gml:Triangle></gml:trianglePatches></gml:TriangulatedSurface></dem:tin>
        </dem:TINRelief></dem:reliefComponent><dem:reliefComponent><dem:MassPointRelief gml:id="dots"/></dem:reliefComponent></dem:ReliefFeature></cityObjectMember>"#,
    );
    let file = read(&text);
    assert_eq!((file.surfaces.len(), file.surfaces[0].lod, file.surfaces[0].object), (1, Some(Lod(2, 0)), 1));
    assert_eq!(skipped(&file), [("reliefs without triangles", 1, "dots")]);
}

/// A tree whose template is written or named, at (10, 20, 30), twice as large and turned by a quarter.
fn tree(id: &str, template: &str) -> String {
    format!(
        r#"<cityObjectMember><SolitaryVegetationObject gml:id="{id}"><lod2ImplicitRepresentation><ImplicitGeometry>
        <transformationMatrix>0 -2 0 1  2 0 0 0  0 0 2 0  0 0 0 1</transformationMatrix>{template}
        <referencePoint><gml:Point><gml:pos>10 20 30</gml:pos></gml:Point></referencePoint></ImplicitGeometry></lod2ImplicitRepresentation></SolitaryVegetationObject></cityObjectMember>"#
    )
}

#[test]
fn implicit_geometries_stand_where_matrix_and_point_put_them() {
    let written = format!(
        r#"<relativeGMLGeometry><gml:MultiSurface gml:id="shape"><gml:surfaceMember>{}</gml:surfaceMember></gml:MultiSurface></relativeGMLGeometry>"#,
        polygon("t", TRIANGLE)
    );
    let named = r##"<relativeGMLGeometry xlink:href="#shape"/>"##;
    let library = "<libraryObject>tree.wrl</libraryObject>";
    for members in [[&written[..], named], [named, &written[..]]] {
        let text = model(&[tree("a", members[0]), tree("b", members[1]), tree("c", library)].concat());
        let file = read(&text);
        assert_eq!(
            file.surfaces.iter().map(|surface| (surface.object, surface.lod)).collect::<Vec<_>>(),
            [(0, Some(Lod(2, 0))), (1, Some(Lod(2, 0)))]
        );
        assert_eq!(rings(&file, 0), rings(&file, 1));
        assert_eq!(rings(&file, 1), [[[11.0, 20.0, 30.0], [11.0, 22.0, 30.0], [9.0, 20.0, 30.0]]]);
        assert_eq!(skipped(&file), [("implicit geometries whose template is another file", 1, "c")]);
    }
}

#[test]
fn a_template_that_is_placed_too_often_is_refused_before_it_is() {
    let ring = "0 0 0 1 0 0 0 1 0 ".repeat(7000);
    let shape = polygon("t", &ring);
    let shape = format!(
        r#"<relativeGMLGeometry><gml:MultiSurface gml:id="shape">{shape}</gml:MultiSurface></relativeGMLGeometry>"#
    );
    let placed = r##"<Road><lod2I><ImplicitGeometry><relativeGMLGeometry xlink:href="#shape"/>
        <referencePoint><gml:pos>1 2 3</gml:pos></referencePoint></ImplicitGeometry></lod2I></Road>"##;
    let error = refused(&model(&(tree("a", &shape) + &placed.repeat(4000))));
    assert!(error.to_string().contains("too many for"), "{error}");
}

#[test]
fn the_reference_system_is_the_envelope_s_or_a_surface_s_or_none() {
    let surface = |name: &str| {
        format!(
            "<bldg:lod2MultiSurface><gml:MultiSurface srsName='{name}'>{}</gml:MultiSurface></bldg:lod2MultiSurface>",
            polygon("p", TRIANGLE)
        )
    };
    let envelope = "<gml:boundedBy><gml:Envelope srsName='EPSG:7415' srsDimension='2'/></gml:boundedBy>";
    assert_eq!(read(&building("")).crs, None);
    assert_eq!(read(&building(&surface("CH1903"))).crs.as_deref(), Some("CH1903"));
    let file = read(&building(&[envelope, &surface("EPSG:7415"), &surface("EPSG:1")].concat()));
    assert_eq!(file.crs.as_deref(), Some("EPSG:7415"));
    assert_eq!(file.surfaces.len(), 2, "the envelope's dimension is its own");
    assert_eq!(file.skipped[0].what, "names of further reference systems (the first one is taken for all surfaces)");
}

#[test]
fn prefixes_byte_order_marks_and_versions_are_as_they_come() {
    for (version, prefix) in [("1.0", "core:"), ("2.0", ""), ("3.0", "x:")] {
        let namespace =
            if prefix.is_empty() { "xmlns".to_owned() } else { format!("xmlns:{}", prefix.trim_end_matches(':')) };
        let text = format!(
            "\u{feff}<?xml version='1.0' encoding='UTF-8'?>\n<{prefix}CityModel {namespace}='http://www.opengis.net/citygml/{version}'><{prefix}cityObjectMember><Building id='h'/></{prefix}cityObjectMember></{prefix}CityModel>"
        );
        assert!(is_citygml(text.as_bytes()));
        let file = read(&text);
        assert_eq!((file.format, file.objects[0].id.as_str()), (format!("CityGML {version}"), "h"));
    }
}

#[test]
fn features_of_extensions_are_objects_and_groups_are_none() {
    let text = model(&format!(
        r#"<cityObjectMember><x:Shed xmlns:x="x" gml:id="shed"><x:lod1Solid><gml:Solid>{}</gml:Solid></x:lod1Solid></x:Shed></cityObjectMember>
        <cityObjectMember><CityObjectGroup gml:id="g"><groupMember><bldg:Building gml:id="in"/></groupMember></CityObjectGroup></cityObjectMember>"#,
        polygon("p", TRIANGLE)
    ));
    let file = read(&text);
    let objects: Vec<_> = file.objects.iter().map(|object| (object.id.as_str(), object.parent)).collect();
    assert_eq!(objects, [("shed", None), ("in", None)]);
    assert_eq!(file.surfaces[0].shell, Some(0));
}

#[test]
fn other_encodings_are_read_by_their_declaration() {
    let text = building("").replace("\"house\"", "\"Stra\u{df}e\"");
    let declared = |name: &str| format!("<?xml version=\"1.0\" encoding=\"{name}\"?>{text}");
    let latin1: Vec<u8> = declared("ISO-8859-1").chars().map(|c| c as u32 as u8).collect();
    assert_eq!(read_citygml(&latin1[..]).unwrap().objects[0].id, "Stra\u{df}e");
    let utf16: Vec<u8> =
        [0xFEFF].into_iter().chain(declared("UTF-16").encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert!(is_citygml(&utf16));
    assert_eq!(read_citygml(&utf16[..]).unwrap().objects[0].id, "Stra\u{df}e");
    let error = refused(&declared("EBCDIC-7"));
    assert!(error.to_string().contains("`EBCDIC-7`"), "{error}");
    // Bytes that are not what is declared.
    let mut broken = declared("UTF-8").into_bytes();
    broken[200] = 0xFF;
    assert!(read_citygml(&broken[..]).is_err());
}

#[test]
fn other_xml_is_no_citygml() {
    for text in ["<kml xmlns='http://www.opengis.net/kml/2.2'/>", "{\"citygml\": 1}", "", "opengis.net/citygml"] {
        assert!(!is_citygml(text.as_bytes()), "{text}");
    }
}
