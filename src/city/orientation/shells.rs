//! Facets of one object that hang together, and which way each such shell looks.

use std::collections::HashMap;

use rayon::prelude::*;

use super::signed_links::{EdgeRuns, Links};
use super::sky::{CERTAIN, Sky, inner_point};
use crate::city::edges::sorted_edges;
use crate::city::{CityModel, CitySource, Facet};

/// Facets of a shell that are asked, the largest: some may stand in a niche.
const SAMPLES: usize = 8;

/// Share of an object that must have been turned for what nothing tells to be turned with it.
const WHOLE: f64 = 0.9;

/// What the facets of one object tell of their sides.
pub(super) struct Judged {
    /// The facets that look inward, ascending.
    pub inward: Vec<u32>,
    /// Area of what tells its side, and of what of this looks inward.
    pub told_m2: f64,
    pub turned_m2: f64,
}
/// The facets of one object, and what is known of their sides.
pub(super) struct Object<'a> {
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
    pub fn new(model: &'a CityModel, facets: &'a [u32], source: &CitySource) -> Object<'a> {
        let edges = sorted_edges(model, facets);
        let mut links = Links::new(facets.len());
        let mut is_sound = true;
        for edge in edges.chunk_by(|a, b| a.ends() == b.ends()) {
            // More than two facets at one edge tell nothing of each other.
            if let [one, other] = edge {
                let along = if one.rises() == other.rises() { EdgeRuns::Alike } else { EdgeRuns::Opposed };
                links.tie(one.facet(), other.facet(), along);
                is_sound &= along == EdgeRuns::Opposed;
            } else {
                is_sound = false;
            }
        }
        let (mut root_of, mut agrees): (Vec<usize>, Vec<bool>) =
            (0..facets.len()).map(|facet| links.root(facet)).unzip();
        let precision_m = source.precision_m;
        // Most objects: one shell, of which every edge has two facets that run along it in opposite directions.
        if is_sound && root_of.iter().all(|&root| root == 0) {
            let shells = vec![Shell { members: (0..facets.len()).collect(), is_closed: true }];
            return Object { model, facets, precision_m, agrees, shells };
        }
        // Where going round comes back with the other side up, every facet stands for itself.
        for member in 0..facets.len() {
            if links.is_twisted[root_of[member]] {
                (root_of[member], agrees[member]) = (member, true);
            }
        }
        let mut is_open = vec![false; facets.len()];
        let mut meeting: Vec<(usize, bool)> = Vec::new();
        for edge in edges.chunk_by(|a, b| a.ends() == b.ends()) {
            meeting.clear();
            meeting.extend(edge.iter().map(|edge| (root_of[edge.facet()], edge.rises() == agrees[edge.facet()])));
            meeting.sort_unstable();
            for same in meeting.chunk_by(|a, b| a.0 == b.0) {
                is_open[same[0].0] |= !matches!(same, [one, other] if one.1 != other.1);
            }
        }
        let mut order: Vec<usize> = (0..facets.len()).collect();
        order.sort_by_key(|&facet| root_of[facet]);
        let runs = order.chunk_by(|&a, &b| root_of[a] == root_of[b]);
        let shells = runs.map(|run| Shell { members: run.to_vec(), is_closed: !is_open[root_of[run[0]]] }).collect();
        Object { model, facets, precision_m, agrees, shells }
    }

    /// For each shell the first that is the same: facets that stand three times and more in one place are shells of one facet each, of which
    /// rays from any tell the same. A mesh shown a thousand times in one place would otherwise be asked a thousand times, through
    /// a thousand triangles.
    fn first_of_its_copies(&self) -> Vec<usize> {
        let mut first_with = HashMap::new();
        let first = |(at, shell): (usize, &Shell)| match shell.members[..] {
            [only] => {
                let Facet { outline, holes, .. } = self.facet(only);
                *first_with.entry((outline, holes)).or_insert(at)
            }
            _ => at,
        };
        self.shells.iter().enumerate().map(first).collect()
    }

    fn facet(&self, member: usize) -> &'a Facet {
        &self.model.facets[self.facets[member] as usize]
    }

    pub fn judged(&self) -> Judged {
        let mut sides: Vec<Side> = self.shells.iter().map(|shell| self.side_by_volume(shell)).collect();
        let disagree = |sides: &[Side]| sides.contains(&Side::Outward) && sides.contains(&Side::Inward);
        if sides.contains(&Side::Untold) || disagree(&sides) {
            let sky = self.sky();
            let closed = sides.clone();
            let asked = self.first_of_its_copies();
            let judged = self.shells.par_iter().zip(&closed).enumerate().map(|(at, (shell, &side))| match side {
                _ if asked[at] != at => Side::Untold,
                Side::Untold => self.side_in_the_open(shell, &sky),
                _ => self
                    .outermost_around(shell, &closed, &sky)
                    .map_or(side, |outer| self.as_turned_with(shell, outer, &closed)),
            });
            let judged: Vec<Side> = judged.collect();
            sides = asked.into_iter().map(|first| judged[first]).collect();
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

    fn sky(&self) -> Sky {
        let mut shell_of = vec![0; self.facets.len()];
        for (at, shell) in self.shells.iter().enumerate() {
            shell.members.iter().for_each(|&member| shell_of[member] = at as u32);
        }
        let triangles_of =
            |(member, shell)| self.model.triangles_of(self.facet(member)).map(move |triangle| (shell, triangle));
        Sky::new(shell_of.into_iter().enumerate().flat_map(triangles_of), self.precision_m)
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

    /// The outermost closed shell that has the whole of this one inside; none for most.
    fn outermost_around(&self, shell: &Shell, sides: &[Side], sky: &Sky) -> Option<usize> {
        let mut around: Option<Vec<u32>> = None;
        for &member in shell.members.iter().take(SAMPLES) {
            let odd = sky.crossed_oddly(&inner_point(self.model, self.facet(member))?)?;
            let is_outer = |other: &u32| {
                sides[*other as usize] != Side::Untold && self.shells[*other as usize].members[0] != shell.members[0]
            };
            around = Some(match around {
                None => odd.into_iter().filter(is_outer).collect(),
                Some(before) => before.into_iter().filter(|other| odd.contains(other)).collect(),
            });
        }
        let size = |shell: usize| self.shells[shell].members.iter().map(|&member| self.facet(member).area).sum::<f64>();
        let around = around?.into_iter().map(|other| other as usize);
        around.max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)))
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

pub(super) fn area(model: &CityModel, facets: &[u32]) -> f64 {
    facets.iter().map(|&facet| model.facets[facet as usize].area).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box without its floor, wound inwards or not, so many times in the same place.
    fn copies(count: usize, is_inward: bool) -> CityModel {
        let corners = "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\no box\n";
        let facets = ["5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"].map(|facet| {
            let mut corners: Vec<&str> = facet.split(' ').collect();
            if is_inward {
                corners.reverse();
            }
            format!("f {}\n", corners.join(" "))
        });
        crate::city::tests::model(&format!("{corners}{}", facets.concat().repeat(count)))
    }

    #[test]
    fn facets_in_one_place_are_asked_once_however_many_there_are() {
        for count in [1, 3, 200] {
            let model = copies(count, false);
            let facets: Vec<u32> = (0..model.facets.len() as u32).collect();
            let object = Object::new(&model, &facets, &model.sources[0]);
            let first = object.first_of_its_copies();
            let asked = first.iter().enumerate().filter(|(at, first)| at == *first).count();
            assert_eq!((facets.len(), asked), (5 * count, if count == 1 { 1 } else { 5 }));
        }
    }

    #[test]
    fn copies_are_turned_as_the_first_of_them() {
        let up = |model: &CityModel| model.facets.iter().filter(|facet| facet.plane.normal.z > 0.9).count();
        for count in [1, 3, 20] {
            let [inward, outward] = [true, false].map(|is_inward| copies(count, is_inward));
            assert_eq!((up(&inward), up(&outward)), (count, count));
        }
    }
}
