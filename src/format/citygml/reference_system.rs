//! In which reference system the coordinates are, from the many places where a file may say it.

use super::element::Element;

/// Names by where they stood; the first of each.
#[derive(Debug, Default)]
pub(super) struct ReferenceSystem {
    of_envelope: Option<String>,
    of_surface: Option<String>,
    of_anything: Option<String>,
}

impl ReferenceSystem {
    /// Takes notice of a name; tells whether it is another than the surfaces before had.
    pub fn note(&mut self, element: Element, name: &str) -> bool {
        let place = match element {
            Element::Envelope => &mut self.of_envelope,
            element if element.holds_surfaces() || element == Element::Ring => &mut self.of_surface,
            _ => &mut self.of_anything,
        };
        place.get_or_insert_with(|| name.to_owned());
        let is_of_surface = element.holds_surfaces() || element == Element::Ring;
        is_of_surface && self.name() != Some(name)
    }

    /// The envelope's, else a surface's, else any.
    pub fn name(&self) -> Option<&str> {
        self.of_envelope.as_deref().or(self.of_surface.as_deref()).or(self.of_anything.as_deref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_envelope_comes_before_surfaces_and_these_before_all_else() {
        let mut system = ReferenceSystem::default();
        assert_eq!(system.name(), None);
        assert!(!system.note(Element::Line, "of a point"));
        assert_eq!(system.name(), Some("of a point"));
        assert!(!system.note(Element::Polygon, "of a polygon"));
        assert_eq!(system.name(), Some("of a polygon"));
        assert!(!system.note(Element::Envelope, "of an envelope"));
        assert_eq!(system.name(), Some("of an envelope"));
        assert!(system.note(Element::Solid, "another"), "of a surface, and not the file's");
        assert!(!system.note(Element::Envelope, "another"), "an envelope holds no surface");
    }
}
