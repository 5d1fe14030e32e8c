//! Geometries of a GeoPackage: its own header, then well-known binary (OGC 12-128r19, 2.1.3; OGC 06-103r4, 8.2).

use super::outline::{Outline, cleaned};

/// Bytes of the bounding box by the code in the header's flags.
const ENVELOPE_BYTES: [usize; 5] = [0, 32, 48, 48, 64];

/// Collections within one another.
const DEEPEST: usize = 8;

/// What a geometry comes to.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Polygons {
    pub outlines: Vec<Outline>,
    pub has_heights: bool,
    pub flat_rings: usize,
    /// Points, lines, and surfaces bounded by curves.
    pub others: usize,
}

/// Reads a geometry blob.
pub(super) fn polygons_of(blob: &[u8]) -> Result<Polygons, String> {
    let [b'G', b'P', _, flags, ..] = *blob else {
        return Err("the geometry does not begin with `GP`; expected that of a GeoPackage".to_owned());
    };
    let code = usize::from(flags >> 1 & 7);
    let envelope = ENVELOPE_BYTES
        .get(code)
        .ok_or_else(|| format!("the geometry has an envelope of code {code}, expected 0 to 4"))?;
    let mut polygons = Polygons::default();
    let is_empty = flags & 0x10 != 0;
    if !is_empty {
        let rest = blob.get(8 + envelope..).ok_or_else(cut)?;
        Reader { rest, is_little: true }.geometry(&mut polygons, 0)?;
    }
    Ok(polygons)
}

fn cut() -> String {
    "the geometry is cut off, or says more points than it has; write the GeoPackage again".to_owned()
}

struct Reader<'a> {
    rest: &'a [u8],
    is_little: bool,
}

impl Reader<'_> {
    fn geometry(&mut self, found: &mut Polygons, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err(format!("more than {DEEPEST} collections stand within one another"));
        }
        self.is_little = self.take::<1>()? == [1];
        let kind = self.number()?;
        // ISO adds thousands for z and m, others set the highest bits.
        let (has_z, has_m) = match (kind & 0xFFFF) / 1000 {
            1 => (true, false),
            2 => (false, true),
            3 => (true, true),
            _ => (kind & 0x8000_0000 != 0, kind & 0x4000_0000 != 0),
        };
        if kind & 0x2000_0000 != 0 {
            self.number()?;
        }
        let dimension = 2 + usize::from(has_z) + usize::from(has_m);
        match (kind & 0xFFFF) % 1000 {
            3 | 17 => {
                found.has_heights |= has_z;
                self.polygon(found, dimension)
            }
            4..=7 | 11 | 12 | 15 | 16 => {
                for _ in 0..self.number()? {
                    self.geometry(found, depth + 1)?;
                }
                Ok(())
            }
            1 => {
                found.others += 1;
                self.skip(1, dimension)
            }
            2 | 8 => {
                found.others += 1;
                let count = self.number()?;
                self.skip(count, dimension)
            }
            9 | 10 => {
                found.others += 1;
                let mut curves = Polygons::default();
                for _ in 0..self.number()? {
                    self.geometry(&mut curves, depth + 1)?;
                }
                Ok(())
            }
            other => Err(format!("the geometry is of the unknown type {other}; expected polygons")),
        }
    }

    fn polygon(&mut self, found: &mut Polygons, dimension: usize) -> Result<(), String> {
        let mut rings = Vec::new();
        let mut has_outline = true;
        for number in 0..self.number()? {
            let count = self.number()? as usize;
            let bytes = count.checked_mul(8 * dimension).filter(|&bytes| bytes <= self.rest.len()).ok_or_else(cut)?;
            let mut ring = Vec::with_capacity(bytes / (8 * dimension));
            for _ in 0..count {
                ring.push([self.float()?, self.float()?]);
                self.advance(8 * (dimension - 2))?;
            }
            match cleaned(&ring) {
                Some(ring) => rings.push(ring),
                None => {
                    found.flat_rings += 1;
                    has_outline &= number > 0;
                }
            }
        }
        if has_outline && !rings.is_empty() {
            let outer = rings.remove(0);
            found.outlines.push(Outline::new(outer, rings));
        }
        Ok(())
    }

    fn skip(&mut self, points: u32, dimension: usize) -> Result<(), String> {
        self.advance((points as usize).checked_mul(8 * dimension).ok_or_else(cut)?)
    }

    fn advance(&mut self, bytes: usize) -> Result<(), String> {
        self.rest = self.rest.get(bytes..).ok_or_else(cut)?;
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (taken, rest) = self.rest.split_first_chunk::<N>().ok_or_else(cut)?;
        self.rest = rest;
        Ok(*taken)
    }

    fn number(&mut self) -> Result<u32, String> {
        let bytes = self.take()?;
        Ok(if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    fn float(&mut self) -> Result<f64, String> {
        let bytes = self.take()?;
        Ok(if self.is_little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }
}
