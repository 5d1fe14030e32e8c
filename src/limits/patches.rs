//! Limits of taking planar patches and the vertical out of a cloud.

/// How planar patches are made of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchLimits {
    /// A larger cloud is thinned evenly to about this many points. Derived: more do not make a pose better, since the model's own
    /// error is shared by all points of a plane.
    pub most_points: usize,
    /// Fewest points of a patch. Derived: a plane is fixed by three; as many more and two can contradict.
    pub fewest_points: usize,
    /// Fewest points of a superpixel that get a plane of their own. Derived: three define it, three more can contradict.
    pub fewest_in_superpixel: usize,
    /// A superpixel has a plane when at least this share of its points lies in it. Chosen.
    pub planar_share: f64,
    /// Points belong to a plane within this many sigmas of its noise. Derived: 99 % of Gaussian noise.
    pub gate_sigmas: f64,
    /// Normals of neighbours in one region differ by no more than this. Derived: local planes of 14 points are good to some 4
    /// degrees, edges of buildings turn by 20 and more.
    pub same_normal_deg: f64,
    /// A local plane rougher than this starts no region: its thickness over its width. Chosen.
    pub seed_roughness: f64,
}

impl Default for PatchLimits {
    fn default() -> Self {
        PatchLimits {
            most_points: 40_000,
            fewest_points: 8,
            fewest_in_superpixel: 6,
            planar_share: 0.6,
            gate_sigmas: 2.5,
            same_normal_deg: 20.0,
            seed_roughness: 0.35,
        }
    }
}

/// Which way is up. Measured with these: on 173 captures with known up (whole or cut to 3 to 8 photographs in a row, or clouds without
/// cameras), seven starts each, the errors of up were 0.7 of its sigmas in the median, 2.0 at 95 % and 3.5 at most where the start's
/// tilt has a sigma of 20 degrees or less; nine pairs of real captures of one place differed by at most 1.9 of theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpLimits {
    /// Up worse than this is not known. Derived: three sigmas of it are what the normals of a right pair of patch and plane may differ
    /// by.
    pub known_sigma_rad: f64,
    /// More directions than this are not searched one by one. Measured on the sample: 2 s for each against 20 s turning freely.
    pub most_known: usize,
    /// How far the up that cameras tell may be off where no start is known, one sigma. Measured on eight captures: 0.4 to 2.3 degrees; on 29 parts
    /// of real photographs cameras and walls differed by up to 18.
    pub cameras_sigma_rad: f64,
    /// An axis of points alone is tried with at least this share of the strongest one's support. Chosen: facades outvote floors, and the right axis
    /// is not always the strongest.
    pub axis_share: f64,
    /// Optima are distinct beyond so many of their common sigmas. Derived: 99 % of Gaussian errors.
    pub distinct_sigmas: f64,
    /// A direction is comparable with at least this share of the best one's support. Measured on the scenes: level photographs of one facade
    /// support it as a floor, seen by cameras that are turned by a quarter, with 0.6 to 0.8 of the right support.
    pub comparable_share: f64,
    /// What leaving the start costs for each squared sigma, shares of the support. Chosen: all of its reach as much as half of one
    /// kind of voters.
    pub cost_of_leaving: f64,
    /// Of walls, floors and roofs. Chosen: walls are built to a third of a degree; streets, yards and flat roofs fall by a few per
    /// cent.
    pub patches: UpErrorModel,
    /// Of cameras. Chosen: hands tilt a camera by a few degrees at random, and by half a degree as a habit.
    pub cameras: UpErrorModel,
    /// So many observations off by a kernel stand in for what few observations cannot tell of their scatter. Measured on 173 captures.
    pub votes_of_kernel: f64,
    /// Nobody looks up at a building more steeply than this: sine of 50 degrees. Chosen.
    pub steepest_view: f64,
    /// A camera that looks straight down may lean so far (sine) that its y axis points up. Chosen.
    pub upside_down: f64,
    /// What a photograph counts that was turned by a quarter. Chosen: fewer are than not. Turned ones alone still outvote what else
    /// their axes would allow, which makes half of them look at the sky.
    pub quarter_turned: f64,
}

impl Default for UpLimits {
    fn default() -> Self {
        UpLimits {
            known_sigma_rad: 0.04,
            most_known: 3,
            cameras_sigma_rad: 0.07,
            axis_share: 0.1,
            distinct_sigmas: 3.0,
            comparable_share: 0.6,
            cost_of_leaving: 0.05,
            patches: UpErrorModel { kernel_rad: 0.035, shared_across_rad: 0.005, shared_along_rad: 0.02 },
            cameras: UpErrorModel { kernel_rad: 0.06, shared_across_rad: 0.01, shared_along_rad: 0.01 },
            votes_of_kernel: 1.0,
            steepest_view: 0.77,
            upside_down: 0.2,
            quarter_turned: 0.7,
        }
    }
}

/// How voters for up err, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpErrorModel {
    /// The weight of an observation this far off has fallen to a quarter.
    pub kernel_rad: f64,
    /// The error that voters of one direction share, where they ask for an up across that direction.
    pub shared_across_rad: f64,
    /// The same error along that direction.
    pub shared_along_rad: f64,
}
