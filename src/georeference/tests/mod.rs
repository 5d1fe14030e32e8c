//! Starts from made-up captures whose truth is known.

mod agreement;
mod control;
mod positions;
mod scene;
mod systems;
