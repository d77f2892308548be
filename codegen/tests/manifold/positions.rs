//! ⊕, ⊖, unit length.

use gelenk_kernels::manifold::{difference, integrate, neutral, normalize};

use super::random::{Random, distance};

const WIDTHS: [usize; 4] = [1, 4, 7, 1];

fn state(random: &mut Random) -> [f64; 13] {
    let (q, pose) = (random.quaternion(), random.pose());
    let mut y = [0.3; 13];
    y[1..5].copy_from_slice(&q);
    y[5..12].copy_from_slice(&pose);
    y
}

fn displacement(random: &mut Random, angle: f64) -> [f64; 11] {
    let mut d: [f64; 11] = random.vector(1.0);
    d[1..4].copy_from_slice(&random.direction(angle));
    d[7..10].copy_from_slice(&random.direction(angle));
    d
}

fn length(q: &[f64]) -> f64 {
    // Summed in two parts, so that the sum itself is exact to a unit in the last place.
    let [a, b] = [q[0].mul_add(q[0], q[1] * q[1]), q[2].mul_add(q[2], q[3] * q[3])];
    (a + b).sqrt()
}

#[test]
fn differences_undo_integration_up_to_half_a_turn() {
    let mut random = Random(1);
    let pi = std::f64::consts::PI;
    let angles = [0.0, 1e-300, 1e-170, 1e-20, 1e-9, 1e-4, 0.1, 0.8, 1.5, 2.2, 3.0, pi - 1e-7, pi - 1e-12];
    for angle in angles {
        for _ in 0..50 {
            let (y, d) = (state(&mut random), displacement(&mut random, angle));
            let mut next = integrate(&WIDTHS, &y, &d);
            let found: [f64; 11] = difference(&WIDTHS, &y, &next);
            // Near half a turn the factor that takes a way back is 1/π², which costs no digit.
            assert!(distance(&found, &d) <= 5e-15, "{angle}: {found:?} is not {d:?}");
            next[1..5].iter_mut().for_each(|entry| *entry = -*entry);
            next[8..12].iter_mut().for_each(|entry| *entry = -*entry);
            let opposite: [f64; 11] = difference(&WIDTHS, &y, &next);
            assert!(distance(&opposite, &d) <= 5e-15, "{angle}: {opposite:?} is not {d:?}");
        }
    }
}

/// Small angles keep their relative accuracy: from the identity nothing is rounded away.
#[test]
fn small_rotations_keep_all_digits() {
    let mut random = Random(2);
    for exponent in [-300, -160, -100, -17, -9, -5, -3, -1] {
        let d = random.direction(10_f64.powi(exponent));
        let q = integrate(&[4], &neutral::<1, 4>(&[4]), &d);
        let back: [f64; 3] = difference(&[4], &neutral::<1, 4>(&[4]), &q);
        let relative = distance(&back, &d) / 10_f64.powi(exponent);
        assert!(relative <= 1e-15, "1e{exponent}: {relative:e}");
        let half = d.map(|d| 0.5 * d);
        if exponent < -8 {
            assert!(distance(&q[..3], &half) <= 1e-15 * 10_f64.powi(exponent));
        }
    }
}

/// Turns about one axis, by the functions of std.
#[test]
fn turns_about_an_axis_are_those_of_std() {
    let mut worst = 0.0_f64;
    for k in -4000..=4000_i32 {
        let angle = f64::from(k) * 1.7e-3;
        let q = integrate(&[4], &[0.0, 0.0, 0.0, 1.0], &[0.0, angle, 0.0]);
        let expected = [0.0, (angle / 2.0).sin(), 0.0, (angle / 2.0).cos()];
        worst = worst.max(distance(&q, &expected));
        let back: [f64; 3] = difference(&[4], &[0.0, 0.0, 0.0, 1.0], &expected);
        let shortest = 2.0 * (angle / 2.0).tan().atan();
        worst = worst.max(distance(&back, &[0.0, shortest, 0.0]) / 2.0);
    }
    assert!(worst <= 5e-16, "{worst:e}");
}

/// Between both formulas for the coefficients, at an angle of π, nothing jumps; nor beyond a whole turn.
#[test]
fn large_rotations_are_many_small_ones() {
    let mut random = Random(3);
    for angle in [3.1622776, 3.1622777, 3.2, 6.27, 6.4, 31.0, 1000.0] {
        let [a, b, c] = random.direction(angle);
        let d = [0.3, -0.2, 0.5, a, b, c];
        let start = random.pose();
        let parts = 4096.0;
        let expected = (0..4096).fold(start, |y, _| integrate(&[7], &y, &d.map(|entry| entry / parts)));
        let found = integrate(&[7], &start, &d);
        assert!(distance(&found, &expected) <= 2e-12, "{angle}: {found:?} is not {expected:?}");
    }
}

#[test]
fn quaternions_keep_unit_length_over_a_million_steps() {
    let mut random = Random(4);
    let mut y = state(&mut random);
    for _ in 0..1_000_000 {
        let d = displacement(&mut random, 0.7);
        y = integrate(&WIDTHS, &y, &d);
        for q in [&y[1..5], &y[8..12]] {
            assert!((length(q) - 1.0).abs() <= 5e-16, "{:e}", length(q) - 1.0);
        }
    }
}

#[test]
fn quaternions_are_normalized_where_they_have_a_direction() {
    for size in [5e-324, 1e-310, 1e-200, 0.5, 1.0, 1.0 + 1e-9, 2.0, 1e200, 1.7e308] {
        let mut y = [7.0, 0.0, size, 0.0, -size];
        assert!(normalize(&[1, 4], &mut y), "{size:e}");
        let half = 0.5_f64.sqrt();
        assert!(distance(&y, &[7.0, 0.0, half, 0.0, -half]) <= 2e-16, "{size:e}: {y:?}");
    }
    for bad in [[0.0; 4], [0.0, f64::NAN, 0.0, 1.0], [0.0, 0.0, f64::INFINITY, 1.0]] {
        let mut y = [4.0, 5.0, 6.0, bad[0], bad[1], bad[2], bad[3]];
        assert!(!normalize(&[7], &mut y));
        assert_eq!(y, [4.0, 5.0, 6.0, 0.0, 0.0, 0.0, 1.0]);
    }
    // One bad attitude leaves the others as they are.
    let mut y = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0];
    assert!(!normalize(&[4, 4], &mut y));
    assert!(distance(&y, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.8]) <= 2e-16);
}

#[test]
fn what_is_no_attitude_gives_nan() {
    let zero = [0.0; 4];
    assert!(integrate(&[4], &zero, &[0.1, 0.0, 0.0]).iter().all(|entry| entry.is_nan()));
    let back: [f64; 3] = difference(&[4], &zero, &[0.0, 0.0, 0.0, 1.0]);
    assert!(back.iter().all(|entry| entry.is_nan()));
    let back: [f64; 3] = difference(&[4], &[0.0, 0.0, 0.0, 1.0], &[0.0, f64::NAN, 0.0, 1.0]);
    assert!(back.iter().all(|entry| entry.is_nan()));
}

/// Widths that are none, or that ask for more entries than there are, never pass for joints.
#[test]
fn wrong_widths_give_nan() {
    assert!(integrate(&[2], &[1.0, 2.0], &[0.1]).iter().all(|entry| entry.is_nan()));
    assert!(integrate(&[7], &[1.0; 6], &[0.1; 5]).iter().all(|entry| entry.is_nan()));
    assert!(integrate(&[1], &[1.0, 2.0], &[0.1, 0.2])[1].is_nan());
    let d: [f64; 2] = difference(&[1], &[1.0, 2.0], &[0.0; 2]);
    assert!(d[1].is_nan());
}

#[test]
fn the_neutral_position_has_attitudes() {
    let expected = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    assert_eq!(neutral::<4, 13>(&WIDTHS), expected);
}
