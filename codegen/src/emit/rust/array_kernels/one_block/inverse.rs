/// Inverse of a symmetric positive definite matrix in place, by Gauss–Jordan elimination without pivoting,
/// from the last row to the first.
///
/// Whole rows are combined, and a bit mask selects the new entries of the pivot column. If these entries were
/// stored separately, the next step would have to wait for these stores.
#[inline]
pub fn invert<const N: usize, const L: usize>(matrix: &mut [[f64; L]; N]) {
    for k in (0..N).rev() {
        let is_own = &Masks::<L>::OWN[k];
        let reciprocal = 1.0 / matrix[k][k];
        let own = matrix[k];
        let mut factors = [0.0; N];
        for i in 0..N {
            factors[i] = -matrix[i][k];
        }
        let mut scaled = [0.0; L];
        for j in 0..L {
            scaled[j] = choose(is_own[j], reciprocal, own[j] * reciprocal);
            for i in 0..N {
                // −0 + x is x, even for the sign of zero.
                let old = choose(is_own[j], -0.0, matrix[i][j]);
                matrix[i][j] = add_product(old, factors[i], scaled[j]);
            }
        }
        matrix[k] = scaled;
    }
}
