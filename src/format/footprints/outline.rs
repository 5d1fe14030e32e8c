//! Outlines on the ground, and which holes are theirs.

/// A polygon in the plane: its outline counter-clockwise, its holes clockwise; no corner repeats the one before.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    pub outer: Vec<[f64; 2]>,
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// A ring made ready: without closing corner and repetitions; nothing where less than three corners or no area are left.
pub(super) fn cleaned(ring: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let mut cleaned: Vec<[f64; 2]> = ring.to_vec();
    cleaned.dedup();
    while cleaned.len() > 1 && cleaned.first() == cleaned.last() {
        cleaned.pop();
    }
    (cleaned.len() >= 3 && doubled_area(&cleaned) != 0.0).then_some(cleaned)
}

/// Twice the area; positive where the ring is counter-clockwise. About its first corner, as coordinates are large.
pub(super) fn doubled_area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = ring.first() else { return 0.0 };
    let about = |[a, b]: [f64; 2]| [a - x, b - y];
    let sides = ring.windows(2).map(|side| (about(side[0]), about(side[1])));
    sides.map(|([ax, ay], [bx, by])| ax * by - bx * ay).sum()
}

impl Outline {
    /// From rings whose roles are given, whichever way they are wound.
    pub fn new(outer: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> Outline {
        let wound = |mut ring: Vec<[f64; 2]>, sign: f64| {
            if doubled_area(&ring) * sign < 0.0 {
                ring.reverse();
            }
            ring
        };
        Outline { outer: wound(outer, 1.0), holes: holes.into_iter().map(|hole| wound(hole, -1.0)).collect() }
    }
}

/// Holes of a record times corners of its outlines: more would take seconds. Chosen: a lake of ten thousand corners may have
/// as many islands.
const MOST_TRIALS: usize = 100_000_000;

/// Outlines of rings that tell their roles by their turn alone (Shapefile: outlines are clockwise, holes are not). A hole
/// belongs to the smallest outline around it; one that lies in none is an outline that was wound the wrong way. Nothing where
/// there are too many of both.
pub(super) fn by_winding(rings: Vec<Vec<[f64; 2]>>) -> Option<Vec<Outline>> {
    let (outer, inner): (Vec<_>, Vec<_>) = rings.into_iter().partition(|ring| doubled_area(ring) < 0.0);
    let corners: usize = outer.iter().map(Vec::len).sum();
    if inner.len().saturating_mul(corners) > MOST_TRIALS {
        return None;
    }
    let areas: Vec<f64> = outer.iter().map(|ring| doubled_area(ring).abs()).collect();
    let mut holes = vec![Vec::new(); outer.len()];
    let mut alone = Vec::new();
    for hole in inner {
        let around = (0..outer.len()).filter(|&at| contains(&outer[at], hole[0]));
        match around.min_by(|&a, &b| areas[a].total_cmp(&areas[b])) {
            Some(at) => holes[at].push(hole),
            None => alone.push(Outline::new(hole, Vec::new())),
        }
    }
    let with_holes = outer.into_iter().zip(holes).map(|(outer, holes)| Outline::new(outer, holes));
    Some(with_holes.chain(alone).collect())
}

/// Whether a point lies within a ring, by the crossings of a ray towards +x.
fn contains(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossings =
        sides.filter(|([ax, ay], [bx, by])| (*ay > y) != (*by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax));
    crossings.count() % 2 == 1
}
