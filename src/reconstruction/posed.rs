//! Cameras, photographs and points of formats that number them from zero, as one reconstruction.

use super::{
    CameraIndex, Image, ImageIndex, Observation, PointIndex, Reconstruction, ReconstructionWarning, SfmFormat,
    WarningKind,
};
use crate::geometry::{Camera, Point3, Rotation3, Vector3};

/// A reconstruction as most formats tell it; ids are given from 1 on.
#[derive(Default)]
pub(super) struct Posed {
    pub cameras: Vec<Camera>,
    pub images: Vec<PosedImage>,
    pub points: Vec<PosedPoint>,
}

pub(super) struct PosedImage {
    pub name: String,
    /// Index into the cameras.
    pub camera: usize,
    pub cam_from_sfm_rotation: Rotation3<f64>,
    pub cam_from_sfm_translation: Vector3<f64>,
}

impl PosedImage {
    /// Whether it stands anywhere: numbers of a file that are finite need not be so when they were multiplied.
    pub fn is_placed(&self) -> bool {
        let (rotation, translation) = (self.cam_from_sfm_rotation.matrix(), self.cam_from_sfm_translation);
        rotation.iter().chain(translation.iter()).all(|v| v.is_finite())
    }
}

pub(super) struct PosedPoint {
    pub position: [f64; 3],
    pub color: [u8; 3],
    /// Index into the images, and where the point appears in it, pixels.
    pub track: Vec<(usize, [f64; 2])>,
}

impl Posed {
    /// Index of a camera among those that there are already, or of a new one.
    pub fn camera(&mut self, camera: Camera) -> usize {
        match self.cameras.iter().position(|known| *known == camera) {
            Some(known) => known,
            None => {
                self.cameras.push(camera);
                self.cameras.len() - 1
            }
        }
    }

    /// Points without a finite position, and observations that are not finite, are left out and counted.
    pub fn into_reconstruction(self, format: SfmFormat, mut warnings: Vec<ReconstructionWarning>) -> Reconstruction {
        let image = |(index, image): (usize, PosedImage)| Image {
            id: index as u32 + 1,
            camera: CameraIndex(image.camera as u32),
            name: image.name,
            cam_from_sfm_rotation: image.cam_from_sfm_rotation,
            cam_from_sfm_translation: image.cam_from_sfm_translation,
            ..Image::default()
        };
        let mut r = Reconstruction {
            format,
            camera_ids: (1..=self.cameras.len() as u32).collect(),
            cameras: self.cameras,
            images: self.images.into_iter().enumerate().map(image).collect(),
            ..Reconstruction::default()
        };
        let has_tracks = self.points.iter().any(|point| !point.track.is_empty());
        if has_tracks {
            r.track_starts.push(0);
        }
        let (mut lost, mut first_lost) = (0, 0);
        for (number, point) in self.points.into_iter().enumerate() {
            if !point.position.iter().all(|v| v.is_finite()) {
                first_lost = if lost == 0 { number } else { first_lost };
                lost += 1;
                continue;
            }
            add_point(&mut r, point);
            if has_tracks {
                r.track_starts.push(r.track_elements.len() as u32);
            }
        }
        if lost > 0 {
            let (kind, example) = (WarningKind::PointsWithoutPosition, format!("point {first_lost}"));
            warnings.push(ReconstructionWarning { kind, count: lost, example });
        }
        r.warnings = warnings;
        r
    }
}

fn add_point(r: &mut Reconstruction, point: PosedPoint) {
    let index = PointIndex(r.points.len() as u32);
    r.points.push(Point3::from(point.position));
    r.point_ids.push(u64::from(index.0) + 1);
    r.colors.push(point.color);
    for (image, [x_px, y_px]) in point.track {
        if x_px.is_finite() && y_px.is_finite() {
            let observations = &mut r.images[image].observations;
            r.track_elements.push((ImageIndex(image as u32), observations.len() as u32));
            observations.push(Observation { x_px, y_px, point: Some(index) });
        }
    }
}

/// How far a matrix of a file may be from a rotation, in any of its numbers: text of few digits.
const ROTATION_TOLERANCE: f64 = 1e-2;

/// The rotation that a matrix of a file is, but for its last digits.
pub(super) fn rotation(rows: &[[f64; 3]; 3]) -> Option<Rotation3<f64>> {
    let matrix = crate::geometry::Matrix3::from_fn(|i, j| rows[i][j]);
    if !matrix.iter().all(|v| v.is_finite() && v.abs() < 2.0) {
        return None;
    }
    let rotation = crate::geometry::nearest_rotation(&matrix)?;
    ((rotation.matrix() - matrix).amax() <= ROTATION_TOLERANCE).then_some(rotation)
}

/// A camera whose numbers make one: finite, with a focal length above zero.
pub(super) fn usable(camera: Camera) -> Option<Camera> {
    let is_finite = camera.params.iter().all(|v| v.is_finite());
    let has_focal_length = camera.focal_px().is_some_and(|focal_px| focal_px > 0.0 && focal_px.is_finite());
    (is_finite && has_focal_length && camera.width_px > 0 && camera.height_px > 0).then_some(camera)
}

/// A colour of a file that writes 0 to 255 as any numbers.
pub(super) fn color(values: [f64; 3]) -> [u8; 3] {
    // The cast holds values outside within 0 to 255.
    values.map(|value| value.round() as u8)
}

/// Adds up what happened several times, with the first case.
pub(super) fn warn(warnings: &mut Vec<ReconstructionWarning>, kind: WarningKind, example: impl FnOnce() -> String) {
    match warnings.iter_mut().find(|warning| warning.kind == kind) {
        Some(warning) => warning.count += 1,
        None => warnings.push(ReconstructionWarning { kind, count: 1, example: example() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::CameraModel;

    /// What reading a file of this name and content ends with.
    fn read(name: &str, content: &str) -> Result<Reconstruction, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), content).unwrap();
        std::fs::write(folder.path().join("p.ply"), PLY).unwrap();
        crate::reconstruction::read_reconstruction(&folder.path().join(name)).map_err(|error| error.to_string())
    }

    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n\
                       end_header\n1e308 2 3\n";

    #[test]
    fn numbers_that_are_finite_until_they_are_multiplied_are_no_pose() {
        let opensfm = |turn: &str| {
            format!(
                r#"[{{"cameras": {{"c": {{"projection_type": "perspective", "width": 4, "height": 3, "focal": 1}}}},
                "shots": {{"a.jpg": {{"rotation": [{turn}, {turn}, 0], "translation": [0, 0, 0], "camera": "c"}}}},
                "points": {{"1": {{"coordinates": [0, 0, 9], "color": [1, 2, 3]}}}}}}]"#
            )
        };
        assert_eq!(read("r.json", &opensfm("0.1")).unwrap().images.len(), 1);
        let r = read("r.json", &opensfm("1e300")).unwrap();
        assert!(r.images.is_empty() && r.warnings[0].kind == WarningKind::ImagesWithoutPose, "{:?}", r.warnings);
        let nerfstudio = |place: &str, scale: &str, ply: &str| {
            format!(
                r#"{{"w": 4, "h": 3, "fl_x": 4, "applied_scale": {scale}, {ply} "frames": [{{"file_path": "a.jpg",
                "transform_matrix": [[0.6, 0.8, 0, {place}], [-0.8, 0.6, 0, {place}], [0, 0, 1, 0], [0, 0, 0, 1]]}}]}}"#
            )
        };
        assert!(read("t.json", &nerfstudio("7", "1", "")).is_ok());
        let message = read("t.json", &nerfstudio("1.7e308", "1", "")).unwrap_err();
        assert!(message.contains("frame a.jpg: expected a rotation and a finite place"), "{message}");
        let message = read("t.json", &nerfstudio("7", "1e-9", r#""ply_file_path": "p.ply","#)).unwrap_err();
        assert!(message.contains("p.ply, point 0: expected a finite place"), "{message}");
        let bundler = |place: &str| {
            format!("# Bundle file v0.3\n1 1\n500 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 {place}\n0 0 -3\n1 2 3\n1 0 0 4 4\n")
        };
        assert!(read("b.out", &bundler("1")).is_ok());
        assert!(read("b.out", &bundler("1e999")).is_err());
    }

    fn image(name: &str) -> PosedImage {
        let (cam_from_sfm_rotation, cam_from_sfm_translation) = (Rotation3::identity(), Vector3::zeros());
        PosedImage { name: name.into(), camera: 0, cam_from_sfm_rotation, cam_from_sfm_translation }
    }

    fn point(x: f64, track: Vec<(usize, [f64; 2])>) -> PosedPoint {
        PosedPoint { position: [x, 0.0, 5.0], color: [1, 2, 3], track }
    }

    #[test]
    fn ids_and_tracks_are_made_for_what_is_there() {
        let camera =
            Camera { model: CameraModel::SimplePinhole, width_px: 4, height_px: 4, params: vec![2.0, 2.0, 2.0] };
        let mut posed = Posed { images: vec![image("a"), image("b")], ..Posed::default() };
        assert_eq!((posed.camera(camera.clone()), posed.camera(camera)), (0, 0));
        posed.points = vec![
            point(1.0, vec![(1, [1.0, 2.0])]),
            point(f64::NAN, vec![(0, [0.0, 0.0])]),
            point(2.0, vec![(0, [3.0, f64::NAN]), (1, [3.0, 4.0]), (0, [5.0, 6.0])]),
        ];
        let r = posed.into_reconstruction(SfmFormat::Nvm, Vec::new());
        assert_eq!((r.point_ids.as_slice(), r.track_starts.as_slice()), ([1, 2].as_slice(), [0, 1, 3].as_slice()));
        assert_eq!(r.track(PointIndex(1)), [(ImageIndex(1), 1), (ImageIndex(0), 0)]);
        assert_eq!(r.images[1].observations[1].point, Some(PointIndex(1)));
        assert_eq!((r.warnings[0].kind, r.warnings[0].count), (WarningKind::PointsWithoutPosition, 1));
        assert!(r.warnings[0].to_string().contains("point 1"));
    }

    #[test]
    fn a_matrix_that_is_no_rotation_is_refused() {
        let turn = Rotation3::from_euler_angles(0.1, 0.2, 0.3);
        let rows = |scale: f64| std::array::from_fn(|i| std::array::from_fn(|j| scale * turn[(i, j)]));
        assert!(rotation(&rows(1.0)).unwrap().angle_to(&turn) < 1e-12);
        assert!(rotation(&rows(1.0001)).is_some() && rotation(&rows(1.1)).is_none() && rotation(&rows(-1.0)).is_none());
        assert!(rotation(&[[0.0; 3]; 3]).is_none() && rotation(&[[f64::NAN; 3]; 3]).is_none());
        assert!(rotation(&[[1e300; 3]; 3]).is_none());
    }
}
