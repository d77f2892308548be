/// The sum `y ⊕ d`: the positions after a motion with the velocities d for one second. Quaternions of the
/// result have unit length with an error of 1e-15, even after many calls.
pub fn integrate<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    y: &[f64; NY],
    d: &[f64; N],
) -> [f64; NY] {
    let mut next = [f64::NAN; NY];
    for (width, position, velocity) in places(widths) {
        match width {
            1 => {
                let ([y], [d]) = (read(y, position), read(d, velocity));
                write(&mut next, position, &[y + d]);
            }
            4 => {
                let (q, w) = (read(y, position), read::<3>(d, velocity));
                let half = stumpff(0.25 * inner(&w, &w));
                write(&mut next, position, &attitude_after(&q, &w, &half));
            }
            7 => {
                let pose = pose_after(&read(y, position), &read(d, velocity));
                write(&mut next, position, &pose);
            }
            _ => {}
        }
    }
    next
}

/// The pose `X exp(d)` on SE(3): the position, then the attitude.
fn pose_after([x, y, z, q @ ..]: &[f64; 7], [a, b, c, w @ ..]: &[f64; 6]) -> [f64; 7] {
    let half = stumpff(0.25 * inner(w, w));
    let [_, c2, c3, ..] = doubled(&half);
    let way = rotated(q, &turned(w, &[*a, *b, *c], c2, c3));
    let [i, j, k, l] = attitude_after(q, w, &half);
    [x + way[0], y + way[1], z + way[2], i, j, k, l]
}

/// The difference `to ⊖ from`: the velocities that lead from `from` to `to` in one second, with the shortest
/// rotation. A quaternion and its negative are the same attitude. If the angle of the rotation is π, its sign
/// is arbitrary.
pub fn difference<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    from: &[f64; NY],
    to: &[f64; NY],
) -> [f64; N] {
    let mut velocities = [f64::NAN; N];
    for (width, position, velocity) in places(widths) {
        match width {
            1 => {
                let ([from], [to]) = (read(from, position), read(to, position));
                write(&mut velocities, velocity, &[to - from]);
            }
            4 => {
                let relative = product(&conjugate(&read(from, position)), &read(to, position));
                write(&mut velocities, velocity, &rotation_vector(&relative));
            }
            7 => {
                let twist = twist_between(&read(from, position), &read(to, position));
                write(&mut velocities, velocity, &twist);
            }
            _ => {}
        }
    }
    velocities
}

/// The logarithm of `from⁻¹ to` on SE(3).
fn twist_between([x, y, z, from @ ..]: &[f64; 7], [a, b, c, to @ ..]: &[f64; 7]) -> [f64; 6] {
    let back = conjugate(from);
    let w = rotation_vector(&product(&back, to));
    let (square, _) = half_cotangent(&w);
    let way = rotated(&back, &[a - x, b - y, c - z]);
    let l = turned(&w, &way, -0.5, square);
    [l[0], l[1], l[2], w[0], w[1], w[2]]
}

/// The function `(1 − (θ/2) cot(θ/2)) / θ²` of the length θ < 2π of a rotation vector, and its derivative
/// with respect to θ divided by θ.
fn half_cotangent(w: &[f64; 3]) -> (f64, f64) {
    let [_, c1, c2, c3, c4, c5] = stumpff(0.25 * inner(w, w));
    let square = 0.25 * (c2 - c3) / c1;
    let slopes = (2.0 * c4 - c3) - (3.0 * c5 - c4) - 4.0 * square * (c3 - c2);
    (square, slopes / (16.0 * c1))
}

/// Normalizes the quaternions. Returns false if a quaternion is zero or not finite. This quaternion is set to
/// the identity.
#[must_use]
pub fn normalize<const J: usize, const NY: usize>(widths: &[usize; J], y: &mut [f64; NY]) -> bool {
    let mut are_attitudes = true;
    for (width, position, _) in places(widths) {
        if width > 1 {
            let first = position.wrapping_add(width.wrapping_sub(4));
            let (q, is_attitude) = normalized(&read(y, first));
            write(y, first, &q);
            are_attitudes &= is_attitude;
        }
    }
    are_attitudes
}

/// Returns the normalized quaternion and true. If the quaternion is zero or not finite, returns the identity
/// and false.
fn normalized(q: &[f64; 4]) -> ([f64; 4], bool) {
    let mut largest = 0.0;
    for entry in q {
        if !entry.is_finite() {
            return ([0.0, 0.0, 0.0, 1.0], false);
        }
        if entry.abs() > largest {
            largest = entry.abs();
        }
    }
    if largest == 0.0 {
        return ([0.0, 0.0, 0.0, 1.0], false);
    }
    // The division avoids overflow and underflow of squares. It may be inexact for subnormal numbers, so the
    // length is corrected once more.
    let scaled = of_unit_length(&q.map(|entry| entry / largest));
    (of_unit_length(&scaled), true)
}

/// Neutral positions: position 0 for each joint, and the identity quaternion for each attitude.
pub fn neutral<const J: usize, const NY: usize>(widths: &[usize; J]) -> [f64; NY] {
    let mut y = [0.0; NY];
    for (width, position, _) in places(widths) {
        if width > 1 {
            write(&mut y, position.wrapping_add(width.wrapping_sub(1)), &[1.0]);
        }
    }
    y
}
