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
        let (own, mut row) = (diagonal[0][i], [0.0; L]);
        for (block, row) in row.as_chunks_mut::<K>().0.iter_mut().enumerate() {
            let (lower, upper) = (products(before, i, block), products(beyond, i, block));
            for lane in 0..K {
                let j = block * K + lane;
                let other = choose(mask(relations[j] > 0), upper[lane], 0.0);
                let other = choose(mask(i == j), own, other);
                row[lane] = choose(mask(relations[j] < 0), lower[lane], other);
            }
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
