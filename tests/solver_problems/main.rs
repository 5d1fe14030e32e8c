//! Whole problems: the golden vectors, every scenario of points, lines and planes, degenerate and hostile input.

#[path = "../needs/mod.rs"]
mod needs;
mod golden;
mod invariance;
mod refusals;
mod scenarios;

use cityweld::problem::{Refusal, parse_problem, solve_json};
use cityweld::solvers::primitives::{ObjectPrimitive, SensorPrimitive, rows_of};
use cityweld::solvers::scene::{Random, Sample, angle_between_rad, pose, sample, up};
use cityweld::solvers::{Degeneracy, Row, Solution, Sought, Up, condition_at, solve, solve_minimal};
use cityweld::{Matrix3, Point3, Rotation3, Similarity, Vector3};
use needs::shared;
use serde_json::Value;
