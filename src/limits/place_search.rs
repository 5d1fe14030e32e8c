//! Limits of the search for a place in the whole city.

/// How a reconstruction is sought where neither scale, heading nor position are known. Unless a line says otherwise the numbers were measured on
/// eight captures of known truth among 3,058 buildings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceSearchLimits {
    /// A wall of the cloud lies on one of the city within this, metres: what a scan of such steps leaves over.
    pub near_wall_m: f64,
    /// ... and within this angle, degrees, beyond the 10 of its class. Derived: half a class and what a slide along the scale turns.
    pub same_direction_deg: f64,
    /// Chance is counted over places this near a wall, metres. Chosen: a street; farther off nothing is met and every pose looks good.
    pub street_m: f64,
    /// Walls that are shorter are met, but no pose is tied to them, metres. Chosen: reveals, chimneys.
    pub least_tied_m: f64,
    /// Cloud walls that poses are tied to. Measured: the truth is found with two; the third stands in where the model lacks one.
    pub anchors: usize,
    /// Steps of the slide along a wall, and of the scale at the cloud's radius, metres. Measured: from 1 to 2 m all rank alike.
    pub step_m: f64,
    /// Walls that are looked at first, and the share of their weight that must be met. Measured: no scene's truth falls below.
    pub looked_at_first: usize,
    pub least_share: f64,
    /// Walls of the cloud that score a pose, the strongest. Chosen: more say nothing new.
    pub most_walls: usize,
    /// Metres of a wall that count as one independent look, and how many looks one wall can be. Measured: so weighed, no search collapsed in scale.
    pub metres_of_look: f64,
    pub most_looks: f64,
    /// Poses of the scan that are made sharp, of each so many walls of the city, distinct by this, metres over the cloud. Measured: the truth was the
    /// 27th of 14,900 walls at worst, and chance poses grow with the city.
    pub keep: usize,
    pub walls_of_keep: usize,
    pub apart_m: f64,
    /// Side of the squares that a city is scanned in, metres. Derived: words of 8 bytes for each half
    /// metre, of which a tenth is near walls, take 200 MB.
    pub district_m: f64,
    /// Sharp poses whose lines of sight are looked along and that are compared, the best of them. Chosen: among more than that none is beyond doubt.
    pub most_places: usize,
    pub most_sighted: usize,
    /// Poses of at least this share of the scan's best score are made sharp. Chosen: below what makes poses comparable afterwards.
    pub sharpened_share: f64,
    /// The tallest wall that was well seen is at least so tall, metres. Chosen: less is a fence.
    pub least_height_m: f64,
    /// Share of the city's walls that are no taller than the tallest that a scale may make of it. Chosen.
    pub tallest_share: f64,
    /// A reconstruction is no wider than this, metres of radius. Chosen: a quarter of a town.
    pub most_radius_m: f64,
    /// Eaves, plinths and levels of detail: by so much what was seen may stand over its wall, metres. Chosen.
    pub overshoot_m: f64,
    /// Gates of the plan's least squares, metres, one step each.
    pub gates_m: &'static [f64],
    /// Lines of sight that are looked along, and how much of the score all of them blocked would take, as a multiple of it.
    pub sights: usize,
    pub sight_weight: f64,
    /// A line of sight that ends this near before its point is not blocked, metres. Chosen: eaves, and what the height is off.
    pub sight_slack_m: f64,
    /// Poses of at least this share of the best score are told.
    pub comparable_share: f64,
    /// Fewer walls have no pattern. Derived: five outweigh chance among 3,000 buildings, three do so near a known place.
    pub fewest_walls: usize,
    /// Walls whose directions differ by less are of one direction, degrees; chosen.
    pub one_direction_deg: f64,
    /// Share of the walls' weight that must stand across the main direction.
    pub least_across: f64,
    /// What a found pose may be off, one sigma: metres in plan, radians, log scale. The refinement lands from there.
    pub position_sigma_m: f64,
    pub heading_sigma_rad: f64,
    pub log_scale_sigma: f64,
    /// Sigma of the height, metres: half of the heights that were left over, within these.
    pub height_sigma_m: [f64; 2],
}

impl Default for PlaceSearchLimits {
    fn default() -> Self {
        PlaceSearchLimits {
            near_wall_m: 0.75,
            same_direction_deg: 13.0,
            street_m: 12.0,
            least_tied_m: 2.0,
            anchors: 3,
            step_m: 2.0,
            looked_at_first: 8,
            least_share: 0.2,
            most_walls: 64,
            metres_of_look: 2.0,
            most_looks: 16.0,
            keep: 400,
            walls_of_keep: 15_000,
            apart_m: 2.0,
            district_m: 8000.0,
            most_places: 100,
            most_sighted: 2048,
            sharpened_share: 0.5,
            least_height_m: 2.0,
            tallest_share: 0.99,
            most_radius_m: 500.0,
            overshoot_m: 1.0,
            gates_m: &[2.0, 1.6, 1.3, 1.0, 0.8, 0.6, 0.5],
            sights: 150,
            sight_weight: 2.0,
            sight_slack_m: 1.5,
            comparable_share: 0.67,
            fewest_walls: 3,
            one_direction_deg: 20.0,
            least_across: 0.03,
            position_sigma_m: 1.5,
            heading_sigma_rad: 2.0 * std::f64::consts::PI / 180.0,
            log_scale_sigma: 0.03,
            height_sigma_m: [1.5, 4.0],
        }
    }
}
