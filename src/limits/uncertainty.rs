//! Limits of the last estimate.

/// What errs together in a model and a reconstruction, and by how much before anything is seen of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertaintyLimits {
    /// Rounds in which the pose is estimated, each with points put on facets anew. Chosen.
    pub rounds: usize,
    /// Points within this of a surface lie on it, units. Chosen: one and a half times the score's, so that buildings which stand off count, and
    /// count by what their heavy tails give them.
    pub gate_units: f64,
    /// Steps in which spreads and unknowns settle in a round. Measured on 210 generated captures: after 8 variances are still near
    /// where they began (74 % in the 95 % band where houses are 3 cm off), after 16 and 24 they are not (83 %).
    pub steps: usize,
    /// Width of a piece of surface that is one observation. Chosen: windows and bays repeat every two to four metres.
    pub cell_m: f64,
    /// A building plane whose points weigh less together is not seen. Derived: one point, so that strays of little weight that are near any surface
    /// say nothing. Measured on 210 generated captures: 5 %
    /// of the errors lie above their band without it, 2 % with it.
    pub least_points: f64,
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
    pub same_building_plane_deg: f64,
    pub same_building_plane_m: f64,
    /// One sigma of a building's shift, of a front's offset and tilts, and of a piece, before anything is seen of them. Measured on models of
    /// others: some centimetres where surveyed, two to five decimetres where generalised; between.
    pub building_sigma_m: f64,
    pub building_plane_sigma_m: f64,
    pub cell_sigma_m: f64,
    /// Standard deviation of the reconstruction's bending, as a share of its radius. Derived: reconstructions bend by 0.1 to 0.5 % of their extent at
    /// most; two radii, and half of the most as root mean square. Measured: with 0.05 % four rendered scenes, which do not bend, come out better by
    /// a tenth (one by a half); with 0.1 % a generated one that does is `aligned` 1.1 m off at 0.15 m stated.
    pub bending_share: f64,
    /// How many observations these are worth. Chosen: little, so that data decide where there are any.
    pub building_worth: f64,
    pub building_plane_worth: f64,
    pub cell_worth: f64,
    pub bending_worth: f64,
    /// One sigma of how far walls stand inside the model's. Measured on LoD1 and LoD2 models drawn from roofs: 0.2 to 0.5 m.
    pub walls_sigma_m: f64,
    /// One sigma of how far tops are from the model's, where all are level (LoD1: a lid at half or more of a pitched roof's height) and where
    /// they are not (surveyed). Chosen: a lid alone still holds a height, if no better than a user asks for.
    pub lids_sigma_m: f64,
    pub roofs_sigma_m: f64,
    /// Degrees of freedom of Student's t for buildings, fronts, pieces and points. Chosen: between Cauchy's one and the four of Lange, Little and
    /// Taylor 1989. Measured on 36 generated captures, a gate of two units: 0.26 m of error in the mean, where 8 with a gate of half a unit for the
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

impl Default for UncertaintyLimits {
    fn default() -> Self {
        UncertaintyLimits {
            rounds: 2,
            gate_units: 1.5,
            steps: 16,
            cell_m: 2.0,
            least_points: 1.0,
            largest_building_m: 80.0,
            square_m: 25.0,
            least_walls: 0.1,
            least_lever_m: 5.0,
            same_building_plane_deg: 8.0,
            same_building_plane_m: 0.5,
            building_sigma_m: 0.1,
            building_plane_sigma_m: 0.05,
            cell_sigma_m: 0.03,
            bending_share: 0.0025,
            building_worth: 2.0,
            building_plane_worth: 2.0,
            cell_worth: 2.0,
            bending_worth: 5.0,
            walls_sigma_m: 0.3,
            lids_sigma_m: 0.25,
            roofs_sigma_m: 0.1,
            student_dof: 3.0,
            fewest_left_out: 8,
            reported_sigmas: 3.1,
            reported_m: 0.1,
            confirmed_times: 3.0,
        }
    }
}
