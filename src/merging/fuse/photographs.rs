//! Photographs of several parts become one each: their keypoints, and the points that these see.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::moved::Moved;
use super::points::PointSets;
use crate::merging::ledger::{DropReason, Ledger};
use crate::merging::limits::MergeLimits;
use crate::merging::shared_photos::PixelMap;
use crate::reconstruction::{ImageIndex, Observation};

/// A photograph of the result.
pub(super) struct Photo {
    pub part: usize,
    pub image: ImageIndex,
    pub keypoints: Vec<Keypoint>,
    pub is_fused: bool,
}

/// A keypoint of the result.
pub(super) struct Keypoint {
    pub x_px: f64,
    pub y_px: f64,
    /// The key of the point seen.
    pub key: Option<u32>,
}

/// A photograph as one part has it.
type Version = (usize, ImageIndex);

/// What photographs are fused with.
pub(super) struct PhotoFuser<'a, 'b> {
    pub moved: &'a [Moved<'a>],
    pub sets: &'b mut PointSets<'a>,
    pub ledger: &'b mut Ledger,
    pub limits: &'a MergeLimits,
}

impl PhotoFuser<'_, '_> {
    /// Every photograph once; a point is seen once in each.
    pub fn photos(&mut self) -> Vec<Photo> {
        let mut photos: Vec<Photo> =
            self.versions().into_iter().map(|versions| self.fuse_versions(&versions)).collect();
        photos.iter_mut().filter(|p| p.is_fused).for_each(|photo| self.unlink_seconds(photo));
        photos
    }

    /// The versions of each photograph, by name. The one that sees most points has the better pose and comes first; of equals the first
    /// stays. A name that a part has twice counts as one only the first time.
    fn versions(&self) -> Vec<Vec<Version>> {
        let mut groups: BTreeMap<(&str, usize), Vec<Version>> = BTreeMap::new();
        for (part, sfm) in self.moved.iter().map(|m| m.given).enumerate() {
            let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
            for (index, image) in sfm.images.iter().enumerate() {
                let times = seen.entry(&image.name).or_default();
                groups.entry((&image.name, *times)).or_default().push((part, ImageIndex(index as u32)));
                *times += 1;
            }
        }
        let support =
            |(part, image): &Version| self.moved[*part].keypoints(*image).iter().filter(|o| o.point.is_some()).count();
        let mut versions: Vec<Vec<Version>> = groups.into_values().collect();
        versions.iter_mut().for_each(|group| group.sort_by_key(|v| std::cmp::Reverse(support(v))));
        versions
    }

    fn fuse_versions(&mut self, versions: &[Version]) -> Photo {
        self.ledger.images.kept += 1;
        self.ledger.images.fused += versions.len() - 1;
        let (part, image) = versions[0];
        let keypoint =
            |o: &Observation| Keypoint { x_px: o.x_px, y_px: o.y_px, key: o.point.map(|p| self.sets.key(part, p)) };
        let keypoints = self.moved[part].keypoints(image).iter().map(keypoint).collect();
        let mut photo = Photo { part, image, keypoints, is_fused: versions.len() > 1 };
        versions[1..].iter().for_each(|version| self.add_version(&mut photo, *version));
        photo
    }

    fn add_version(&mut self, photo: &mut Photo, (other, image): Version) {
        let (given, theirs) = (self.moved[photo.part].given, self.moved[other].keypoints(image));
        let pixels = PixelMap::of([given, self.moved[other].given], [photo.image, image], &self.limits.keypoints);
        let ours: Vec<Observation> =
            photo.keypoints.iter().map(|k| Observation { x_px: k.x_px, y_px: k.y_px, point: None }).collect();
        let mut partner = vec![None; theirs.len()];
        for (i, j) in pixels.same_keypoints(&ours, theirs, &|_| true) {
            partner[j as usize] = Some(i as usize);
        }
        for (o, partner) in theirs.iter().zip(partner) {
            let [x_px, y_px] = pixels.carried(o);
            let key = o.point.map(|p| self.sets.key(other, p)).filter(|key| self.stays(photo, *key, [x_px, y_px]));
            match (partner, key) {
                (Some(i), Some(key)) => match photo.keypoints[i].key {
                    None => photo.keypoints[i].key = Some(key),
                    Some(known) if self.sets.join(known, key) => self.ledger.observations.fused += 1,
                    Some(_) => photo.keypoints.push(Keypoint { x_px, y_px, key: Some(key) }),
                },
                (Some(_), None) => {}
                (None, key) => photo.keypoints.push(Keypoint { x_px, y_px, key }),
            }
        }
    }

    /// True where the photograph's pose and camera, which come from another part, show the point near its keypoint.
    fn stays(&mut self, photo: &Photo, key: u32, [x_px, y_px]: [f64; 2]) -> bool {
        let (part, point) = self.sets.part_of(key);
        let camera = self.moved[photo.part].given.camera_of(photo.image);
        let pose = self.moved[photo.part].pose(photo.image);
        let Some([x, y]) = camera.project(&pose.cam_from_sfm(&self.moved[part].point(point))) else {
            self.ledger.observations.drop(DropReason::BehindCamera, 1);
            return false;
        };
        let off_px = (x - x_px).hypot(y - y_px);
        let near = off_px <= self.limits.fuse.far_from_keypoint_share * camera.width_px as f64;
        if !near {
            self.ledger.observations.drop(DropReason::FarFromKeypoint, 1);
        }
        near
    }

    /// A point is seen once in a photograph: its first keypoint stays. Another one at the same pixel is the same observation again.
    fn unlink_seconds(&mut self, photo: &mut Photo) {
        let given = self.moved[photo.part].given;
        let tolerance = PixelMap::of([given; 2], [photo.image; 2], &self.limits.keypoints).tolerance;
        let mut first: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        for Keypoint { x_px, y_px, key } in &mut photo.keypoints {
            let Some(root) = key.map(|k| self.sets.root(k)) else { continue };
            let (x, y) = match first.entry(root) {
                Entry::Vacant(place) => {
                    place.insert((*x_px, *y_px));
                    continue;
                }
                Entry::Occupied(place) => *place.get(),
            };
            *key = None;
            if (*x_px - x).hypot(*y_px - y) <= tolerance {
                self.ledger.observations.fused += 1;
            } else {
                self.ledger.observations.drop(DropReason::SecondKeypoint, 1);
            }
        }
    }
}
