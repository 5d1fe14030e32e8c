//! What is held against what a reader returns. Each check gives the promise that was broken, in words.

mod city;
mod las_of_text;
mod places;
pub mod readers;
mod sfm;
mod told;
mod written;

/// A number that is returned is a number.
fn finite(what: &str, values: impl IntoIterator<Item = f64>) -> Result<(), String> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("{what}: {value} is returned")),
        None => Ok(()),
    }
}

/// An index that is returned points at something.
fn within(what: &str, index: usize, count: usize) -> Result<(), String> {
    if index < count { Ok(()) } else { Err(format!("{what}: index {index} of {count}")) }
}
