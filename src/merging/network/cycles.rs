//! Which edge is wrong where a cycle does not close.
//!
//! Input        edges between parts and anchors in a city, each with what its estimate leaves open
//! Output       a place for every part that the edges reach and whose place hangs on no doubtful choice
//! Method       the strongest edges place the parts. Every further edge closes a cycle; what it misses by is held against what all edges
//!              of the cycle leave open together. A cycle that does not close has a wrong edge in it, and only the other cycles
//!              say which one

use super::graph::{EdgeId, Network, Placement, derivative};
use crate::geometry::Similarity;
use crate::merging::extent::Extent;
use crate::merging::fault::EdgeFault;
use crate::robust::{Matrix7, MotionParameters, Vector7};

/// An edge that may be the wrong one, and where the others put the parts.
struct Suspect {
    edge: EdgeId,
    without: Placement,
    contradictions_left: usize,
    strength: usize,
}

/// How far an edge is from what the places say.
struct Miss {
    /// In its motion's unknowns, as a share of the radius.
    share: f64,
    sigmas: f64,
}

impl Network<'_> {
    fn covariance(&self, edge: EdgeId) -> Option<Matrix7> {
        let floor = (self.limits.network.edge_floor * self.parameters(edge)?.radius).powi(2);
        Some(self.information(edge)?.try_inverse()? + Matrix7::identity() * floor)
    }

    /// How far an edge misses where the others put its parts, against what the whole cycle leaves open.
    fn missed(&self, placement: &Placement, edge: EdgeId) -> Option<Miss> {
        let miss = self.miss(&placement.poses, edge)?;
        let mut open = self.covariance(edge)?;
        for other in self.cycle(placement, edge) {
            let carried = self.carried(placement, edge, other, &miss)?;
            open += carried * self.covariance(other)? * carried.transpose();
        }
        let sigmas = miss.dot(&(open.try_inverse()? * miss)).max(0.0).sqrt();
        Some(Miss { share: miss.norm() / self.parameters(edge)?.radius, sigmas })
    }

    /// The other edges of the cycle that an edge closes; none where it is in the tree itself.
    fn cycle(&self, placement: &Placement, edge: EdgeId) -> Vec<EdgeId> {
        let (one, other) = match edge {
            EdgeId::Pair(index) => {
                let edge = &self.pairs[index].edge;
                (placement.paths[edge.a].as_slice(), placement.paths[edge.b].as_slice())
            }
            EdgeId::Anchor(p) => (placement.paths[p].as_slice(), [].as_slice()),
        };
        let only_one = one.iter().filter(|t| !other.contains(t));
        only_one.chain(other.iter().filter(|t| !one.contains(t))).copied().filter(|t| *t != edge).collect()
    }

    /// How an edge's miss changes with the unknowns of another edge of its cycle. Which side of the cycle that one is on changes
    /// only the sign.
    fn carried(&self, placement: &Placement, edge: EdgeId, other: EdgeId, miss: &Vector7) -> Option<Matrix7> {
        let parameters = self.parameters(other)?;
        let common = match other {
            EdgeId::Pair(index) => placement.poses[self.pairs[index].edge.a]?,
            EdgeId::Anchor(_) => Similarity::identity(),
        };
        let end = match edge {
            EdgeId::Pair(index) => self.pairs[index].edge.b,
            EdgeId::Anchor(p) => p,
        };
        let mut poses = placement.poses.clone();
        derivative(parameters.radius, miss, |nudge| {
            let motion = common * parameters.moved(&Similarity::identity(), nudge) * common.inverse();
            poses[end] = Some(motion * placement.poses[end]?);
            self.miss(&poses, edge)
        })
    }

    fn contradictions(&self, placement: &Placement, without: Option<EdgeId>) -> usize {
        self.edges(without).filter(|edge| self.is_off(placement, *edge)).count()
    }

    fn is_off(&self, placement: &Placement, edge: EdgeId) -> bool {
        self.missed(placement, edge).is_some_and(|miss| miss.sigmas > self.limits.cycle_sigmas())
    }

    /// Places the parts without the edges that contradict the others. Where several edges may be the wrong one, the parts whose
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
            let Suspect { edge, without, .. } = suspects.swap_remove(0);
            self.put_aside(edge, &without, choices);
            placement = without;
        }
        (0..self.parts.len()).map(|p| placement.poses[p].filter(|_| !doubtful[p])).collect()
    }

    /// The edges without which fewest contradictions are left, the weakest first.
    fn suspects(&self, placement: &Placement) -> Vec<Suspect> {
        let placed = |placement: &Placement| placement.poses.iter().flatten().count();
        let mut suspects = Vec::new();
        for edge in self.edges(None) {
            let without = self.place(Some(edge));
            // An edge without which a part has no place at all is in no cycle, and one that agrees with the others is not to blame.
            if placed(&without) == placed(placement) && self.is_off(&without, edge) {
                let strength = match edge {
                    EdgeId::Pair(index) => self.pairs[index].edge.inliers,
                    EdgeId::Anchor(_) => usize::MAX,
                };
                let contradictions_left = self.contradictions(&without, Some(edge));
                suspects.push(Suspect { edge, without, contradictions_left, strength });
            }
        }
        suspects.sort_by_key(|s| (s.contradictions_left, s.strength));
        let fewest = suspects.first().map(|s| s.contradictions_left);
        suspects.retain(|s| Some(s.contradictions_left) == fewest);
        suspects
    }

    fn put_aside(&mut self, edge: EdgeId, without: &Placement, choices: usize) {
        let name = |p: usize| self.parts[p].name();
        let names = match edge {
            EdgeId::Pair(index) => format!("{} and {}", name(self.pairs[index].edge.a), name(self.pairs[index].edge.b)),
            EdgeId::Anchor(p) => format!("{} and the city", name(p)),
        };
        let miss = self.missed(without, edge).unwrap_or(Miss { share: f64::INFINITY, sigmas: f64::INFINITY });
        let Miss { share, sigmas } = miss;
        let fault = match choices {
            1 => EdgeFault::Contradicted { names, share, sigmas },
            _ => EdgeFault::OpenCycle { names, share, sigmas, choices },
        };
        if choices > 1 {
            self.ambiguity.get_or_insert_with(|| fault.clone());
        }
        match edge {
            EdgeId::Pair(index) => self.pairs[index].edge.refusal = Some(fault),
            EdgeId::Anchor(p) => {
                self.anchored[p] = false;
                self.anchor_faults[p] = Some(fault);
            }
        }
    }

    fn differs(&self, part: usize, one: Option<Similarity>, other: Option<Similarity>) -> bool {
        let (Some(one), Some(other)) = (one, other) else { return one.is_some() != other.is_some() };
        let Extent { center, radius } = self.parts[part].extent;
        let moved =
            MotionParameters::of_similarity(center, radius).between(&Similarity::identity(), &(one.inverse() * other));
        moved.norm() > self.limits.same_place() * radius
    }
}

#[cfg(test)]
mod tests;
