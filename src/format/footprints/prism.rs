//! A footprint and its height to a prism.

use super::outline::Outline;
use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::{Lod, SurfaceKind};

/// How far from zero a coordinate may be; the reach of the other formats.
const COORDINATE_LIMIT: f64 = 1e9;

/// Prisms in the making.
#[derive(Debug, Default)]
pub(super) struct Prisms {
    pub builder: SurfaceBuilder,
    shells: u32,
}

/// One row of the file.
pub(super) struct Footprint {
    pub id: String,
    /// From 1.
    pub record: u64,
    pub outlines: Vec<Outline>,
    pub height: Option<f64>,
    pub base: Option<f64>,
}

impl Prisms {
    /// Adds an object with one closed prism for each outline; counts a footprint that has no height.
    pub fn add(&mut self, footprint: Footprint) -> Result<(), SurfaceError> {
        let Footprint { id, record, outlines, height, base } = footprint;
        let Some(height) = height.filter(|height| height.is_finite() && *height > 0.0) else {
            self.builder.skip("footprints without a height above zero", 1, || id);
            return Ok(());
        };
        let Some(base) = base.filter(|base| base.is_finite()) else {
            self.builder.skip("footprints without a base", 1, || id);
            return Ok(());
        };
        let top = base + height;
        let corners =
            outlines.iter().flat_map(|outline| outline.holes.iter().chain([&outline.outer])).flatten().flatten();
        if !corners.chain([&top, &base]).all(|value| value.abs() <= COORDINATE_LIMIT) {
            let problem = format!("a coordinate is not finite or farther than {COORDINATE_LIMIT:e} from zero");
            return Err(SurfaceError::at(Place::Record(record), problem).of(Some(id)));
        }
        if outlines.is_empty() {
            self.builder.skip("footprints without a polygon", 1, || id);
            return Ok(());
        }
        let object = self.builder.add_object(id, "Building", None);
        outlines.iter().try_for_each(|outline| self.add_prism(object, outline, base, top))
    }

    fn add_prism(&mut self, object: u32, outline: &Outline, base: f64, top: f64) -> Result<(), SurfaceError> {
        let shell = Some(self.shells);
        self.shells += 1;
        let traits = |kind| SurfaceTraits { object, lod: Some(Lod(1, 0)), kind: Some(kind), shell };
        let rings = || std::iter::once(&outline.outer).chain(&outline.holes);
        let lid = |z: f64| rings().map(move |ring| ring.iter().map(|[x, y]| [*x, *y, z]).collect::<Vec<_>>());
        let roof: Vec<Vec<[f64; 3]>> = lid(top).collect();
        let ground: Vec<Vec<[f64; 3]>> = lid(base).map(|ring| ring.into_iter().rev().collect()).collect();
        self.builder.add_surface(ground.iter().map(Vec::as_slice), traits(SurfaceKind::Ground))?;
        for ring in rings() {
            for ([ax, ay], [bx, by]) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                let wall = [[*ax, *ay, base], [*bx, *by, base], [*bx, *by, top], [*ax, *ay, top]];
                self.builder.add_surface([&wall[..]], traits(SurfaceKind::Wall))?;
            }
        }
        self.builder.add_surface(roof.iter().map(Vec::as_slice), traits(SurfaceKind::Roof))
    }
}
