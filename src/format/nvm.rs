//! Reconstructions of VisualSFM: NVM files (<http://ccwu.me/vsfm/doc.html>), as they stand.

use std::path::Path;

use super::sfm_file::{Fault, SfmFileError, Tokens, bytes_of};

const FORMAT: &str = "NVM_V3";

/// The first (and largest) model of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NvmModel {
    /// fx, cx, fy, cy of all cameras, pixels, where the calibration was given.
    pub fixed_calibration: Option<[f64; 4]>,
    pub cameras: Vec<NvmCamera>,
    pub points: Vec<NvmPoint>,
    /// Further models of the file, not read.
    pub further_models: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NvmCamera {
    pub name: String,
    pub focal_px: f64,
    /// World to camera.
    pub quaternion_wxyz: [f64; 4],
    pub center: [f64; 3],
    /// Of the square of the distance from the axis, as VisualSFM counts it.
    pub distortion: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NvmPoint {
    pub position: [f64; 3],
    pub color: [f64; 3],
    /// Camera, and pixels right and down, from the middle or the corner of the picture.
    pub measurements: Vec<(usize, [f64; 2])>,
}

pub fn is_nvm(start: &[u8]) -> bool {
    start.starts_with(b"NVM_V3")
}

pub fn read_nvm(path: &Path) -> Result<NvmModel, SfmFileError> {
    parse(&bytes_of(path)?).map_err(|fault| fault.in_file(path, FORMAT))
}

/// Bytes of the shortest camera, point and measurement, with a blank after each value.
const CAMERA_BYTES: usize = 22;
const POINT_BYTES: usize = 14;
const MEASUREMENT_BYTES: usize = 8;

fn parse(bytes: &[u8]) -> Result<NvmModel, Fault> {
    let mut tokens = Tokens::new(bytes);
    let head = tokens.line();
    let mut model = NvmModel { fixed_calibration: fixed_calibration(head)?, ..NvmModel::default() };
    for _ in 0..tokens.counted("cameras", CAMERA_BYTES)? {
        model.cameras.push(camera(&mut tokens)?);
    }
    for _ in 0..tokens.counted("points", POINT_BYTES)? {
        model.points.push(point(&mut tokens, model.cameras.len())?);
    }
    // What follows are further models, up to one of no cameras, and comments.
    model.further_models = further_models(&mut tokens);
    Ok(model)
}

fn fixed_calibration(head: &[u8]) -> Result<Option<[f64; 4]>, Fault> {
    let mut words = Tokens::new(head);
    match (words.token(), words.token()) {
        (b"NVM_V3", b"") => Ok(None),
        (b"NVM_V3", b"FixedK") => words.numbers("the calibration fx cx fy cy after FixedK").map(Some),
        (first, second) => {
            let got = String::from_utf8_lossy(&[first, b" ", second].concat()).into_owned();
            let expected =
                "a first line `NVM_V3`, or with `FixedK` and the calibration (VisualSFM's own poses as quaternions)";
            Err(Fault::new("line 1", expected, format!("`{}`", super::escaped(got.trim()))))
        }
    }
}

fn camera(tokens: &mut Tokens) -> Result<NvmCamera, Fault> {
    // VisualSFM writes quotation marks for blanks within names.
    let name = tokens.name("the name of a photograph")?.replace('"', " ");
    let focal_px = tokens.number("a focal length")?;
    let quaternion_wxyz = tokens.numbers("a quaternion W X Y Z")?;
    let center = tokens.numbers("a camera's centre X Y Z")?;
    let [distortion, _zero] = tokens.numbers("a radial distortion and a zero")?;
    Ok(NvmCamera { name, focal_px, quaternion_wxyz, center, distortion })
}

fn point(tokens: &mut Tokens, cameras: usize) -> Result<NvmPoint, Fault> {
    let position = tokens.numbers("a point X Y Z")?;
    let color = tokens.numbers("a colour R G B")?;
    let count = tokens.counted("measurements", MEASUREMENT_BYTES)?;
    let mut measurements = Vec::with_capacity(count);
    for _ in 0..count {
        let camera = tokens.count("a measurement's camera")?;
        if camera >= cameras {
            return Err(tokens.fault(&format!("one of the {cameras} cameras"), camera.to_string().as_bytes()));
        }
        tokens.number("a measurement's feature")?;
        measurements.push((camera, tokens.numbers("a measurement X Y")?));
    }
    Ok(NvmPoint { position, color, measurements })
}

fn further_models(tokens: &mut Tokens) -> usize {
    let mut found = 0;
    while let Ok(cameras) = tokens.counted("cameras", CAMERA_BYTES) {
        if cameras == 0 {
            break;
        }
        let is_whole = (0..cameras).all(|_| camera(tokens).is_ok())
            && tokens
                .counted("points", POINT_BYTES)
                .is_ok_and(|points| (0..points).all(|_| point(tokens, cameras).is_ok()));
        found += 1;
        if !is_whole {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "NVM_V3 \n\n2\na\"b.jpg 500 1 0 0 0 0 0 0 -0.1 0\nc.jpg 510 0.9 0 0.1 0 1 2 3 0 0\n\n\
        1\n0.5 -0.5 4 255 128 0 2 0 17 320.5 240 1 4 -3 7.25\n\n";

    #[test]
    fn cameras_points_and_measurements_are_read() {
        let model = parse(FILE.as_bytes()).unwrap();
        assert_eq!(model.cameras[0].name, "a b.jpg");
        assert_eq!((model.cameras[1].focal_px, model.cameras[1].center), (510.0, [1.0, 2.0, 3.0]));
        assert_eq!(model.points[0].measurements, [(0, [320.5, 240.0]), (1, [-3.0, 7.25])]);
        assert_eq!((model.further_models, model.fixed_calibration), (0, None));
    }

    #[test]
    fn a_calibration_that_was_given_and_further_models_are_told() {
        let second = FILE.replace("NVM_V3 \n\n", "");
        let model =
            parse(format!("{}{second}0\n#comment", FILE.replace("V3 ", "V3 FixedK 500 320 501 240")).as_bytes());
        let model = model.unwrap();
        assert_eq!((model.further_models, model.fixed_calibration), (1, Some([500.0, 320.0, 501.0, 240.0])));
    }

    #[test]
    fn counts_that_lie_and_cameras_that_are_not_there_are_refused() {
        for (from, to, what) in [
            ("\n\n2\n", "\n\n4000000000\n", "at most"),
            ("0 2 0 17", "0 4000000000 0 17", "at most"),
            ("1 4 -3", "2 4 -3", "one of the 2 cameras"),
            ("NVM_V3 ", "NVM_V3_R9T ", "NVM_V3_R9T"),
        ] {
            let fault = parse(FILE.replace(from, to).as_bytes()).unwrap_err();
            assert!(format!("{} {}", fault.expected, fault.got).contains(what), "{to}: {fault:?}");
        }
    }

    #[test]
    fn cut_and_changed_files_never_panic() {
        for cut in 0..FILE.len() {
            let _ = parse(&FILE.as_bytes()[..cut]);
            for value in *b"\0-9. \nx" {
                let mut changed = FILE.as_bytes().to_vec();
                changed[cut] = value;
                let _ = parse(&changed);
            }
        }
    }
}
