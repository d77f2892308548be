/// Product `to = −left right`, six rows by K columns at a time. With fewer sums at a time, each addition would
/// wait for the previous one.
#[inline]
pub fn negative_product<const N: usize, const L: usize, const W: usize>(
    left: &[[f64; L]; N],
    right: &[[f64; L]; N],
    to: &mut [[f64; W]; N],
) {
    for (left, to) in left.chunks(6).zip(to.chunks_mut(6)) {
        let mut factors = [[0.0; L]; 6];
        for (factors, left) in factors.iter_mut().zip(left) {
            for (factor, left) in factors.iter_mut().zip(left) {
                *factor = -left;
            }
        }
        let mut rows = [[0.0; L]; 6];
        for block in 0..L / K {
            let mut sums = [[0.0; K]; 6];
            for (k, right) in right.iter().enumerate() {
                let right = &right.as_chunks::<K>().0[block];
                for i in 0..6 {
                    for j in 0..K {
                        sums[i][j] = match k {
                            0 => factors[i][k] * right[j],
                            _ => add_product(sums[i][j], factors[i][k], right[j]),
                        };
                    }
                }
            }
            for (row, sums) in rows.iter_mut().zip(sums) {
                row.as_chunks_mut::<K>().0[block] = sums;
            }
        }
        for (to, row) in to.iter_mut().zip(&rows) {
            to.copy_from_slice(row.split_at(W).0);
        }
    }
}
