//! Solver of symmetric positive definite banded systems `(I + Σ wᵢ dᵢ dᵢᵀ) s = f`. The factorization L D Lᵀ takes linear
//! time.

/// Lower band of a symmetric matrix, row by row. `rows[i][k]` is the entry (i, i − k), or zero if i < k.
pub(super) type Band<const W: usize> = Vec<[f64; W]>;

/// Factors the band in place and solves for `x` in place. `W` is the number of diagonals of the lower half.
///
/// The pivots are not zero, because the diagonal entries of these systems are at least 1.
pub(super) fn solve<const W: usize>(band: &mut Band<W>, x: &mut [f64]) {
    let m = band.len();
    // Row i becomes [1/dᵢ, lᵢ,ᵢ₋₁, lᵢ,ᵢ₋₂ …]. The last W − 1 rows and their pivots stay in registers.
    let mut rows = [[0.0; W]; W];
    let mut pivots = [1.0; W];
    let mut solved = [0.0; W];
    for i in 0..m {
        let row = factor_row(band[i], &rows, &pivots);
        let mut y = x[i];
        for k in 1..W {
            y -= row.1[k] * solved[k - 1];
        }
        x[i] = y;
        for k in (1..W).rev() {
            rows[k] = rows[k - 1];
            pivots[k] = pivots[k - 1];
            solved[k] = solved[k - 1];
        }
        (pivots[0], rows[0], solved[0]) = (row.0, row.1, y);
        band[i] = row.1;
        band[i][0] = 1.0 / row.0;
    }
    for i in (0..m).rev() {
        let mut y = x[i] * band[i][0];
        for k in 1..W {
            if i + k < m {
                y -= band[i + k][k] * x[i + k];
            }
        }
        x[i] = y;
    }
}

/// Returns the pivot and the multipliers of one row. `rows[k]` and `pivots[k]` belong to the row that is k + 1 rows above.
#[inline(always)]
fn factor_row<const W: usize>(a: [f64; W], rows: &[[f64; W]; W], pivots: &[f64; W]) -> (f64, [f64; W]) {
    // u[k] = lᵢ,ᵢ₋ₖ dᵢ₋ₖ, from the farthest column to the nearest one.
    let mut u = a;
    let mut l = [0.0; W];
    for k in (1..W).rev() {
        for far in k + 1..W {
            // Column i − far of row i − k, if this column lies within the band.
            u[k] -= u[far] * rows[k - 1][far - k];
        }
        l[k] = u[k] / pivots[k - 1];
    }
    let mut pivot = a[0];
    for k in 1..W {
        pivot -= u[k] * l[k];
    }
    (pivot, l)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;
    use nalgebra::{DMatrix, DVector};

    fn check<const W: usize>(m: usize) {
        let mut random = SplitMix64::new(m as u64);
        let mut dense = DMatrix::<f64>::identity(m, m);
        for start in 0..m.saturating_sub(W - 1) {
            let d =
                DVector::from_fn(m, |i, _| if i >= start && i < start + W { random.normal() } else { 0.0 });
            dense += &d * d.transpose();
        }
        let mut band: Band<W> =
            (0..m).map(|i| std::array::from_fn(|k| if k <= i { dense[(i, i - k)] } else { 0.0 })).collect();
        let f = DVector::from_fn(m, |_, _| random.normal());
        let mut x = f.as_slice().to_vec();
        solve(&mut band, &mut x);
        let exact = dense.cholesky().unwrap().solve(&f);
        assert!((DVector::from_vec(x) - exact).amax() < 1e-12);
    }

    #[test]
    fn agrees_with_a_dense_factorization() {
        check::<3>(50);
        check::<4>(51);
        check::<3>(3);
        check::<4>(2);
        check::<5>(30);
    }
}
