//! One polygon while it is read.

/// Rings of a polygon, one after the other; memory is kept from polygon to polygon.
#[derive(Debug, Default)]
pub(super) struct Polygon {
    is_open: bool,
    points: Vec<[f64; 3]>,
    /// Rings that have ended: their end in `points`.
    ring_ends: Vec<usize>,
    /// Where the outline stands among the rings.
    outline: Option<usize>,
    is_ring_open: bool,
    short_holes: usize,
    /// A reason to pass it over.
    defect: Option<&'static str>,
}

/// A ring cannot begin or end where it does.
pub(super) const MISPLACED: &str = "ring or polygon within another; expected one after the other";

impl Polygon {
    pub fn begin(&mut self) -> Result<(), String> {
        if self.is_open {
            return Err(MISPLACED.to_owned());
        }
        self.points.clear();
        self.ring_ends.clear();
        (self.outline, self.is_open, self.is_ring_open, self.short_holes, self.defect) = (None, true, false, 0, None);
        Ok(())
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }

    pub fn begin_ring(&mut self) -> Result<(), String> {
        if std::mem::replace(&mut self.is_ring_open, true) {
            return Err(MISPLACED.to_owned());
        }
        Ok(())
    }

    /// Whether positions belong to it.
    pub fn is_ring_open(&self) -> bool {
        self.is_open && self.is_ring_open
    }

    pub fn pass_over(&mut self, defect: &'static str) {
        self.defect.get_or_insert(defect);
    }

    /// Adds positions to the ring that is open; what repeats the corner before is none (curves of a ring touch there).
    pub fn add(&mut self, positions: impl Iterator<Item = [f64; 3]>) {
        let start = self.ring_ends.last().copied().unwrap_or(0);
        for position in positions {
            if self.points.len() == start || self.points.last() != Some(&position) {
                self.points.push(position);
            }
        }
    }

    pub fn end_ring(&mut self, is_hole: bool) {
        self.is_ring_open = false;
        let start = self.ring_ends.last().copied().unwrap_or(0);
        let is_closed = self.points.len() > start + 1 && self.points.last() == Some(&self.points[start]);
        if is_closed {
            self.points.pop();
        }
        let corners = self.points.len() - start;
        match (is_hole, self.outline) {
            (true, _) if corners < 3 => {
                self.points.truncate(start);
                self.short_holes += 1;
            }
            (true, _) => self.ring_ends.push(self.points.len()),
            (false, None) if corners >= 3 => {
                self.outline = Some(self.ring_ends.len());
                self.ring_ends.push(self.points.len());
            }
            (false, None) => self.pass_over("polygons with less than three corners"),
            (false, Some(_)) => self.pass_over("polygons with two outlines"),
        }
    }

    /// Ends the polygon: its outline and then its holes, or why it is passed over.
    pub fn end(&mut self) -> Result<Vec<&mut [[f64; 3]]>, &'static str> {
        self.is_open = false;
        if let Some(defect) = self.defect {
            return Err(defect);
        }
        let outline = self.outline.ok_or("polygons without an outline")?;
        let mut rings = Vec::with_capacity(self.ring_ends.len());
        let (mut rest, mut start) = (&mut self.points[..], 0);
        for &end in &self.ring_ends {
            let (ring, after) = rest.split_at_mut(end - start);
            rings.push(ring);
            (rest, start) = (after, end);
        }
        rings.swap(0, outline);
        Ok(rings)
    }

    /// Holes that were left out, having less than three corners.
    pub fn short_holes(&self) -> usize {
        self.short_holes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(polygon: &mut Polygon, corners: &[[f64; 3]], is_hole: bool) {
        polygon.begin_ring().unwrap();
        polygon.add(corners.iter().copied());
        polygon.end_ring(is_hole);
    }

    const A: [f64; 3] = [0.0; 3];
    const B: [f64; 3] = [1.0, 0.0, 0.0];
    const C: [f64; 3] = [0.0, 1.0, 0.0];

    #[test]
    fn corners_that_repeat_the_one_before_and_the_closing_one_are_none() {
        let mut polygon = Polygon::default();
        polygon.begin().unwrap();
        ring(&mut polygon, &[A, A, B, B, B, C, C, A], false);
        assert_eq!(polygon.end().unwrap(), [[A, B, C]]);
    }

    #[test]
    fn nothing_is_left_of_the_polygon_before() {
        let mut polygon = Polygon::default();
        polygon.begin().unwrap();
        ring(&mut polygon, &[A, B], false);
        polygon.pass_over("a reason that comes second");
        assert_eq!(polygon.end(), Err("polygons with less than three corners"));
        polygon.begin().unwrap();
        ring(&mut polygon, &[C, B, A], false);
        ring(&mut polygon, &[A, B], true);
        assert_eq!(polygon.short_holes(), 1);
        assert_eq!(polygon.end().unwrap(), [[C, B, A]]);
    }

    #[test]
    fn two_outlines_are_no_polygon() {
        let mut polygon = Polygon::default();
        polygon.begin().unwrap();
        ring(&mut polygon, &[A, B, C], false);
        ring(&mut polygon, &[A, B, C], false);
        assert_eq!(polygon.end(), Err("polygons with two outlines"));
    }

    #[test]
    fn rings_and_polygons_do_not_nest() {
        let mut polygon = Polygon::default();
        polygon.begin().unwrap();
        assert!(polygon.begin().is_err());
        polygon.begin_ring().unwrap();
        assert!(polygon.begin_ring().is_err() && polygon.is_ring_open());
    }
}
