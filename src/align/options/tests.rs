use super::*;
use crate::geometry::Similarity;

#[test]
fn setters_change_what_they_name_and_nothing_else() {
    let plain = AlignOptions::new(Start::with_default_sigmas(Similarity::identity()));
    assert_eq!((plain.fixed_scale, plain.up, plain.accuracy_m, plain.seed), (None, Up::Auto, None, 0));
    let set = plain.with_fixed_scale(2.5).with_up(Up::None).with_accuracy(0.1).with_seed(9).with_false_alarm(1e-6);
    assert_eq!((set.fixed_scale, set.up, set.accuracy_m, set.seed), (Some(2.5), Up::None, Some(0.1), 9));
    assert_eq!(set.limits.verdict.false_alarm, 1e-6);
    let others = Limits { verdict: plain.limits.verdict, ..set.limits };
    assert_eq!((others, set.place), (plain.limits, plain.place));
    assert_eq!(set.with_fixed_scale(None).fixed_scale, None);
}
