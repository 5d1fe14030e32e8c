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
pub(super) fn vote(signs: &ShellSigns, crs: Option<&Crs>, middle: [f64; 2]) -> AxisVotes {
    AxisVotes {
        shells: signs.shells,
        negative: signs.negative,
        by_range: crs.and_then(|crs| order_by_range(crs.epsg?, middle)),
    }
}

/// Closed shells that have a volume, and those of them whose volume is negative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShellSigns {
    shells: usize,
    negative: usize,
}

impl ShellSigns {
    pub fn of(files: &[&SurfaceFile]) -> ShellSigns {
        let volumes = files.iter().flat_map(|file| shell_volumes(file)).filter(|volume| *volume != 0.0);
        volumes.fold(ShellSigns::default(), |signs, volume| ShellSigns {
            shells: signs.shells + 1,
            negative: signs.negative + usize::from(volume < 0.0),
        })
    }

    pub fn add(&mut self, other: &ShellSigns) {
        self.shells += other.shells;
        self.negative += other.negative;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::surfaces::SurfaceRecord;

    /// A tetrahedron as one closed shell, at large coordinates.
    fn tetrahedron() -> SurfaceFile {
        let at = |x, y, z| [691_000.0 + x, 5_335_000.0 + y, 500.0 + z];
        let corners = vec![0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
        let surface =
            |ring| SurfaceRecord { object: 0, first_ring: ring, ring_count: 1, lod: None, kind: None, shell: Some(0) };
        SurfaceFile {
            positions: vec![at(0.0, 0.0, 0.0), at(6.0, 0.0, 0.0), at(0.0, 6.0, 0.0), at(0.0, 0.0, 6.0)],
            corners,
            ring_ends: vec![3, 6, 9, 12],
            surfaces: (0..4).map(surface).collect(),
            ..SurfaceFile::default()
        }
    }

    #[test]
    fn the_volume_of_a_shell_has_the_sign_of_its_axes_and_no_noise_of_large_coordinates() {
        let mut file = tetrahedron();
        assert!((shell_volumes(&file)[0] - 36.0).abs() < 1e-6);
        file.positions.iter_mut().for_each(|position| position.swap(0, 1));
        assert!((shell_volumes(&file)[0] + 36.0).abs() < 1e-6);
        let votes = vote(&ShellSigns::of(&[&file]), None, [0.0, 0.0]);
        assert_eq!((votes.shells, votes.negative, votes.order()), (1, 1, Some(AxisOrder::NorthFirst)));
    }

    #[test]
    fn polygons_without_shells_tell_nothing() {
        let mut file = tetrahedron();
        file.surfaces.iter_mut().for_each(|surface| surface.shell = None);
        assert_eq!(vote(&ShellSigns::of(&[&file]), None, [0.0, 0.0]).order(), None);
    }

    #[test]
    fn half_of_the_shells_are_not_most() {
        let votes = |shells, negative| AxisVotes { shells, negative, by_range: None }.order();
        assert_eq!(votes(10, 5), Some(AxisOrder::EastFirst));
        assert_eq!(votes(10, 6), Some(AxisOrder::NorthFirst));
    }

    #[test]
    fn ranges_of_known_systems_tell_east_from_north() {
        for (code, east, north) in [
            (25_832, 691_030.0, 5_336_020.0),
            (7_415, 85_000.0, 446_550.0),
            (2_056, 2_678_219.0, 1_243_583.0),
            (31_467, 3_450_000.0, 5_430_000.0),
            (2_154, 650_000.0, 6_860_000.0),
        ] {
            assert_eq!(order_by_range(code, [east, north]), Some(AxisOrder::EastFirst), "{code}");
            assert_eq!(order_by_range(code, [north, east]), Some(AxisOrder::NorthFirst), "{code}");
            // Shifted to zero, or of another place: not told.
            assert_eq!(order_by_range(code, [12.0, 40.0]), None, "{code}");
        }
        assert_eq!(order_by_range(3_857, [1e6, 6e6]), None);
    }
}
