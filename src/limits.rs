//! Every number that decides how a reconstruction is aligned and judged, in one value.
//!
//! Each says where it comes from: *derived* (from what), *measured on* (what), or *chosen* (why). Guards of arithmetic (smallest
//! lengths, block sizes of parallel work) stand beside the code that they guard. Lengths are metres; a *unit* is the width of a
//! scene's narrowest gate, [`Limits::model_unit_m`] and so many sigmas of the cloud's noise.

/// The numbers that decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// How far what is known beforehand is believed, in sigmas. Derived: nine in a thousand of Gaussian errors of one freedom lie
    /// beyond three sigmas; what users are told.
    pub reach_sigmas: f64,
    /// Cost of one squared sigma away from what is known beforehand, in the unit of the score. Chosen: three sigmas in one freedom (9)
    /// cost as much as a small house, 3 %.
    pub prior_cost: f64,
    /// Levelling by walls and floors is not believed to be better than this, radians. Chosen: a degree.
    pub least_tilt_rad: f64,

    /// Gates are multiples of this ... Chosen: what eaves, reveals and a model's error put between a point and its facet.
    pub model_unit_m: f64,
    /// So many sigmas of the cloud's noise are added to it. Derived: 95 % of Gaussian noise.
    pub noise_sigmas: f64,
    /// Error of one plane of the model as a whole. Measured on the surveyed LoD2 models at hand: some centimetres.
    pub plane_sigma_m: f64,
    /// No point of a photograph is better than this. Chosen.
    pub least_point_sigma_m: f64,

    /// Normals of a patch and its facet agree within this angle. Chosen: patch normals are good to some degrees, walls of a block
    /// turn by more.
    pub same_normal_deg: f64,
    /// A facet that is seen at a more grazing angle shows no points. Chosen.
    pub grazing_deg: f64,
    /// Sine of the angle within which a wall is upright and a floor level. Chosen: steeper roofs and ramps are neither.
    pub upright_sin: f64,
    /// A frame that leans by less than this tells a floor, up to 37 degrees from its z, from the ceiling that it would be upside
    /// down, radians. Derived: a right angle less 37 degrees, and some slack.
    pub tells_floors_rad: f64,

    pub exposure: FacetVisibilityLimits,
    pub patches: PatchLimits,
    pub up: UpLimits,
    pub search: SearchLimits,
    pub refinement: RefinementLimits,
    pub walk: LineSearchLimits,
    pub sight: OcclusionLimits,
    pub null_poses: NullPoseLimits,
    pub evidence: EvidenceLimits,
    pub uncertainty: UncertaintyLimits,
    pub verdict: VerdictLimits,
}

/// Which facets somebody could have seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetVisibilityLimits {
    /// Lines of sight start this far off the facet. Chosen: beyond the mortar between the walls of two houses.
    pub start_m: f64,
    /// What is nearer than this in front of a facet hides it. Chosen: nobody stands there.
    pub narrowest_gap_m: f64,
    /// The front of a neighbour's wall this near before the back of one's own is met with it: the two share a party wall, often to the
    /// last digit. Chosen: models are written to centimetres or finer.
    pub joint_m: f64,
    /// Lines of sight that meet nothing within this distance end in the open. Chosen: wider than a courtyard.
    pub open_m: f64,
    /// Larger triangles are looked at from three places, square metres. Chosen.
    pub large_triangle_m2: f64,
}

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
    pub patches: UpHabits,
    /// Of cameras. Chosen: hands tilt a camera by a few degrees at random, and by half a degree as a habit.
    pub cameras: UpHabits,
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

/// How voters for up err, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpHabits {
    /// The weight of an observation this far off has fallen to a quarter.
    pub kernel_rad: f64,
    /// The error that voters of one direction share, where they ask for an up across that direction.
    pub shared_across_rad: f64,
    /// The same error along that direction.
    pub shared_along_rad: f64,
}

/// How hypotheses are drawn, ranked and kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLimits {
    /// Samples drawn at least and at most. Measured on
    /// the scenes of known truth: with these all of 160 starts were found (2026-11-22).
    pub fewest_samples: usize,
    pub most_samples: usize,
    /// The search ends once the leader has been found so often. Chosen.
    pub enough_hits: usize,
    /// The best of each block of 64 samples, which are refined before they are ranked. Measured on two laser scans of which the model knows a
    /// tenth, five starts each: right poses, one sample in ten thousand, are among the best two or three of their blocks.
    pub best_of_block: usize,
    /// Sample points that refine and rank them. Derived: one inlier in 200 more or less is noise beside that of a minimal sample.
    pub local_optimization_points: usize,
    /// Gates of that refinement, one step each, and of the ranking after it, units. Derived: from a hypothesis's to what a refined pose is off
    /// by. Measured on the same scans: of the poses kept the right one is the first in five of six runs; a ranking gate of 2.3 left it
    /// behind a hundred in one.
    pub local_optimization_gates_units: &'static [f64],
    pub ranking_gate_units: f64,
    /// Hypotheses that are refined further. Chosen.
    pub keep: usize,
    /// Sample points that rank a hypothesis within its block. Measured on the same scans: with 64 the right pose of one run in four is lost, with
    /// 100 of none.
    pub ranking_points: usize,
    /// Gate of that ranking, units. Derived: a minimal sample extrapolates the noise of a few patches over the whole scene.
    pub gate_units: f64,
    /// Poses that move no corner of the scene by more than this are one place of the search. Chosen: well within the basin
    /// of refinement.
    pub same_place_m: f64,
    /// Planes smaller than this are not offered as pairs (they still count in every score), square metres. Chosen: a patch of that
    /// size has no firm normal.
    pub smallest_target_m2: f64,
    /// Tilts of a patch and its plane differ by no more than this, radians, and azimuths, once the heading is fixed by another pair of
    /// the same uncertainty. Chosen: patch normals are good to some degrees.
    pub same_angle_rad: f64,
    /// Two patches and their two planes stand at the same angle, by as much as this: cosines. Derived: they differ by at most the
    /// angles, of which there are two.
    pub same_cos: f64,
    /// A row's own uncertainty: error of the model and of the patch's centre. Chosen.
    pub row_sigma_m: f64,
    /// What an uncertain rotation adds to it, per metre of distance from the middle of the cloud. Derived: a normal that is a
    /// degree off.
    pub row_sigma_per_m: f64,
    /// A patch whose row is known to within this says nothing new. Chosen: three or four row sigmas.
    pub informative_sigma_m: f64,
    /// Patches drawn for a place in a sample until one can lie anywhere. Measured on laser scans of which the model knows a tenth: with one the
    /// right pose of the Delft blocks is missed in every other run.
    pub most_draws: usize,
    /// They are drawn where fewer than this share of the samples find planes for all their patches with one. Measured on 13 scenes: where models
    /// lack most of what was seen 0 to 7 % do, else 12 to 63 %.
    pub feasible_share: f64,
    /// Patches that lie on the city: the others are trees, cars, and houses that the model lacks. Chosen: half.
    pub on_city: f64,
    /// Time to draw one pair and to score one pose (on 200 sample points, when these ranked), microseconds. Measured by `cargo bench --bench search` on one
    /// core of a shared EPYC, 2026-11-30; their ratio matters.
    pub pair_us: f64,
    pub score_us: f64,
}

/// How a pose is made sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinementLimits {
    /// A point whose foot lies farther outside its facet than this share of the gate is not on it. Chosen.
    pub outside_share: f64,
    /// Directions held worse than this are not moved by least squares. Chosen: a step of a metre is beyond every gate.
    pub most_sigma_m: f64,
    /// Loose points, of unknown direction, are taken for a facet's own only this close to it, sigmas of a point. Derived: 99 % of
    /// Gaussian noise.
    pub unsegmented_gate_sigmas: f64,
    /// Such points count for this much of a patch's point. Chosen: many of them lie there by chance.
    pub unsegmented_weight: f64,
    /// Width of Tukey's biweight, sigmas. Derived: 95 % efficient on Gaussian noise.
    pub tukey_sigmas: f64,
    /// The narrowest gate that residuals may set, as a share of the widest. Chosen.
    pub least_gate_share: f64,
    /// Two poses that move no corner of the scene by more than this are one, units. Chosen.
    pub same_pose_units: f64,
    /// Rounds of improvement, each with more sample points, narrower gates and fewer poses. Chosen.
    pub stages: [StageLimits; 3],
    /// Sample points whose lines of sight are traced, and that rank at most. Derived: more points change the third digit.
    pub traced_points: usize,
    pub most_scoring_points: usize,
}

/// A round of improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageLimits {
    /// Sample points that refine and rank; all of the patches' where the cloud has fewer.
    pub sample_points: usize,
    /// Gates of refinement, one step each, and of ranking, units.
    pub gates_units: &'static [f64],
    pub ranking_gate_units: f64,
    /// Whether lines of sight count.
    pub sight: bool,
    /// Whether better poses in the basins beside join first.
    pub basins: bool,
    /// Poses that go on.
    pub keep: usize,
}

/// How poses are moved along what the data hold loosely or not at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSearchLimits {
    /// Directions held worse than this are walked by the score. Chosen: a window's reveal.
    pub loose_m: f64,
    /// Step of that walk in gates. Derived: the score changes by little over half a gate.
    pub step_of_gate: f64,
    /// Its greatest number of steps to either side. Chosen: a bound for starts that know nothing.
    pub most_steps: i32,
    /// Moves into neighbouring basins, units. Chosen: parallel planes of one facade stand some decimetres apart.
    pub basin_moves_units: [f64; 4],
    /// Gates of refinement after such a move, units. Derived: as wide as a move, then as the score's.
    pub basin_gates_units: [f64; 4],
    /// Sample points that say which of two basins explains more. Chosen.
    pub basin_points: usize,
    /// Rounds of such moves. Chosen.
    pub most_rounds: usize,
    /// A walk by the score ends within this many units of the right place. Chosen.
    pub settling_units: f64,
    /// A plane whose distance changes by less than this share of a motion is not left by it. Chosen.
    pub unmoved_share: f64,
}

/// Poses fitted by chance, against which an answer's evidence is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullPoseLimits {
    /// Null poses that are asked for. Chosen: a chance of 2 % is then known to half of itself.
    pub count: usize,
    /// Each round has a batch of samples for every null pose that is asked for; there are no more rounds than so many. Chosen: a bound
    /// for clouds of which few samples give a pose.
    pub most_rounds: u64,
    /// Samples in a batch, of which the best is taken. Measured on 114 wrong answers of generated captures: against single samples they exceed
    /// 2, 4, 6 and 8 bits in 23, 7, 4 and 2 %, as often as the four poses that an answer is chosen from on average allow at most; against the best
    /// of ten right poses lose a third of their bits.
    pub samples: usize,
    /// Sample points that choose the best of a batch. Derived: as the search's.
    pub ranking_points: usize,
    /// Sample points that refine it. Derived: as the search's first round.
    pub refining_points: usize,
    /// Gates of refinement, units. Derived: from the search's to the score's.
    pub gates_units: &'static [f64],
    /// Null poses are sought at least so far from the start, metres. Chosen: a row of houses along a street.
    pub least_reach_m: f64,
    /// Poses that differ by less than these (metres, radians, log scale) are led to one place by refinement. Measured on the scenes of
    /// known truth: 2 m, 6 degrees, 8 %.
    pub basin_m: f64,
    pub basin_rad: f64,
    pub basin_log_scale: f64,
    /// The best null poses of other places, which are refined to the end and heard as rivals. Chosen: as many as the search's candidates.
    pub heard: usize,
}

/// What speaks for a pose, in bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvidenceLimits {
    /// Coplanar pieces of the cloud are one observation: normals within this angle. Measured on 369 poses: where each piece of a front
    /// counts, wrong poses reach 86 bits, where the front counts once, 15.
    pub same_plane_deg: f64,
    /// Their centres must lie within this of the larger one's plane, metres. Measured on the same poses.
    pub same_plane_m: f64,
    /// Sample points of a piece that are looked up. Derived: a share of a piece is then known to a seventh.
    pub sample_points: usize,
    /// Sample points of a piece whose lines of sight are traced. Chosen: two in three decide.
    pub traced_points: usize,
    /// A sample point lies on a facet within this distance, metres. Measured on the same poses: 0.2 to 0.5 m do alike.
    pub tolerance_m: f64,
    /// The distance is at least so many sigmas of the cloud's noise. Derived: 99.7 % of Gaussian noise.
    pub tolerance_sigmas: f64,
    /// Points of the cloud that are asked whether the city hides them. Derived: a share is then known to 3 %.
    pub occlusion_points: usize,
    /// They are spread evenly over squares of this width, metres. Chosen: a house's width, since one house hides what lies in one.
    pub hidden_square_m: f64,
    /// Null poses that met everything alike stand in for what few null poses cannot tell. Chosen: one.
    pub unseen_null_poses: f64,
}

/// When the city hides a point from its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionLimits {
    /// The point's own surroundings do not hide it. Chosen: eaves, reveals and the model's error reach this far.
    pub surroundings_m: f64,
    /// The camera's own place may be off the model's free space by this much. Chosen.
    pub camera_slack_m: f64,
}

/// What errs together in a model and a reconstruction, and by how much before anything is seen of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertaintyLimits {
    /// Rounds in which the pose is estimated, each with points put on facets anew. Chosen.
    pub rounds: usize,
    /// Points within this of a surface lie on it, units. Chosen: one and a half times the score's, so that buildings which stand off are heard, and
    /// count by what their heavy tails give them.
    pub gate_units: f64,
    /// Steps in which spreads and unknowns settle in a round. Chosen.
    pub steps: usize,
    /// Width of a piece of surface that is one observation. Chosen: windows and bays repeat every two to four metres.
    pub piece_m: f64,
    /// An object that is larger is no building, and is taken apart ... Chosen.
    pub largest_building_m: f64,
    /// Larger objects are cut into squares of this width. Chosen: a building's width.
    pub square_m: f64,
    /// An object is built where its walls have more than this share of its other surface; else it is ground. Derived: a hall of 100 m, 8 m
    /// high, has 0.3; a quay of 3 m along a square of 60 m has 0.05.
    pub least_walls: f64,
    /// A turn is not felt by less than this. Chosen: half a small house.
    pub least_lever_m: f64,
    /// Planes of a building are one in space within this angle and distance. Measured on wrong poses: what is nearer fits or
    /// misses together.
    pub same_front_deg: f64,
    pub same_front_m: f64,
    /// One sigma of a building's shift, of a front's offset and tilts, and of a piece, before anything is seen of them. Measured on models of
    /// others: some centimetres where surveyed, two to five decimetres where generalised; between.
    pub building_sigma_m: f64,
    pub front_sigma_m: f64,
    pub piece_sigma_m: f64,
    /// Standard deviation of the reconstruction's bending, as a share of its radius. Derived: reconstructions bend by 0.1 to 0.5 % of their extent at
    /// most; two radii, and half of the most as root mean square. Measured: with 0.05 % four rendered scenes, which do not bend, come out better by
    /// a tenth (one by a half); with 0.1 % a generated one that does is `aligned` 1.1 m off at 0.15 m stated.
    pub bending_share: f64,
    /// How many observations these are worth. Chosen: little, so that data decide where there are any.
    pub building_worth: f64,
    pub front_worth: f64,
    pub piece_worth: f64,
    pub bending_worth: f64,
    /// One sigma of how far walls stand inside the model's. Measured on LoD1 and LoD2 models drawn from roofs: 0.2 to 0.5 m.
    pub walls_sigma_m: f64,
    /// One sigma of how far tops are from the model's, where all are level (LoD1: a lid at half or more of a pitched roof's height) and where
    /// they are not (surveyed). Chosen: a lid alone still holds a height, if no better than a user asks for.
    pub lids_sigma_m: f64,
    pub roofs_sigma_m: f64,
    /// Degrees of freedom of Student's t for buildings, fronts, pieces and points. Chosen: between Cauchy's one and the four of Lange, Little and
    /// Taylor (1989). Measured on 36 generated captures, a gate of two units: 0.26 m of error in the mean, where 8 with a gate of half a unit for the
    /// pose gave 0.31 m.
    pub student_dof: f64,
    /// Fewest buildings whose scatter is asked. Derived: as many as a pose has unknowns, and one.
    pub fewest_left_out: usize,
    /// What is common to all walls or tops, and bending, is told where it is so many sigmas beyond chance ... Derived: one in a thousand.
    pub reported_sigmas: f64,
    /// A common error is reported from this size on. Chosen: what a survey of buildings would note.
    pub reported_m: f64,
    /// A freedom is confirmed where it is held to this many times what is asked when any one front is left out, whatever the other freedoms
    /// then are. Chosen.
    pub confirmed_times: f64,
}

/// What a verdict asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerdictLimits {
    /// The chance of a wrong pose that is called right which may be taken. Chosen: one in a thousand; `--false-alarm`.
    pub false_alarm: f64,
    /// Poses that differ by less than this along what is held are one pose, at the scene's radius. Chosen.
    pub same_m: f64,
    /// A freedom that the data hold worse than this is not determined, at the scene's radius. Chosen: a window's width is what a
    /// user would see.
    pub default_accuracy_m: f64,
    /// The accuracy asked for as a share of the radius, where that is more. Chosen: reconstructions bend by as much.
    pub default_accuracy_share: f64,
    /// Gates that lead from a given scale to the data's own, units. Derived: from the search's to the score's, step by step.
    pub scale_gates_units: &'static [f64],
    /// The data contradict a given scale where theirs is so many sigmas away ... Derived: 99.7 % of Gaussian errors.
    pub scale_sigmas: f64,
    /// It must also be off at least so far at the scene's radius. Derived: three sigmas of a plane of the model, which alone explain as much.
    pub scale_m: f64,
}

impl VerdictLimits {
    /// How much likelier than all that speaks against it a pose must be, in bits.
    pub fn margin_bits(&self) -> f64 {
        -self.false_alarm.log2()
    }

    /// What a freedom must be held to where nothing else is asked for, metres at this radius.
    pub fn accuracy_m(&self, radius_m: f64) -> f64 {
        self.default_accuracy_m.max(self.default_accuracy_share * radius_m)
    }
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            reach_sigmas: 3.0,
            prior_cost: 0.003,
            least_tilt_rad: 0.02,
            model_unit_m: 0.25,
            noise_sigmas: 2.0,
            plane_sigma_m: 0.05,
            least_point_sigma_m: 0.01,
            same_normal_deg: 25.0,
            grazing_deg: 83.0,
            upright_sin: 0.2,
            tells_floors_rad: 0.8,
            exposure: FacetVisibilityLimits {
                start_m: 0.06,
                narrowest_gap_m: 0.5,
                joint_m: 0.01,
                open_m: 40.0,
                large_triangle_m2: 4.0,
            },
            patches: PatchLimits {
                most_points: 40_000,
                fewest_points: 8,
                fewest_in_superpixel: 6,
                planar_share: 0.6,
                gate_sigmas: 2.5,
                same_normal_deg: 20.0,
                seed_roughness: 0.35,
            },
            up: UpLimits {
                known_sigma_rad: 0.04,
                most_known: 3,
                distinct_sigmas: 3.0,
                comparable_share: 0.6,
                cost_of_leaving: 0.05,
                patches: UpHabits { kernel_rad: 0.035, shared_across_rad: 0.005, shared_along_rad: 0.02 },
                cameras: UpHabits { kernel_rad: 0.06, shared_across_rad: 0.01, shared_along_rad: 0.01 },
                votes_of_kernel: 1.0,
                steepest_view: 0.77,
                upside_down: 0.2,
                quarter_turned: 0.7,
            },
            search: SearchLimits {
                fewest_samples: 8192,
                most_samples: 65_536,
                enough_hits: 10,
                best_of_block: 3,
                local_optimization_points: 200,
                local_optimization_gates_units: &[5.0, 2.3],
                ranking_gate_units: 1.3,
                keep: 60,
                ranking_points: 100,
                gate_units: 5.0,
                same_place_m: 1.5,
                smallest_target_m2: 1.0,
                same_angle_rad: 0.12,
                same_cos: 0.17,
                row_sigma_m: 0.3,
                row_sigma_per_m: 0.015,
                informative_sigma_m: 1.0,
                most_draws: 6,
                feasible_share: 0.1,
                on_city: 0.5,
                pair_us: 0.6,
                score_us: 16.0,
            },
            refinement: RefinementLimits {
                outside_share: 0.5,
                most_sigma_m: 1.0,
                unsegmented_gate_sigmas: 2.5,
                unsegmented_weight: 0.25,
                tukey_sigmas: 4.685,
                least_gate_share: 0.2,
                same_pose_units: 2.5,
                stages: [
                    StageLimits {
                        sample_points: 400,
                        gates_units: &[5.0, 5.0, 4.0, 3.3, 2.7],
                        ranking_gate_units: 2.3,
                        sight: false,
                        basins: false,
                        keep: 16,
                    },
                    StageLimits {
                        sample_points: 1500,
                        gates_units: &[2.7, 2.3, 2.0, 1.7, 1.7],
                        ranking_gate_units: 1.3,
                        sight: true,
                        basins: false,
                        keep: 6,
                    },
                    StageLimits {
                        sample_points: usize::MAX,
                        gates_units: &[1.7, 1.3, 1.0, 1.0],
                        ranking_gate_units: 1.0,
                        sight: true,
                        basins: true,
                        keep: 6,
                    },
                ],
                traced_points: 500,
                most_scoring_points: 3000,
            },
            walk: LineSearchLimits {
                loose_m: 0.25,
                step_of_gate: 0.5,
                most_steps: 120,
                basin_moves_units: [-2.0, -1.0, 1.0, 2.0],
                basin_gates_units: [1.7, 1.3, 1.0, 1.0],
                basin_points: 1500,
                most_rounds: 3,
                settling_units: 4.0,
                unmoved_share: 0.3,
            },
            sight: OcclusionLimits { surroundings_m: 0.7, camera_slack_m: 0.7 },
            null_poses: NullPoseLimits {
                count: 256,
                most_rounds: 4,
                samples: 1,
                ranking_points: 200,
                refining_points: 400,
                gates_units: &[5.0, 4.0, 3.3, 2.7, 2.0, 1.3, 1.0],
                least_reach_m: 100.0,
                basin_m: 2.0,
                basin_rad: 0.105,
                basin_log_scale: 0.08,
                heard: 6,
            },
            evidence: EvidenceLimits {
                same_plane_deg: 8.0,
                same_plane_m: 0.5,
                sample_points: 12,
                traced_points: 3,
                tolerance_m: 0.3,
                tolerance_sigmas: 3.0,
                occlusion_points: 256,
                hidden_square_m: 12.0,
                unseen_null_poses: 1.0,
            },
            uncertainty: UncertaintyLimits {
                rounds: 2,
                gate_units: 1.5,
                steps: 8,
                piece_m: 2.0,
                largest_building_m: 80.0,
                square_m: 25.0,
                least_walls: 0.1,
                least_lever_m: 5.0,
                same_front_deg: 8.0,
                same_front_m: 0.5,
                building_sigma_m: 0.1,
                front_sigma_m: 0.05,
                piece_sigma_m: 0.03,
                bending_share: 0.0025,
                building_worth: 2.0,
                front_worth: 2.0,
                piece_worth: 2.0,
                bending_worth: 5.0,
                walls_sigma_m: 0.3,
                lids_sigma_m: 0.25,
                roofs_sigma_m: 0.1,
                student_dof: 3.0,
                fewest_left_out: 8,
                reported_sigmas: 3.1,
                reported_m: 0.1,
                confirmed_times: 3.0,
            },
            verdict: VerdictLimits {
                false_alarm: 0.001,
                same_m: 0.8,
                default_accuracy_m: 0.35,
                default_accuracy_share: 0.01,
                scale_gates_units: &[5.0, 5.0, 4.0, 3.3, 2.7, 2.3, 2.0, 1.7, 1.3, 1.0],
                scale_sigmas: 3.0,
                scale_m: 0.15,
            },
        }
    }
}
