//! Sites: what stands there, and what the model makes of it.

use super::block::{Block, GROUND_REACH_M};
use super::draws::{between, one_of, stream};
use super::house::{Face, House};
use super::levels::Levels;
use crate::geometry::{Point3, RayCaster, Vector3};
use crate::solvers::scene::Random;

/// A turn moves the ends of a house no more than a shift does; small houses are not spun, metres.
const LEAST_LEVER_M: f64 = 15.0;

/// Heights of a house come out better than its outline: this much of its shift.
const UP_SHARE: f64 = 0.7;

/// What lies under a roof this far before a wall is the house next door, metres.
const NEXT_DOOR_M: f64 = 0.3;

/// One place twice: what stands there, and the model that the program is given.
#[derive(Clone, Debug)]
pub struct Site {
    pub built: Block,
    pub modelled: Block,
}

/// What became of a house since its model was made.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    None,
    Gone,
    OtherHeight,
    Rebuilt,
    /// It is not in the model yet.
    New,
}

impl Site {
    /// A plan as it was built and as it was modelled, `levels` apart.
    pub fn new(plan: &Block, levels: &Levels, seed: u64) -> Site {
        let (mut built, mut modelled) = (Vec::new(), Vec::new());
        let rays = plan.rays();
        for (house, number) in plan.houses.iter().zip(1..) {
            // Streams of each house and purpose, so that one level does not stir what another one draws.
            let mut of_change = stream(seed, 2 * number);
            let change = change(&mut of_change, levels.changed);
            if change != Change::New {
                modelled.push(as_modelled(house, levels, seed, number));
            }
            let standing = house.under_eaves(levels.eaves_m, |wall| is_free(&rays, wall));
            built.extend(match change {
                Change::Gone => None,
                Change::None | Change::New => Some(standing),
                Change::OtherHeight => Some(standing.stretched_up(between(&mut of_change, 0.6, 1.7))),
                Change::Rebuilt => {
                    let shift = 1.5 * Vector3::new(of_change.normal(), of_change.normal(), 0.0);
                    let other = standing.stretched_up(between(&mut of_change, 0.7, 1.4));
                    Some(other.shifted(shift, 0.1 * of_change.normal()))
                }
            });
        }
        let ground = levels.ground.then(|| ground_as_modelled(plan, levels, seed));
        Site { built: Block::new(built).with_ground(), modelled: Block { houses: modelled, ground } }
    }
}

/// The ground is surveyed by itself: where the houses stand in the plan, off as any other plane.
fn ground_as_modelled(plan: &Block, levels: &Levels, seed: u64) -> Face {
    let mut ground = plan.ground_within(GROUND_REACH_M);
    let off_m = levels.plane_m * stream(seed, 0).normal();
    ground.corners.iter_mut().for_each(|corner| corner.z += off_m);
    ground
}

/// Whether a wall stands in the open: eaves reach over the street, not into the house next door.
fn is_free(rays: &RayCaster, wall: &Face) -> bool {
    let corners = wall.corners.iter().map(|c| c.coords);
    let before = Point3::from(corners.sum::<Vector3<f64>>() / wall.corners.len() as f64 + NEXT_DOOR_M * wall.normal());
    rays.first_hit(&before, &Vector3::z(), f64::MAX).is_none()
}

/// Half as many houses as are changed are new.
fn change(random: &mut Random, share: f64) -> Change {
    let drawn = random.unit();
    let kinds = [(Change::Gone, 0.35), (Change::OtherHeight, 0.35), (Change::Rebuilt, 0.3)];
    let kind = one_of(random, &kinds);
    match drawn {
        d if d < share => kind,
        d if d < 1.5 * share => Change::New,
        _ => Change::None,
    }
}

fn as_modelled(house: &House, levels: &Levels, seed: u64, number: u64) -> House {
    let mut random = stream(seed, 2 * number + 1);
    let drawn = if levels.lids { house.as_lid() } else { house.clone() };
    let foot = drawn.middle();
    let reach = drawn.faces.iter().flat_map(|f| &f.corners).map(|c| (c - foot).xy().norm()).fold(0.0, f64::max);
    let shift = levels.building_m * random.normal_vector().component_mul(&Vector3::new(1.0, 1.0, UP_SHARE));
    let turn = levels.building_m / (2.0 * reach).max(LEAST_LEVER_M) * random.normal();
    let out_m: Vec<f64> = drawn.faces.iter().map(|_| levels.plane_m * random.normal()).collect();
    drawn.with_planes_moved(&out_m).shifted(shift, turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_faults_the_model_is_what_stands_there() {
        let plan = Block::town(3, 2, 1);
        let site = Site::new(&plan, &Levels::none(), 4);
        for (built, modelled) in site.built.houses.iter().zip(&site.modelled.houses) {
            let corners = |h: &House| h.faces.iter().flat_map(|f| f.corners.clone()).collect::<Vec<_>>();
            assert!(corners(built).iter().zip(&corners(modelled)).all(|(a, b)| (a - b).norm() < 1e-9));
        }
        assert_eq!(site.built.houses.len(), plan.houses.len());
    }

    #[test]
    fn the_ground_of_the_model_does_not_follow_the_houses_that_are_off() {
        let plan = Block::town(8, 8, 2);
        let height_m = |levels: Levels| Site::new(&plan, &levels, 4).modelled.ground.unwrap().corners[0].z;
        let right_m = height_m(Levels::none());
        assert!((height_m(Levels { building_m: 0.25, ..Levels::none() }) - right_m).abs() < 1e-12);
        let off_m = height_m(Levels { plane_m: 0.03, ..Levels::none() }) - right_m;
        assert!(off_m != 0.0 && off_m.abs() < 0.12, "{off_m}");
    }

    #[test]
    fn houses_are_off_and_changed_by_as_much_as_was_asked_for() {
        let plan = Block::town(8, 8, 2);
        let off = Site::new(&plan, &Levels { building_m: 0.2, ..Levels::none() }, 4);
        let shifts: Vec<Vector3<f64>> =
            off.modelled.houses.iter().zip(&plan.houses).map(|(m, p)| m.middle() - p.middle()).collect();
        let rms = (shifts.iter().map(|s| s.x * s.x).sum::<f64>() / shifts.len() as f64).sqrt();
        assert!((rms - 0.2).abs() < 0.02, "{rms}");

        let changed = Site::new(&plan, &Levels { changed: 0.2, ..Levels::none() }, 4);
        let houses = plan.houses.len() as f64;
        let gone = 1.0 - changed.built.houses.len() as f64 / houses;
        let new = 1.0 - changed.modelled.houses.len() as f64 / houses;
        assert!((gone - 0.07).abs() < 0.04 && (new - 0.1).abs() < 0.04, "{gone} {new}");
    }
}
