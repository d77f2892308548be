/// A matrix over the pairs of a tree's joints, K columns at a time: `Σ before.0[r][i] before.1[r][j]` where j is before
/// i on its path to the base (`relations[i][j]` is −1), `diagonal[i]`, `Σ beyond.0[r][i] beyond.1[r][j]` where i is before
/// j (1), and 0 elsewhere.
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const K: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
    relations: &[[i8; L]; N],
) {
    for (i, (to, relations)) in to.iter_mut().zip(relations).enumerate() {
        let mut row = [0.0; L];
        let blocks = row.as_chunks_mut::<K>().0.iter_mut();
        for (block, (row, relations)) in blocks.zip(relations.as_chunks::<K>().0).enumerate() {
            let before = products::<L, K, A>(before, i, block);
            let beyond = products::<L, K, B>(beyond, i, block);
            for lane in 0..K {
                let is_own = block * K + lane == i;
                let other = if relations[lane] > 0 { beyond[lane] } else { 0.0 };
                let other = if is_own { diagonal[0][i] } else { other };
                row[lane] = if relations[lane] < 0 { before[lane] } else { other };
            }
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
