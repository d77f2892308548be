//! Derivatives along ⊕, and the bracket.

use gelenk_kernels::manifold::{
    bracket, difference, difference_derivatives, integrate, integrate_derivatives,
};

use super::random::{Random, distance};

type Matrix = [[f64; 6]; 6];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

fn adjoint(d: &[f64; 6]) -> Matrix {
    let mut matrix = [[0.0; 6]; 6];
    for j in 0..6 {
        let mut unit = [0.0; 6];
        unit[j] = 1.0;
        let column = bracket(&[7], d, &unit);
        (0..6).for_each(|i| matrix[i][j] = column[i]);
    }
    matrix
}

/// `Σ (−ad_d)ᵏ / (k + shift)!` by its definition.
fn series(d: &[f64; 6], shift: i32) -> Matrix {
    let ad = adjoint(&d.map(|d| -d));
    let mut power: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    let (mut sum, mut factorial) = ([[0.0; 6]; 6], 1.0);
    for k in 0..80 {
        factorial *= f64::from((k + shift).max(1));
        for i in 0..6 {
            (0..6).for_each(|j| sum[i][j] += power[i][j] / factorial);
        }
        power = times(&power, &ad);
    }
    sum
}

#[test]
fn derivatives_of_integration_are_the_series_of_the_bracket() {
    let mut random = Random(11);
    for angle in [0.0, 1e-200, 1e-8, 1e-3, 0.5, 1.6, 3.13, 3.17, 4.5, 6.2, 8.0] {
        let ([a, b, c], [l, m, n]) = (random.direction(angle), random.vector(2.0));
        let d = [l, m, n, a, b, c];
        let (by_y, by_d) = integrate_derivatives(&[7], &d);
        for (found, expected) in [(by_y, series(&d, 0)), (by_d, series(&d, 1))] {
            let error = distance(found.as_flattened(), expected.as_flattened());
            // The series itself loses digits: its terms grow to e^θ.
            assert!(error <= 1e-15 * (8.0 + angle.exp()), "{angle}: {error:e}");
        }
    }
}

#[test]
fn derivatives_of_differences_are_the_inverse() {
    let mut random = Random(12);
    let identity: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    for angle in [0.0, 1e-200, 1e-8, 1e-3, 0.5, 1.6, 3.0, std::f64::consts::PI] {
        let ([a, b, c], [l, m, n]) = (random.direction(angle), random.vector(2.0));
        let d = [l, m, n, a, b, c];
        let (by_to, by_from) = difference_derivatives(&[7], &d);
        let (by_y, by_d) = integrate_derivatives(&[7], &d);
        let product = times(&by_to, &by_d);
        assert!(distance(product.as_flattened(), identity.as_flattened()) <= 3e-15, "{angle}");
        // d does not change where both poses are moved alike: ∂/∂from = −∂/∂to Ad(exp(−d)).
        let expected = times(&by_to, &by_y).map(|row| row.map(|entry| -entry));
        assert!(distance(by_from.as_flattened(), expected.as_flattened()) <= 5e-15, "{angle}");
    }
}

const WIDTHS: [usize; 3] = [4, 1, 7];

/// Central differences along ⊕ by the j-th direction.
fn quotient(j: usize, value: impl Fn(&[f64; 10]) -> [f64; 10]) -> [f64; 10] {
    let at = |h: f64| {
        let mut direction = [0.0; 10];
        direction[j] = h;
        value(&direction)
    };
    let (after, before) = (at(1e-5), at(-1e-5));
    core::array::from_fn(|i| (after[i] - before[i]) / 2e-5)
}

#[test]
fn derivatives_are_those_by_quotients_along_the_manifold() {
    let mut random = Random(13);
    for _ in 0..20 {
        let mut y = [0.4; 12];
        y[..4].copy_from_slice(&random.quaternion());
        y[5..].copy_from_slice(&random.pose());
        let d: [f64; 10] = random.vector(1.5);
        let next = integrate(&WIDTHS, &y, &d);
        let (by_y, by_d) = integrate_derivatives(&WIDTHS, &d);
        let (by_to, by_from) = difference_derivatives(&WIDTHS, &d);
        for j in 0..10 {
            let column = |matrix: &[[f64; 10]; 10]| -> [f64; 10] { core::array::from_fn(|i| matrix[i][j]) };
            let moved = |e: &[f64; 10]| integrate(&WIDTHS, &y, e);
            let found = quotient(j, |e| difference(&WIDTHS, &next, &integrate(&WIDTHS, &moved(e), &d)));
            assert!(distance(&found, &column(&by_y)) <= 1e-9);
            let sum = |e: &[f64; 10]| -> [f64; 10] { core::array::from_fn(|i| d[i] + e[i]) };
            let found = quotient(j, |e| difference(&WIDTHS, &next, &integrate(&WIDTHS, &y, &sum(e))));
            assert!(distance(&found, &column(&by_d)) <= 1e-9);
            if d[..3].iter().chain(&d[7..]).all(|w| w.abs() < 1.2) {
                let found = quotient(j, |e| difference(&WIDTHS, &y, &integrate(&WIDTHS, &next, e)));
                assert!(distance(&found, &column(&by_to)) <= 1e-8);
                let found = quotient(j, |e| difference(&WIDTHS, &moved(e), &next));
                assert!(distance(&found, &column(&by_from)) <= 1e-8);
            }
        }
    }
}

/// `exp(a) exp(b) exp(−a) exp(−b) = exp([a, b] + …)`, which fixes the sign.
#[test]
fn the_bracket_is_what_is_left_of_exchanged_motions() {
    let mut random = Random(14);
    let (a, b): ([f64; 10], [f64; 10]) = (random.vector(1.0), random.vector(1.0));
    let expected = bracket(&WIDTHS, &a, &b);
    let h = 1e-4;
    let neutral = gelenk_kernels::manifold::neutral(&WIDTHS);
    let mut y: [f64; 12] = neutral;
    for (d, sign) in [(a, h), (b, h), (a, -h), (b, -h)] {
        y = integrate(&WIDTHS, &y, &d.map(|d| sign * d));
    }
    let left: [f64; 10] = difference(&WIDTHS, &neutral, &y);
    assert!(distance(&left.map(|left| left / (h * h)), &expected) <= 1e-3);
    assert!(expected[3] == 0.0 && expected.iter().any(|entry| entry.abs() > 0.3));
}
