//! What counts as zero.

/// What vanishes beside quantities of size 1: a diagonal entry of the triangular normals, the area of a triple, the
/// radius of a line's circle. Rounding leaves some 1e-16; random scenes come below 1e-10 once in ten thousand million.
pub const RANK_TOLERANCE: f64 = 1e-12;
