//! The camera models, with COLMAP's numbers for them.

/// Every model of COLMAP 4.2, in the order of its ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraModel {
    SimplePinhole,
    Pinhole,
    SimpleRadial,
    Radial,
    Opencv,
    OpencvFisheye,
    FullOpencv,
    Fov,
    SimpleRadialFisheye,
    RadialFisheye,
    ThinPrismFisheye,
    RadTanThinPrismFisheye,
    SimpleDivision,
    Division,
    SimpleFisheye,
    Fisheye,
    Eucm,
    Equirectangular,
}

impl CameraModel {
    #[rustfmt::skip]
    pub const ALL: [CameraModel; 18] = [
        CameraModel::SimplePinhole, CameraModel::Pinhole, CameraModel::SimpleRadial, CameraModel::Radial,
        CameraModel::Opencv, CameraModel::OpencvFisheye, CameraModel::FullOpencv, CameraModel::Fov,
        CameraModel::SimpleRadialFisheye, CameraModel::RadialFisheye, CameraModel::ThinPrismFisheye,
        CameraModel::RadTanThinPrismFisheye, CameraModel::SimpleDivision, CameraModel::Division,
        CameraModel::SimpleFisheye, CameraModel::Fisheye, CameraModel::Eucm, CameraModel::Equirectangular,
    ];

    /// COLMAP's number for the model: its place in [`CameraModel::ALL`].
    pub fn colmap_id(self) -> i32 {
        self as i32
    }

    pub fn from_colmap_id(id: i32) -> Option<CameraModel> {
        CameraModel::ALL.get(usize::try_from(id).ok()?).copied()
    }
}
