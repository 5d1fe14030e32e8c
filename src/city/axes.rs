//! Whether files write north before east: a city would become its own mirror image.

use super::Crs;
use crate::format::surfaces::SurfaceFile;

/// What closed shells and the reference system tell of the order of axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct AxisVotes {
    /// Closed shells, and those of negative volume.
    pub shells: usize,
    pub negative: usize,
    /// What the reference system's own range of coordinates says.
    pub by_range: Option<AxisOrder>,
}

/// Which horizontal axis is written first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisOrder {
    EastFirst,
    NorthFirst,
}

impl AxisVotes {
    /// Ranges are certain where they tell; a file all of whose shells are wound inwards has negative volumes, too.
    pub fn order(&self) -> Option<AxisOrder> {
        let by_volume = match (self.shells, self.negative) {
            (0, _) => None,
            (shells, negative) if 2 * negative > shells => Some(AxisOrder::NorthFirst),
            _ => Some(AxisOrder::EastFirst),
        };
        self.by_range.or(by_volume)
    }
}

/// Asks the closed shells of all files, and where the reference system says its coordinates are. `middle`: of the files' first two axes.
pub(super) fn vote(files: &[&SurfaceFile], crs: Option<&Crs>, middle: [f64; 2]) -> AxisVotes {
    let volumes: Vec<f64> = files.iter().flat_map(|file| shell_volumes(file)).filter(|volume| *volume != 0.0).collect();
    AxisVotes {
        shells: volumes.len(),
        negative: volumes.iter().filter(|volume| **volume < 0.0).count(),
        by_range: crs.and_then(|crs| order_by_range(crs.epsg?, middle)),
    }
}

/// Signed volume of each closed shell: positive where polygons run counter-clockwise seen from outside and x, y, z are right-handed.
fn shell_volumes(file: &SurfaceFile) -> Vec<f64> {
    // Sum of a shell's pyramids, and the corner that is their apex: near, so that large coordinates cancel first.
    let mut shells: Vec<Option<([f64; 3], f64)>> = Vec::new();
    for surface in &file.surfaces {
        let Some(shell) = surface.shell.map(|shell| shell as usize) else { continue };
        if shells.len() <= shell {
            shells.resize(shell + 1, None);
        }
        for ring in surface.first_ring..surface.first_ring + surface.ring_count {
            let mut corners = file.ring(ring).iter().map(|&at| file.positions[at as usize]);
            let Some(first) = corners.next() else { continue };
            let (apex, volume) = shells[shell].get_or_insert((first, 0.0));
            let apex = *apex;
            let from_apex = |[x, y, z]: [f64; 3]| [x - apex[0], y - apex[1], z - apex[2]];
            let first = from_apex(first);
            let mut before = None;
            for corner in corners.map(from_apex) {
                if let Some(before) = before {
                    *volume += triple(first, before, corner);
                }
                before = Some(corner);
            }
        }
    }
    shells.into_iter().flatten().map(|(_, volume)| volume / 6.0).collect()
}

/// a . (b x c)
fn triple([a0, a1, a2]: [f64; 3], [b0, b1, b2]: [f64; 3], [c0, c1, c2]: [f64; 3]) -> f64 {
    a0 * (b1 * c2 - b2 * c1) + a1 * (b2 * c0 - b0 * c2) + a2 * (b0 * c1 - b1 * c0)
}

/// Kilometres east and north between which coordinates of a reference system lie, generously about its area of use (EPSG dataset).
type Range = (std::ops::RangeInclusive<u32>, [f64; 2], [f64; 2]);
const RANGES: [Range; 11] = [
    (25_828..=25_838, [50.0, 950.0], [2_000.0, 9_400.0]),
    (32_601..=32_660, [50.0, 950.0], [1_000.0, 9_400.0]),
    (32_701..=32_760, [50.0, 950.0], [1_000.0, 10_000.0]),
    (5_554..=5_556, [50.0, 950.0], [2_000.0, 9_400.0]),
    (5_971..=5_973, [50.0, 950.0], [2_000.0, 9_400.0]),
    (31_466..=31_469, [2_200.0, 5_900.0], [5_200.0, 6_300.0]),
    (28_992..=28_992, [-10.0, 310.0], [280.0, 640.0]),
    (7_415..=7_415, [-10.0, 310.0], [280.0, 640.0]),
    (2_056..=2_056, [2_400.0, 2_900.0], [1_000.0, 1_350.0]),
    (21_781..=21_781, [400.0, 900.0], [0.0, 350.0]),
    (2_154..=2_154, [0.0, 1_300.0], [5_900.0, 7_300.0]),
];

fn order_by_range(code: u32, [first, second]: [f64; 2]) -> Option<AxisOrder> {
    let (_, east, north) = RANGES.iter().find(|range| range.0.contains(&code))?;
    let lies = |x: f64, y: f64| {
        let within = |value: f64, [low, high]: [f64; 2]| value >= 1e3 * low && value <= 1e3 * high;
        within(x, *east) && within(y, *north)
    };
    match (lies(first, second), lies(second, first)) {
        (true, false) => Some(AxisOrder::EastFirst),
        (false, true) => Some(AxisOrder::NorthFirst),
        _ => None,
    }
}
