//! What was odd in a reconstruction, and tolerated.

use crate::format::escaped;

/// Something odd that real files hold, tolerated; `count` cases, the first of them named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReconstructionWarning {
    pub kind: WarningKind,
    pub count: usize,
    pub example: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarningKind {
    /// Keypoints name points that are not in the model; they count as keypoints without a point.
    ObservationsOfMissingPoints,
    /// A track lists a keypoint that is not there, or belongs to another point or to none, or lacks one; no line of sight then.
    TracksThatImagesContradict,
    /// Tracks name images that are not in the model: taken out, or without a pose.
    TracksOfMissingImages,
    /// Points that no track supports.
    PointsWithoutTrack,
    /// A model of points alone.
    NoImages,
    /// Images without any keypoint.
    ImagesWithoutObservations,
    /// Images whose pose is not finite or has no direction; they were left out.
    ImagesWithoutPose,
    /// An image's pose is not its frame's; the frame's is taken, as COLMAP does.
    PosesThatFramesContradict,
    /// Quaternions far from unit length; they were normalised.
    UnnormalizedQuaternions,
    /// Names that are not UTF-8; they were read as Latin-1.
    NamesNotUtf8,
    /// Images that bear the name of another one.
    NamesTwice,
    /// Points without a finite position; they were left out.
    PointsWithoutPosition,
    /// Reprojection errors that are no numbers; they count as unknown.
    ErrorsNotFinite,
    /// Normals without a direction.
    NormalsWithoutDirection,
    /// The folder holds further models.
    FurtherModels,
    /// A text file holds fewer records than its first lines say.
    FewerThanAnnounced,
    /// A text file holds more records than its first lines say.
    MoreThanAnnounced,
    /// There are images, and no points.
    NoPoints,
    /// The points of a model stand in a PLY file beside it; they have no tracks.
    PointsFromPly,
    /// Points do not lie where keypoints and poses say, but most nearly do.
    LooseFit,
    /// Cameras in whose picture no point lies, in a reconstruction without tracks.
    BlindCameras,
    /// Points, poses and keypoints contradict each other: nothing is concluded from who saw what.
    SightDenied,
    /// Further properties of points that are not carried into the output.
    FieldsDropped,
    /// Parameters of Gaussian splats, which turn and grow with the frame; they are not carried into the output.
    SplatFieldsDropped,
    /// Rows of elements other than points that are not as the header says.
    OddRowsPassedOver,
    /// Points classified as noise (7, 18), or withheld, left out.
    NoiseLeftOut,
    /// Points of other classes than were asked for, left out.
    OtherClassesLeftOut,
    /// Coordinates in another unit than metres.
    UnitNotMetres,
    /// Heights in another unit than the plan.
    HeightsBrought,
    /// Photographs whose camera model is not known.
    CamerasNotHeld,
    /// Pictures whose size the files do not tell.
    SizesGuessed,
    /// Further pieces of a reconstruction that are not connected with the one that was read.
    PiecesLeftOut,
}

impl WarningKind {
    /// What there are so many of.
    fn text(self) -> &'static str {
        match self {
            WarningKind::ObservationsOfMissingPoints => "keypoints of points that the model does not hold, ignored",
            WarningKind::TracksThatImagesContradict => {
                "links between keypoints and points that only images or only tracks tell, left out"
            }
            WarningKind::TracksOfMissingImages => "track elements of images that are not in the model, left out",
            WarningKind::PointsWithoutTrack => "points without a track",
            WarningKind::NoImages => "model without images, taken as a cloud: no sfm folder is written",
            WarningKind::ImagesWithoutObservations => "images without keypoints",
            WarningKind::ImagesWithoutPose => "images without a pose, left out",
            WarningKind::PosesThatFramesContradict => "image poses that differ from their frames', the frames' taken",
            WarningKind::UnnormalizedQuaternions => "quaternions not of unit length, normalised",
            WarningKind::NamesNotUtf8 => "names that are not UTF-8, read as Latin-1",
            WarningKind::NamesTwice => {
                "images that bear the name of another one, so that photographs and labels are theirs alike"
            }
            WarningKind::PointsWithoutPosition => "points without a finite position, left out",
            WarningKind::ErrorsNotFinite => "reprojection errors that are no numbers, taken as unknown",
            WarningKind::NormalsWithoutDirection => "normals without a direction",
            WarningKind::FurtherModels => "further models beside the one that was read",
            WarningKind::FewerThanAnnounced => "records fewer than the file says: it was cut off, or edited",
            WarningKind::MoreThanAnnounced => "records more than the file says",
            WarningKind::NoPoints => "reconstruction without points",
            WarningKind::PointsFromPly => "points taken from a PLY file beside cameras and images, without tracks",
            WarningKind::LooseFit => "observations that were looked at fit their cameras loosely",
            WarningKind::BlindCameras => "cameras have no point in their picture",
            WarningKind::SightDenied => {
                "observations that were looked at contradict their cameras, so that no lines of sight are used"
            }
            WarningKind::FieldsDropped => "further properties of points that are not carried into the output",
            WarningKind::SplatFieldsDropped => {
                "properties of Gaussian splats that are not carried over: the result is a bare cloud; apply the transform of alignment.json in a splat editor"
            }
            WarningKind::OddRowsPassedOver => {
                "rows of other elements than vertices that are not as the header says, passed over"
            }
            WarningKind::NoiseLeftOut => "points classified as noise (7, 18) or withheld, left out",
            WarningKind::OtherClassesLeftOut => "points of other classes than were asked for, left out",
            WarningKind::UnitNotMetres => "unit other than metres",
            WarningKind::HeightsBrought => "unit of heights other than that of the plan",
            WarningKind::CamerasNotHeld => "photographs with a camera model that is not read, left out",
            WarningKind::SizesGuessed => "pictures whose size the file does not tell, taken from their keypoints",
            WarningKind::PiecesLeftOut => "further pieces, which are not connected with the largest, left out",
        }
    }
}

impl std::fmt::Display for ReconstructionWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let ReconstructionWarning { kind, count, example } = self;
        let example = escaped(example);
        match kind {
            WarningKind::UnitNotMetres | WarningKind::HeightsBrought => write!(f, "{example}"),
            WarningKind::LooseFit | WarningKind::SightDenied => write!(f, "{count} {}: {example}", kind.text()),
            WarningKind::BlindCameras => write!(f, "{count} {}, {example}", kind.text()),
            WarningKind::FieldsDropped | WarningKind::SplatFieldsDropped => {
                write!(f, "{count} {} ({example})", kind.text())
            }
            _ => write!(f, "{count} {} (such as {example})", kind.text()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_calls_its_pictures_does_not_steer_the_terminal() {
        let example = "\x1b[2J\u{202e}gpj.a".to_owned();
        let warning = ReconstructionWarning { kind: WarningKind::SizesGuessed, count: 2, example };
        assert!(warning.to_string().ends_with("(such as \\u{1b}[2J\\u{202e}gpj.a)"), "{warning}");
    }
}
