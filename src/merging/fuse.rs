//! Several placed parts become one model: cameras, photographs, points and tracks, each once.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Matrix3;

use super::ledger::Ledger;
use super::links::{SharedPhoto, pixel_scale, same_keypoints, tolerance_px};
use super::sigma::{covariance_in, extent};
use super::{Fused, Part};
use crate::format::colmap::{Encoding, FrameRecord, RigRecord, SENSOR_CAMERA, SensorRecord};
use crate::geometry::{Camera, Point3, Similarity, Vector3};
use crate::reconstruction::{CameraIndex, ColmapParts, Image, ImageIndex, Observation, PointIndex, Reconstruction};

/// Two points at one pixel are one where they are nearer than this many sigmas.
const SAME_POINT: f64 = 4.0;
/// Parts bend against each other by about this share of the radius.
const BEND_SHARE: f64 = 3e-3;
/// A point of the other part that misses its keypoint in the fused photograph by more than this share of the width is not
/// tied to it any longer.
const FAR_FROM_KEYPOINT: f64 = 0.02;
/// Of points without colour.
const GREY: [u8; 3] = [128; 3];

const BEHIND: &str = "behind camera";
const FAR: &str = "far from its keypoint in the fused photograph";
const SECOND: &str = "second keypoint of one point in a photograph";
const UNSEEN: &str = "no observation left";

/// Joins the parts `placed`, in that order.
pub(super) fn fuse(parts: &[Part], placed: &[usize], places: &[Option<Similarity>]) -> (Fused, Ledger) {
    let mut ledger = Ledger::open(parts, |p| placed.contains(&p));
    let moved: Vec<Moved<'_>> = placed.iter().map(|&p| Moved::of(&parts[p].sfm, places[p].as_ref())).collect();
    let cameras = Cameras::of(&moved);
    let mut sets = PointSets::of(&moved);
    let photos = fuse_photos(&moved, &mut sets, &mut ledger);
    let model = build(&moved, &cameras, &mut sets, photos, &mut ledger);
    let part_of_point = model.1.iter().map(|&k| placed[k] as u32).collect();
    (Fused { sfm: model.0, part_of_point }, ledger)
}

/// A part in the merged frame.
struct Moved<'a> {
    /// As it was given: keypoints and tracks are taken from here, since no frame changes them.
    given: &'a Reconstruction,
    /// Its points and poses where they belong.
    posed: Reconstruction,
}

impl Moved<'_> {
    fn of<'a>(given: &'a Reconstruction, merged_from_part: Option<&Similarity>) -> Moved<'a> {
        let mut posed = given.skeleton();
        if let Some(place) = merged_from_part {
            posed.transform(place);
        }
        Moved { given, posed }
    }

    fn point(&self, point: PointIndex) -> Point3<f64> {
        self.posed.points[point.0 as usize]
    }

    fn pose(&self, image: ImageIndex) -> &Image {
        &self.posed.images[image.0 as usize]
    }

    fn keypoints(&self, image: ImageIndex) -> &[Observation] {
        &self.given.images[image.0 as usize].observations
    }
}

/// Which cameras are the same, and which belong to rigs of several.
struct Cameras {
    cameras: Vec<Camera>,
    /// By part and camera: index into `cameras`.
    index: Vec<Vec<u32>>,
    /// By part and camera: true where its rig has no other sensor.
    alone: Vec<Vec<bool>>,
}

impl Cameras {
    fn of(moved: &[Moved<'_>]) -> Cameras {
        let mut found = Cameras { cameras: Vec::new(), index: Vec::new(), alone: Vec::new() };
        let mut known: BTreeMap<(i32, u64, u64, Vec<u64>), u32> = BTreeMap::new();
        for part in moved.iter().map(|m| m.given) {
            let in_rigs = cameras_in_rigs(part);
            let alone: Vec<bool> = part.camera_ids.iter().map(|id| !in_rigs.contains(id)).collect();
            let index = part.cameras.iter().zip(&alone).map(|(camera, alone)| {
                let bits = camera.params.iter().map(|v| v.to_bits()).collect();
                let key = (camera.model.colmap_id(), camera.width_px, camera.height_px, bits);
                let next = found.cameras.len() as u32;
                let index = if *alone { *known.entry(key).or_insert(next) } else { next };
                if index == next {
                    found.cameras.push(camera.clone());
                }
                index
            });
            let index = index.collect();
            found.index.push(index);
            found.alone.push(alone);
        }
        found
    }
}

/// Ids of cameras that share a rig with another sensor.
fn cameras_in_rigs(part: &Reconstruction) -> BTreeSet<u32> {
    let rigs = part.colmap.iter().flat_map(|c| c.rigs.iter().flatten()).filter(|rig| !rig.others.is_empty());
    let sensors = rigs.flat_map(|rig| rig.reference.into_iter().chain(rig.others.iter().map(|(s, _)| *s)));
    sensors.filter(|s| s.kind == SENSOR_CAMERA).map(|s| s.id).collect()
}

/// Points of all parts, joined into sets.
struct PointSets<'a> {
    moved: &'a [Moved<'a>],
    starts: Vec<usize>,
    parent: Vec<u32>,
    /// Members of a set, at its root; empty for a point alone.
    members: BTreeMap<u32, Vec<u32>>,
    radius: Vec<f64>,
    bend: f64,
}

impl PointSets<'_> {
    fn of<'a>(moved: &'a [Moved<'a>]) -> PointSets<'a> {
        let mut starts = vec![0];
        for part in moved {
            starts.push(starts[starts.len() - 1] + part.given.points.len());
        }
        let radius: Vec<f64> = moved.iter().map(|part| extent(&part.posed.points).1).collect();
        let bend = BEND_SHARE * radius.iter().copied().fold(f64::INFINITY, f64::min);
        let parent = (0..starts[moved.len()] as u32).collect();
        PointSets { moved, starts, parent, members: BTreeMap::new(), radius, bend }
    }

    fn key(&self, part: usize, point: PointIndex) -> u32 {
        (self.starts[part] + point.0 as usize) as u32
    }

    fn part_of(&self, key: u32) -> (usize, PointIndex) {
        let part = self.starts.partition_point(|start| *start <= key as usize) - 1;
        (part, PointIndex((key as usize - self.starts[part]) as u32))
    }

    fn root(&self, key: u32) -> u32 {
        self.parent[key as usize]
    }

    fn members(&self, root: u32) -> Vec<u32> {
        self.members.get(&root).cloned().unwrap_or_else(|| vec![root])
    }

    fn uncertainty(&self, key: u32) -> (Point3<f64>, Matrix3<f64>) {
        let (part, point) = self.part_of(key);
        let moved = &self.moved[part];
        let covariance = covariance_in(&moved.posed, moved.given.track(point), point, self.radius[part]);
        (moved.point(point), covariance)
    }

    /// Joins two points if they may be one; a part's own points stay apart.
    fn join(&mut self, a: u32, b: u32) -> bool {
        let (ra, rb) = (self.root(a), self.root(b));
        if ra == rb {
            return true;
        }
        let (of_a, of_b) = (self.members(ra), self.members(rb));
        let parts: BTreeSet<usize> = of_a.iter().map(|k| self.part_of(*k).0).collect();
        if of_b.iter().any(|k| parts.contains(&self.part_of(*k).0)) || !self.may_be_one(a, b) {
            return false;
        }
        let root = ra.min(rb);
        let mut all = of_a;
        all.extend(of_b);
        all.sort_unstable();
        all.iter().for_each(|k| self.parent[*k as usize] = root);
        self.members.remove(&ra.max(rb));
        self.members.insert(root, all);
        true
    }

    fn may_be_one(&self, a: u32, b: u32) -> bool {
        let ((xa, ca), (xb, cb)) = (self.uncertainty(a), self.uncertainty(b));
        let covariance = ca + cb + Matrix3::identity() * (self.bend * self.bend);
        let apart: Vector3<f64> = xa - xb;
        covariance.try_inverse().is_some_and(|info| apart.dot(&(info * apart)) < SAME_POINT * SAME_POINT)
    }

    /// Weighted by what each part knows of it.
    fn position(&self, root: u32) -> Point3<f64> {
        let members = self.members(root);
        if members.len() == 1 {
            let (part, point) = self.part_of(root);
            return self.moved[part].point(point);
        }
        let (mut information, mut sum) = (Matrix3::zeros(), Vector3::zeros());
        for key in members {
            let (x, covariance) = self.uncertainty(key);
            let bent = covariance + Matrix3::identity() * (self.bend * self.bend);
            let own = bent.try_inverse().unwrap_or_else(Matrix3::identity);
            information += own;
            sum += own * x.coords;
        }
        Point3::from(information.try_inverse().map_or_else(Vector3::zeros, |covariance| covariance * sum))
    }
}

/// A photograph of the result.
struct Photo {
    part: usize,
    image: ImageIndex,
    /// Position and the key of the point seen.
    keypoints: Vec<(f64, f64, Option<u32>)>,
    is_fused: bool,
}

fn fuse_photos(moved: &[Moved<'_>], sets: &mut PointSets<'_>, ledger: &mut Ledger) -> Vec<Photo> {
    // A name that a part has twice counts as one only the first time.
    let mut groups: BTreeMap<(&str, usize), Vec<(usize, ImageIndex)>> = BTreeMap::new();
    for (part, sfm) in moved.iter().map(|m| m.given).enumerate() {
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        for (index, image) in sfm.images.iter().enumerate() {
            let times = seen.entry(&image.name).or_default();
            groups.entry((&image.name, *times)).or_default().push((part, ImageIndex(index as u32)));
            *times += 1;
        }
    }
    groups
        .into_values()
        .map(|mut versions| {
            let support = |(part, image): &(usize, ImageIndex)| {
                moved[*part].keypoints(*image).iter().filter(|o| o.point.is_some()).count()
            };
            // The version that sees most points has the better pose; of equals the first stays.
            versions.sort_by_key(|v| std::cmp::Reverse(support(v)));
            ledger.images.kept += 1;
            ledger.images.fused += versions.len() - 1;
            fuse_versions(moved, &versions, sets, ledger)
        })
        .collect()
}

fn fuse_versions(
    moved: &[Moved<'_>],
    versions: &[(usize, ImageIndex)],
    sets: &mut PointSets<'_>,
    ledger: &mut Ledger,
) -> Photo {
    let (part, image) = versions[0];
    let keyed = |sets: &PointSets<'_>, part: usize, o: &Observation| o.point.map(|p| sets.key(part, p));
    let keypoints = moved[part].keypoints(image).iter().map(|o| (o.x_px, o.y_px, keyed(sets, part, o))).collect();
    let mut photo = Photo { part, image, keypoints, is_fused: versions.len() > 1 };
    for &(other, other_image) in &versions[1..] {
        let shared = SharedPhoto { name: String::new(), in_a: image, in_b: other_image };
        let scale = pixel_scale(moved[part].given, moved[other].given, &shared);
        let tolerance = tolerance_px(moved[part].given, &shared);
        let theirs = moved[other].keypoints(other_image);
        let ours: Vec<Observation> = photo
            .keypoints
            .iter()
            .map(|(x_px, y_px, _)| Observation { x_px: *x_px, y_px: *y_px, point: None })
            .collect();
        let links = same_keypoints(&ours, theirs, scale, [0.0; 2], tolerance, &|_| true);
        let mut partner = vec![None; theirs.len()];
        links.iter().for_each(|(i, j)| partner[*j as usize] = Some(*i as usize));
        for (j, o) in theirs.iter().enumerate() {
            let key = keyed(sets, other, o).filter(|key| stays(moved, &photo, sets, *key, o, scale, ledger));
            match (partner[j], key) {
                (Some(i), Some(key)) => match photo.keypoints[i].2 {
                    None => photo.keypoints[i].2 = Some(key),
                    Some(known) if sets.join(known, key) => ledger.observations.fused += 1,
                    Some(_) => photo.keypoints.push((o.x_px * scale[0], o.y_px * scale[1], Some(key))),
                },
                (Some(_), None) => {}
                (None, key) => photo.keypoints.push((o.x_px * scale[0], o.y_px * scale[1], key)),
            }
        }
    }
    photo
}

/// True where the photograph's pose and camera, which come from another part, show the point near its keypoint.
fn stays(
    moved: &[Moved<'_>],
    photo: &Photo,
    sets: &PointSets<'_>,
    key: u32,
    o: &Observation,
    scale: [f64; 2],
    ledger: &mut Ledger,
) -> bool {
    let (part, point) = sets.part_of(key);
    let camera = moved[photo.part].given.camera_of(photo.image);
    let pose = moved[photo.part].pose(photo.image);
    let Some([x, y]) = camera.project(&pose.cam_from_sfm(&moved[part].point(point))) else {
        ledger.observations.drop(BEHIND, 1);
        return false;
    };
    let off = (x - o.x_px * scale[0]).hypot(y - o.y_px * scale[1]);
    let near = off <= FAR_FROM_KEYPOINT * camera.width_px as f64;
    if !near {
        ledger.observations.drop(FAR, 1);
    }
    near
}

/// The model, and for each of its points the (placed) part that it comes from.
fn build(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    sets: &mut PointSets<'_>,
    mut photos: Vec<Photo>,
    ledger: &mut Ledger,
) -> (Reconstruction, Vec<usize>) {
    unlink_seconds(moved, &mut photos, sets, ledger);
    let (roots, number_of) = surviving(moved, &photos, sets, ledger);
    let points: Vec<Point3<f64>> = roots.iter().map(|r| sets.position(*r)).collect();
    let images: Vec<Image> =
        photos.iter_mut().enumerate().map(|(n, p)| image(moved, cameras, sets, p, n, &number_of)).collect();
    let (track_starts, track_elements) = tracks(&images, points.len());
    let origins: Vec<(usize, PointIndex)> = roots.iter().map(|r| sets.part_of(*r)).collect();
    let color =
        |(part, point): &(usize, PointIndex)| moved[*part].given.colors.get(point.0 as usize).copied().unwrap_or(GREY);
    let mut sfm = Reconstruction {
        cameras: cameras.cameras.clone(),
        camera_ids: (1..=cameras.cameras.len() as u32).collect(),
        point_ids: (1..=points.len() as u64).collect(),
        colors: origins.iter().map(color).collect(),
        colmap: Some(colmap_parts(moved, cameras, &photos)),
        images,
        points,
        track_starts,
        track_elements,
        ..Reconstruction::default()
    };
    sfm.point_errors_px = errors(moved, &sfm, sets, &roots, &photos);
    let parts = origins.into_iter().map(|(part, _)| part).collect();
    (sfm, parts)
}

/// A point is seen once in a photograph: its first keypoint stays. Another one at the same pixel is the same observation again.
fn unlink_seconds(moved: &[Moved<'_>], photos: &mut [Photo], sets: &PointSets<'_>, ledger: &mut Ledger) {
    for photo in photos.iter_mut().filter(|p| p.is_fused) {
        let same = SharedPhoto { name: String::new(), in_a: photo.image, in_b: photo.image };
        let tolerance = tolerance_px(moved[photo.part].given, &same);
        let mut first: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        for (x_px, y_px, key) in &mut photo.keypoints {
            let Some(root) = key.map(|k| sets.root(k)) else { continue };
            let (x, y) = match first.entry(root) {
                Entry::Vacant(place) => {
                    place.insert((*x_px, *y_px));
                    continue;
                }
                Entry::Occupied(place) => *place.get(),
            };
            *key = None;
            if (*x_px - x).hypot(*y_px - y) <= tolerance {
                ledger.observations.fused += 1;
            } else {
                ledger.observations.drop(SECOND, 1);
            }
        }
    }
}

/// Points that are still seen (or never were), and their numbers in the result; the accounts of points and observations.
fn surviving(moved: &[Moved<'_>], photos: &[Photo], sets: &PointSets<'_>, ledger: &mut Ledger) -> (Vec<u32>, Vec<u32>) {
    let total = sets.parent.len();
    let mut seen = vec![false; total];
    for key in photos.iter().flat_map(|p| &p.keypoints).filter_map(|(_, _, key)| *key) {
        seen[sets.root(key) as usize] = true;
        ledger.observations.kept += 1;
    }
    let (mut roots, mut number_of) = (Vec::new(), vec![u32::MAX; total]);
    for key in 0..total as u32 {
        if sets.root(key) != key {
            ledger.points.fused += 1;
            continue;
        }
        let (part, point) = sets.part_of(key);
        if seen[key as usize] || moved[part].given.track(point).is_empty() {
            number_of[key as usize] = roots.len() as u32;
            roots.push(key);
        } else {
            ledger.points.drop(UNSEEN, 1);
        }
    }
    ledger.points.kept = roots.len();
    (roots, number_of)
}

fn image(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    sets: &PointSets<'_>,
    photo: &mut Photo,
    number: usize,
    number_of: &[u32],
) -> Image {
    let own = moved[photo.part].pose(photo.image);
    // Taken over, not copied: both forms have the same size, so that collecting takes no further memory.
    let observations = std::mem::take(&mut photo.keypoints).into_iter().map(|(x_px, y_px, key)| Observation {
        x_px,
        y_px,
        point: key.map(|k| PointIndex(number_of[sets.root(k) as usize])),
    });
    Image {
        id: number as u32 + 1,
        camera: CameraIndex(cameras.index[photo.part][own.camera.0 as usize]),
        name: own.name.clone(),
        cam_from_sfm_rotation: own.cam_from_sfm_rotation,
        cam_from_sfm_translation: own.cam_from_sfm_translation,
        quaternion_wxyz: own.quaternion_wxyz,
        observations: observations.collect(),
    }
}

/// Who sees each point, by image and keypoint.
fn tracks(images: &[Image], points: usize) -> (Vec<u32>, Vec<(ImageIndex, u32)>) {
    let links = || {
        images.iter().enumerate().flat_map(|(i, image)| {
            let linked = image.observations.iter().enumerate();
            linked.filter_map(move |(k, o)| Some((o.point?, (ImageIndex(i as u32), k as u32))))
        })
    };
    let mut starts = vec![0u32; points + 1];
    links().for_each(|(point, _)| starts[point.0 as usize + 1] += 1);
    for p in 0..points {
        starts[p + 1] += starts[p];
    }
    let mut next = starts.clone();
    let mut elements = vec![(ImageIndex(0), 0); starts[points] as usize];
    for (point, element) in links() {
        let place = &mut next[point.0 as usize];
        elements[*place as usize] = element;
        *place += 1;
    }
    (starts, elements)
}

/// Mean reprojection errors: as they were, except of points that were fused or are seen in a fused photograph.
fn errors(
    moved: &[Moved<'_>],
    sfm: &Reconstruction,
    sets: &PointSets<'_>,
    roots: &[u32],
    photos: &[Photo],
) -> Vec<f64> {
    let error = |(number, root): (usize, &u32)| {
        let (part, point) = sets.part_of(*root);
        let track = sfm.track(PointIndex(number as u32));
        let is_touched =
            sets.members.contains_key(root) || track.iter().any(|(image, _)| photos[image.0 as usize].is_fused);
        match moved[part].given.point_errors_px.get(point.0 as usize) {
            Some(error) if !is_touched => *error,
            _ => mean_error(sfm, number, track),
        }
    };
    roots.iter().enumerate().map(error).collect()
}

fn mean_error(sfm: &Reconstruction, number: usize, track: &[(ImageIndex, u32)]) -> f64 {
    let offsets = track.iter().filter_map(|(index, keypoint)| {
        let image = &sfm.images[index.0 as usize];
        let o = &image.observations[*keypoint as usize];
        let [x, y] = sfm.camera_of(*index).project(&image.cam_from_sfm(&sfm.points[number]))?;
        Some((x - o.x_px).hypot(y - o.y_px))
    });
    let (sum, count) = offsets.fold((0.0, 0usize), |(sum, count), off| (sum + off, count + 1));
    if count == 0 { -1.0 } else { sum / count as f64 }
}

/// Rigs and frames, where any part has them: a camera alone has a rig of its own, rigs of several are kept.
fn colmap_parts(moved: &[Moved<'_>], cameras: &Cameras, photos: &[Photo]) -> ColmapParts {
    let is_text = |part: &Moved<'_>| part.given.colmap.as_ref().is_some_and(|c| c.encoding == Encoding::Text);
    let encoding = if moved.iter().all(is_text) { Encoding::Text } else { Encoding::Binary };
    if !moved.iter().any(|part| part.given.colmap.as_ref().is_some_and(|c| c.rigs.is_some())) {
        return ColmapParts { encoding, rigs: None, frames: None };
    }
    let mut rigs = Vec::new();
    let mut rig_of_camera: Vec<Option<u32>> = vec![None; cameras.cameras.len()];
    let mut rig_of: BTreeMap<(usize, u32), u32> = BTreeMap::new();
    for (part, sfm) in moved.iter().map(|m| &m.posed).enumerate() {
        for (camera, index) in cameras.index[part].iter().enumerate() {
            let known = &mut rig_of_camera[*index as usize];
            if cameras.alone[part][camera] && known.is_none() {
                let id = rigs.len() as u32 + 1;
                *known = Some(id);
                let reference = Some(SensorRecord { kind: SENSOR_CAMERA, id: index + 1 });
                rigs.push(RigRecord { id, reference, others: Vec::new() });
            }
        }
        let of_several = sfm.colmap.iter().flat_map(|c| c.rigs.iter().flatten()).filter(|r| !r.others.is_empty());
        for rig in of_several {
            let id = rigs.len() as u32 + 1;
            rig_of.insert((part, rig.id), id);
            let sensor = |s: SensorRecord| renumbered(s, sfm, &cameras.index[part]);
            let others = rig.others.iter().map(|(s, pose)| (sensor(*s), *pose)).collect();
            rigs.push(RigRecord { id, reference: rig.reference.map(sensor), others });
        }
    }
    let frames = frames(moved, cameras, photos, &rig_of_camera, &rig_of);
    ColmapParts { encoding, rigs: Some(rigs), frames: Some(frames) }
}

fn renumbered(sensor: SensorRecord, sfm: &Reconstruction, index: &[u32]) -> SensorRecord {
    let place = sfm.camera_ids.iter().position(|id| *id == sensor.id);
    match place.filter(|_| sensor.kind == SENSOR_CAMERA) {
        Some(place) => SensorRecord { id: index[place] + 1, ..sensor },
        None => sensor,
    }
}

fn frames(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    photos: &[Photo],
    rig_of_camera: &[Option<u32>],
    rig_of: &BTreeMap<(usize, u32), u32>,
) -> Vec<FrameRecord> {
    let mut frames: Vec<FrameRecord> = Vec::new();
    let mut number_of: BTreeMap<(usize, u32), usize> = BTreeMap::new();
    // The frame of every image of a rig, by part and image id.
    let mut frame_of: BTreeMap<(usize, u64), &FrameRecord> = BTreeMap::new();
    for (part, sfm) in moved.iter().map(|m| &m.posed).enumerate() {
        for frame in sfm.colmap.iter().flat_map(|c| c.frames.iter().flatten()) {
            if rig_of.contains_key(&(part, frame.rig_id)) {
                let images = frame.data.iter().filter(|(sensor, _)| sensor.kind == SENSOR_CAMERA);
                frame_of.extend(images.map(|(_, id)| ((part, *id), frame)));
            }
        }
    }
    for (number, photo) in photos.iter().enumerate() {
        let own = moved[photo.part].pose(photo.image);
        let camera = cameras.index[photo.part][own.camera.0 as usize];
        let data = (SensorRecord { kind: SENSOR_CAMERA, id: camera + 1 }, number as u64 + 1);
        let id = frames.len() as u32 + 1;
        match (frame_of.get(&(photo.part, u64::from(own.id))), rig_of_camera[camera as usize]) {
            (Some(frame), _) => {
                let place = *number_of.entry((photo.part, frame.id)).or_insert(frames.len());
                if place == frames.len() {
                    let rig_id = rig_of[&(photo.part, frame.rig_id)];
                    frames.push(FrameRecord { id, rig_id, rig_from_world: frame.rig_from_world, data: Vec::new() });
                }
                frames[place].data.push(data);
            }
            (None, Some(rig_id)) => {
                frames.push(FrameRecord { id, rig_id, rig_from_world: own.pose(), data: vec![data] });
            }
            // A camera of a rig whose image no frame holds: the reader would not have let it pass.
            (None, None) => {}
        }
    }
    frames
}
