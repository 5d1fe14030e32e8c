use super::*;

#[test]
fn falls_to_zero_at_the_width() {
    assert_eq!(tukey_weight(0.0, 2.0), 1.0);
    assert_eq!(tukey_weight(1.0, 2.0), 0.5625);
    assert_eq!(tukey_weight(4.0, 2.0), 0.0);
    assert_eq!(tukey_weight(9.0, 2.0), 0.0);
    assert_eq!(truncated_quadratic(1.0, 2.0), 0.75);
    assert_eq!(truncated_quadratic(5.0, 2.0), 0.0);
}

#[test]
fn tukeys_weight_is_the_slope_of_a_loss_that_grows_and_ends() {
    // rho(r) = c^2 / 6 (1 - (1 - r^2 / c^2)^3), whose slope over r is the weight.
    let width = 3.0f64;
    let loss = |r: f64| width * width / 6.0 * (1.0 - (1.0 - (r / width).powi(2)).max(0.0).powi(3));
    for k in 1..400 {
        let r = 0.01 * f64::from(k);
        let slope = (loss(r + 1e-6) - loss(r - 1e-6)) / 2e-6;
        assert!((tukey_weight(r * r, width) - slope / r).abs() < 1e-6, "{r}");
        assert!(loss(r + 0.01) >= loss(r));
    }
}

#[test]
fn both_losses_are_even_in_scale() {
    for factor in [1e-3, 7.0, 1e4] {
        for share in [0.1, 0.5, 0.9, 1.5] {
            let scaled = |loss: fn(f64, f64) -> f64, unit: f64| loss((share * unit).powi(2), unit);
            for loss in [tukey_weight, truncated_quadratic] {
                assert!((scaled(loss, factor) - scaled(loss, 1.0)).abs() < 1e-12);
            }
        }
    }
}
