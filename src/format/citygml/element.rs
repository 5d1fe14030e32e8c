//! What the elements of CityGML mean for a reader of polygons.

use crate::format::surfaces::{Lod, SurfaceKind};

/// An element by its local name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    /// A feature that is kept as an object.
    Object,
    /// Holds features: `cityObjectMember`.
    Member,
    /// Holds parts of an object, or names them: `consistsOfBuildingPart`.
    PartProperty,
    /// Holds a geometry of this level of detail: `lod2Solid`.
    Lod(Lod),
    /// Level of detail as text: `dem:lod`.
    LodText,
    /// A surface of a building: `WallSurface`.
    Boundary(SurfaceKind),
    /// Polygon, patch or triangle: one surface.
    Polygon,
    Solid,
    /// Any other geometry that holds surfaces.
    Surfaces,
    /// Holds a surface and turns it where its orientation is `-`.
    Orientable,
    Exterior,
    Interior,
    Ring,
    Position,
    Positions,
    Coordinates,
    /// A point that a ring names, and does not hold.
    PointProperty,
    /// An arc or spline.
    Curved,
    /// Points and lines.
    Line,
    PointCloud,
    /// A template, placed.
    Implicit,
    TemplateProperty,
    Matrix,
    ReferencePoint,
    LibraryObject,
    Envelope,
    Other,
}

impl Element {
    /// Geometries and what holds them.
    pub fn of(local_name: &str) -> Element {
        match local_name {
            "Polygon" | "PolygonPatch" | "Triangle" | "Rectangle" => Element::Polygon,
            "LinearRing" | "Ring" => Element::Ring,
            "exterior" | "outerBoundaryIs" => Element::Exterior,
            "interior" | "innerBoundaryIs" => Element::Interior,
            "posList" => Element::Positions,
            "pos" => Element::Position,
            "coordinates" => Element::Coordinates,
            "pointProperty" | "pointRep" => Element::PointProperty,
            "Solid" => Element::Solid,
            "MultiSurface"
            | "CompositeSurface"
            | "Shell"
            | "Surface"
            | "PolyhedralSurface"
            | "TriangulatedSurface"
            | "Tin"
            | "CompositeSolid"
            | "MultiSolid"
            | "MultiGeometry"
            | "GeometricComplex" => Element::Surfaces,
            "OrientableSurface" | "TexturedSurface" | "_TexturedSurface" => Element::Orientable,
            "Arc"
            | "ArcString"
            | "ArcByCenterPoint"
            | "ArcByBulge"
            | "ArcStringByBulge"
            | "Circle"
            | "CircleByCenterPoint"
            | "CubicSpline"
            | "BSpline"
            | "Bezier"
            | "Clothoid"
            | "OffsetCurve" => Element::Curved,
            "MultiCurve" | "MultiPoint" | "Point" | "LineString" | "Curve" | "CompositeCurve" | "OrientableCurve" => {
                Element::Line
            }
            "PointCloud" => Element::PointCloud,
            "ImplicitGeometry" => Element::Implicit,
            "relativeGMLGeometry" | "relativeGeometry" => Element::TemplateProperty,
            "transformationMatrix" => Element::Matrix,
            "referencePoint" => Element::ReferencePoint,
            "libraryObject" => Element::LibraryObject,
            "Envelope" => Element::Envelope,
            "cityObjectMember" | "featureMember" | "featureMembers" | "member" => Element::Member,
            "lod" => Element::LodText,
            _ => Element::of_feature(local_name),
        }
    }

    fn of_feature(local_name: &str) -> Element {
        if let Some(kind) = boundary(local_name) {
            Element::Boundary(kind)
        } else if is_object(local_name) {
            Element::Object
        } else if let Some(lod) = lod(local_name) {
            Element::Lod(lod)
        } else if local_name.starts_with(|c: char| c.is_ascii_lowercase()) && local_name.ends_with("Part") {
            Element::PartProperty
        } else {
            Element::Other
        }
    }

    /// Whether it is a geometry that may hold surfaces.
    pub fn holds_surfaces(self) -> bool {
        matches!(self, Element::Polygon | Element::Solid | Element::Surfaces | Element::Orientable)
    }

    /// Whether its text is read.
    pub fn has_text(self) -> bool {
        use Element::*;
        matches!(self, Position | Positions | Coordinates | Matrix | LodText)
    }
}

/// `lod2Solid` is of level 2.
fn lod(local_name: &str) -> Option<Lod> {
    let level = local_name.strip_prefix("lod")?.bytes().next()?;
    level.is_ascii_digit().then(|| Lod(level - b'0', 0))
}

fn boundary(local_name: &str) -> Option<SurfaceKind> {
    match local_name {
        "GroundSurface" => Some(SurfaceKind::Ground),
        "RoofSurface" => Some(SurfaceKind::Roof),
        "WallSurface" => Some(SurfaceKind::Wall),
        "ClosureSurface" => Some(SurfaceKind::Closure),
        "Window" | "Door" | "TrafficArea" | "AuxiliaryTrafficArea" | "Marking" => Some(SurfaceKind::Other),
        _ if local_name.starts_with(|c: char| c.is_ascii_uppercase()) && local_name.ends_with("Surface") => {
            Some(SurfaceKind::Other)
        }
        _ => None,
    }
}

/// Feature types of CityGML 1 to 3 that can have geometry of their own. Further ones (of an extension) are known by what holds them.
fn is_object(local_name: &str) -> bool {
    const PARTS: [&str; 6] = ["Part", "Installation", "Room", "Furniture", "ConstructiveElement", "Relief"];
    const OBJECTS: [&str; 30] = [
        "Building",
        "Bridge",
        "Tunnel",
        "OtherConstruction",
        "BuildingUnit",
        "Storey",
        "HollowSpace",
        "BridgeConstructionElement",
        "SolitaryVegetationObject",
        "PlantCover",
        "WaterBody",
        "LandUse",
        "CityFurniture",
        "GenericCityObject",
        "GenericOccupiedSpace",
        "GenericUnoccupiedSpace",
        "GenericLogicalSpace",
        "ReliefFeature",
        "TransportationComplex",
        "Road",
        "Railway",
        "Track",
        "Square",
        "Waterway",
        "Section",
        "Intersection",
        "TrafficSpace",
        "AuxiliaryTrafficSpace",
        "ClearanceSpace",
        "Hole",
    ];
    local_name.starts_with(|c: char| c.is_ascii_uppercase())
        && (OBJECTS.contains(&local_name) || PARTS.iter().any(|ending| local_name.ends_with(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_of_all_three_versions_are_objects() {
        for name in [
            "Building",
            "BuildingPart",
            "BuildingInstallation",
            "IntBuildingInstallation",
            "BuildingConstructiveElement",
            "BuildingRoom",
            "Room",
            "BridgePart",
            "TunnelInstallation",
            "OtherConstruction",
            "SolitaryVegetationObject",
            "WaterBody",
            "Road",
            "TrafficSpace",
            "GenericCityObject",
            "TINRelief",
            "CityFurniture",
        ] {
            assert_eq!(Element::of(name), Element::Object, "{name}");
        }
        for name in ["Address", "CityModel", "Appearance", "ExternalReference", "outerBuildingInstallation", "building"]
        {
            assert_eq!(Element::of(name), Element::Other, "{name}");
        }
    }

    #[test]
    fn surfaces_of_geometry_are_no_boundaries() {
        for name in ["MultiSurface", "CompositeSurface", "Surface", "PolyhedralSurface", "TriangulatedSurface"] {
            assert_eq!(Element::of(name), Element::Surfaces, "{name}");
        }
        assert_eq!(Element::of("OrientableSurface"), Element::Orientable);
        for name in
            ["FloorSurface", "CeilingSurface", "WaterSurface", "InteriorWallSurface", "DoorSurface", "TrafficArea"]
        {
            assert_eq!(Element::of(name), Element::Boundary(SurfaceKind::Other), "{name}");
        }
        assert_eq!(Element::of("baseSurface"), Element::Other, "a property");
    }

    #[test]
    fn levels_are_read_from_the_names_of_properties() {
        for (name, level) in [("lod0FootPrint", 0), ("lod1Solid", 1), ("lod2MultiSurface", 2), ("lod4Geometry", 4)] {
            assert_eq!(Element::of(name), Element::Lod(Lod(level, 0)), "{name}");
        }
        assert_eq!(Element::of("lod"), Element::LodText);
        for name in ["lodging", "LOD2", "slod2"] {
            assert_eq!(Element::of(name), Element::Other, "{name}");
        }
    }

    #[test]
    fn parts_are_held_by_properties_in_small_letters() {
        for name in ["consistsOfBuildingPart", "buildingPart", "consistsOfBridgePart", "tunnelPart"] {
            assert_eq!(Element::of(name), Element::PartProperty, "{name}");
        }
    }
}
