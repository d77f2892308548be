/// A matrix over the pairs of a chain's joints. Its entries are `Σ before.0[r][i] before.1[r][j]` if j < i,
/// `diagonal[i]` if j = i, and `Σ beyond.0[r][i] beyond.1[r][j]` if j > i.
#[inline]
pub fn pairs<const N: usize, const L: usize, const W: usize, const A: usize, const B: usize>(
    before: (&[[f64; L]; A], &[[f64; L]; A]),
    beyond: (&[[f64; L]; B], &[[f64; L]; B]),
    diagonal: &[[f64; L]; 1],
    to: &mut [[f64; W]; N],
) {
    for (i, to) in to.iter_mut().enumerate() {
        let (is_before, is_own) = (&Masks::<L>::BEFORE[i], &Masks::<L>::OWN[i]);
        let own = diagonal[0][i];
        let mut row = [0.0; L];
        // The loop over the columns is the outer loop, so that it becomes one sequence of vector operations.
        for j in 0..L {
            let mut lower = before.0[0][i] * before.1[0][j];
            for r in 1..A {
                lower = add_product(lower, before.0[r][i], before.1[r][j]);
            }
            let mut upper = beyond.0[0][i] * beyond.1[0][j];
            for r in 1..B {
                upper = add_product(upper, beyond.0[r][i], beyond.1[r][j]);
            }
            row[j] = choose(is_before[j], lower, choose(is_own[j], own, upper));
        }
        to.copy_from_slice(row.split_at(W).0);
    }
}
