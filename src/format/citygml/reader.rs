//! XML events to the scene, and errors with their place.

use std::io::BufRead;

use quick_xml::Reader;
use quick_xml::events::{BytesRef, Event};

use super::attributes::Attributes;
use super::scene::Scene;
use super::source::{LineCounter, Text, text_of};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// Bytes within which a CityGML file declares its namespaces, after whatever remarks.
const LOOKED_AT: usize = 1 << 16;

/// Whether a file that begins with these bytes is CityGML: XML in which a namespace of it is declared.
pub fn is_citygml(start: &[u8]) -> bool {
    let start = &start[..start.len().min(LOOKED_AT)];
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start).trim_ascii_start();
    // In UTF-16 every letter takes two bytes.
    let ascii: Vec<u8> = match start {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => start[2..].iter().copied().filter(|&byte| byte != 0).collect(),
        _ => text.to_vec(),
    };
    ascii.starts_with(b"<") && memchr::memmem::find(&ascii, b"opengis.net/citygml").is_some()
}

/// Reads a file of any length: what is held is its surfaces, and one text at a time.
pub fn read_citygml(source: impl BufRead) -> Result<SurfaceFile, SurfaceError> {
    match text_of(source)? {
        Text::Utf8(source) => CityGml::new(source).read(),
        Text::Other(source) => CityGml::new(source).read(),
    }
}

struct CityGml<R: BufRead> {
    xml: Reader<LineCounter<R>>,
    scene: Scene,
}

impl<R: BufRead> CityGml<R> {
    fn new(source: R) -> CityGml<R> {
        let mut xml = Reader::from_reader(LineCounter::new(source));
        xml.config_mut().expand_empty_elements = true;
        CityGml { xml, scene: Scene::default() }
    }

    fn read(mut self) -> Result<SurfaceFile, SurfaceError> {
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            match self.xml.read_event_into(&mut buffer) {
                Ok(Event::Eof) => return self.finish(),
                Ok(event) => self.take(event)?,
                Err(error) => {
                    return Err(
                        self.here(SurfaceError::whole(format!("the XML is broken: {error}; write the file again")))
                    );
                }
            }
        }
    }

    fn take(&mut self, event: Event<'_>) -> Result<(), SurfaceError> {
        let taken = match event {
            Event::Start(element) => Attributes::of(&element)
                .map_err(|error| format!("the XML is broken: {error}; write the file again"))
                .and_then(|attributes| self.scene.begin(element.local_name().as_ref(), attributes))
                .map_err(SurfaceError::whole),
            Event::End(_) => self.scene.end(),
            Event::Text(text) if self.scene.wants_text() => {
                self.scene.add_text(&text);
                Ok(())
            }
            Event::CData(text) if self.scene.wants_text() => {
                self.scene.add_text(&text);
                Ok(())
            }
            Event::GeneralRef(reference) if self.scene.wants_text() => self.take_reference(&reference),
            _ => Ok(()),
        };
        taken.map_err(|error| self.here(error))
    }

    /// A character by its number. Entities are not expanded: what a document type says of them may be endless.
    fn take_reference(&mut self, reference: &BytesRef<'_>) -> Result<(), SurfaceError> {
        match reference.resolve_char_ref() {
            Ok(Some(character)) => {
                self.scene.add_text(character.encode_utf8(&mut [0; 4]));
                Ok(())
            }
            _ => Err(SurfaceError::whole(format!("entity `&{};` among coordinates; expected numbers", &**reference))),
        }
    }

    /// quick-xml takes the end of a file that is cut between two elements for a good one.
    fn finish(self) -> Result<SurfaceFile, SurfaceError> {
        if self.scene.depth() > 0 {
            let what = format!("the file is cut off: {} elements have no end; get it again", self.scene.depth());
            return Err(self.here(SurfaceError::whole(what)));
        }
        let bytes = self.xml.buffer_position();
        self.scene.finish(bytes)
    }

    /// Says where an error was met.
    fn here(&self, error: SurfaceError) -> SurfaceError {
        let line = self.xml.get_ref().line;
        let place = Place::Line { line, byte: self.xml.buffer_position() };
        SurfaceError { place, ..error }.of(self.scene.object())
    }
}
