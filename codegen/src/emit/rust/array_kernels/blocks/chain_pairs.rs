/// A matrix over the pairs of a chain's joints, K columns at a time. Its entries are
/// `Σ before.0[r][i] before.1[r][j]` if j < i, `diagonal[i]` if j = i, and `Σ beyond.0[r][i] beyond.1[r][j]`
/// if j > i.
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
) {
    for (i, to) in to.iter_mut().enumerate() {
        let (mut lower, mut upper) = ([0.0; L], [0.0; L]);
        for block in 0..L / K {
            if block * K < i {
                lower.as_chunks_mut::<K>().0[block] = products(before, i, block);
            }
            if (block + 1) * K > i {
                upper.as_chunks_mut::<K>().0[block] = products(beyond, i, block);
            }
        }
        // The selection is in a separate loop, in which it becomes a vector operation.
        let mut row = [0.0; L];
        for j in 0..L {
            let (before, beyond) = (lower[j], upper[j]);
            let other = if j > i { beyond } else { diagonal[0][i] };
            row[j] = if j < i { before } else { other };
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
