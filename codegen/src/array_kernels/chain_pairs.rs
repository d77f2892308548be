/// A matrix over the pairs of a chain's joints, K columns at a time: `Σ before.0[r][i] before.1[r][j]` for j < i,
/// `diagonal[i]`, and `Σ beyond.0[r][i] beyond.1[r][j]` for j > i.
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const K: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
) {
    for (i, to) in to.iter_mut().enumerate() {
        let mut row = [0.0; L];
        for (block, row) in row.as_chunks_mut::<K>().0.iter_mut().enumerate() {
            if block * K < i {
                *row = products::<L, K, A>(before, i, block);
            }
            if (block + 1) * K > i {
                let beyond = products::<L, K, B>(beyond, i, block);
                for lane in 0..K {
                    let j = block * K + lane;
                    let other = if j > i { beyond[lane] } else { diagonal[0][i] };
                    row[lane] = if j < i { row[lane] } else { other };
                }
            }
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
