/// Product `to = −left right`, six rows by K columns at a time. With fewer sums at a time, each addition would
/// wait for the previous one.
///
/// - `rows_of`: for each block of columns, the rows of `right` that are non-zero in this block
#[inline]
pub fn negative_product<const N: usize, const L: usize, const W: usize, const B: usize>(
    left: &[[f64; L]; N],
    right: &[[f64; L]; N],
    to: &mut [[f64; W]; N],
    rows_of: &[&[usize]; B],
) {
    for (left, to) in left.chunks(6).zip(to.chunks_mut(6)) {
        let mut factors = [[0.0; L]; 6];
        for (factors, left) in factors.iter_mut().zip(left) {
            for (factor, left) in factors.iter_mut().zip(left) {
                *factor = -left;
            }
        }
        let mut rows = [[0.0; L]; 6];
        for (block, rows_of) in rows_of.iter().enumerate() {
            // −0 + x is x, even for the sign of zero.
            let mut sums = [[-0.0; K]; 6];
            // The limit avoids a bounds check in each step.
            for k in rows_of.iter().map(|&k| k.min(N - 1)) {
                let right = &right[k].as_chunks::<K>().0[block];
                for i in 0..6 {
                    for j in 0..K {
                        sums[i][j] = add_product(sums[i][j], factors[i][k], right[j]);
                    }
                }
            }
            for (row, sums) in rows.iter_mut().zip(sums) {
                row.as_chunks_mut::<K>().0[block] = sums;
            }
        }
        // The blocks are read as they were written. Longer loads would wait for several stores.
        for (to, row) in to.iter_mut().zip(&rows) {
            for (to, row) in to.chunks_mut(K).zip(row.as_chunks::<K>().0) {
                for (to, entry) in to.iter_mut().zip(row) {
                    *to = *entry;
                }
            }
        }
    }
}
