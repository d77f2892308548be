//! Scalar products and solution of small systems of equations.

pub(super) fn product<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `A x = b` by the factorization `A = L D Lᵀ` (Golub and Van Loan, Matrix Computations, 2013, section
/// 4.1); NaN if A is not positive definite.
pub(super) fn solve_positive_definite<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for j in 0..N {
        let pivot = a[j][j];
        if pivot <= 0.0 {
            return [f64::NAN; N];
        }
        for i in j + 1..N {
            let factor = a[i][j] / pivot;
            for k in j + 1..=i {
                a[i][k] -= factor * a[k][j];
            }
            b[i] -= factor * b[j];
        }
    }
    for j in (0..N).rev() {
        let known: f64 = (j + 1..N).map(|i| a[i][j] * b[i]).sum();
        b[j] = (b[j] - known) / a[j][j];
    }
    b
}
