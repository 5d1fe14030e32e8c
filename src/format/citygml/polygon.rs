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
