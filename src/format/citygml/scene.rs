//! What a file has come to so far: elements begin, have text, end.

use super::attributes::Attributes;
use super::context::{Context, Open, Purpose};
use super::element::Element;
use super::implicit::{Instance, Instances, Template, matrix_of};
use super::links::{Link, Links};
use super::numbers::numbers_of;
use super::polygon::Polygon;
use super::reference_system::ReferenceSystem;
use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::SurfaceFile;

/// Elements within one another. CityGML needs some thirty.
const DEEPEST: usize = 512;

/// Everything read so far.
#[derive(Debug, Default)]
pub(super) struct Scene {
    builder: SurfaceBuilder,
    open: Vec<Open>,
    polygon: Polygon,
    /// Text of the innermost element, where it is read.
    text: String,
    numbers: Vec<f64>,
    links: Links,
    instances: Instances,
    implicit: Option<Instance>,
    reference_system: ReferenceSystem,
    version: Option<String>,
    root: Option<String>,
    shells: u32,
    /// The object of surfaces that stand in no object.
    nobody: Option<u32>,
}

impl Scene {
    /// Identifier of the object that is open.
    pub fn object(&self) -> Option<String> {
        self.builder.object_id(self.open.last()?.context.object)
    }

    /// Elements that are open.
    pub fn depth(&self) -> usize {
        self.open.len()
    }

    /// Whether the text of the innermost element is wanted.
    pub fn wants_text(&self) -> bool {
        self.open.last().is_some_and(|open| open.element.has_text())
    }

    pub fn add_text(&mut self, text: &str) {
        self.text.push_str(text);
    }

    pub fn begin(&mut self, local_name: &str, attributes: Attributes<'_>) -> Result<(), String> {
        if self.open.len() >= DEEPEST {
            return Err(format!("more than {DEEPEST} elements stand within one another; this is no CityGML"));
        }
        if self.open.is_empty() {
            self.root.get_or_insert_with(|| local_name.to_owned());
        }
        self.text.clear();
        let parent = self.open.last();
        let around = parent.map_or(Element::Other, |open| open.element);
        let mut context = parent.map_or(Context::OUTERMOST, |open| open.context);
        let element = element_within(around, local_name);
        self.version = self.version.take().or(attributes.version);
        let within_polygon = self.polygon.is_open();
        if within_polygon {
            self.begin_in_polygon(element, &attributes.href, &mut context)?;
        } else {
            self.begin_around_polygon(element, local_name, attributes.id.as_deref(), &mut context)?;
        }
        if element == Element::Coordinates && attributes.has_separators {
            return Err("coordinates are separated in a way of their own; write gml:posList".to_owned());
        }
        if element == Element::Orientable && attributes.is_reversed {
            context.is_reversed = !context.is_reversed;
        }
        if let Some(name) = &attributes.srs_name {
            self.note_reference_system(element, name, context);
        }
        if let Some(dimension) = attributes.srs_dimension.filter(|_| element != Element::Envelope) {
            context.dimension = dimension_of(&dimension)?;
        }
        if let Some(href) = attributes.href.filter(|_| !within_polygon) {
            self.refer(element, around, &href, context);
        }
        if element == Element::Line && matches!(around, Element::Lod(_)) {
            self.skip("points and lines", context);
        }
        let id = attributes.id.filter(|_| element.holds_surfaces()).map(|id| id.into_owned().into_boxed_str());
        let surfaces_before = self.surfaces_for(context.purpose).surface_count();
        let links_before = self.links.count();
        self.open.push(Open { element, context, id, surfaces_before, links_before });
        Ok(())
    }

    fn begin_in_polygon(
        &mut self,
        element: Element,
        href: &Option<std::borrow::Cow<'_, str>>,
        context: &mut Context,
    ) -> Result<(), String> {
        match element {
            Element::Exterior => context.is_hole = false,
            Element::Interior => context.is_hole = true,
            Element::Ring => self.polygon.begin_ring()?,
            Element::Polygon => self.polygon.begin()?,
            Element::Curved => self.polygon.pass_over("polygons bounded by arcs or splines"),
            Element::PointProperty if href.is_some() => self.polygon.pass_over("polygons whose corners are references"),
            _ => {}
        }
        Ok(())
    }

    fn begin_around_polygon(
        &mut self,
        element: Element,
        local_name: &str,
        id: Option<&str>,
        context: &mut Context,
    ) -> Result<(), String> {
        match element {
            Element::Object => {
                let object = self.builder.add_object(id.unwrap_or_default().to_owned(), local_name, context.object);
                *context = Context { object: Some(object), lod: None, kind: None, shell: None, ..*context };
                if matches!(local_name, "MassPointRelief" | "BreaklineRelief" | "RasterRelief") {
                    self.skip("reliefs without triangles", *context);
                }
            }
            Element::Lod(lod) => context.lod = Some(lod),
            Element::Boundary(kind) => context.kind = Some(kind),
            Element::Solid if context.purpose == Purpose::Scene => {
                context.shell = Some(self.shells);
                self.shells += 1;
            }
            Element::Polygon => {
                context.is_hole = false;
                self.polygon.begin()?;
            }
            Element::PointCloud => self.skip("point clouds", *context),
            Element::Implicit => self.begin_implicit(*context)?,
            Element::TemplateProperty => context.purpose = Purpose::Template,
            Element::ReferencePoint => context.purpose = Purpose::ReferencePoint,
            Element::LibraryObject => {
                if let Some(implicit) = &mut self.implicit {
                    implicit.template = Template::Library;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn begin_implicit(&mut self, context: Context) -> Result<(), String> {
        if self.implicit.is_some() {
            return Err("implicit geometry within another; expected one after the other".to_owned());
        }
        let none_yet = self.instances.templates.surface_count();
        self.implicit = Some(Instance {
            object: self.owner(context),
            lod: context.lod,
            matrix: None,
            reference: None,
            template: Template::Inline(none_yet..none_yet),
        });
        Ok(())
    }

    fn note_reference_system(&mut self, element: Element, name: &str, context: Context) {
        let is_other = self.reference_system.note(element, name.trim());
        if is_other && context.purpose == Purpose::Scene {
            self.skip("names of further reference systems (the first one is taken for all surfaces)", context);
        }
    }

    /// Keeps a reference to a geometry, a template or a part.
    fn refer(&mut self, element: Element, around: Element, href: &str, context: Context) {
        match (element, &mut self.implicit, context.object) {
            (Element::TemplateProperty, Some(implicit), _) => implicit.template = Template::Named(href.into()),
            (Element::PartProperty, _, Some(object)) => self.links.add_part(object, href),
            (Element::Lod(_), ..) => self.link(href, context),
            _ if around.holds_surfaces() => self.link(href, context),
            _ => {}
        }
    }

    fn link(&mut self, href: &str, context: Context) {
        let Context { kind, shell, is_reversed, .. } = context;
        if context.purpose == Purpose::Scene {
            self.links.add(Link { href: href.into(), kind, shell, is_reversed });
        } else {
            self.skip("references within implicit geometries", context);
        }
    }

    pub fn end(&mut self) -> Result<(), SurfaceError> {
        let Some(open) = self.open.pop() else { return Ok(()) };
        let ended = self.end_element(&open);
        ended.map_err(|error| error.of(self.builder.object_id(open.context.object)))?;
        if let Some(id) = open.id {
            let surfaces = open.surfaces_before..self.surfaces_for(open.context.purpose).surface_count();
            if open.context.purpose == Purpose::Scene {
                self.links.add_target(id, surfaces, open.links_before..self.links.count());
            } else {
                self.instances.ids.entry(id).or_insert(surfaces);
            }
        }
        Ok(())
    }

    fn end_element(&mut self, open: &Open) -> Result<(), SurfaceError> {
        let wrong = |problem: String| SurfaceError::whole(problem);
        match open.element {
            Element::Position | Element::Positions | Element::Coordinates => {
                self.take_positions(open).map_err(wrong)?;
            }
            Element::Ring if self.polygon.is_open() => self.polygon.end_ring(open.context.is_hole),
            Element::Polygon => self.end_polygon(open.context)?,
            Element::Matrix => {
                if let Some(implicit) = &mut self.implicit {
                    numbers_of(&self.text, open.element, &mut self.numbers).map_err(wrong)?;
                    implicit.matrix = Some(matrix_of(&self.numbers).map_err(wrong)?);
                }
            }
            Element::LodText => self.take_lod(),
            Element::Implicit => self.instances.instances.extend(self.implicit.take()),
            Element::TemplateProperty => {
                let end = self.instances.templates.surface_count();
                if let Some(Instance { template: Template::Inline(surfaces), .. }) = &mut self.implicit {
                    surfaces.end = end;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn take_positions(&mut self, open: &Open) -> Result<(), String> {
        let is_point = open.context.purpose == Purpose::ReferencePoint;
        if !is_point && !self.polygon.is_ring_open() {
            return Ok(());
        }
        numbers_of(&self.text, open.element, &mut self.numbers)?;
        let (count, dimension) = (self.numbers.len(), open.context.dimension);
        if count % dimension != 0 || (open.element == Element::Position && count != dimension) {
            return Err(format!(
                "{count} numbers do not make positions of {dimension}; expected x y z of every corner"
            ));
        }
        let mut positions = self.numbers.chunks_exact(3).map(|position| [position[0], position[1], position[2]]);
        if dimension != 3 {
            self.polygon.pass_over("polygons without heights (in two dimensions)");
        } else if !is_point {
            self.polygon.add(positions);
        } else if let Some(implicit) = &mut self.implicit {
            implicit.reference = positions.next_back();
        }
        Ok(())
    }

    fn end_polygon(&mut self, context: Context) -> Result<(), SurfaceError> {
        let object = self.owner(context);
        let short_holes = self.polygon.short_holes();
        let mut rings = match self.polygon.end() {
            Ok(rings) => rings,
            Err(defect) => {
                self.skip(defect, context);
                return Ok(());
            }
        };
        if context.is_reversed {
            rings.iter_mut().for_each(|ring| ring.reverse());
        }
        let Context { lod, kind, shell, .. } = context;
        let builder = match context.purpose {
            Purpose::Template => &mut self.instances.templates,
            _ => &mut self.builder,
        };
        builder.add_surface(rings.iter().map(|ring| &**ring), SurfaceTraits { object, lod, kind, shell })?;
        if short_holes > 0 {
            let example = self.builder.object_id(Some(object)).unwrap_or_default();
            self.builder.skip("holes with less than three corners", short_holes, || example);
        }
        Ok(())
    }

    /// The text is the level of detail of the object around it.
    fn take_lod(&mut self) {
        let level = self.text.trim().parse().ok().map(|level| crate::format::surfaces::Lod(level, 0));
        if let Some(open) = self.open.last_mut().filter(|open| open.element == Element::Object) {
            open.context.lod = open.context.lod.or(level);
        }
    }

    fn owner(&mut self, context: Context) -> u32 {
        let builder = &mut self.builder;
        context
            .object
            .unwrap_or_else(|| *self.nobody.get_or_insert_with(|| builder.add_object(String::new(), "CityModel", None)))
    }

    fn surfaces_for(&self, purpose: Purpose) -> &SurfaceBuilder {
        if purpose == Purpose::Template { &self.instances.templates } else { &self.builder }
    }

    fn skip(&mut self, what: &'static str, context: Context) {
        let example = self.builder.object_id(context.object).unwrap_or_default();
        self.builder.skip(what, 1, || example);
    }

    /// The whole file, when its end has come.
    pub fn finish(mut self, file_bytes: u64) -> Result<SurfaceFile, SurfaceError> {
        let Some(version) = self.version else {
            let root = self.root.unwrap_or_default();
            return Err(SurfaceError::whole(format!(
                "the XML begins with `{root}` and declares no namespace of CityGML; expected a CityGML file"
            )));
        };
        self.links.resolve(&mut self.builder)?;
        self.instances.place(&mut self.builder, file_bytes)?;
        self.builder.file.format = format!("CityGML {version}");
        self.builder.file.crs = self.reference_system.name().map(str::to_owned);
        Ok(self.builder.file)
    }
}

/// Features of extensions have names of their own; they are told by standing where objects do.
fn element_within(around: Element, local_name: &str) -> Element {
    let element = Element::of(local_name);
    let is_feature = element == Element::Other && local_name.starts_with(|c: char| c.is_ascii_uppercase());
    let is_group = matches!(local_name, "CityObjectGroup" | "Appearance");
    if around == Element::Member && is_feature && !is_group { Element::Object } else { element }
}

fn dimension_of(text: &str) -> Result<usize, String> {
    match text.trim() {
        "3" => Ok(3),
        "2" => Ok(2),
        other => Err(format!("srsDimension is `{other}`; expected 3")),
    }
}
