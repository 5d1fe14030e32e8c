use super::*;

#[test]
fn white_black_and_red_have_their_cielab_values() {
    let lab = |rgb| LabImage::of(&RgbImage::from_pixel(3, 2, image::Rgb(rgb))).pixel(4);
    // CIE 15 for sRGB's primaries under D65.
    for (rgb, expected) in
        [([255, 255, 255], [100.0, 0.0, 0.0]), ([0, 0, 0], [0.0, 0.0, 0.0]), ([255, 0, 0], [53.24, 80.09, 67.20])]
    {
        assert!(distance(&lab(rgb), &expected) < 0.1, "{rgb:?}: {:?}", lab(rgb));
    }
}

#[test]
fn a_large_photograph_is_scaled_down_in_its_shape() {
    let image = LabImage::of(&RgbImage::new(4000, 1000));
    assert_eq!((image.width, image.height), (2000, 500));
}

#[test]
fn every_grey_has_the_lightness_of_its_luminance() {
    for value in 0..=255u8 {
        let [l, a, b] = LabImage::of(&RgbImage::from_pixel(2, 2, image::Rgb([value; 3]))).pixel(0);
        let luminance = f64::from(linear(value.into()));
        let dark = luminance <= 216.0 / 24_389.0;
        let expected = if dark { luminance * 24_389.0 / 27.0 } else { 116.0 * luminance.cbrt() - 16.0 };
        assert!((f64::from(l) - expected).abs() < 2e-3 && a.abs() < 0.02 && b.abs() < 0.02, "{value}: {l} {a} {b}");
    }
}

#[test]
fn smoothing_blends_neighbours_and_counts_the_border_twice() {
    let white = |x: u32, y: u32| if (x, y) == (0, 0) { [255; 3] } else { [0; 3] };
    let image = LabImage::of(&RgbImage::from_fn(4, 3, |x, y| image::Rgb(white(x, y))));
    let l: Vec<f32> = image.channels[0].iter().map(|l| l / 100.0).collect();
    let across = [0.75, 0.25, 0.0, 0.0];
    for (y, down) in [0.75, 0.25, 0.0].into_iter().enumerate() {
        for (x, across) in across.into_iter().enumerate() {
            assert!((l[y * 4 + x] - across * down).abs() < 1e-4, "{l:?}");
        }
    }
}

/// By the formulas of CIE 15 in double precision.
fn reference([r, g, b]: [u8; 3]) -> [f64; 3] {
    let linear = |v: u8| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    let [r, g, b] = [r, g, b].map(linear);
    let xyz = [
        (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47,
        0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b,
        (0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83,
    ];
    let root = |t: f64| if t > 216.0 / 24_389.0 { t.cbrt() } else { 841.0 / 108.0 * t + 4.0 / 29.0 };
    let [x, y, z] = xyz.map(root);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[test]
fn every_colour_is_that_of_the_standard() {
    for r in (0..=255).step_by(15) {
        for g in (0..=255).step_by(15) {
            for b in (0..=255).step_by(15) {
                let rgb = [r as u8, g as u8, b as u8];
                let found = LabImage::of(&RgbImage::from_pixel(1, 1, image::Rgb(rgb))).pixel(0);
                for (found, expected) in found.iter().zip(reference(rgb)) {
                    assert!((f64::from(*found) - expected).abs() < 0.06, "{rgb:?}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn smoothing_keeps_an_even_picture_and_the_mean_of_any_other() {
    let even = LabImage::of(&RgbImage::from_pixel(9, 7, image::Rgb([120, 60, 200])));
    assert!((0..63).all(|at| distance(&even.pixel(at), &even.pixel(0)) < 1e-4));
    let photo = RgbImage::from_fn(40, 30, |x, y| image::Rgb([(x * 6) as u8, (y * 8) as u8, ((x * y) % 256) as u8]));
    let (plain, smooth) = (converted(&photo), smoothed(converted(&photo)));
    for (before, after) in plain.channels.iter().zip(&smooth.channels) {
        let mean = |values: &[f32]| values.iter().map(|v| f64::from(*v)).sum::<f64>() / 1200.0;
        assert!((mean(before) - mean(after)).abs() < 1e-3);
        let rough = |values: &[f32]| values.windows(2).map(|two| f64::from(two[1] - two[0]).abs()).sum::<f64>();
        assert!(rough(after) < rough(before));
    }
}
