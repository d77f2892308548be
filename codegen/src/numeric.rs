//! Numeric functions with the same bits on every platform.
//!
//! Constants that the generator computes are printed in generated modules. The functions of std depend on the
//! platform's C library. The functions here use only operations that IEEE 754 rounds uniquely.

use gelenk_kernels::math;

pub(crate) use math::sin_cos;

/// Angle of the point (x, y) to the x axis in rad, from −π to π. The angle of the origin is 0. Uses the crate
/// libm, which has the same arithmetic on every platform.
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    match x == 0.0 && y == 0.0 {
        true => 0.0,
        false => libm::atan2(y, x),
    }
}

/// Length `√(Σ x²)` of a vector with entries up to 1e30, the limit of descriptions.
pub(crate) fn length<const N: usize>(x: [f64; N]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The cross product `a × b`.
pub(crate) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The power `base^exponent`, by repeated multiplication.
pub(crate) fn power(base: f64, exponent: i32) -> f64 {
    let power = (0..exponent.unsigned_abs()).fold(1.0, |power, _| power * base);
    match exponent < 0 {
        true => 1.0 / power,
        false => power,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "the functions of std are what ours are compared with")]

    use super::*;

    #[test]
    fn angles_are_those_of_std() {
        let mut worst = 0.0_f64;
        for k in -1800..=1800_i32 {
            let angle = f64::from(k) * 0.1_f64.to_radians();
            for size in [1e-30, 0.3, 1.0, 7.0, 1e30] {
                let (y, x) = (size * angle.sin(), size * angle.cos());
                let (found, expected) = (atan2(y, x), y.atan2(x));
                worst = worst.max((found - expected).abs() / expected.abs().max(1e-300));
            }
        }
        assert!(worst <= 2.0 * f64::EPSILON, "{worst:e}");
        let quarter = std::f64::consts::FRAC_PI_2;
        let exact = [
            ((0.0, 0.0), 0.0),
            ((0.0, 2.0), 0.0),
            ((3.0, 0.0), quarter),
            ((0.0, -2.0), 2.0 * quarter),
            ((-3.0, 0.0), -quarter),
            ((1.0, 1.0), quarter / 2.0),
            ((-1.0, -1.0), -1.5 * quarter),
        ];
        for ((y, x), expected) in exact {
            assert_eq!(atan2(y, x), expected, "{y}, {x}");
        }
    }

    #[test]
    fn lengths_are_those_of_std() {
        for (x, y) in [(3.0, 4.0), (1e-9, 1.0), (0.1, -0.7), (1e30, 1e30)] {
            let (found, expected) = (length([x, y]), f64::hypot(x, y));
            assert!((found / expected - 1.0).abs() <= 2.0 * f64::EPSILON, "{x}, {y}");
        }
        assert_eq!(length([0.0; 3]), 0.0);
    }
}
