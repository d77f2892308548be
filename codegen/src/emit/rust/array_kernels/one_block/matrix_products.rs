/// Product `to = −left right`.
#[inline]
pub fn negative_product<const N: usize, const L: usize, const W: usize>(
    left: &[[f64; L]; N],
    right: &[[f64; L]; N],
    to: &mut [[f64; W]; N],
) {
    let factors = left.map(|row| row.map(|factor| -factor));
    let mut rows = [[0.0; L]; N];
    // The loop over the columns is the outer loop, so that it becomes one sequence of vector operations.
    for j in 0..L {
        for i in 0..N {
            let mut sum = factors[i][0] * right[0][j];
            for k in 1..N {
                sum = add_product(sum, factors[i][k], right[k][j]);
            }
            rows[i][j] = sum;
        }
    }
    for (to, row) in to.iter_mut().zip(&rows) {
        to.copy_from_slice(row.split_at(W).0);
    }
}
