//! A CityJSON text, or a sequence of features, to surfaces.

use super::assembly::{Assembly, Vertices};
use super::document::{CityObject, Document, Transform};
use super::fault::{CityJsonError, CityJsonProblem, Fault, place_of};
use super::objects::Ties;
use super::templates::{Template, read_templates};
use super::vertices::read_vertices;
use crate::format::surfaces::{ObjectRecord, SurfaceFile};

/// Versions that are read; smaller steps (1.0.3) differ in nothing that matters here.
const VERSIONS: [&str; 3] = ["1.0", "1.1", "2.0"];

/// What may stand between the values of a sequence.
const JSON_BLANKS: [char; 4] = [' ', '\t', '\r', '\n'];

/// Reads CityJSON or CityJSONSeq that is wholly in memory: the latter's features follow the header, each a JSON object.
pub fn read_cityjson(bytes: &[u8]) -> Result<SurfaceFile, CityJsonError> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes)
        .map_err(|error| Fault::at(error.valid_up_to(), CityJsonProblem::NotUtf8).in_text(bytes))?;
    read_text(text).map_err(|fault| fault.in_text(bytes))
}

fn read_text(text: &str) -> Result<SurfaceFile, Fault> {
    let mut rest = text;
    let header = next_document(text, &mut rest)?;
    let byte = place_of(text, text.trim_start_matches(JSON_BLANKS));
    match header.kind.as_deref() {
        Some("CityJSON") => {}
        Some("CityJSONFeature") => return Err(Fault::at(byte, CityJsonProblem::NoHeader)),
        Some(other) => return Err(Fault::at(byte, wrong_type(other, "CityJSON"))),
        None => return Err(Fault::at(byte, CityJsonProblem::Missing { what: "`type`" })),
    }
    let version = version_of(&header).map_err(|problem| Fault::at(byte, problem))?;
    let transform = checked(header.transform.unwrap_or_default()).map_err(|problem| Fault::at(byte, problem))?;
    let templates = header.templates.as_ref().map_or(Ok(Vec::new()), |list| read_templates(text, list))?;
    let mut assembly = Assembly::new(text);
    assembly.file.format = format!("CityJSON {version}");
    assembly.file.crs = header.crs();
    assembly.file.step = header.transform.map(|transform| transform.scale.into_iter().fold(0.0, f64::max));
    add_document(&mut assembly, text, &header, &transform, &templates)?;
    rest = rest.trim_start_matches(JSON_BLANKS);
    if !rest.is_empty() {
        assembly.file.format.push_str(" Seq");
    }
    while !rest.is_empty() {
        let byte = place_of(text, rest);
        let feature = next_document(text, &mut rest)?;
        match feature.kind.as_deref() {
            Some("CityJSONFeature") => {}
            other => return Err(Fault::at(byte, wrong_type(other.unwrap_or("(none)"), "CityJSONFeature"))),
        }
        let own = feature.transform.map(checked).transpose().map_err(|problem| Fault::at(byte, problem))?;
        add_document(&mut assembly, text, &feature, &own.unwrap_or(transform), &templates)?;
        rest = rest.trim_start_matches(JSON_BLANKS);
    }
    Ok(assembly.file)
}

/// Takes the next JSON value off the text that is left.
fn next_document<'a>(text: &'a str, rest: &mut &'a str) -> Result<Document<'a>, Fault> {
    let mut values = serde_json::Deserializer::from_str(rest).into_iter::<Document<'a>>();
    let found = values.next();
    let read = values.byte_offset();
    let here = std::mem::take(rest);
    match found {
        Some(Ok(document)) => {
            *rest = here.get(read..).unwrap_or_default();
            Ok(document)
        }
        Some(Err(error)) => Err(Fault::json(place_of(text, here), here, &error)),
        None => Err(Fault::at(0, CityJsonProblem::CutOff { message: "there is nothing in it".into() })),
    }
}

fn wrong_type(found: &str, expected: &'static str) -> CityJsonProblem {
    CityJsonProblem::Type { found: found.to_owned(), expected }
}

fn version_of(header: &Document<'_>) -> Result<&'static str, CityJsonProblem> {
    let found = match &header.version {
        Some(serde_json::Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
        None => return Err(CityJsonProblem::Missing { what: "`version`" }),
    };
    let is_of =
        |version: &str| found.strip_prefix(version).is_some_and(|step| step.is_empty() || step.starts_with('.'));
    VERSIONS.into_iter().find(|version| is_of(version)).ok_or(CityJsonProblem::Version { found })
}

fn checked(transform: Transform) -> Result<Transform, CityJsonProblem> {
    let refused = |what, values, expected| Err(CityJsonProblem::Transform { what, values, expected });
    match transform {
        Transform { scale, .. } if !scale.iter().all(|step| step.is_finite() && *step > 0.0) => {
            refused("scale", scale, " above 0")
        }
        Transform { translate, .. } if !translate.iter().all(|shift| shift.is_finite()) => {
            refused("translate", translate, "")
        }
        transform => Ok(transform),
    }
}

/// Adds the vertices and objects of a file or a feature.
fn add_document(
    assembly: &mut Assembly<'_>,
    text: &str,
    document: &Document<'_>,
    transform: &Transform,
    templates: &[Option<Template>],
) -> Result<(), Fault> {
    let first = assembly.file.positions.len();
    if let Some(vertices) = document.vertices {
        read_vertices(vertices.get(), place_of(text, vertices.get()), transform, &mut assembly.file.positions)?;
    }
    let vertices = Vertices { first, count: assembly.file.positions.len() - first };
    let first_object = assembly.file.objects.len();
    let mut ties = Ties::default();
    for (id, part) in document.objects.iter().flat_map(|objects| &objects.0) {
        let byte = place_of(text, part.get());
        let object = serde_json::from_str::<CityObject<'_>>(part.get())
            .map_err(|error| Fault::json(byte, part.get(), &error).of(id))?;
        let at = u32::try_from(assembly.file.objects.len()).map_err(|_| Fault::at(byte, CityJsonProblem::TooMany))?;
        let class = object.class.unwrap_or_default();
        assembly.file.objects.push(ObjectRecord { id: id.clone(), class, parent: None });
        ties.parents.extend(object.parents.into_iter().flatten().map(|parent| (at, parent)));
        ties.children.extend(object.children.into_iter().flatten().map(|child| (at, child)));
        for geometry in object.geometry.iter().flatten() {
            assembly.add(at, geometry, &vertices, templates).map_err(|fault| fault.of(id))?;
        }
    }
    let loose = ties.resolve(&mut assembly.file.objects, first_object);
    for (what, objects) in [
        ("parents and children that the file does not have", loose.missing),
        ("objects that are parts of themselves", loose.circular),
    ] {
        objects.into_iter().for_each(|object| assembly.skip(what, 1, object));
    }
    Ok(())
}
