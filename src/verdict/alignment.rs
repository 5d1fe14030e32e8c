//! The outcome of an alignment.

use crate::geometry::{Point3, Similarity, Vector3};

/// How sure the program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every freedom is determined and no other pose explains the data nearly as well.
    Aligned,
    /// At least one freedom is not fixed by the data.
    Undetermined,
    /// Two or more distinct poses explain the data.
    Ambiguous,
    /// Nothing explains the data better than chance.
    Failed,
}

impl Verdict {
    /// The word that the report uses.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Aligned => "aligned",
            Verdict::Undetermined => "undetermined",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Failed => "failed",
        }
    }
}

/// The outcome of an alignment. Similarities map the reconstruction to absolute city coordinates.
#[derive(Clone, Debug)]
pub struct Alignment {
    pub verdict: Verdict,
    /// One sentence with figures.
    pub reason: String,
    /// The pose that fits best, whatever the verdict; `None` only with [`Verdict::Failed`]. What may be relied on is [`Alignment::transform`].
    pub best_candidate: Option<Similarity>,
    /// Other distinct poses, heaviest first.
    pub alternatives: Vec<Alternative>,
    /// What speaks for the best pose.
    pub certainty: Certainty,
    /// Local origin of the city model, metres.
    pub origin: Vector3<f64>,
    /// Centre of the scene that the covariance is about, absolute city coordinates.
    pub center: Point3<f64>,
    /// Radius of the scene, metres: where a sigma of a turn or of the scale is felt as that of a length.
    pub radius: f64,
    /// What a freedom must be held to in order to be determined, metres at the radius.
    pub accuracy_m: f64,
    /// What the data say of the model and of the reconstruction beside the pose.
    pub model_errors: ModelErrors,
    pub freedoms: Vec<Freedom>,
    /// Rows and columns: rotation vector about `center` (rad), translation of `center` (m), log scale; city frame.
    pub covariance: [[f64; 7]; 7],
    pub support: Support,
    pub evidence: Vec<PlaneSupport>,
    pub search: SearchSummary,
    pub warnings: Vec<String>,
}

impl Alignment {
    /// The similarity that sets the reconstruction into the city: `None` unless the verdict is [`Verdict::Aligned`].
    pub fn transform(&self) -> Option<&Similarity> {
        self.best_candidate.as_ref().filter(|_| self.verdict == Verdict::Aligned)
    }
}

/// How sure the best pose is that of the data, and not one that chance fits as well.
#[derive(Clone, Debug, Default)]
pub struct Certainty {
    /// How much likelier is what the cloud meets in the city under the pose than under poses fitted to other places: log2.
    pub bits: f64,
    /// log2 of one over the share that the start gives to it among the distinct poses of which it is the best: of equally likely ones, their number.
    pub search_bits: f64,
    /// What the bits must reach: those of the search and of the false alarms that are allowed.
    pub needed_bits: f64,
    /// That the pose is right, if one within the start's reach is.
    pub probability: f64,
    /// The chance of a wrong `aligned` that is allowed.
    pub false_alarm: f64,
    /// Planes in space that the cloud saw: what can speak for a pose; and how many do, by half a bit or more.
    pub witnesses: usize,
    pub speaking: usize,
    /// Poses that were fitted to other places, and the largest evidence of one of them.
    pub by_chance: usize,
    pub most_bits_by_chance: f64,
}

/// Errors of the model and of the reconstruction, as the data show them; metres, one sigma where not said otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelErrors {
    /// How far walls stand inside the model's, all alike, and one sigma of that.
    pub walls_inset: [f64; 2],
    /// How much lower level tops of buildings are than the model's, all alike, and one sigma of that.
    pub tops_lower: [f64; 2],
    /// Shift of a single building.
    pub buildings: f64,
    /// Offset of a single front of a building.
    pub fronts: f64,
    /// Bending of the reconstruction, root mean square.
    pub bending: f64,
}

/// Another pose that explains the data.
#[derive(Clone, Debug)]
pub struct Alternative {
    pub city_from_sfm: Similarity,
    /// Share of belief among all poses kept, 0 to 1.
    pub weight: f64,
    /// In words: "turned 180.0 deg about up at (..)".
    pub differs: String,
}

/// What a freedom moves most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreedomKind {
    Shift,
    Turn,
    Scale,
}

/// Unit of a freedom's sigma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreedomUnit {
    Metre,
    /// Length in the frame of a part, which is not metric.
    FrameUnit,
    Degree,
    /// Natural logarithm of the scale.
    LogScale,
}

impl FreedomUnit {
    /// As the reports write it.
    pub fn symbol(self) -> &'static str {
        match self {
            FreedomUnit::Metre => "m",
            FreedomUnit::FrameUnit => "frame unit",
            FreedomUnit::Degree => "deg",
            FreedomUnit::LogScale => "1",
        }
    }
}

/// One of the seven freedoms in the basis that the data suggest.
#[derive(Clone, Debug)]
pub struct Freedom {
    pub kind: FreedomKind,
    /// In words: "along up", "along the azimuth 31 deg", "heading", "scale".
    pub name: String,
    /// City frame; zero for the scale.
    pub direction: Vector3<f64>,
    /// One standard deviation, in `unit`.
    pub sigma: f64,
    pub unit: FreedomUnit,
    pub determined: bool,
    /// Told by the user, not by the data; then it is determined as long as the data do not contradict it.
    pub given: bool,
}

/// How well the points lie on the city.
#[derive(Clone, Debug, Default)]
pub struct Support {
    /// Points of the reconstruction that belong to a patch.
    pub points: usize,
    /// Those of them that lie on a facet of the city in the best pose.
    pub trusted_points: usize,
    /// City planes with trusted points.
    pub planes: usize,
    /// Of the trusted points.
    pub rms_m: f64,
    /// Of the trusted points.
    pub median_m: f64,
}

/// What one city plane contributes.
#[derive(Clone, Debug)]
pub struct PlaneSupport {
    /// Index of the plane in the city's planes.
    pub plane: u32,
    pub object: String,
    pub points: usize,
    pub rms_m: f64,
}

/// What the search did.
#[derive(Clone, Debug, Default)]
pub struct SearchSummary {
    /// Configuration of the minimal solver that made the winning hypothesis.
    pub solver: String,
    pub samples: u64,
    pub seed: u64,
}
