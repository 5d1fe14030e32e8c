//! What was typed, turned into what is meant, done by one call of the library and told to a person or a script.

mod align;
mod args;
mod completions;
mod demo;
mod export;
mod index;
mod inspect;
mod interrupt;
mod merge;
mod parts;
mod place;
mod plan;
mod planes;
mod print;
mod progress;
mod roles;
mod run;
mod sample;
mod session;
mod solve;
mod summary;

pub use run::run;
use session::{Outcome, Session};
