//! Rotations to start from, near which every solution of a problem lies.
//!
//! Known vertical, or three points on a plane: an axis is known up to its sense, and every row that has lost translation and offset
//! is a line that meets the circle (turn.rs). Otherwise, and besides: three quadrics in all charts (three_quadrics.rs); of more than
//! three, three fixed combinations.

use super::degeneracy::Degeneracy;
use super::normalised::Normalised;
use crate::geometry::{Axes, Matrix3};
use crate::solvers::algebra::macaulay::meet_in_points;
use crate::solvers::algebra::quaternion::{Quadric, form_of, rotation};
use crate::solvers::algebra::three_quadrics::{Charts, three_quadrics};
use crate::solvers::elimination::triangular;
use crate::solvers::sought::Sought;
use crate::solvers::turn::{KnownAxis, Line, Sense, Turn, line_with};

/// A line whose radius is smaller than this beside the others says nothing of the angle.
const NO_LINE: f64 = 1e-11;

/// By how much, relative to the radius, a tangent may pass beside the circle: with more rows than unknowns it may by more than
/// rounding.
const NEARLY_TANGENT: f64 = 1e-7;

/// Rotations to start from; every solution is near one of them.
pub fn candidates(problem: &Normalised) -> Result<Vec<Matrix3<f64>>, Degeneracy> {
    if let Some(up) = problem.sought.up() {
        let turns = about_axis(problem, up.axis(), &[Sense::Along]);
        return turns.ok_or(Degeneracy::FreeHeading);
    }
    let quadrics = quadrics_of(problem);
    let mut found = Vec::new();
    for seed in 0..if quadrics.len() == 3 { 1 } else { 2 } {
        let three = combined(&quadrics, seed).ok_or(Degeneracy::NotIsolated)?;
        if seed == 0 && !meet_in_points(&three) {
            return Err(Degeneracy::NotIsolated);
        }
        found.extend(three_quadrics(&three, Charts::All).iter().map(rotation));
    }
    if let Some((triple, normal)) = problem.largest_triangle() {
        let axis = KnownAxis { sensor: Axes::about(&triple), object: Axes::about(&normal) };
        found.extend(about_axis(problem, &axis, &Sense::BOTH).into_iter().flatten());
    }
    Ok(found)
}

/// Turns about a known axis that satisfy one of the rows that remain when the linear unknowns are gone; `None` where no such
/// row says anything of the angle.
fn about_axis(problem: &Normalised, axis: &KnownAxis, senses: &[Sense]) -> Option<Vec<Matrix3<f64>>> {
    let mut rows: Vec<[f64; 10]> = Vec::with_capacity(problem.forms.len());
    for row in &problem.forms {
        let [x, y, z] = axis.object.coordinates(&row.normal);
        let (d, constant) = split(&problem.sought, row.offset);
        let [a, b, c, e, f] = axis.parts_of(&row.turning);
        rows.push([x, y, z, d, constant, a, b, c, e, f]);
    }
    let unknowns = linear_unknowns(&problem.sought);
    triangular(&mut rows, unknowns);
    let lines = rows[unknowns..]
        .iter()
        .flat_map(|row| senses.iter().map(|&sense| (line_with(&row[5..], row[4], sense), sense)));
    let telling: Vec<_> = lines.filter(|(line, _)| says_something(line)).collect();
    let turns = telling.iter().flat_map(|&(line, sense)| Turn::on(pulled_to_circle(line), sense, 0.0));
    (!telling.is_empty()).then(|| turns.map(|turn| axis.rotation(&turn)).collect())
}

fn says_something([a, b, g]: &Line) -> bool {
    a.hypot(*b) > NO_LINE * g.abs().max(1.0)
}

fn pulled_to_circle([a, b, g]: Line) -> Line {
    let radius = a.hypot(b);
    [a, b, if g.abs() < radius * (1.0 + NEARLY_TANGENT) { g.clamp(-radius, radius) } else { g }]
}

/// The rows as quadrics in q, free of the linear unknowns.
fn quadrics_of(problem: &Normalised) -> Vec<Quadric> {
    let mut rows: Vec<[f64; 14]> = Vec::with_capacity(problem.forms.len());
    for row in &problem.forms {
        let (d, constant) = split(&problem.sought, row.offset);
        let mut out = [0.0; 14];
        out[..4].copy_from_slice(&[row.normal.x, row.normal.y, row.normal.z, d]);
        out[4..].copy_from_slice(&form_of(&row.turning));
        // |q|^2 = 1 turns a constant into a quadratic form.
        out[4..8].iter_mut().for_each(|square| *square += constant);
        rows.push(out);
    }
    let unknowns = linear_unknowns(&problem.sought);
    triangular(&mut rows, unknowns);
    rows[unknowns..].iter().map(|row| std::array::from_fn(|j| row[4 + j])).collect()
}

/// Three general combinations of three or more quadrics; the weights are fixed numbers without structure.
fn combined(quadrics: &[Quadric], seed: usize) -> Option<[Quadric; 3]> {
    if let Ok(three) = quadrics.try_into() {
        return Some(three);
    }
    (quadrics.len() > 3).then(|| {
        std::array::from_fn(|k| {
            let mut out = [0.0; 10];
            for (i, quadric) in quadrics.iter().enumerate() {
                let weight = (1.0 + 2.3 * (k as f64 + 1.0) * (i as f64 + 1.7) + 0.9 * seed as f64).sin();
                for j in 0..10 {
                    out[j] += weight * quadric[j];
                }
            }
            out
        })
    })
}

/// Linear unknowns removed by reflections: the translation, and the constant 1 beside an unknown scale.
fn linear_unknowns(sought: &Sought) -> usize {
    if sought.is_similarity() { 4 } else { 3 }
}

/// An offset as (column beside the translation, constant beside the rotation).
fn split(sought: &Sought, offset: f64) -> (f64, f64) {
    if sought.is_similarity() { (offset, 0.0) } else { (0.0, offset) }
}
