/// The function `1 + c₁ ad_d + c₂ ad_d²` of a displacement d. The slopes are the derivatives of the
/// coefficients with respect to the angle θ, divided by θ.
struct Polynomial {
    linear: f64,
    square: f64,
    linear_slope: f64,
    square_slope: f64,
}

impl Polynomial {
    /// The adjoint matrix `Ad(exp(−d))`, from the Stumpff functions for k = 1 to 5.
    fn adjoint([c1, c2, c3, c4, _]: &[f64; 5]) -> Self {
        Self {
            linear: -c1,
            square: *c2,
            linear_slope: c2 - c3,
            square_slope: 2.0 * c4 - c3,
        }
    }

    /// The right Jacobian `J_r(d) = Σ (−ad_d)ᵏ / (k + 1)!`, from the Stumpff functions for k = 1 to 5.
    fn right([_, c2, c3, c4, c5]: &[f64; 5]) -> Self {
        Self {
            linear: -c2,
            square: *c3,
            linear_slope: c3 - 2.0 * c4,
            square_slope: 3.0 * c5 - c4,
        }
    }

    /// The inverse `J_r⁻¹(d)` of the right Jacobian if `side` is 1, or the inverse `J_l⁻¹(d)` of the left
    /// Jacobian if `side` is −1.
    fn inverse(w: &[f64; 3], side: f64) -> Self {
        let (square, square_slope) = half_cotangent(w);
        Self {
            linear: side * 0.5,
            square,
            linear_slope: 0.0,
            square_slope,
        }
    }

    /// The function on SO(3).
    fn of_rotation(&self, w: &[f64; 3]) -> [[f64; 3]; 3] {
        let mut matrix = combination(self.linear, self.square, w);
        for i in 0..3 {
            matrix[i][i] += 1.0;
        }
        matrix
    }

    /// The function on SE(3). Since `ad_d = [ω× l×; 0 ω×]`, the upper right block is the derivative of the
    /// function on SO(3) in the direction l.
    fn of_pose(&self, [a, b, c, w @ ..]: &[f64; 6]) -> [[f64; 6]; 6] {
        let l = [*a, *b, *c];
        let (diagonal, along) = (self.of_rotation(w), inner(w, &l));
        let turned = combination(along * self.linear_slope, along * self.square_slope, w);
        let moved = combination(self.linear, 0.0, &l);
        let mut matrix = [[0.0; 6]; 6];
        for i in 0..3 {
            for j in 0..3 {
                let mixed = self.square * (l[i] * w[j] + w[i] * l[j]);
                matrix[i][j] = diagonal[i][j];
                matrix[i + 3][j + 3] = diagonal[i][j];
                matrix[i][j + 3] = turned[i][j] + (moved[i][j] + mixed);
            }
            matrix[i][i + 3] -= 2.0 * self.square * along;
        }
        matrix
    }
}

/// The matrix `α w× + β w× w×`.
#[inline]
fn combination(alpha: f64, beta: f64, w: &[f64; 3]) -> [[f64; 3]; 3] {
    let (s, t) = (w.map(|w| alpha * w), w.map(|w| beta * w));
    let [xx, yy, zz] = [t[0] * w[0], t[1] * w[1], t[2] * w[2]];
    let [xy, xz, yz] = [t[0] * w[1], t[0] * w[2], t[1] * w[2]];
    [
        [-(yy + zz), xy - s[2], xz + s[1]],
        [xy + s[2], -(xx + zz), yz - s[0]],
        [xz - s[1], yz + s[0], -(xx + yy)],
    ]
}

/// The derivatives of `X exp(d)` on SE(3) with respect to X and d.
pub(super) fn pose_tangents(d: &[f64; 6]) -> [[[f64; 6]; 6]; 2] {
    let [_, _, _, w @ ..] = d;
    let functions = doubled(&stumpff(0.25 * inner(w, w)));
    [
        Polynomial::adjoint(&functions).of_pose(d),
        Polynomial::right(&functions).of_pose(d),
    ]
}

/// The derivatives of `X exp(d)` on SO(3) with respect to X and d.
pub(super) fn rotation_tangents(w: &[f64; 3]) -> [[[f64; 3]; 3]; 2] {
    let functions = doubled(&stumpff(0.25 * inner(w, w)));
    [
        Polynomial::adjoint(&functions).of_rotation(w),
        Polynomial::right(&functions).of_rotation(w),
    ]
}

/// The derivatives of the logarithm d of the relative pose, with respect to the pose `to` and to the pose
/// `from`.
fn pose_differences(d: &[f64; 6]) -> [[[f64; 6]; 6]; 2] {
    let [_, _, _, w @ ..] = d;
    let by_from = Polynomial::inverse(w, -1.0).of_pose(d);
    [
        Polynomial::inverse(w, 1.0).of_pose(d),
        by_from.map(|row| row.map(|entry| -entry)),
    ]
}

/// The derivatives of the logarithm on SO(3), with respect to the attitudes `to` and `from`.
fn rotation_differences(w: &[f64; 3]) -> [[[f64; 3]; 3]; 2] {
    let by_from = Polynomial::inverse(w, -1.0).of_rotation(w);
    [
        Polynomial::inverse(w, 1.0).of_rotation(w),
        by_from.map(|row| row.map(|entry| -entry)),
    ]
}

/// The derivatives of `y ⊕ d` with respect to y and d, along ⊕ at the result: `Ad(exp(−d))` and the right
/// Jacobian `J_r(d)`.
pub fn integrate_derivatives<const J: usize, const N: usize>(
    widths: &[usize; J],
    d: &[f64; N],
) -> ([[f64; N]; N], [[f64; N]; N]) {
    let (mut by_y, mut by_d) = (unknown(), unknown());
    for (width, _, first) in places(widths) {
        match width {
            1 => write_pair([&mut by_y, &mut by_d], first, &[[[1.0]], [[1.0]]]),
            4 => write_pair(
                [&mut by_y, &mut by_d],
                first,
                &rotation_tangents(&read(d, first)),
            ),
            7 => write_pair(
                [&mut by_y, &mut by_d],
                first,
                &pose_tangents(&read(d, first)),
            ),
            _ => {}
        }
    }
    (by_y, by_d)
}

/// The derivatives of `d = to ⊖ from` along ⊕: `J_r⁻¹(d)` with respect to `to`, and `−J_l⁻¹(d)` with respect
/// to `from`.
///
/// The angles of rotations in d are at most π. At π, d and its derivatives are discontinuous.
pub fn difference_derivatives<const J: usize, const N: usize>(
    widths: &[usize; J],
    d: &[f64; N],
) -> ([[f64; N]; N], [[f64; N]; N]) {
    let (mut by_to, mut by_from) = (unknown(), unknown());
    for (width, _, first) in places(widths) {
        match width {
            1 => write_pair([&mut by_to, &mut by_from], first, &[[[1.0]], [[-1.0]]]),
            4 => {
                let blocks = rotation_differences(&read(d, first));
                write_pair([&mut by_to, &mut by_from], first, &blocks);
            }
            7 => write_pair(
                [&mut by_to, &mut by_from],
                first,
                &pose_differences(&read(d, first)),
            ),
            _ => {}
        }
    }
    (by_to, by_from)
}

/// A matrix with NaN on the diagonal, which remains for joints without a block.
fn unknown<const N: usize>() -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for i in 0..N {
        matrix[i][i] = f64::NAN;
    }
    matrix
}

/// Writes a joint's blocks into two matrices.
#[inline]
fn write_pair<const K: usize, const N: usize>(
    matrices: [&mut [[f64; N]; N]; 2],
    first: usize,
    blocks: &[[[f64; K]; K]; 2],
) {
    for (matrix, block) in matrices.into_iter().zip(blocks) {
        for (row, values) in matrix.iter_mut().skip(first).zip(block) {
            write(row, first, values);
        }
    }
}
