//! Made-up city blocks, reconstructions of them, and the truth, for tests, examples and benchmarks.
//!
//! Question: what does a stage answer where the right answer is known?
//! Input: a [`Block`] of houses; how it is seen ([`CloudOptions`], or [`Station`]s with [`CaptureOptions`]); a seed.
//! Output: its [`CityModel`](crate::city::CityModel), and a [`Survey`]: the reconstruction in a frame of its own with the similarity that leads back.
//! Method: points are drawn on faces that can be seen from outside; photographs keep the points that no wall hides. Noise
//! is Gaussian, in metres for points and in pixels for keypoints; what is wrong is wrong by a stated share.
//! Assumptions: the city frame is that of the block, metres, z up; truth is exact.
//! A [`Case`] is what the real thing is like: a [`Site`] that was modelled once and has changed, photographed with all
//! [`Levels`] of faults, and starts at right and wrong places; an [`Assessment`] says what the answer was worth.
//! Deterministic: same options and seed, same numbers on every machine. No stage of the program imports this room.

mod assess;
mod bend;
mod block;
mod capture;
mod case;
mod cloud;
mod clutter;
mod draws;
mod house;
mod imperfect;
mod levels;
mod offset;
mod quarters;
mod relief;
mod remodel;
mod sampling;
mod site;
mod survey;
mod viewpoints;
mod world;

pub use assess::{Assessment, Outcome};
pub use block::Block;
pub use capture::{CaptureOptions, Ring, Station};
pub use case::{Case, Errand, Request, Setting};
pub use cloud::CloudOptions;
pub use house::{Face, House, Plinth, Surface};
pub use imperfect::Imperfect;
pub use levels::{Fault, Levels};
pub use offset::{Move, Offset};
pub use quarters::{Quarter, Quarters, Repeated};
pub use sampling::resampled;
pub use site::Site;
pub use survey::{Survey, sfm_from_city};
