//! All similarities at once: each edge with its own information, anchors too.
//!
//! Method       Gauss-Newton over the seven unknowns of every part, weights that bound an edge's pull. The frame is held by the
//!              anchors, or else by the first placed part

use nalgebra::{DMatrix, DVector};

use super::graph::{EdgeId, Network, derivative};
use crate::geometry::Similarity;
use crate::merging::extent::Extent;
use crate::robust::{Matrix7, MotionParameters, Vector7};

const ROUNDS: usize = 20;
const CONVERGED: f64 = 1e-10;

/// How firmly a part is held in the merged frame.
#[derive(Clone, Debug)]
pub(super) struct Held {
    /// Merged frame.
    pub parameters: MotionParameters,
    /// What is left of the information when all other parts are free.
    pub information: Matrix7,
}

struct Adjustment<'a> {
    network: &'a Network<'a>,
    edges: Vec<EdgeId>,
    /// Parts that move.
    free: Vec<usize>,
    parameters: Vec<MotionParameters>,
}

/// Moves `poses` to the least squares of all edges in use; the hold on each part that has a place and is not the frame itself.
pub(super) fn adjust(network: &Network<'_>, poses: &mut [Option<Similarity>]) -> Vec<Option<Held>> {
    let edges: Vec<EdgeId> = network.edges(None).collect();
    let has_anchor = edges.iter().any(|edge| matches!(edge, EdgeId::Anchor(_)));
    let frame = poses.iter().position(Option::is_some).filter(|_| !has_anchor);
    let free = (0..poses.len()).filter(|&p| poses[p].is_some() && Some(p) != frame).collect();
    let parameters = |p: usize| {
        let Extent { center, radius } = network.parts[p].extent;
        let pose = poses[p].unwrap_or_else(Similarity::identity);
        MotionParameters::of_similarity(pose.apply(&center), pose.scale * radius)
    };
    let adjustment = Adjustment { network, edges, free, parameters: (0..poses.len()).map(parameters).collect() };
    adjustment.settle(poses);
    adjustment.held(poses)
}

impl Adjustment<'_> {
    fn settle(&self, poses: &mut [Option<Similarity>]) {
        // A tree has no contradictions to share out.
        let rounds = if self.edges.len() > self.free.len() { ROUNDS } else { 0 };
        for _ in 0..rounds {
            let (information, gradient) = self.equations(poses);
            let Some(factor) = information.cholesky() else { return };
            let step = -factor.solve(&gradient);
            let mut largest: f64 = 0.0;
            for (k, &p) in self.free.iter().enumerate() {
                let own = Vector7::from_iterator(step.rows(7 * k, 7).iter().copied());
                largest = largest.max(own.norm() / self.parameters[p].radius);
                poses[p] = poses[p].map(|pose| self.parameters[p].moved(&pose, &own));
            }
            if largest < CONVERGED {
                return;
            }
        }
    }

    fn equations(&self, poses: &[Option<Similarity>]) -> (DMatrix<f64>, DVector<f64>) {
        let size = 7 * self.free.len();
        let (mut information, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut nudged = poses.to_vec();
        for edge in &self.edges {
            let (Some(miss), Some(own)) = (self.network.miss(poses, *edge), self.network.information(*edge)) else {
                continue;
            };
            let mut jacobian = DMatrix::zeros(7, size);
            for (k, &p) in self.free.iter().enumerate().filter(|(_, p)| self.network.touches(*edge, **p)) {
                let of_part = derivative(self.parameters[p].radius, &miss, |nudge| {
                    nudged[p] = poses[p].map(|pose| self.parameters[p].moved(&pose, nudge));
                    self.network.miss(&nudged, *edge)
                });
                nudged[p] = poses[p];
                jacobian.columns_mut(7 * k, 7).copy_from(&of_part.unwrap_or_else(Matrix7::zeros));
            }
            let gate = self.network.limits.network.pull_sigmas;
            let off = miss.dot(&(own * miss)).max(0.0);
            let weight = (1.0 + off / (7.0 * gate * gate)).recip();
            let weighted = DMatrix::from_iterator(7, 7, (own * weight).iter().copied());
            information += jacobian.transpose() * &weighted * &jacobian;
            gradient += jacobian.transpose() * &weighted * DVector::from_iterator(7, miss.iter().copied());
        }
        (information, gradient)
    }

    fn held(&self, poses: &[Option<Similarity>]) -> Vec<Option<Held>> {
        let mut held = vec![None; poses.len()];
        let Some(covariance) = self.equations(poses).0.cholesky().map(|c| c.inverse()) else { return held };
        for (k, &p) in self.free.iter().enumerate() {
            let own: Matrix7 = covariance.fixed_view::<7, 7>(7 * k, 7 * k).into_owned();
            held[p] = own.try_inverse().map(|information| Held { parameters: self.parameters[p], information });
        }
        held
    }
}

#[cfg(test)]
mod tests;
