//! Reconstructions of Bundler: `bundle.out` of version 0.3, with the list of photographs that was given to it
//! (<https://www.cs.cornell.edu/~snavely/bundler/bundler-v0.4-manual.html>), as they stand.

use std::path::Path;

use super::sfm_file::{Fault, SfmFileError, Tokens, bytes_of};

const FORMAT: &str = "Bundler v0.3";

#[derive(Clone, Debug, Default, PartialEq)]
pub struct BundlerModel {
    /// In the order of the list; those that were not placed have a focal length of zero.
    pub cameras: Vec<BundlerCamera>,
    pub points: Vec<BundlerPoint>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BundlerCamera {
    pub focal_px: f64,
    pub radial: [f64; 2],
    /// World to camera, row by row; the camera looks along -z, y up.
    pub rotation: [f64; 9],
    pub translation: [f64; 3],
}

#[derive(Clone, Debug, PartialEq)]
pub struct BundlerPoint {
    pub position: [f64; 3],
    pub color: [f64; 3],
    /// Camera, and pixels right and up from the middle of the picture.
    pub views: Vec<(usize, [f64; 2])>,
}

pub fn is_bundler(start: &[u8]) -> bool {
    start.starts_with(b"# Bundle file")
}

pub fn read_bundler(path: &Path) -> Result<BundlerModel, SfmFileError> {
    parse(&bytes_of(path)?).map_err(|fault| fault.in_file(path, FORMAT))
}

/// The names in a list of photographs: the first word of each line.
pub fn read_bundler_list(path: &Path) -> Result<Vec<String>, SfmFileError> {
    let bytes = bytes_of(path)?;
    let lines = bytes.split(|b| *b == b'\n').map(|line| String::from_utf8_lossy(line.trim_ascii()).into_owned());
    Ok(lines.filter_map(|line| line.split_ascii_whitespace().next().map(str::to_owned)).collect())
}

/// Bytes of the shortest camera, point and view, with a blank after each value.
const CAMERA_BYTES: usize = 30;
const POINT_BYTES: usize = 14;
const VIEW_BYTES: usize = 8;

fn parse(bytes: &[u8]) -> Result<BundlerModel, Fault> {
    let mut tokens = Tokens::new(bytes);
    let head = tokens.line();
    if head.strip_prefix(b"# Bundle file v").is_none_or(|version| !version.starts_with(b"0.3")) {
        return Err(tokens.fault("a first line `# Bundle file v0.3`", head));
    }
    let mut model = BundlerModel::default();
    let cameras = tokens.counted("cameras", CAMERA_BYTES)?;
    let points = tokens.counted("points", POINT_BYTES)?;
    for _ in 0..cameras {
        let [focal_px, k1, k2] = tokens.numbers("a focal length and two coefficients of distortion")?;
        let rotation = tokens.numbers("a rotation of nine numbers")?;
        let translation = tokens.numbers("a translation")?;
        model.cameras.push(BundlerCamera { focal_px, radial: [k1, k2], rotation, translation });
    }
    for _ in 0..points {
        model.points.push(point(&mut tokens, cameras)?);
    }
    match tokens.token() {
        [] => Ok(model),
        token => Err(tokens.fault("the end of the file after the last point", token)),
    }
}

fn point(tokens: &mut Tokens, cameras: usize) -> Result<BundlerPoint, Fault> {
    let position = tokens.numbers("a point X Y Z")?;
    let color = tokens.numbers("a colour R G B")?;
    let count = tokens.counted("views", VIEW_BYTES)?;
    let mut views = Vec::with_capacity(count);
    for _ in 0..count {
        let camera = tokens.count("a view's camera")?;
        if camera >= cameras {
            return Err(tokens.fault(&format!("one of the {cameras} cameras"), camera.to_string().as_bytes()));
        }
        tokens.number("a view's key")?;
        views.push((camera, tokens.numbers("a view's place X Y")?));
    }
    Ok(BundlerPoint { position, color, views })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "# Bundle file v0.3\n2 1\n500 -0.1 0.01\n1 0 0\n0 1 0\n0 0 1\n0.5 0 -3\n\
        0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n1 2 -3\n255 128 0\n1 0 17 -3.5 40.25\n";

    #[test]
    fn cameras_points_and_views_are_read() {
        let model = parse(FILE.as_bytes()).unwrap();
        assert_eq!((model.cameras[0].focal_px, model.cameras[0].radial), (500.0, [-0.1, 0.01]));
        assert_eq!((model.cameras[0].translation, model.cameras[1].focal_px), ([0.5, 0.0, -3.0], 0.0));
        assert_eq!(model.points[0].views, [(0, [-3.5, 40.25])]);
    }

    #[test]
    fn names_stand_first_in_the_lines_of_a_list() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "./a.jpg 0 660.8\r\n\nsub/b.jpg\n").unwrap();
        assert_eq!(read_bundler_list(file.path()).unwrap(), ["./a.jpg", "sub/b.jpg"]);
    }

    #[test]
    fn counts_that_lie_other_versions_and_rests_are_refused() {
        for (from, to, what) in [
            ("\n2 1\n", "\n4000000000 1\n", "at most"),
            ("\n2 1\n", "\n2 4000000000\n", "at most"),
            ("1 0 17", "4000000000 0 17", "at most"),
            ("1 0 17", "1 2 17", "one of the 2 cameras"),
            ("v0.3", "v0.1", "v0.3"),
            ("40.25\n", "40.25 7\n", "the end of the file"),
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
