//! Pseudo-inverse of a small matrix, without allocation.

use gelenk_kernels::math::sqrt;

/// Singular values below this tolerance, relative to the largest singular value, count as zero.
const RANK_TOLERANCE: f64 = 1e-12;

/// Largest number of sweeps of rotations. Five or six sweeps are usually enough.
const MOST_SWEEPS: usize = 40;

/// Returns the pseudo-inverse `B⁺` of a matrix B. `B⁺ f` is the shortest vector u that minimizes `|B u − f|`. Returns `None` for a
/// matrix that is empty, zero or not finite.
///
/// One-sided Jacobi rotations V make the columns of B V orthogonal (Hestenes 1958; Golub and Van Loan 2013,
/// section 8.6.3). For the singular value decomposition `B = U Σ Vᵀ`, the pseudo-inverse is `B⁺ = V Σ⁻² (B V)ᵀ`.
#[must_use]
pub fn pseudo_inverse<const N: usize, const M: usize>(matrix: &[[f64; M]; N]) -> Option<[[f64; N]; M]> {
    let largest = matrix.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 || !matrix.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    // Columns of B V in units of the largest entry of B, and columns of V.
    let mut columns: [[f64; N]; M] =
        core::array::from_fn(|j| core::array::from_fn(|i| matrix[i][j] / largest));
    let mut rotation: [[f64; M]; M] =
        core::array::from_fn(|j| core::array::from_fn(|i| if i == j { 1.0 } else { 0.0 }));
    for _ in 0..MOST_SWEEPS {
        if !sweep(&mut columns, &mut rotation) {
            break;
        }
    }
    let squares = columns.map(|column| dot(&column, &column));
    let least = RANK_TOLERANCE * RANK_TOLERANCE * squares.iter().fold(0.0_f64, |most, x| most.max(*x));
    Some(core::array::from_fn(|j| {
        core::array::from_fn(|i| {
            let ranks = (0..M).filter(|&k| squares[k] > least);
            ranks.map(|k| rotation[k][j] * columns[k][i] / squares[k]).sum::<f64>() / largest
        })
    }))
}

/// Rotates every pair of columns until they are orthogonal. Returns whether a pair was rotated.
fn sweep<const N: usize, const M: usize>(columns: &mut [[f64; N]; M], rotation: &mut [[f64; M]; M]) -> bool {
    let mut has_turned = false;
    for p in 0..M {
        for q in p + 1..M {
            let (a, b) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
            let c = dot(&columns[p], &columns[q]);
            if c.abs() <= f64::EPSILON * sqrt(a * b) {
                continue;
            }
            has_turned = true;
            let slope = (b - a) / (2.0 * c);
            let tangent = slope.signum() / (slope.abs() + sqrt(1.0 + slope * slope));
            let cosine = 1.0 / sqrt(1.0 + tangent * tangent);
            turn(columns, [p, q], cosine, cosine * tangent);
            turn(rotation, [p, q], cosine, cosine * tangent);
        }
    }
    has_turned
}

fn turn<const L: usize, const M: usize>(
    columns: &mut [[f64; L]; M],
    [p, q]: [usize; 2],
    cosine: f64,
    sine: f64,
) {
    for i in 0..L {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = cosine * x - sine * y;
        columns[q][i] = sine * x + cosine * y;
    }
}

/// Inner product `aᵀ b`.
#[must_use]
pub fn dot<const L: usize>(a: &[f64; L], b: &[f64; L]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// A linear congruential generator (Knuth 1997, section 3.3.4).
    struct Random(u64);

    impl Random {
        /// A number between −1 and 1.
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
        }
    }

    #[test]
    fn robots_without_drives_have_no_feed_forward() {
        assert_eq!(pseudo_inverse::<2, 0>(&[[], []]), None);
        assert_eq!(pseudo_inverse::<0, 2>(&[]), None);
        assert_eq!(pseudo_inverse(&[[0.0, 0.0]]), None);
        assert_eq!(pseudo_inverse(&[[f64::NAN]]), None);
        let inverse = pseudo_inverse(&[[0.0, 4.0]]).unwrap();
        assert!(inverse[0][0].abs() < 1e-15 && (inverse[1][0] - 0.25).abs() < 1e-15);
    }

    /// Tests the four conditions that define the pseudo-inverse (Penrose 1955), for matrices of every rank. Some matrices have a
    /// column of another magnitude.
    #[test]
    fn penrose_s_conditions_hold() {
        let mut random = Random(5);
        for case in 0..300 {
            check::<4, 4>(&mut random, case);
            check::<5, 3>(&mut random, case);
            check::<3, 6>(&mut random, case);
        }
    }

    fn check<const N: usize, const M: usize>(random: &mut Random, case: usize) {
        let mut matrix: [[f64; M]; N] = core::array::from_fn(|_| core::array::from_fn(|_| random.next()));
        if case.is_multiple_of(3) {
            matrix[1] = matrix[0].map(|x| -2.0 * x);
        }
        for row in &mut matrix {
            row[0] *= [1.0, 160.0, 1e-3][case % 3];
        }
        let found = pseudo_inverse(&matrix).unwrap();
        let (b, x) =
            (DMatrix::from_fn(N, M, |i, j| matrix[i][j]), DMatrix::from_fn(M, N, |j, i| found[j][i]));
        // The tolerance allows for rounding errors, which the condition number amplifies.
        let condition = b.norm() * x.norm();
        let (bx, xb) = (&b * &x, &x * &b);
        let conditions = [
            ((&bx * &b - &b).norm(), b.norm()),
            ((&xb * &x - &x).norm(), x.norm()),
            ((bx.transpose() - &bx).norm(), 1.0),
            ((xb.transpose() - &xb).norm(), 1.0),
        ];
        for (k, (error, size)) in conditions.into_iter().enumerate() {
            assert!(error <= 1e-14 * condition * size, "{case}, {k}: {error:e}, {condition:e}: {matrix:?}");
        }
    }
}
