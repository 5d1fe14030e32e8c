//! A reconstruction as a structure-from-motion tool left it: cameras, images, points, tracks, in its own frame.

use crate::geometry::{Point3, Rotation3, Vector3};

/// Index into [`Reconstruction::images`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImageIndex(pub u32);

/// Index into [`Reconstruction::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PointIndex(pub u32);

/// Points, and where known the cameras that saw them. A PLY cloud has no images.
#[derive(Clone, Debug, Default)]
pub struct Reconstruction {
    pub images: Vec<Image>,
    /// Sfm frame, sfm units.
    pub points: Vec<Point3<f64>>,
    /// One per point, or empty where the file has none.
    pub colors: Vec<[u8; 3]>,
    /// Unit normals, one per point, or empty where the file has none.
    pub normals: Vec<Vector3<f64>>,
    /// Start of each point's track in `track_elements`, one more than there are points (or empty without images).
    pub track_starts: Vec<u32>,
    /// (image, index of the observation in the image).
    pub track_elements: Vec<(ImageIndex, u32)>,
}

/// A posed photograph.
#[derive(Clone, Debug)]
pub struct Image {
    pub name: String,
    pub cam_from_sfm_rotation: Rotation3<f64>,
    pub cam_from_sfm_translation: Vector3<f64>,
    /// Keypoints: pixel position (x right, y down, the centre of the first pixel is (0.5, 0.5)), and the point seen.
    pub observations: Vec<Observation>,
}

#[derive(Clone, Copy, Debug)]
pub struct Observation {
    pub x_px: f64,
    pub y_px: f64,
    pub point: Option<PointIndex>,
}

impl Image {
    /// Where the camera stood; sfm frame.
    pub fn center(&self) -> Point3<f64> {
        Point3::from(-(self.cam_from_sfm_rotation.inverse() * self.cam_from_sfm_translation))
    }
}

impl Reconstruction {
    /// The observations of a point: (image, index of the observation in the image).
    pub fn track(&self, p: PointIndex) -> &[(ImageIndex, u32)] {
        let starts = self.track_starts.get(p.0 as usize..p.0 as usize + 2);
        starts.map_or(&[], |s| &self.track_elements[s[0] as usize..s[1] as usize])
    }
}
