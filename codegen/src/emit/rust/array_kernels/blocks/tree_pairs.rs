/// A matrix over the pairs of a tree's joints, K columns at a time. Its entries are
///
/// - `Σ before.0[r][i] before.1[r][j]` if j is before i on its path to the base (`relations[i][j]` is −1)
/// - `diagonal[i]` if j = i
/// - `Σ beyond.0[r][i] beyond.1[r][j]` if i is before j (`relations[i][j]` is 1)
/// - 0 otherwise
///
/// - `blocks`: for each joint i, the blocks of columns with joints before it, and the blocks with joints
///   beyond it
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
    relations: &[[i8; L]; N],
    blocks: [&[&[usize]; N]; 2],
) {
    for (i, to) in to.iter_mut().enumerate() {
        let (relations, blocks) = (&relations[i], blocks.map(|blocks| blocks[i]));
        if W == L {
            pairs_of(i, before, beyond, to, relations, blocks);
        } else {
            // A row that ends within a block is computed with its padding.
            let mut row = [0.0; L];
            pairs_of(i, before, beyond, &mut row, relations, blocks);
            for (to, from) in to.chunks_mut(K).zip(row.as_chunks::<K>().0) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = *from;
                }
            }
        }
        to[i] = diagonal[0][i];
    }
}

/// A row of this matrix without its diagonal entry. Each load has the size of the preceding store, because a
/// longer load would wait for all stores that it overlaps.
#[inline(always)]
fn pairs_of<const L: usize, const W: usize, const A: usize, const B: usize>(
    i: usize,
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    row: &mut [f64; W],
    relations: &[i8; L],
    blocks: [&[usize]; 2],
) {
    *row = [0.0; W];
    let (row, relations) = (row.as_chunks_mut::<K>().0, relations.as_chunks::<K>().0);
    for &block in blocks[0] {
        let (sums, row) = (products(before, i, block), &mut row[block]);
        for lane in 0..K {
            row[lane] = choose(mask(relations[block][lane] < 0), sums[lane], 0.0);
        }
    }
    for &block in blocks[1] {
        let (sums, row) = (products(beyond, i, block), &mut row[block]);
        for lane in 0..K {
            row[lane] = choose(mask(relations[block][lane] > 0), sums[lane], row[lane]);
        }
    }
}
