//! The sample that is inside the program.

use crate::export::UnpackedFile;

/// Where the sample lies in the output: whoever wants to go on finds the form of every input there.
pub const SAMPLE_FOLDER: &str = "sample";

macro_rules! sample {
    ($($path:literal),* $(,)?) => {
        &[$((concat!("sample/", $path), include_bytes!(concat!("../../assets/sample/", $path)))),*]
    };
}

/// By their paths in the output: a part of Delfshaven in Rotterdam, its reconstruction from 24 photographs, their
/// superpixels, and a coarse start.
pub const SAMPLE: &[UnpackedFile] = sample![
    "LICENSE.txt",
    "city.obj",
    "start.json",
    "sfm/cameras.txt",
    "sfm/frames.txt",
    "sfm/images.txt",
    "sfm/points3D.txt",
    "sfm/rigs.txt",
    "labels/p001.png",
    "labels/p002.png",
    "labels/p003.png",
    "labels/p004.png",
    "labels/p005.png",
    "labels/p006.png",
    "labels/p007.png",
    "labels/p008.png",
    "labels/p009.png",
    "labels/p010.png",
    "labels/p011.png",
    "labels/p012.png",
    "labels/p013.png",
    "labels/p014.png",
    "labels/p015.png",
    "labels/p016.png",
    "labels/p017.png",
    "labels/p018.png",
    "labels/p019.png",
    "labels/p020.png",
    "labels/p021.png",
    "labels/p022.png",
    "labels/p023.png",
    "labels/p024.png",
    "photos/p001.jpg",
    "photos/p007.jpg",
    "photos/p013.jpg",
    "photos/p019.jpg",
];
