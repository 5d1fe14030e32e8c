use super::*;
use crate::geometry::{Similarity, Start, StartSigmas};
use crate::merging::Unbalanced;

#[test]
fn an_error_in_one_type_says_what_the_own_one_says() {
    let sigmas = StartSigmas { height_m: -1.0, ..StartSigmas::default() };
    let start = Start::new(Similarity::identity(), sigmas).unwrap_err();
    let unbalanced = Unbalanced { what: "points", given: 5, kept: 3, fused: 1, dropped: 0, counted: 3 };
    let merge = MergeError::from(unbalanced);
    for (own, all) in [
        (start.to_string(), Error::from(start)),
        (Cancelled.to_string(), Error::from(Cancelled)),
        (merge.to_string(), Error::from(merge)),
    ] {
        assert_eq!(own, all.to_string());
        assert!(!own.is_empty());
    }
}

#[test]
fn every_function_of_the_library_may_be_asked_with_one_type_of_error() {
    fn nothing_there() -> Result<(), Error> {
        crate::city::read_city(std::path::Path::new("absent.obj"), &[], &crate::city::CityOptions::default())?;
        Ok(())
    }
    assert!(matches!(nothing_there(), Err(Error::City(_))));
    fn ended() -> Result<(), Error> {
        Err(Cancelled)?;
        Ok(())
    }
    assert!(matches!(ended(), Err(Error::Cancelled(_))));
}
