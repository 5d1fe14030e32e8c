//! Sorting, and what is found by it: equal things among many.

use rayon::prelude::*;

/// Things from which on several threads sort; fewer are sorted before threads have begun.
const MANY: usize = 1 << 18;

/// Odd, with as many ones as zeros in no order: the golden ratio's binary digits.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// Sorts; equal things must be alike in all, so that the number of threads means nothing.
pub(super) fn sort<T: Ord + Send>(things: &mut [T]) {
    if things.len() < MANY { things.sort_unstable() } else { things.par_sort_unstable() }
}

/// Calls `found` with the numbers, ascending, of the things that have one key, for every key that several have.
///
/// Sorted are 32-bit digests of the keys, each with its number in one word; keys themselves are compared among the few of one digest, and
/// sorted as well, so that keys made to have one digest cost no more than a sort.
pub(super) fn each_alike<Key: Ord>(
    count: u32,
    digest: impl Fn(u32) -> u32 + Sync,
    key: impl Fn(u32) -> Key,
    mut found: impl FnMut(&[u32]),
) {
    let mut order: Vec<u64> = (0..count).map(|at| u64::from(digest(at)) << 32 | u64::from(at)).collect();
    sort(&mut order);
    let mut candidates: Vec<(Key, u32)> = Vec::new();
    let mut same: Vec<u32> = Vec::new();
    for run in order.chunk_by(|a, b| a >> 32 == b >> 32).filter(|run| run.len() > 1) {
        candidates.clear();
        candidates.extend(run.iter().map(|&word| (key(word as u32), word as u32)));
        candidates.sort_unstable();
        for alike in candidates.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
            same.clear();
            same.extend(alike.iter().map(|(_, at)| at));
            found(&same);
        }
    }
}

/// Equal for equal words, and seldom for others.
pub(super) fn digest<const N: usize>(words: [u64; N]) -> u32 {
    let mixed = words.iter().fold(SPREAD, |mixed, &word| {
        let product = u128::from(mixed ^ word) * u128::from(SPREAD);
        (product as u64) ^ (product >> 64) as u64
    });
    (mixed >> 32) as u32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The numbers of equal things, by comparing each with each.
    fn by_comparing(things: &[u8]) -> Vec<Vec<u32>> {
        let like = |thing: u8| (0..).zip(things).filter(|(_, other)| **other == thing).map(|(at, _)| at).collect();
        (0..=u8::MAX).map(like).filter(|alike: &Vec<u32>| alike.len() > 1).collect()
    }

    proptest! {
        #[test]
        fn equal_things_are_found_whatever_digests_they_share(things in proptest::collection::vec(0..9_u8, 0..40), digests in 1..9_u32) {
            let mut found = Vec::new();
            let (digest, key) = (|at: u32| u32::from(things[at as usize]) % digests, |at: u32| things[at as usize]);
            each_alike(things.len() as u32, digest, key, |alike| found.push(alike.to_vec()));
            found.sort_by_key(|alike| things[alike[0] as usize]);
            prop_assert_eq!(found, by_comparing(&things));
        }
    }

    #[test]
    fn neighbours_on_a_grid_have_digests_of_their_own() {
        let mut digests: Vec<u32> =
            (0..100_000).map(|at| digest([f64::from(at % 300).to_bits(), f64::from(at / 300).to_bits(), 0])).collect();
        digests.sort_unstable();
        digests.dedup();
        // By chance one pair.
        assert!(digests.len() > 99_990, "{}", digests.len());
    }
}
