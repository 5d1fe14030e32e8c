//! The height of a pose, by what its walls allow.
//!
//! Question     at which heights does what was seen of each wall lie between the foot and the top of the wall that it meets?
//! Method       each place that lies on a wall allows an interval; the heights that most of the weight allows are the answer (stabbing)

/// Heights that a place on a wall allows, and its weight.
#[derive(Clone, Copy, Debug)]
pub struct HeightVote {
    pub from_m: f64,
    pub to_m: f64,
    pub weight: f64,
}

/// The heights that most votes allow: least and most; `None` without votes. Of equally many the lowest.
pub fn stabbed(votes: &[HeightVote]) -> Option<[f64; 2]> {
    // Intervals open before they close at one height, so that those that touch count together.
    let opens = votes.iter().map(|v| (v.from_m, -v.weight));
    let closes = votes.iter().map(|v| (v.to_m, v.weight));
    let mut ends: Vec<(f64, f64)> = opens.chain(closes).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let (mut sum, mut most, mut best) = (0.0, 0.0, None);
    for (i, &(at_m, change)) in ends.iter().enumerate() {
        sum -= change;
        // Sums that differ by rounding are the same.
        if sum > most + ROUNDING {
            most = sum;
            best = ends.get(i + 1).map(|next| [at_m, next.0]);
        }
    }
    best
}

const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_heights_that_most_votes_allow_are_found() {
        let vote = |from_m, to_m, weight| HeightVote { from_m, to_m, weight };
        let votes = [vote(0.0, 10.0, 1.0), vote(4.0, 12.0, 1.0), vote(6.0, 7.0, 0.5), vote(20.0, 21.0, 2.0)];
        assert_eq!(stabbed(&votes), Some([6.0, 7.0]));
        assert_eq!(stabbed(&votes[..2]), Some([4.0, 10.0]));
        assert_eq!(stabbed(&[]), None);
    }
}
