/// The Stumpff functions `Σ (−z)ʲ / (2j + k)!` for k = 0 to 5. They are cos x, sin x / x, (1 − cos x) / x², …
/// with z = x².
///
/// Up to x = π/2 the sums are used, because they lose no digits there. For larger x, sine and cosine are
/// used. Errors are a few units in the last place of 1/k!.
fn stumpff(z: f64) -> [f64; 6] {
    const TERMS: usize = 10;
    // The coefficients 1/(2j + 4)! and 1/(2j + 5)!, with alternating signs.
    const COEFFICIENTS: [[f64; 2]; TERMS] = {
        let mut coefficients = [[0.0; 2]; TERMS];
        let (mut j, mut factorial, mut sign) = (0, 6.0, 1.0);
        while j < TERMS {
            factorial *= (2 * j + 4) as f64;
            coefficients[j][0] = sign / factorial;
            factorial *= (2 * j + 5) as f64;
            coefficients[j][1] = sign / factorial;
            sign = -sign;
            j += 1;
        }
        coefficients
    };
    if z <= 2.5 {
        let (mut c4, mut c5) = (0.0, 0.0);
        for [even, odd] in COEFFICIENTS.iter().rev() {
            (c4, c5) = (even + z * c4, odd + z * c5);
        }
        let (c2, c3) = (0.5 - z * c4, 1.0 / 6.0 - z * c5);
        return [1.0 - z * c2, 1.0 - z * c3, c2, c3, c4, c5];
    }
    let x = sqrt(z);
    let (sin, cos) = sin_cos(x);
    let (c1, c2) = (sin / x, (1.0 - cos) / z);
    let c3 = (1.0 - c1) / z;
    [cos, c1, c2, c3, (0.5 - c2) / z, (1.0 / 6.0 - c3) / z]
}

/// The Stumpff functions for k = 1 to 5 of twice the angle. No difference of nearly equal numbers occurs.
fn doubled([c0, c1, c2, c3, c4, c5]: &[f64; 6]) -> [f64; 5] {
    [
        c0 * c1,
        0.5 * c1 * c1,
        (c3 + c1 * c2) / 4.0,
        c3 * (1.0 + c1) / 8.0,
        (c5 + c4 + c2 * c3) / 16.0,
    ]
}

#[inline]
pub(super) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline]
fn inner(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector `a + α w × a + β w × (w × a)`.
#[inline]
fn turned(w: &[f64; 3], a: &[f64; 3], alpha: f64, beta: f64) -> [f64; 3] {
    let once = cross(w, a);
    let twice = cross(w, &once);
    core::array::from_fn(|i| a[i] + (alpha * once[i] + beta * twice[i]))
}

/// Transforms the vector a from the body's frame to the parent's frame. The conjugate quaternion gives the
/// inverse transformation.
#[inline]
fn rotated(q: &[f64; 4], a: &[f64; 3]) -> [f64; 3] {
    turned(&[q[0], q[1], q[2]], a, 2.0 * q[3], 2.0)
}

#[inline]
fn conjugate(q: &[f64; 4]) -> [f64; 4] {
    [-q[0], -q[1], -q[2], q[3]]
}

/// The product `a b` of quaternions x, y, z, w.
#[inline]
fn product(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [
        a[3] * b[0] + b[3] * a[0] + (a[1] * b[2] - a[2] * b[1]),
        a[3] * b[1] + b[3] * a[1] + (a[2] * b[0] - a[0] * b[2]),
        a[3] * b[2] + b[3] * a[2] + (a[0] * b[1] - a[1] * b[0]),
        a[3] * b[3] - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]),
    ]
}

/// The quaternion divided by its length.
///
/// If the length is close to one, a Newton step without a square root is sufficient; its error is below
/// 1e-16. The result for the quaternion 0 is NaN.
#[inline]
fn of_unit_length(q: &[f64; 4]) -> [f64; 4] {
    let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    let factor = if (square - 1.0).abs() < 1e-8 {
        1.5 - 0.5 * square
    } else {
        1.0 / sqrt(square)
    };
    [q[0] * factor, q[1] * factor, q[2] * factor, q[3] * factor]
}

/// The attitude `q exp(w)` after a rotation by the vector w in the body's frame. `half` contains the Stumpff
/// functions of half the angle.
#[inline]
fn attitude_after(q: &[f64; 4], w: &[f64; 3], half: &[f64; 6]) -> [f64; 4] {
    let s = 0.5 * half[1];
    of_unit_length(&product(q, &[s * w[0], s * w[1], s * w[2], half[0]]))
}

/// The shortest rotation vector of an attitude. Its length is at most π. A quaternion and its negative are
/// the same attitude.
fn rotation_vector(q: &[f64; 4]) -> [f64; 3] {
    let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    let (sin, cos) = (sqrt(square), q[3].abs());
    let factor = angle_over_sine(sin, cos, sqrt(square + q[3] * q[3]));
    let factor = if q[3] < 0.0 { -factor } else { factor };
    [factor * q[0], factor * q[1], factor * q[2]]
}

/// The value `2 φ / sin`, where φ is the angle of the point (cos, sin) with cos, sin ≥ 0, and `length` is the
/// distance of this point from the origin. The result is 2 / cos for sin = 0, and NaN for the origin.
///
/// φ is 2 atan u with u = tan(φ/2). atan u is c + atan((u − tan c)/(1 + u tan c)) with the nearest multiple c
/// of π/8.
fn angle_over_sine(sin: f64, cos: f64, length: f64) -> f64 {
    use core::f64::consts::{FRAC_PI_4, FRAC_PI_8, SQRT_2};
    const TAN_FRAC_PI_8: f64 = SQRT_2 - 1.0;
    let u = sin / (length + cos);
    if u < 0.2 {
        return 4.0 * arctangent_over(u) / (length + cos);
    }
    let (center, tangent) = if u < 0.67 {
        (FRAC_PI_8, TAN_FRAC_PI_8)
    } else {
        (FRAC_PI_4, 1.0)
    };
    let rest = (u - tangent) / (1.0 + u * tangent);
    4.0 * (center + rest * arctangent_over(rest)) / sin
}

/// The value `atan t / t` for |t| ≤ 0.21 by its Taylor series. The remainder is below 1e-17.
fn arctangent_over(t: f64) -> f64 {
    const TERMS: usize = 12;
    let (z, mut sum) = (t * t, 0.0);
    for k in (0..TERMS).rev() {
        sum = 1.0 / (2 * k + 1) as f64 - z * sum;
    }
    sum
}
