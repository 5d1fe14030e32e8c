//! From the ids of a file to indices.

use std::collections::HashMap;

/// A table by id is taken where it needs at most this many entries per record; ids are mostly near to consecutive.
const ENTRIES_PER_RECORD: usize = 8;

/// Marks an id that no record has.
const NONE: u32 = u32::MAX;

/// Which record has an id.
pub(super) enum IdIndex {
    Table(Vec<u32>),
    Map(HashMap<u64, u32>),
}

/// What keeps ids from being indexed.
pub(super) enum IdFault {
    Twice(u64),
    TooMany,
}

impl IdIndex {
    pub(super) fn new(ids: impl ExactSizeIterator<Item = u64> + Clone) -> Result<IdIndex, IdFault> {
        let count = ids.len();
        if count >= NONE as usize {
            return Err(IdFault::TooMany);
        }
        let largest = ids.clone().max().map_or(Some(0), |id| usize::try_from(id).ok());
        let mut index = match largest {
            Some(largest) if largest / ENTRIES_PER_RECORD <= count => IdIndex::Table(vec![NONE; largest + 1]),
            _ => IdIndex::Map(HashMap::with_capacity(count)),
        };
        for (record, id) in ids.enumerate() {
            let before = match &mut index {
                IdIndex::Table(table) => std::mem::replace(&mut table[id as usize], record as u32),
                IdIndex::Map(map) => map.insert(id, record as u32).unwrap_or(NONE),
            };
            if before != NONE {
                return Err(IdFault::Twice(id));
            }
        }
        Ok(index)
    }

    pub(super) fn get(&self, id: u64) -> Option<u32> {
        match self {
            IdIndex::Table(table) => table.get(usize::try_from(id).ok()?).copied().filter(|record| *record != NONE),
            IdIndex::Map(map) => map.get(&id).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_records_by_near_and_by_far_ids_up_to_the_largest() {
        for ids in [vec![3, 1, 2], vec![u64::MAX - 1, 0, 7], vec![u64::MAX], vec![0, u64::MAX, u64::MAX - 1], vec![]] {
            let index = IdIndex::new(ids.iter().copied()).ok().unwrap();
            for (record, id) in ids.iter().enumerate() {
                assert_eq!(index.get(*id), Some(record as u32));
            }
            assert_eq!((index.get(5), index.get(u64::MAX - 7)), (None, None));
        }
    }

    #[test]
    fn an_id_far_away_takes_no_table_of_that_length() {
        let index = IdIndex::new([1, 1 << 40].into_iter()).ok().unwrap();
        assert!(matches!(index, IdIndex::Map(_)));
    }

    #[test]
    fn names_an_id_that_is_there_twice() {
        for twice in [4, 1 << 40] {
            let fault = IdIndex::new([twice, 1, twice].into_iter()).err();
            assert!(matches!(fault, Some(IdFault::Twice(id)) if id == twice));
        }
    }
}
