//! What a file holds, before anything is chosen.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Crs, Lod, SurfaceKind};
use crate::format::surfaces::{ObjectRecord, SurfaceFile};

/// What a city file holds, before levels of detail are chosen.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct CityContents {
    /// What the file is, with its version ("CityJSON 2.0").
    pub format: String,
    /// Objects that are part of no other.
    pub objects: usize,
    /// Objects that are parts of others.
    pub parts: usize,
    #[serde(serialize_with = "as_pairs", deserialize_with = "from_pairs")]
    pub polygons: BTreeMap<Option<Lod>, KindCounts>,
    /// Polygons with holes.
    pub holes: usize,
    /// The reference system that the file names.
    pub crs: Option<Crs>,
}

/// A map whose keys are no texts, as JSON can hold it.
fn as_pairs<S: Serializer>(map: &BTreeMap<Option<Lod>, KindCounts>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(map)
}

fn from_pairs<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<Option<Lod>, KindCounts>, D::Error> {
    Ok(Vec::deserialize(deserializer)?.into_iter().collect())
}

/// Polygons by what they are of their object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct KindCounts {
    pub ground: usize,
    pub roof: usize,
    pub wall: usize,
    /// Closures, floors, windows, water and so on.
    pub other: usize,
    /// The file does not say what they are.
    pub unsaid: usize,
}

impl KindCounts {
    pub fn total(&self) -> usize {
        self.ground + self.roof + self.wall + self.other + self.unsaid
    }

    /// Each kind by its name in files and reports.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let KindCounts { ground, roof, wall, other, unsaid } = *self;
        [("ground", ground), ("roof", roof), ("wall", wall), ("other", other), ("unsaid", unsaid)].into_iter()
    }

    fn add_all(&mut self, other: &KindCounts) {
        self.ground += other.ground;
        self.roof += other.roof;
        self.wall += other.wall;
        self.other += other.other;
        self.unsaid += other.unsaid;
    }

    fn add(&mut self, kind: Option<SurfaceKind>) {
        *match kind {
            Some(SurfaceKind::Ground) => &mut self.ground,
            Some(SurfaceKind::Roof) => &mut self.roof,
            Some(SurfaceKind::Wall) => &mut self.wall,
            Some(SurfaceKind::Closure | SurfaceKind::Other) => &mut self.other,
            None => &mut self.unsaid,
        } += 1;
    }
}

impl CityContents {
    pub(super) fn of(file: &SurfaceFile) -> CityContents {
        // Rooms, installations and the like belong to an object as well, and are no parts of a building.
        let is_part = |object: &&ObjectRecord| object.parent.is_some() && object.class.ends_with("Part");
        let mut contents = CityContents {
            format: file.format.clone(),
            objects: file.objects.iter().filter(|object| object.parent.is_none()).count(),
            parts: file.objects.iter().filter(is_part).count(),
            crs: file.crs.as_deref().map(Crs::understood),
            ..CityContents::default()
        };
        for surface in &file.surfaces {
            contents.polygons.entry(surface.lod).or_default().add(surface.kind);
            contents.holes += usize::from(surface.ring_count > 1);
        }
        contents
    }

    /// Takes in what a further part of the same file holds.
    pub(super) fn add(&mut self, other: &CityContents) {
        self.objects += other.objects;
        self.parts += other.parts;
        self.holes += other.holes;
        for (lod, counts) in &other.polygons {
            self.polygons.entry(*lod).or_default().add_all(counts);
        }
    }

    /// Of a format without levels and kinds.
    pub(super) fn plain(format: &str, objects: usize, polygons: usize) -> CityContents {
        let counts = KindCounts { unsaid: polygons, ..KindCounts::default() };
        let polygons = BTreeMap::from([(None, counts)]);
        CityContents { format: format.to_owned(), objects, polygons, ..CityContents::default() }
    }
}
