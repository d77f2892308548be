/// A matrix over the pairs of a tree's joints, K columns at a time: `Σ before.0[r][i] before.1[r][j]` where j is before
/// i on its path to the base (`relations[i][j]` is −1), `diagonal[i]`, `Σ beyond.0[r][i] beyond.1[r][j]` where i is before
/// j (1), and 0 elsewhere.
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
    relations: &[[i8; L]; N],
) {
    for (i, (to, relations)) in to.iter_mut().zip(relations).enumerate() {
        let (mut lower, mut upper) = ([0.0; L], [0.0; L]);
        for block in 0..L / K {
            lower.as_chunks_mut::<K>().0[block] = products(before, i, block);
            upper.as_chunks_mut::<K>().0[block] = products(beyond, i, block);
        }
        // Chosen in a loop of its own, where it is a vector operation.
        let mut row = [0.0; L];
        for j in 0..L {
            let (before, beyond) = (lower[j], upper[j]);
            let other = if relations[j] > 0 { beyond } else { 0.0 };
            let other = if j == i { diagonal[0][i] } else { other };
            row[j] = if relations[j] < 0 { before } else { other };
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
