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
//! Cost: sorting the edges, and 8 rays for each of at most [`SAMPLES`] facets of an open shell.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::signed_links::{EdgeRuns, Links};
use super::validate::{OBJECTS_PER_CHUNK, facets_by_object, sorted_edges};
use super::warning::{CityDefect, CityPlace, Warnings};
use super::{CityModel, CityRole, CitySource, Facet};
use crate::geometry::{Plane, Point3, RayCaster, Vector3};

/// Directions in which rays rise, evenly around, so that both sides of a wall get as many. Begun off the axes, on which
/// walls stand; two slopes, so that a low one passes under what a steep one meets.
const AZIMUTHS: usize = 8;
const FIRST_AZIMUTH: f64 = 0.2134;
const SLOPES_DEG: [f64; 2] = [37.0, 61.0];

/// Facets of a shell that are asked, the largest: some may stand in a niche.
const SAMPLES: usize = 8;

/// Share by which votes for one side must exceed those for the other, of rays and of facets: seven of eight agree.
const CERTAIN: f64 = 0.75;

/// Free rays that tell that a facet's back is outside: a single one may have found a crack.
const LEAST_FREE: usize = 2;

/// Share of an object that must have been turned for what nothing tells to be turned with it.
const WHOLE: f64 = 0.9;

/// Share of a file's area that must tell its side before the file is turned as a whole. Chosen: a few odd walls shall not turn a city.
const TELLING_SHARE: f64 = 0.1;

/// Boxes that one ray may pass; in a building of 10,000 triangles it passes some 50.
const BOXES_PER_RAY: usize = 512;

/// Limits of what counts as the facet's own place, metres: a copy of a wall is no second wall, a window pane is.
const OWN_PLACE_M: (f64, f64) = (1e-4, 0.02);

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
    let objects = facets_by_object(model, source.objects.clone(), source.facets.clone());
    let mut turned = inward(model, &objects, source);
    let area_told = turned.area;
    if sense.turns_all(&turned.area) {
        // What nothing tells was wound as the rest was: turn all, and judge it as any other file.
        source.facets.clone().for_each(|facet| turn(model, facet));
        let still = inward(model, &objects, source);
        still.facets.iter().flatten().for_each(|&facet| turn(model, facet));
        let others = |(all, still): (&Vec<u32>, &Vec<u32>)| {
            all.iter().copied().filter(|facet| still.binary_search(facet).is_err()).collect()
        };
        turned.facets = objects.iter().zip(&still.facets).map(others).collect();
    } else {
        turned.facets.iter().flatten().for_each(|&facet| turn(model, facet));
    }
    let met = objects.iter().zip(&turned.facets).filter(|(_, turned)| !turned.is_empty());
    let is_whole = |(all, turned): &(&Vec<u32>, &Vec<u32>)| area(model, turned) > area(model, all) / 2.0;
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

fn inward(model: &CityModel, objects: &[Vec<u32>], source: &CitySource) -> Inward {
    let judge = |facets: &Vec<u32>| Object::new(model, facets, source).judged();
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

/// What the facets of one object tell of their sides.
struct Judged {
    /// The facets that look inward, ascending.
    inward: Vec<u32>,
    /// Area of what tells its side, and of what of this looks inward.
    told_m2: f64,
    turned_m2: f64,
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

fn area(model: &CityModel, facets: &[u32]) -> f64 {
    facets.iter().map(|&facet| model.facets[facet as usize].area).sum()
}

/// The facets of one object, and what is known of their sides.
struct Object<'a> {
    model: &'a CityModel,
    facets: &'a [u32],
    precision_m: f64,
    /// Whether each facet runs as the first of its shell does.
    agrees: Vec<bool>,
    shells: Vec<Shell>,
}

/// Facets that hang together.
struct Shell {
    /// Indices into `Object::facets`, ascending.
    members: Vec<usize>,
    is_closed: bool,
}

/// Which way a shell looks, by its first facet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Outward,
    Inward,
    Untold,
}

impl Side {
    /// By the sign of what was measured.
    fn of(measure: f64, least: f64) -> Side {
        match measure {
            _ if measure > 0.0 && measure >= least => Side::Outward,
            _ if measure < 0.0 && measure <= -least => Side::Inward,
            _ => Side::Untold,
        }
    }
}

impl<'a> Object<'a> {
    fn new(model: &'a CityModel, facets: &'a [u32], source: &CitySource) -> Object<'a> {
        let edges = sorted_edges(model, facets);
        let mut links = Links::new(facets.len());
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            // More than two facets at one edge tell nothing of each other.
            if let [one, other] = edge {
                let along = if one.2 == other.2 { EdgeRuns::Alike } else { EdgeRuns::Opposed };
                links.tie(one.3 as usize, other.3 as usize, along);
            }
        }
        let (mut root_of, mut agrees): (Vec<usize>, Vec<bool>) =
            (0..facets.len()).map(|facet| links.root(facet)).unzip();
        // Where going round comes back with the other side up, every facet stands for itself.
        for member in 0..facets.len() {
            if links.is_twisted[root_of[member]] {
                (root_of[member], agrees[member]) = (member, true);
            }
        }
        let mut is_open = vec![false; facets.len()];
        let mut meeting: Vec<(usize, bool)> = Vec::new();
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            meeting.clear();
            meeting.extend(edge.iter().map(|&(_, _, rises, at)| (root_of[at as usize], rises == agrees[at as usize])));
            meeting.sort_unstable();
            for same in meeting.chunk_by(|a, b| a.0 == b.0) {
                is_open[same[0].0] |= !matches!(same, [one, other] if one.1 != other.1);
            }
        }
        let mut order: Vec<usize> = (0..facets.len()).collect();
        order.sort_by_key(|&facet| root_of[facet]);
        let runs = order.chunk_by(|&a, &b| root_of[a] == root_of[b]);
        let shells = runs.map(|run| Shell { members: run.to_vec(), is_closed: !is_open[root_of[run[0]]] }).collect();
        Object { model, facets, precision_m: source.precision_m, agrees, shells }
    }

    fn facet(&self, member: usize) -> &'a Facet {
        &self.model.facets[self.facets[member] as usize]
    }

    fn judged(&self) -> Judged {
        let mut sides: Vec<Side> = self.shells.iter().map(|shell| self.side_by_volume(shell)).collect();
        let disagree = |sides: &[Side]| sides.contains(&Side::Outward) && sides.contains(&Side::Inward);
        if sides.contains(&Side::Untold) || disagree(&sides) {
            let sky = Sky::new(self);
            let closed = sides.clone();
            let judged = self.shells.par_iter().zip(&closed).map(|(shell, &side)| match side {
                Side::Untold => self.side_in_the_open(shell, &sky),
                _ => sky
                    .outermost_around(self, shell, &closed)
                    .map_or(side, |outer| self.as_turned_with(shell, outer, &closed)),
            });
            sides = judged.collect();
        }
        let mut inward = vec![false; self.facets.len()];
        let (mut told_m2, mut turned_m2) = (0.0, 0.0);
        for (shell, side) in self.shells.iter().zip(&sides).filter(|(_, side)| **side != Side::Untold) {
            for &member in &shell.members {
                inward[member] = self.agrees[member] == (*side == Side::Inward);
                told_m2 += self.facet(member).area;
                turned_m2 += if inward[member] { self.facet(member).area } else { 0.0 };
            }
        }
        if turned_m2 > WHOLE * told_m2 && told_m2 > area(self.model, self.facets) / 2.0 {
            let untold = self.shells.iter().zip(&sides).filter(|(_, side)| **side == Side::Untold);
            untold.flat_map(|(shell, _)| &shell.members).for_each(|&member| inward[member] = true);
        }
        let inward = self.facets.iter().zip(inward).filter(|(_, inward)| *inward).map(|(&facet, _)| facet).collect();
        Judged { inward, told_m2, turned_m2 }
    }

    /// By the sign of the volume; nothing where the shell is open, or flat to the digits of the file.
    fn side_by_volume(&self, shell: &Shell) -> Side {
        if !shell.is_closed {
            return Side::Untold;
        }
        let middle = self.model.vertices[self.facet(shell.members[0]).outline[0] as usize];
        let (mut volume, mut area) = (0.0, 0.0);
        for &member in &shell.members {
            let facet = self.facet(member);
            let cone = -facet.plane.signed_distance(&middle) * facet.area / 3.0;
            volume += if self.agrees[member] { cone } else { -cone };
            area += facet.area;
        }
        // Half a digit, all over.
        Side::of(volume, area * self.precision_m / 2.0)
    }

    /// By the rays from its largest facets.
    fn side_in_the_open(&self, shell: &Shell, sky: &Sky) -> Side {
        let mut asked: Vec<usize> = shell.members.clone();
        asked.sort_by(|&a, &b| self.facet(b).area.total_cmp(&self.facet(a).area).then(a.cmp(&b)));
        asked.truncate(SAMPLES);
        let by = |vote: &dyn Fn(&Facet) -> f64| {
            let (mut lead, mut told) = (0.0, 0.0);
            for &member in &asked {
                let facet = self.facet(member);
                let vote = facet.area * vote(facet);
                lead += if self.agrees[member] { vote } else { -vote };
                told += vote.abs();
            }
            Side::of(lead, CERTAIN * told)
        };
        let side = by(&|facet| sky.free_rays(self.model, facet));
        // Where nothing would be turned, there is nothing to confirm.
        let turns_some =
            side != Side::Untold && shell.members.iter().any(|&m| self.agrees[m] == (side == Side::Inward));
        if !turns_some || side == by(&|facet| sky.parity(self.model, facet)) { side } else { Side::Untold }
    }

    /// The side that keeps a shell's sense, as the file has it, against one that lies around it.
    fn as_turned_with(&self, shell: &Shell, outer: usize, sides: &[Side]) -> Side {
        // The first facet may be one of a few that are wound against the rest.
        let mostly_agrees = |shell: &Shell| {
            let signed = |&member: &usize| if self.agrees[member] { 1.0 } else { -1.0 } * self.facet(member).area;
            shell.members.iter().map(signed).sum::<f64>() > 0.0
        };
        let is_outer_turned = mostly_agrees(&self.shells[outer]) == (sides[outer] == Side::Inward);
        if mostly_agrees(shell) == is_outer_turned { Side::Inward } else { Side::Outward }
    }
}

/// The triangles of an object, and the rays that look for the open.
struct Sky {
    rays: RayCaster,
    /// Shell of each triangle.
    shell_of: Vec<u32>,
    directions: Vec<Vector3<f64>>,
    own_place_m: f64,
}

impl Sky {
    fn new(object: &Object<'_>) -> Sky {
        let mut shell_of_member = vec![0; object.facets.len()];
        for (at, shell) in object.shells.iter().enumerate() {
            shell.members.iter().for_each(|&member| shell_of_member[member] = at as u32);
        }
        let (mut triangles, mut shell_of) = (Vec::new(), Vec::new());
        for (member, &shell) in shell_of_member.iter().enumerate() {
            triangles.extend(object.model.triangles_of(object.facet(member)));
            shell_of.resize(triangles.len(), shell);
        }
        let direction = |at: usize| {
            let azimuth = FIRST_AZIMUTH + at as f64 * std::f64::consts::TAU / AZIMUTHS as f64;
            let slope = SLOPES_DEG[at % SLOPES_DEG.len()].to_radians();
            Vector3::new(slope.cos() * azimuth.cos(), slope.cos() * azimuth.sin(), slope.sin())
        };
        Sky {
            rays: RayCaster::new(triangles.into_iter()),
            shell_of,
            directions: (0..AZIMUTHS).map(direction).collect(),
            own_place_m: object.precision_m.clamp(OWN_PLACE_M.0, OWN_PLACE_M.1),
        }
    }

    /// 1 where one gets into the open from the facet's front and not at once from its back, -1 from its back alone, else 0.
    fn free_rays(&self, model: &CityModel, facet: &Facet) -> f64 {
        let Some(from) = inner_point(model, facet) else { return 0.0 };
        let is_free = |direction: &&Vector3<f64>| {
            let (mut boxes, mut is_free) = (0, true);
            self.rays.hits(&from, direction, self.own_place_m, |hit| {
                boxes += 1;
                is_free = hit.is_none() && boxes < BOXES_PER_RAY;
                if is_free { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            is_free
        };
        let on_front = |direction: &&Vector3<f64>| facet.plane.normal.dot(direction) > 0.0;
        let back = || self.directions.iter().filter(|direction| !on_front(direction));
        let is_front_free = || self.directions.iter().filter(on_front).any(|direction| is_free(&direction));
        // Most facets are right, and for them two rays are enough.
        match (back().next().is_some_and(|direction| is_free(&direction)), is_front_free()) {
            (false, true) => 1.0,
            (_, false) if back().filter(is_free).count() >= LEAST_FREE => -1.0,
            _ => 0.0,
        }
    }

    /// 1 where the rays cross the object as they must if the facet looks outward, -1 where as if it looked inward, else 0.
    fn parity(&self, model: &CityModel, facet: &Facet) -> f64 {
        let Some(from) = inner_point(model, facet) else { return 0.0 };
        let vote = |direction: &Vector3<f64>| {
            let (mut boxes, mut crossings) = (0, 0);
            self.rays.hits(&from, direction, self.own_place_m, |hit| {
                boxes += 1;
                crossings += usize::from(hit.is_some());
                if boxes < BOXES_PER_RAY { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            let leaves_on_its_front = facet.plane.normal.dot(direction) > 0.0;
            match boxes {
                BOXES_PER_RAY => 0.0,
                _ if (crossings % 2 == 0) == leaves_on_its_front => 1.0,
                _ => -1.0,
            }
        };
        let votes = self.directions.iter().map(vote).sum::<f64>() / AZIMUTHS as f64;
        if votes.abs() >= CERTAIN { votes.signum() } else { 0.0 }
    }

    /// The outermost closed shell that has the whole of this one inside; none for most.
    fn outermost_around(&self, object: &Object<'_>, shell: &Shell, sides: &[Side]) -> Option<usize> {
        let mut around: Option<Vec<u32>> = None;
        for &member in shell.members.iter().take(SAMPLES) {
            let from = inner_point(object.model, object.facet(member))?;
            let (mut boxes, mut met) = (0, Vec::new());
            self.rays.hits(&from, &self.directions[0], self.own_place_m, |hit| {
                boxes += 1;
                met.extend(hit.map(|hit| self.shell_of[hit.triangle as usize]));
                if boxes < BOXES_PER_RAY { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            if boxes == BOXES_PER_RAY {
                return None;
            }
            met.sort_unstable();
            let odd = met.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]);
            let odd = odd.filter(|&other| sides[other as usize] != Side::Untold);
            let odd: Vec<u32> =
                odd.filter(|&other| object.shells[other as usize].members[0] != shell.members[0]).collect();
            around = Some(match around {
                None => odd,
                Some(before) => before.into_iter().filter(|other| odd.contains(other)).collect(),
            });
        }
        let size =
            |shell: usize| object.shells[shell].members.iter().map(|&member| object.facet(member).area).sum::<f64>();
        let around = around?.into_iter().map(|other| other as usize);
        around.max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)))
    }
}

/// The middle of the facet's largest triangle.
fn inner_point(model: &CityModel, facet: &Facet) -> Option<Point3<f64>> {
    let doubled_area = |[a, b, c]: &[Point3<f64>; 3]| (b - a).cross(&(c - a)).norm();
    let largest = model.triangles_of(facet).max_by(|a, b| doubled_area(a).total_cmp(&doubled_area(b)))?;
    Some(Point3::from((largest[0].coords + largest[1].coords + largest[2].coords) / 3.0))
}
