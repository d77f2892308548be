//! The pseudo-inverse of a small matrix, without allocation.

/// Singular values below this share of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-12;

/// Sweeps after which columns are as orthogonal as they get; five or six are usual.
const MOST_SWEEPS: usize = 40;

/// `B⁺`: `B⁺ f` is the shortest of the u for which `B u` comes closest to f. None for matrices that are empty,
/// zero or not finite.
///
/// One-sided Jacobi rotations make the columns of B V orthogonal (Hestenes 1958; Golub and Van Loan 2013, section
/// 8.6.3): `B = U Σ Vᵀ`, `B⁺ = V Σ⁻² (B V)ᵀ`.
pub(crate) fn pseudo_inverse<const N: usize, const M: usize>(
    matrix: &[[f64; M]; N],
) -> Option<[[f64; N]; M]> {
    let largest = matrix.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest == 0.0 || !matrix.iter().flatten().all(|x| x.is_finite()) {
        return None;
    }
    // Columns of B V in units of the largest entry, and of V.
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

/// Rotates every pair of columns until it is orthogonal; tells whether one was not.
fn sweep<const N: usize, const M: usize>(columns: &mut [[f64; N]; M], rotation: &mut [[f64; M]; M]) -> bool {
    let mut has_turned = false;
    for p in 0..M {
        for q in p + 1..M {
            let (a, b) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
            let c = dot(&columns[p], &columns[q]);
            if c.abs() <= f64::EPSILON * (a * b).sqrt() {
                continue;
            }
            has_turned = true;
            let slope = (b - a) / (2.0 * c);
            let tangent = slope.signum() / (slope.abs() + (1.0 + slope * slope).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
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

fn dot<const L: usize>(a: &[f64; L], b: &[f64; L]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn robots_without_drives_have_no_feed_forward() {
        assert_eq!(pseudo_inverse::<2, 0>(&[[], []]), None);
        assert_eq!(pseudo_inverse::<0, 2>(&[]), None);
        assert_eq!(pseudo_inverse(&[[0.0, 0.0]]), None);
        assert_eq!(pseudo_inverse(&[[f64::NAN]]), None);
        let inverse = pseudo_inverse(&[[0.0, 4.0]]).unwrap();
        assert!(inverse[0][0].abs() < 1e-15 && (inverse[1][0] - 0.25).abs() < 1e-15);
    }

    /// What nalgebra's singular value decomposition gives, for matrices of every rank, some with rows or columns
    /// of other sizes.
    #[test]
    fn it_is_that_of_another_method() {
        let mut random = fastrand::Rng::with_seed(5);
        for case in 0..300 {
            check::<4, 4>(&mut random, case);
            check::<5, 3>(&mut random, case);
            check::<3, 6>(&mut random, case);
        }
    }

    fn check<const N: usize, const M: usize>(random: &mut fastrand::Rng, case: usize) {
        let mut matrix: [[f64; M]; N] =
            core::array::from_fn(|_| core::array::from_fn(|_| 2.0 * random.f64() - 1.0));
        if case % 3 == 0 {
            matrix[1] = matrix[0].map(|x| -2.0 * x);
        }
        for row in &mut matrix {
            row[0] *= [1.0, 160.0, 1e-3][case % 3];
        }
        let svd = DMatrix::from_fn(N, M, |i, j| matrix[i][j]).svd(true, true);
        let largest = svd.singular_values.max();
        let expected = svd.pseudo_inverse(RANK_TOLERANCE * largest).unwrap();
        let found = pseudo_inverse(&matrix).unwrap();
        let size = expected.amax();
        for (j, row) in found.iter().enumerate() {
            for (i, entry) in row.iter().enumerate() {
                assert!((entry - expected[(j, i)]).abs() <= 1e-10 * size, "{case}: {matrix:?}");
            }
        }
    }
}
