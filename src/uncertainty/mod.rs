//! How exactly a pose is known where the model is not exact: the last estimate, and its covariance.
//!
//! Question     where does a found pose stand for good, and how far may it be off?
//! Method       surfaces of a city model err together: a whole building is shifted and turned, each of its building planes is off and leans,
//!              all walls stand inside the eaves that they were drawn from, and the reconstruction bends. These errors are unknowns
//!              beside the pose, each with a spread that is estimated from the data (`estimate`). All but the pose is
//!              eliminated (`elimination`), which leaves the information that the data hold on the pose; what the answer does when
//!              one building or one building plane is left out checks it (`leave_out`)
//! Source       mixed models and their variances: Harville 1977, Laird and Ware 1982; with heavy tails: Lange, Little and
//!              Taylor 1989, Pinheiro, Liu and Wu 2001; leaving out: Efron 1982

mod bending;
mod elimination;
mod estimate;
mod findings;
mod leave_out;
mod observations;
mod rows;
mod system;
mod variances;

pub use estimate::{Estimate, estimate};
pub use findings::SystematicErrors;
