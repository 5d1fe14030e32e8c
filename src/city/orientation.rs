//! Which side of a facet is outside: what is wound inwards is turned, before anything else judges the model.
//!
//! Facets that share an edge are brought to one sense; each *shell* that hangs together so is then judged as a whole.
//!
//! 1. A closed shell encloses a volume that is positive when its facets look outward. One that lies wholly within
//!    another is a cavity, or a solid inside a solid, which cannot be told apart: it keeps its sense against the other.
//! 2. An open shell is turned where two signs agree that it looks inward. *Free rays*: from its back one gets into the
//!    open, meeting nothing of the object, and from its front not. *Parity*: a ray from its outside crosses the object an
//!    even number of times. Either alone is led astray, free rays where party walls are left out (92 facets of a city's
//!    15,000 turned, most of them wrongly), parity where frames and panes of windows are not watertight (5,000 of
//!    143,000). All rays rise, because what every model may leave out is the ground; so roofs must look up. A wall that
//!    stands alone has as many rays for it as against it, and nothing tells.
//! 3. What nothing tells goes with the rest of its object if that was inside out, and else stays as it is. A file of which most
//!    that tells its side looks inward is turned as a whole, then judged as any other.
//!
//! Terrain is one surface that looks up as a whole. A mirror image of a city is a city wound inwards to all of this: see
//! [`CityDefect::InsideOut`].
//!
//! Cost: sorting the edges, and 8 rays for each of at most eight facets of an open shell.
mod shells;
mod signed_links;
mod sky;

use rayon::prelude::*;

use self::shells::{Judged, Object, area};
use super::edges::{by_object, objects_of};
use super::validate::OBJECTS_PER_CHUNK;
use super::warning::{CityDefect, CityPlace, Warnings};
use super::{CityModel, CityRole, CitySource, Facet};
use crate::geometry::Plane;

/// Share of a file's area that must tell its side before the file is turned as a whole. Chosen: a few odd walls shall not turn a city.
const TELLING_SHARE: f64 = 0.1;

/// Share of a terrain's plan by which one side must prevail; a terrain below that is a solid, or a heap of facets.
const TERRAIN_SHARE: f64 = 0.1;

/// Turns what one file wound inwards.
pub(super) fn turn_outward(
    model: &mut CityModel,
    source: &CitySource,
    warnings: &mut Warnings,
    sense: FileSense,
    place_of: impl Fn(u32) -> CityPlace,
) -> ToldArea {
    if source.role == CityRole::Terrain
        && let Some(looks_down) = looks_down(&model.facets[source.facets.start as usize..source.facets.end as usize])
    {
        if looks_down {
            source.facets.clone().for_each(|facet| turn(model, facet));
            warnings.add(CityDefect::TerrainLooksDown, 1, || place_of(source.facets.start));
        }
        return ToldArea::default();
    }
    let by_object = by_object(model, source.facets.clone());
    let objects = objects_of(model, &by_object);
    let mut turned = inward(model, &objects, source);
    let area_told = turned.area;
    if sense.turns_all(&turned.area) {
        // What nothing tells was wound as the rest was: turn all, and judge it as any other file.
        source.facets.clone().for_each(|facet| turn(model, facet));
        let still = inward(model, &objects, source);
        still.facets.iter().flatten().for_each(|&facet| turn(model, facet));
        let others = |(all, still): (&&[u32], &Vec<u32>)| {
            all.iter().copied().filter(|facet| still.binary_search(facet).is_err()).collect()
        };
        turned.facets = objects.iter().zip(&still.facets).map(others).collect();
    } else {
        turned.facets.iter().flatten().for_each(|&facet| turn(model, facet));
    }
    let met = objects.iter().zip(&turned.facets).filter(|(_, turned)| !turned.is_empty());
    let is_whole = |(all, turned): &(&&[u32], &Vec<u32>)| area(model, turned) > area(model, all) / 2.0;
    let (whole, part): (Vec<_>, Vec<_>) = met.partition(is_whole);
    let (of, facets) = (objects.len() as u64, part.iter().map(|(_, turned)| turned.len() as u64).sum());
    warnings.add(CityDefect::InsideOut { of }, whole.len() as u64, || place_of(whole[0].1[0]));
    warnings.add(CityDefect::WoundAgainstTheRest { facets }, part.len() as u64, || place_of(part[0].1[0]));
    area_told
}

/// Whether a file is turned as a whole before its objects are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileSense {
    /// Where most of it that tells its side looks inward.
    Ask,
    /// It was asked before, of the whole of which this is a part.
    Known { turned: bool },
}

impl FileSense {
    fn turns_all(self, area: &ToldArea) -> bool {
        match self {
            FileSense::Ask => area.is_mostly_inward(),
            FileSense::Known { turned } => turned,
        }
    }
}

/// Area of a file, of what of it tells its side, and of what of this looks inward; square metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToldArea {
    all_m2: f64,
    told_m2: f64,
    inward_m2: f64,
}

impl ToldArea {
    pub fn add(&mut self, other: &ToldArea) {
        self.all_m2 += other.all_m2;
        self.told_m2 += other.told_m2;
        self.inward_m2 += other.inward_m2;
    }

    pub fn is_mostly_inward(&self) -> bool {
        self.inward_m2 > self.told_m2 / 2.0 && self.told_m2 > TELLING_SHARE * self.all_m2
    }
}

/// The facets of each object that look inward, ascending, and how much of the file tells it.
struct Inward {
    facets: Vec<Vec<u32>>,
    area: ToldArea,
}

fn inward(model: &CityModel, objects: &[&[u32]], source: &CitySource) -> Inward {
    let judge = |facets: &&[u32]| Object::new(model, facets, source).judged();
    let chunks = objects.par_chunks(OBJECTS_PER_CHUNK);
    let judged: Vec<Vec<Judged>> = chunks.map(|chunk| chunk.iter().map(judge).collect()).collect();
    let (mut told_m2, mut turned_m2) = (0.0, 0.0);
    for object in judged.iter().flatten() {
        (told_m2, turned_m2) = (told_m2 + object.told_m2, turned_m2 + object.turned_m2);
    }
    let all_m2: f64 = objects.iter().map(|facets| area(model, facets)).sum();
    let facets = judged.into_iter().flatten().map(|object| object.inward).collect();
    Inward { facets, area: ToldArea { all_m2, told_m2, inward_m2: turned_m2 } }
}

/// The facet seen from its other side.
fn turn(model: &mut CityModel, facet: u32) {
    let facet = &mut model.facets[facet as usize];
    // The first corner stays the first.
    facet.outline[1..].reverse();
    facet.holes.iter_mut().for_each(|hole| hole.reverse());
    let plane = facet.plane.flipped();
    // Adding zero turns a negative zero into the usual one.
    facet.plane = Plane { normal: plane.normal.map(|c| c + 0.0), offset: plane.offset + 0.0 };
    for triangle in &mut model.triangles[facet.triangles.start as usize..facet.triangles.end as usize] {
        triangle.swap(1, 2);
    }
}

/// Whether a surface looks down as a whole; `None` where about as much of it looks either way.
fn looks_down(facets: &[Facet]) -> Option<bool> {
    let plans = facets.iter().map(|facet| facet.area * facet.plane.normal.z);
    let (sum, whole) = plans.fold((0.0, 0.0), |(sum, whole), plan: f64| (sum + plan, whole + plan.abs()));
    (sum.abs() > TERRAIN_SHARE * whole).then_some(sum < 0.0)
}
