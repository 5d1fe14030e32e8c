//! Why two parts are not joined, and why an edge between them is not used, with figures; the words are the report's.

/// What speaks against a pair of parts. Shares are of the radius, and told as per cent of the extent, which is twice as long.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PairFault {
    #[error("{part} contradicts itself: its points miss its own keypoints by {:.1} % of the photograph's width", 100.0 * .error_share)]
    Unsound { part: String, error_share: f64 },
    #[error(
        "the {photos} photographs of one name show different keypoints: {pairs} of {keypoints} coincide, chance gives {chance:.0}; \
         they may be different photographs with the same name"
    )]
    OtherPhotographs { photos: usize, pairs: usize, keypoints: usize, chance: f64 },
    #[error("no superpixel of the shared photographs has a plane in one part and points in the other")]
    NoSuperpixels,
    #[error(
        "the shared photographs have too few superpixels with a plane: {planes} with {points} points of the other part"
    )]
    FewPlanes { planes: usize, points: usize },
    #[error("no similarity explains {pairs} point pairs")]
    NoSimilarityOfPairs { pairs: usize },
    #[error("no similarity lays the points of one part on the planes of the other")]
    NoSimilarityOfPlanes,
    #[error("only {inliers} of {pairs} point pairs agree with one similarity")]
    FewPairsAgree { inliers: usize, pairs: usize },
    /// Shares of the points, under the right planes and under those of other superpixels.
    #[error(
        "only {:.0} % of the points lie on the planes of their superpixels ({:.0} % on those of other superpixels); the photographs \
         may be different ones with the same name",
        100.0 * .share, 100.0 * .by_chance
    )]
    FewPointsOnPlanes { share: f64, by_chance: f64 },
    #[error("the point pairs disagree by {:.2} % of the extent, more than parts of one place do", 50.0 * .bend)]
    Bent { bend: f64 },
    #[error("one part is a mirror image of the other; only a reflection fits")]
    Mirrored,
    #[error(
        "one part is stretched by {:.0} % along one axis against the other; no similarity fits",
        100.0 * (.ratio - 1.0)
    )]
    Stretched { ratio: f64 },
    /// The shift in units of what is allowed.
    #[error(
        "the shared photograph's two poses contradict the {holds} (turned by {turn_deg:.1} deg, shifted by {shift:.1} times what \
         would be allowed)"
    )]
    CamerasElsewhere { holds: &'static str, turn_deg: f64, shift: f64 },
    /// One sigma of the loosest freedom.
    #[error(
        "{inliers} {counted} leave one freedom open to {:.2} % of the extent (one sigma); a further shared photograph would fix it",
        50.0 * .sigma.min(1e4)
    )]
    FreedomOpen { inliers: usize, counted: &'static str, sigma: f64 },
    /// Shares of the points that lie on their planes, at the pairs' place and at the planes' own.
    #[error(
        "the point pairs and the planes of the superpixels contradict each other: where the pairs put the parts {:.0} % of the points \
         lie on their planes, but {:.0} % do in a place that is {apart} away",
        100.0 * .share, 100.0 * .own_share
    )]
    SourcesContradict { share: f64, own_share: f64, apart: String },
    #[error("where the city has them, the surfaces that both see lie {:.2} % of the extent apart", 50.0 * .off)]
    SurfacesApart { off: f64 },
}

/// Why an edge of the network is not used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EdgeFault {
    /// The two parts do not belong together, or how they stand to each other is not fixed.
    #[error(transparent)]
    Pair(#[from] PairFault),
    /// The other edges of its cycles agree with each other, but not with this one. The share is of the radius.
    #[error("puts {names} {:.1} % of the extent ({sigmas:.0} sigmas) off from where the other edges put them", 50.0 * .share)]
    Contradicted { names: String, share: f64, sigmas: f64 },
    /// A cycle does not close, and any of so many edges may be the wrong one.
    #[error(
        "a cycle does not close: the edges round {names} disagree by {:.1} % of the extent ({sigmas:.0} sigmas), and any of {choices} \
         may be the wrong one; a further shared photograph would tell",
        50.0 * .share
    )]
    OpenCycle { names: String, share: f64, sigmas: f64, choices: usize },
    #[error("its parts belong to another group than the one that was placed")]
    OtherGroup,
    #[error("the city does not fix both parts")]
    NotFixedByCity,
}

#[cfg(test)]
mod tests;
