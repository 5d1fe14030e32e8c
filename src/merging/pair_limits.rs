//! Every number that decides how two parts are compared: keypoints, planes, fit, search, sources, decision.
//!
//! As in [`super::limits`] each says where it comes from.

/// When two keypoints are one, and how well a keypoint is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeypointLimits {
    /// Keypoints this near to each other are one, as a share of the photograph's width. Chosen: 1.4 pixels of 1400, what an
    /// undistortion or a change of size leaves.
    pub same_share: f64,
    /// Keypoints nearer than this are one in small photographs too, pixels. Chosen: some tools
    /// write whole pixels.
    pub same_px: f64,
    /// One sigma of a keypoint, pixels. Chosen: detectors reach a third to a half, reconstructions leave about one.
    pub sigma_px: f64,
}

/// When points of one part are on planes of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedPlaneLimits {
    /// Superpixels of a photograph where parts are joined. Chosen: so small that most show one piece of surface, and still hold a
    /// handful of points.
    pub superpixels: usize,
    /// Fewest points of a superpixel that get a plane. Derived: three define it, one more can contradict.
    pub fewest_points: usize,
    /// A plane that is thicker than this share of its narrow spread is a heap of points. Chosen.
    pub flatness: f64,
    /// Cosine between normal and line of sight below which a plane is seen edge-on. Chosen: 11 degrees.
    pub edge_on: f64,
    /// A point further from the plane's centre than this many of its longer spreads lies beside it. Derived: points that fill a disc reach
    /// two spreads, four points of it may have a third of the spread of all.
    pub beside_spreads: f64,
    /// Where the poses are known, a point is on a patch within so many times the median distance of neighbours, and what the
    /// bend adds. Chosen.
    pub partner_spacings: f64,
    /// The bend adds so many of its sigmas. Derived: 99.7 % of Gaussian errors.
    pub partner_bends: f64,
    /// Fewer points of the other part on a patch may be there by chance. Chosen.
    pub fewest_partners: usize,
}

/// How a pose is fitted to what two parts share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitLimits {
    /// What is further off than this many sigmas is a mismatch, and has no weight. Derived: chi-square of the three freedoms
    /// of a point pair
    /// leaves one in a thousand beyond 4.03.
    pub gate_sigmas: f64,
    /// The bend of two parts against each other is sought between these. Chosen: what no data have, and what no decision lets pass.
    pub least_bend: f64,
    pub most_bend: f64,
    /// The bend before anything is known of it. Chosen: as the floor of an edge.
    pub first_bend: f64,
    /// All observations of one source count at most as so many independent ones. Chosen: their bend is common to neighbours.
    pub independent: f64,
    /// An estimate scatters at least by this share of the variance that its rows state. Derived: rows claim keypoints with one sigma of a
    /// pixel; no detector is better than a fifth of that.
    pub least_effect: f64,
    pub cameras: CameraFitLimits,
}

/// What the two poses of one photograph say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFitLimits {
    /// One sigma of a camera's rotation between two reconstructions, radians. Chosen: a pixel or two of a photograph.
    pub turn_sigma_rad: f64,
    /// A difference of the focal lengths, as a share, adds so many radians for each of it. Chosen.
    pub turn_per_focal_doubt: f64,
    /// One sigma of its centre, bends. Chosen: cameras bend with their points.
    pub center_bends: f64,
    /// A camera further from the pairs' answer than this many medians of a whitened residual is left out. Chosen: 4.6 sigmas.
    pub gate_medians: f64,
}

/// How hypotheses are drawn, ranked and kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSearchLimits {
    /// Pairs, groups of points on planes, and points of a group that rank hypotheses. Chosen: more say nothing new.
    pub scored_pairs: usize,
    pub scored_groups: usize,
    pub scored_in_group: usize,
    /// Samples of three pairs, at least and at most, and hits of the leader that end the search. Chosen: half of the pairs right, one
    /// sample in eight is.
    pub fewest_pair_samples: usize,
    pub most_pair_samples: usize,
    pub enough_hits: usize,
    /// Poses by pairs that are kept. Chosen: only the best is used, the others compete with it.
    pub kept_by_pairs: usize,
    /// Samples of seven points on planes. Derived: with a third of the points off their planes one in seventeen has none of them.
    pub plane_samples: usize,
    /// Distinct poses by planes that are refined. Chosen: samples of noisy points a few pixels apart give rough poses.
    pub kept_by_planes: usize,
    /// Bend while hypotheses by planes are ranked, and while those that are kept are refined. Chosen: from what a minimal sample is off
    /// by to what parts bend.
    pub plane_bend: f64,
    pub narrowing_bends: [f64; 3],
    /// Poses that differ by less than these (share of the radius, radians, log scale) are one. Chosen: well within the basin of refinement.
    pub same_shift: f64,
    pub same_turn_rad: f64,
    pub same_log_scale: f64,
}

/// When two sources say the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceLimits {
    /// Sources that differ by more than this many sigmas disagree. Derived: in seven unknowns chance gives 4.7 (chi-square 22) as
    /// rarely as three sigmas in one; rarer than the false alarms of a verdict it need not be, since a word is all that it costs.
    pub disagree_sigmas: f64,
    /// A point this near to its plane lies on it, whatever its sigmas. Chosen: 0.2 % of the extent.
    pub on_plane: f64,
    /// Planes contradict a place where less than this share of what agrees at their own place agrees. Chosen.
    pub contradicted_share: f64,
    /// Planes whose own place is further away than this contradict it, too. Chosen: no bend of a sound part does that.
    pub elsewhere: f64,
}

/// Whether two parts belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairDecisionLimits {
    /// What agrees must exceed chance by this factor. Chosen.
    pub chance_factor: f64,
    /// Coincident keypoints must exceed chance by this many of its standard deviations as well. Chosen: beyond the 3.1 that
    /// the false alarms of a verdict ask for.
    pub chance_sigmas: f64,
    /// Fewer pairs fix nothing. Derived: seven unknowns, each five times over.
    pub fewest_pairs: usize,
    /// Fewer planes, and points on them, fix nothing. Derived: seven unknowns and one; each three times over.
    pub fewest_planes: usize,
    pub fewest_on_planes: usize,
    /// Share that must agree with the similarity. Measured: of parts of two places a third of the points can be laid on planes.
    pub agreeing_share: f64,
    /// A part whose own points miss its own keypoints by more than this share of the width is no sound part. Chosen.
    pub own_error_share: f64,
    /// Bend beyond which two parts are not the same thing. Chosen: a per cent of the extent.
    pub most_bend: f64,
    /// The nearest of the shared cameras must agree to this turn and shift. Chosen.
    pub most_turn_deg: f64,
    pub most_shift: f64,
    /// The shift may be greater by so many times what the focal lengths' difference moves a camera by. Chosen.
    pub shift_focal_doubts: f64,
    /// A mirrored part explains this many times more where a part is a mirror image. Chosen.
    pub mirror_gain: f64,
    /// An affine map that stretches by more than this shows a stretched part. Chosen.
    pub most_stretch: f64,
    /// It must leave less than this share of the residual, too. Chosen.
    pub stretch_rest: f64,
    /// How firmly a stretch is held at none where the data say nothing of it: a share of what they say on average. Chosen.
    pub stretch_hold: f64,
    /// Residuals of points on planes are compared at this quantile. Derived: a stretch along an axis leaves the planes along
    /// that axis where
    /// they are, which may be more than half of all; wrong points are fewer than the rest.
    pub stretch_quantile: f64,
    /// One sigma beyond which a freedom is not determined; a smaller difference of two sources is no matter. Chosen: 0.15 % of
    /// the extent.
    pub determined: f64,
}

impl Default for SharedPlaneLimits {
    fn default() -> Self {
        SharedPlaneLimits {
            superpixels: 1100,
            fewest_points: 4,
            flatness: 0.25,
            edge_on: 0.2,
            beside_spreads: 6.0,
            partner_spacings: 4.0,
            partner_bends: 3.0,
            fewest_partners: 3,
        }
    }
}

impl Default for FitLimits {
    fn default() -> Self {
        FitLimits {
            gate_sigmas: 4.0,
            least_bend: 1e-7,
            most_bend: 5e-2,
            first_bend: 5e-3,
            independent: 200.0,
            least_effect: 0.04,
            cameras: CameraFitLimits {
                turn_sigma_rad: 1.5e-3,
                turn_per_focal_doubt: 0.05,
                center_bends: 1.0,
                gate_medians: 3.0,
            },
        }
    }
}

impl Default for PairSearchLimits {
    fn default() -> Self {
        PairSearchLimits {
            scored_pairs: 250,
            scored_groups: 200,
            scored_in_group: 4,
            fewest_pair_samples: 2048,
            most_pair_samples: 8192,
            enough_hits: 20,
            kept_by_pairs: 5,
            plane_samples: 8192,
            kept_by_planes: 40,
            plane_bend: 1e-2,
            narrowing_bends: [1e-2, 5e-3, 3e-3],
            same_shift: 0.05,
            same_turn_rad: 0.1,
            same_log_scale: 0.1,
        }
    }
}

impl Default for PairDecisionLimits {
    fn default() -> Self {
        PairDecisionLimits {
            chance_factor: 3.0,
            chance_sigmas: 5.0,
            fewest_pairs: 12,
            fewest_planes: 8,
            fewest_on_planes: 21,
            agreeing_share: 0.5,
            own_error_share: 0.006,
            most_bend: 0.02,
            most_turn_deg: 4.0,
            most_shift: 0.06,
            shift_focal_doubts: 1.5,
            mirror_gain: 1.15,
            most_stretch: 1.06,
            stretch_rest: 0.6,
            stretch_hold: 1e-2,
            stretch_quantile: 0.8,
            determined: 0.003,
        }
    }
}
