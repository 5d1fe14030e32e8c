//! Which configuration of the minimal family searches a scene.
//!
//! Question     with which samples is a right pose expected to cost least?
//! Input        the searches that could be made, one for each configuration that solves the problem
//! Output       the cheapest configuration among those that the data can feed; none where they feed none
//! Method       A pilot draws samples of each, the same as far as they go together. A sample costs its draw; where the patches could give its points, a solve besides,
//!              and a score for every pose within the start's reach: on average c. Each draw tells the chance p that its k
//!              pairs are right if their patches lie on the city at all, which the share q of patches does: p q^k. So a right
//!              sample is expected after 1 / mean(p q^k) trials and costs c / mean(p q^k).
//! Assumptions  a right sample leads to a right pose, whatever the configuration; costs in ratio to each other are those of
//!              the machine on which the constants were measured (a measured time here would undo `same seed, same bytes`)
//! Source       number of trials: Fischler and Bolles 1981; Ramalingam et al. 2010, section 5, weigh 3 planes against 6 so;
//!              docs/mathematics.md 15 (18)

use super::pose_search::PoseSearch;
use crate::limits::SearchLimits;
use crate::robust::Random;
use crate::solvers::Configuration;

/// What a pilot tells of one configuration.
#[derive(Clone, Copy, Debug)]
pub struct SolverCost {
    pub configuration: Configuration,
    /// Share of the draws that the data could feed.
    pub fed: f64,
    /// Poses within the start's reach per draw.
    pub poses: f64,
    /// Mean chance that a draw is right in all its pairs.
    pub chance: f64,
}

/// A pilot ends once so many samples of the first configuration, which has the fewest planes, have a pose: enough to tell
/// costs that differ by some tens of per cent.
const PILOT_SAMPLES: usize = 64;
/// The pilot ends after so many draws at the latest: as many as the shortest search.
const PILOT_DRAWS: u64 = 8192;
/// Seed of the pilot: its own, so that the choice does not hang on the user's.
const PILOT_SEED: u64 = 0;

/// What a pilot tells of each search.
pub fn solver_costs(searches: &[PoseSearch], limits: &SearchLimits) -> Vec<SolverCost> {
    let draws = searches.first().map_or(0, draws_of_pilot);
    searches.iter().map(|search| SolverCost::of(search, draws, limits.on_city)).collect()
}

fn draws_of_pilot(search: &PoseSearch) -> u64 {
    let mut poses = Vec::new();
    let mut solved = 0;
    (0..PILOT_DRAWS)
        .find(|&draw| {
            poses.clear();
            search.sample(&mut Random::stream(PILOT_SEED, draw), &mut poses);
            solved += usize::from(!poses.is_empty());
            solved >= PILOT_SAMPLES
        })
        .map_or(PILOT_DRAWS, |last| last + 1)
}

impl SolverCost {
    fn of(search: &PoseSearch, draws: u64, on_city: f64) -> SolverCost {
        let (mut fed, mut found, mut chance) = (0, 0, 0.0);
        let mut poses = Vec::new();
        for draw in 0..draws {
            poses.clear();
            let drawn = search.sample(&mut Random::stream(PILOT_SEED, draw), &mut poses);
            fed += usize::from(drawn.is_some());
            found += poses.len();
            // A sample without a pose is not right.
            chance += drawn.filter(|_| !poses.is_empty()).unwrap_or(0.0);
        }
        let per_draw = |count: f64| count / draws as f64;
        SolverCost {
            configuration: *search.configuration,
            fed: per_draw(fed as f64),
            poses: per_draw(found as f64),
            chance: per_draw(chance) * on_city.powi(search.configuration.points_per_plane.len() as i32),
        }
    }

    /// Expected time until a sample is right, microseconds; `None` where the data feed none.
    pub fn expected_us(&self, limits: &SearchLimits) -> Option<f64> {
        let planes = self.configuration.points_per_plane.len();
        let cost =
            planes as f64 * limits.pair_us + self.fed * self.configuration.solve_us + self.poses * limits.score_us;
        (self.chance > 0.0).then(|| cost / self.chance)
    }
}

/// The configuration whose right sample is expected to cost least.
pub fn cheapest(solver_costs: &[SolverCost], limits: &SearchLimits) -> Option<Configuration> {
    let costs = solver_costs.iter().filter_map(|p| Some((p.expected_us(limits)?, p.configuration)));
    costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, configuration)| configuration)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::solvers::SIMILARITY;

    /// (3,2,1,1), (3,1,1,1,1), (2,2,2,1) of a similarity, fed and right alike.
    fn solver_costs() -> [SolverCost; 3] {
        [0, 1, 2].map(|k| SolverCost { configuration: SIMILARITY[k], fed: 0.5, poses: 0.2, chance: 0.01 })
    }

    fn chosen(solver_costs: &[SolverCost]) -> String {
        cheapest(solver_costs, &Limits::default().search)
            .map_or(String::new(), |configuration| configuration.to_string())
    }

    #[test]
    fn fewer_planes_win_where_all_else_is_equal() {
        let [four, five, _] = solver_costs();
        assert_eq!(chosen(&[five, four]), "(3,2,1,1)");
    }

    #[test]
    fn the_faster_solve_wins_where_the_planes_are_as_many() {
        let [fast, _, slow] = solver_costs();
        assert_eq!(chosen(&[slow, fast]), "(3,2,1,1)");
    }

    #[test]
    fn a_chance_that_is_better_by_more_than_the_cost_wins() {
        let [fast, _, slow] = solver_costs();
        let luckier = SolverCost { chance: 2.0 * fast.chance, ..slow };
        assert_eq!(chosen(&[fast, luckier]), "(2,2,2,1)");
    }

    #[test]
    fn a_configuration_that_the_data_cannot_feed_is_never_chosen() {
        let [fast, five, slow] = solver_costs();
        let unfed = SolverCost { fed: 0.0, poses: 0.0, chance: 0.0, ..fast };
        assert_eq!(chosen(&[unfed, five, slow]), "(3,1,1,1,1)");
        assert_eq!(chosen(&[unfed]), "");
    }

    #[test]
    fn the_expected_cost_is_that_of_a_trial_over_the_chance_of_success() {
        let [four, ..] = solver_costs();
        let limits = Limits::default().search;
        let trial = 4.0 * limits.pair_us + 0.5 * SIMILARITY[0].solve_us + 0.2 * limits.score_us;
        assert!((four.expected_us(&limits).unwrap() - trial / 0.01).abs() < 1e-9);
    }
}
