//! Factorization of the small symmetric matrices of the inputs.

/// Error: a pivot of `R̃ + BᵀPB` is not positive, with the input weights and barrier terms R̃, the input
/// matrix B and the cost-to-go P. Either the weights are not positive (semi)definite, or a number is not
/// finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NotPositive;

/// Factors of `Λ D Λᵀ`, a symmetric matrix that is given by its lower triangle. The result contains `Λ` below the diagonal
/// and `D⁻¹` on the diagonal.
///
/// # Errors
/// [`NotPositive`] if a pivot is not positive.
#[inline(always)]
pub(super) fn factor_ldl<const NU: usize>(mut h: [[f64; NU]; NU]) -> Result<[[f64; NU]; NU], NotPositive> {
    let mut positive = true;
    for j in 0..NU {
        let pivot = h[j][j];
        positive &= pivot > 0.0;
        let inverse = 1.0 / pivot;
        for i in j + 1..NU {
            let l = h[i][j] * inverse;
            for m in j + 1..=i {
                h[i][m] -= l * h[m][j];
            }
        }
        for i in j + 1..NU {
            h[i][j] *= inverse;
        }
        h[j][j] = inverse;
    }
    if positive { Ok(h) } else { Err(NotPositive) }
}

/// Solves `Λ D Λᵀ x = w` with the factors of [`factor_ldl`].
#[inline(always)]
pub(super) fn solve_ldl<const NU: usize>(l: &[[f64; NU]; NU], w: &[f64; NU]) -> [f64; NU] {
    let mut v = *w;
    for i in 0..NU {
        for j in 0..i {
            v[i] -= l[i][j] * v[j];
        }
    }
    for i in 0..NU {
        v[i] *= l[i][i];
    }
    for i in (0..NU).rev() {
        for j in i + 1..NU {
            v[i] -= l[j][i] * v[j];
        }
    }
    v
}
