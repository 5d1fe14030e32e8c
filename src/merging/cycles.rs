//! Where the strongest ties put the parts, and which tie is wrong where a cycle does not close.
//!
//! Input        edges between parts and anchors in a city, each with what its estimate leaves open
//! Output       a place for every part that the ties reach and whose place hangs on no doubtful choice
//! Method       the strongest edges that join everything (greatest spanning tree by inliers), grown from the anchors or else from
//!              one part, place the parts. Every further tie closes a cycle; what it misses by is held against what all ties
//!              of the cycle leave open together. A cycle that does not close has a wrong tie in it, and only the other cycles
//!              say which one

use super::pairwise::Link;
use super::sigma::extent;
use super::{Anchor, Part};
use crate::geometry::{Point3, Similarity};
use crate::robust::{Chart, Matrix7, Vector7};

/// No tie is known better than this share of its radius in any of the seven unknowns, one sigma: parts bend, which their own
/// covariances do not tell. Parts that belong together were seen to err by up to 0.4 % of the extent all unknowns together.
pub(super) const TIE_FLOOR: f64 = 5e-3;
/// A cycle that misses by more sigmas has a wrong tie in it: root of the chi-square of seven degrees of freedom at 99.9 %.
const CYCLE_SIGMAS: f64 = 4.93;
/// Places that differ by less than what one tie at the floor may miss by are one place, share of the radius.
const SAME_PLACE: f64 = CYCLE_SIGMAS * TIE_FLOOR;
/// Step of numerical derivatives, share of the radius.
const DIFFERENCE: f64 = 1e-6;

/// What holds a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tie {
    /// Index of an edge.
    Link(usize),
    /// Index of a part that the city holds.
    Anchor(usize),
}

/// All parts and their ties.
pub(super) struct Network<'a> {
    pub parts: &'a [Part],
    /// The parts by their content.
    pub order: &'a [usize],
    pub links: Vec<Link>,
    /// Which parts' anchors are in use.
    pub anchored: Vec<bool>,
    /// Why an anchor that is determined is not used.
    pub anchor_faults: Vec<Option<String>>,
    /// Where a cycle does not close and nothing says which of its ties is wrong.
    pub ambiguity: Option<String>,
}

/// Places along the strongest ties.
#[derive(Clone)]
pub(super) struct Placement {
    pub poses: Vec<Option<Similarity>>,
    /// The ties that lead to each part.
    paths: Vec<Vec<Tie>>,
}

/// A tie that may be the wrong one, and where the others put the parts.
struct Suspect {
    tie: Tie,
    without: Placement,
    contradictions_left: usize,
    strength: usize,
}

/// By how much a tie misses what the places say.
struct Miss {
    /// In its chart's unknowns, as a share of the radius.
    share: f64,
    sigmas: f64,
}

impl<'a> Network<'a> {
    pub fn new(parts: &'a [Part], order: &'a [usize], links: Vec<Link>) -> Network<'a> {
        let anchored = parts.iter().map(|p| p.anchor.as_ref().is_some_and(Anchor::is_determined)).collect();
        Network { parts, order, links, anchored, anchor_faults: vec![None; parts.len()], ambiguity: None }
    }

    /// The ties in use, but for one.
    pub fn ties(&self, without: Option<Tie>) -> impl Iterator<Item = Tie> {
        let links = (0..self.links.len()).filter(|&i| self.links[i].edge.used).map(Tie::Link);
        let anchors = (0..self.parts.len()).filter(|&p| self.anchored[p]).map(Tie::Anchor);
        links.chain(anchors).filter(move |tie| Some(*tie) != without)
    }

    /// Carries places along the strongest edges. Without an anchor the largest group of joined parts is placed, in the frame
    /// of the one that was given first.
    fn place(&self, without: Option<Tie>) -> Placement {
        let count = self.parts.len();
        let mut found = Placement { poses: vec![None; count], paths: vec![Vec::new(); count] };
        for tie in self.ties(without) {
            if let Tie::Anchor(p) = tie {
                found.poses[p] = self.anchor_pose(p);
                found.paths[p] = vec![tie];
            }
        }
        let (tree, group) = self.tree(without);
        let has_frame = found.poses.iter().any(Option::is_some);
        if let Some(root) = self.root(&group).filter(|_| !has_frame) {
            found.poses[root] = Some(Similarity::identity());
        }
        // Each sweep reaches at least one further part.
        for _ in 0..count {
            tree.iter().for_each(|&index| self.carry(&mut found, index));
        }
        found
    }

    /// The edges of the strongest tree, and a number for the group that each part is in.
    fn tree(&self, without: Option<Tie>) -> (Vec<usize>, Vec<usize>) {
        let links = self.ties(without).filter_map(|tie| if let Tie::Link(index) = tie { Some(index) } else { None });
        let mut strongest: Vec<usize> = links.collect();
        strongest.sort_by_key(|i| std::cmp::Reverse(self.links[*i].edge.inliers));
        let mut group: Vec<usize> = (0..self.parts.len()).collect();
        strongest.retain(|&index| {
            let edge = &self.links[index].edge;
            let (a, b) = (group[edge.a], group[edge.b]);
            group.iter_mut().filter(|g| **g == b).for_each(|g| *g = a);
            a != b
        });
        (strongest, group)
    }

    /// The part that gives the frame: the first of the largest group.
    fn root(&self, group: &[usize]) -> Option<usize> {
        let size = |g: usize| group.iter().filter(|other| **other == g).count();
        let members = |g: usize| (0..group.len()).filter(move |p| group[*p] == g);
        let points = |g: usize| members(g).map(|p| self.parts[p].sfm.points.len()).sum::<usize>();
        // The last of equals is taken, so the canonical order is walked backwards.
        let largest = self.order.iter().rev().map(|p| group[*p]).max_by_key(|g| (size(*g), points(*g)));
        largest.filter(|g| size(*g) > 1).and_then(|g| members(g).next())
    }

    fn carry(&self, found: &mut Placement, index: usize) {
        let link = &self.links[index];
        let (a, b) = (link.edge.a, link.edge.b);
        let Some(fit) = &link.fit else { return };
        let (from, to, pose) = match (found.poses[a], found.poses[b]) {
            (Some(pose), None) => (a, b, pose * fit.a_from_b),
            (None, Some(pose)) => (b, a, pose * fit.a_from_b.inverse()),
            _ => return,
        };
        found.poses[to] = Some(pose);
        found.paths[to] = found.paths[from].clone();
        found.paths[to].push(Tie::Link(index));
    }

    fn anchor_pose(&self, part: usize) -> Option<Similarity> {
        self.parts[part].anchor.as_ref().map(|a| a.common_from_part)
    }

    /// The seven unknowns by which the poses miss a tie, and the chart they are in: of an edge in the frame of its first
    /// part, of an anchor in the city's.
    pub fn miss(&self, poses: &[Option<Similarity>], tie: Tie) -> Option<Vector7> {
        let chart = self.chart(tie)?;
        let motion = match tie {
            Tie::Link(index) => {
                let edge = &self.links[index].edge;
                (poses[edge.a]?.inverse() * poses[edge.b]?) * self.links[index].fit.as_ref()?.a_from_b.inverse()
            }
            Tie::Anchor(p) => poses[p]? * self.anchor_pose(p)?.inverse(),
        };
        let turn = motion.rotation.scaled_axis() * chart.radius;
        let shift = motion.apply(&chart.center) - chart.center;
        let scale = motion.scale.ln() * chart.radius;
        Some(Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, scale]))
    }

    pub fn chart(&self, tie: Tie) -> Option<Chart> {
        match tie {
            Tie::Link(index) => Some(self.links[index].fit.as_ref()?.chart),
            Tie::Anchor(p) => Some(self.parts[p].anchor.as_ref()?.chart),
        }
    }

    pub fn information(&self, tie: Tie) -> Option<Matrix7> {
        match tie {
            Tie::Link(index) => Some(self.links[index].fit.as_ref()?.information),
            Tie::Anchor(p) => Some(self.parts[p].anchor.as_ref()?.information),
        }
    }

    fn covariance(&self, tie: Tie) -> Option<Matrix7> {
        let floor = (TIE_FLOOR * self.chart(tie)?.radius).powi(2);
        Some(self.information(tie)?.try_inverse()? + Matrix7::identity() * floor)
    }

    /// How far a tie misses where the others put its parts, against what the whole cycle leaves open.
    fn missed(&self, placement: &Placement, tie: Tie) -> Option<Miss> {
        let miss = self.miss(&placement.poses, tie)?;
        let mut open = self.covariance(tie)?;
        for other in self.cycle(placement, tie) {
            let carried = self.carried(placement, tie, other, &miss)?;
            open += carried * self.covariance(other)? * carried.transpose();
        }
        let sigmas = miss.dot(&(open.try_inverse()? * miss)).max(0.0).sqrt();
        Some(Miss { share: miss.norm() / self.chart(tie)?.radius, sigmas })
    }

    /// The other ties of the cycle that a tie closes; none where it is in the tree itself.
    fn cycle(&self, placement: &Placement, tie: Tie) -> Vec<Tie> {
        let (one, other) = match tie {
            Tie::Link(index) => {
                let edge = &self.links[index].edge;
                (placement.paths[edge.a].as_slice(), placement.paths[edge.b].as_slice())
            }
            Tie::Anchor(p) => (placement.paths[p].as_slice(), [].as_slice()),
        };
        let only_one = one.iter().filter(|t| !other.contains(t));
        only_one.chain(other.iter().filter(|t| !one.contains(t))).copied().filter(|t| *t != tie).collect()
    }

    /// How a tie's miss changes with the unknowns of another tie of its cycle. Which side of the cycle that one is on changes
    /// only the sign.
    fn carried(&self, placement: &Placement, tie: Tie, other: Tie, miss: &Vector7) -> Option<Matrix7> {
        let chart = self.chart(other)?;
        let common = match other {
            Tie::Link(index) => placement.poses[self.links[index].edge.a]?,
            Tie::Anchor(_) => Similarity::identity(),
        };
        let end = match tie {
            Tie::Link(index) => self.links[index].edge.b,
            Tie::Anchor(p) => p,
        };
        let mut poses = placement.poses.clone();
        let mut derivative = Matrix7::zeros();
        for column in 0..7 {
            let mut nudge = Vector7::zeros();
            nudge[column] = DIFFERENCE * chart.radius;
            let motion = common * chart.moved(&Similarity::identity(), &nudge) * common.inverse();
            poses[end] = Some(motion * placement.poses[end]?);
            derivative.set_column(column, &((self.miss(&poses, tie)? - miss) / nudge[column]));
        }
        Some(derivative)
    }

    fn contradictions(&self, placement: &Placement, without: Option<Tie>) -> usize {
        self.ties(without).filter(|tie| self.is_off(placement, *tie)).count()
    }

    fn is_off(&self, placement: &Placement, tie: Tie) -> bool {
        self.missed(placement, tie).is_some_and(|miss| miss.sigmas > CYCLE_SIGMAS)
    }

    /// Places the parts without the ties that contradict the others. Where several ties may be the wrong one, the parts whose
    /// place hangs on the choice get none.
    pub fn settle(&mut self) -> Vec<Option<Similarity>> {
        let mut placement = self.place(None);
        let mut doubtful = vec![false; self.parts.len()];
        while self.contradictions(&placement, None) > 0 {
            let mut suspects = self.suspects(&placement);
            if suspects.is_empty() {
                break;
            }
            for other in &suspects[1..] {
                for (p, doubt) in doubtful.iter_mut().enumerate() {
                    *doubt |= self.differs(p, suspects[0].without.poses[p], other.without.poses[p]);
                }
            }
            let choices = suspects.len();
            let Suspect { tie, without, .. } = suspects.swap_remove(0);
            self.put_aside(tie, &without, choices);
            placement = without;
        }
        (0..self.parts.len()).map(|p| placement.poses[p].filter(|_| !doubtful[p])).collect()
    }

    /// The ties without which fewest contradictions are left, the weakest first.
    fn suspects(&self, placement: &Placement) -> Vec<Suspect> {
        let placed = |placement: &Placement| placement.poses.iter().flatten().count();
        let mut suspects = Vec::new();
        for tie in self.ties(None) {
            let without = self.place(Some(tie));
            // A tie without which a part has no place at all is in no cycle, and one that agrees with the others is not to blame.
            if placed(&without) == placed(placement) && self.is_off(&without, tie) {
                let strength = match tie {
                    Tie::Link(index) => self.links[index].edge.inliers,
                    Tie::Anchor(_) => usize::MAX,
                };
                let contradictions_left = self.contradictions(&without, Some(tie));
                suspects.push(Suspect { tie, without, contradictions_left, strength });
            }
        }
        suspects.sort_by_key(|s| (s.contradictions_left, s.strength));
        let fewest = suspects.first().map(|s| s.contradictions_left);
        suspects.retain(|s| Some(s.contradictions_left) == fewest);
        suspects
    }

    fn put_aside(&mut self, tie: Tie, without: &Placement, choices: usize) {
        let name = |p: usize| &self.parts[p].name;
        let names = match tie {
            Tie::Link(index) => format!("{} and {}", name(self.links[index].edge.a), name(self.links[index].edge.b)),
            Tie::Anchor(p) => format!("{} and the city", name(p)),
        };
        let miss = self.missed(without, tie).unwrap_or(Miss { share: f64::INFINITY, sigmas: f64::INFINITY });
        let off = format!("{:.1} % of the extent ({:.0} sigmas)", 50.0 * miss.share, miss.sigmas);
        let reason = match choices {
            1 => format!("puts {names} {off} off from where the other edges put them"),
            n => format!(
                "a cycle does not close: the edges round {names} disagree by {off}, and any of {n} may be the wrong one; a \
                 further shared photograph would tell"
            ),
        };
        if choices > 1 {
            self.ambiguity.get_or_insert_with(|| reason.clone());
        }
        match tie {
            Tie::Link(index) => {
                self.links[index].edge.used = false;
                self.links[index].edge.reason = Some(reason);
            }
            Tie::Anchor(p) => {
                self.anchored[p] = false;
                self.anchor_faults[p] = Some(reason);
            }
        }
    }

    fn differs(&self, part: usize, one: Option<Similarity>, other: Option<Similarity>) -> bool {
        let (Some(one), Some(other)) = (one, other) else { return one.is_some() != other.is_some() };
        let (center, radius) = extent(&self.parts[part].sfm.points);
        motion_share(&(one.inverse() * other), &center, radius) > SAME_PLACE
    }

    /// Ties of parts that were not placed carry nothing.
    pub fn retire_unplaced(&mut self, poses: &[Option<Similarity>]) {
        for link in self.links.iter_mut().filter(|l| l.edge.used) {
            if poses[link.edge.a].is_none() || poses[link.edge.b].is_none() {
                link.edge.used = false;
                let elsewhere = || "its parts belong to another group than the one that was placed".to_owned();
                link.edge.reason = Some(self.ambiguity.clone().unwrap_or_else(elsewhere));
            }
        }
        (0..poses.len()).for_each(|p| self.anchored[p] &= poses[p].is_some());
    }
}

/// How far a motion carries a scene, as a share of its radius: turned, shifted and scaled.
fn motion_share(motion: &Similarity, center: &Point3<f64>, radius: f64) -> f64 {
    let shift = (motion.apply(center) - center).norm() / radius;
    motion.rotation.angle().hypot(shift).hypot(motion.scale.ln())
}
